"""Sweeps by Hydra's launchers: many jobs at a time, on this machine or on a cluster."""

import json
import os
import signal
import time

import pytest
from running import BRIEF, children, ended, footopt, outcome, program, started, stored

pytestmark = pytest.mark.slow


@pytest.fixture(autouse=True)
def submitit():
    pytest.importorskip("hydra_plugins.hydra_submitit_launcher", reason="needs footopt[submitit]")


def test_a_sweep_finds_what_each_job_finds_alone_and_ends_with_a_table(tmp_path):
    arguments = [*BRIEF, "solver.n_gen=3", "hydra.sweep.dir=sweep"]
    done = footopt(*arguments, "sand.zeta=5", "solver.seed=2", "hydra.run.dir=alone", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    done = program(
        "-m",
        "hydra/launcher=submitit_local",
        "solver.seed=2",
        "sand.zeta=5,0.001",
        *arguments,
        cwd=tmp_path,
    )
    assert done.returncode == 1, done.stderr  # nobody walks on sand of zeta 0.001
    assert "2 runs in" in done.stdout
    assert "1 of the jobs failed" in done.stderr
    assert "Traceback" not in done.stderr
    assert (tmp_path / "sweep" / "1" / "error.txt").read_text().startswith("No feasible design")
    assert outcome(tmp_path / "sweep" / "0") == outcome(tmp_path / "alone")


def test_a_job_that_is_killed_leaves_the_others_and_is_resumed(tmp_path):
    command = ["-m", "hydra/launcher=submitit_local", "solver.seed=1,2", *BRIEF, "hydra.sweep.dir=sweep"]
    run = started(*command, cwd=tmp_path)
    _, victim = searching(run, tmp_path / "sweep" / ".submitit")
    os.kill(victim, signal.SIGKILL)
    _, err = ended(run)
    assert run.returncode == 1
    assert "footopt: error: a job was lost" in err
    assert "footopt resume=FOLDER" in err
    assert "Traceback" not in err
    deadline = time.monotonic() + 120
    while (done := footopt("resume=sweep", cwd=tmp_path)) and "at work" in done.stdout:
        assert time.monotonic() < deadline  # the other job goes on by itself, and is left alone
        time.sleep(0.5)
    assert done.returncode == 0, done.stderr
    reused = [json.loads((tmp_path / "sweep" / n / "result.json").read_text())["reused"] for n in "01"]
    assert max(reused) > 0


def searching(run, folder):
    """The log and the process of a sweep's job, when all of them are searching."""
    end = time.monotonic() + 120
    while True:
        logs = list(folder.glob("*/*_0_log.out"))
        jobs = [path.parent for path in folder.parent.glob("*/designs.sqlite")]
        if len(jobs) == len(logs) > 0 and all(stored(job) >= 3 * 16 for job in jobs):
            break
        assert run.poll() is None
        assert time.monotonic() < end
        time.sleep(0.02)
    (process,) = children(int(logs[0].parent.name))
    return logs[0], process
