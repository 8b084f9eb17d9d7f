"""Faults at random moments, from a seed; FOOTOPT_TRIES says how many of each."""

import json
import os
import random
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from running import (
    BRIEF,
    children,
    descendants,
    ended,
    environment,
    folder_of,
    footopt,
    outcome,
    started,
    wait_for,
)

TRIES = int(os.environ.get("FOOTOPT_TRIES", "3"))
SHORT = (*BRIEF, "solver=nsga2", "engine.workers=2")

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """The folder of a run that nothing happened to."""
    return folder_of(tmp_path_factory, *BRIEF, "solver=nsga2")


def same(folder, other):
    one, two = outcome(folder), outcome(other)
    assert one[0] | {"settings": 0} == two[0] | {"settings": 0}
    assert one[1:] == two[1:]


@pytest.mark.parametrize("seed", range(TRIES))
def test_ctrl_c_at_any_moment_ends_with_130_and_without_a_traceback(seed, undisturbed, tmp_path):
    """From the first line of footopt on; before that, Python itself says what it thinks of it."""
    random.seed(seed)
    run = started(*BRIEF, "solver=nsga2", "hydra.run.dir=run", cwd=tmp_path)
    time.sleep(0.4 + random.uniform(0.0, 5.0))
    run.send_signal(signal.SIGINT)
    _, err = ended(run)
    assert run.returncode == 130, err
    assert "Traceback" not in err
    assert "footopt: stopped" in err
    if (tmp_path / "run" / "designs.sqlite").is_file():
        done = footopt("resume=run", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        same(tmp_path / "run", undisturbed)


@pytest.mark.parametrize("seed", range(TRIES))
def test_ctrl_c_in_a_job_s_first_generation_stops_the_sweep(seed, tmp_path):
    random.seed(seed)
    slow = [*BRIEF, "solver.pop_size=2000", "foot.n=11", "accuracy.dt=2e-4", "solver.n_gen=2"]
    run = started("-m", "solver.seed=1,2", *slow, "hydra.sweep.dir=sweep", cwd=tmp_path)
    wait_for(run, "Searching")
    time.sleep(random.uniform(0.0, 1.0))
    run.send_signal(signal.SIGINT)
    _, err = ended(run)
    assert run.returncode == 130, err
    assert "stopped before a feasible design was found; go on with" in err
    assert not (tmp_path / "sweep" / "1" / "designs.sqlite").exists()


@pytest.mark.parametrize("seed", range(TRIES))
@pytest.mark.parametrize("who", ["head", "workers", "all"])
def test_memory_that_is_short_for_half_a_second_is_survived_or_said(who, seed, undisturbed, tmp_path):
    random.seed(seed)
    run = started(*SHORT, "engine=processes", "hydra.run.dir=run", cwd=tmp_path)
    wait_for(run, "Searching")
    time.sleep(random.uniform(0.0, 2.0))
    family = {"head": {run.pid}, "workers": descendants(run.pid)}
    hit = family["head"] | family["workers"] if who == "all" else family[who]
    for limit in (random.choice([0, 10**4, 10**5, 10**6]), None):
        for pid in hit:
            try:
                size = 4096 * int(Path(f"/proc/{pid}/statm").read_text().split()[0])
                most = resource.RLIM_INFINITY if limit is None else size + limit
                resource.prlimit(pid, resource.RLIMIT_AS, (most, resource.RLIM_INFINITY))
            except (ProcessLookupError, FileNotFoundError):
                continue
        time.sleep(0.5)
    _, err = ended(run, limit=150)
    assert run.returncode in (0, 1), err
    assert "This is a bug" not in err
    if run.returncode:
        done = footopt("resume=run", "engine=local", "engine.workers=null", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    same(tmp_path / "run", undisturbed)


@pytest.mark.parametrize("seed", range(TRIES))
@pytest.mark.parametrize("how", [signal.SIGSTOP, signal.SIGKILL])
def test_a_worker_that_is_stopped_or_killed_changes_nothing(how, seed, undisturbed, tmp_path):
    random.seed(seed)
    run = started(*SHORT, "engine=processes", "hydra.run.dir=run", cwd=tmp_path)
    if seed % 2:  # it searches; else its workers are starting, or not even that
        wait_for(run, "Searching")
    time.sleep(random.uniform(0.0, 4.0))
    # all processes of a pool have one command; their server, which is the run's own child, is no worker
    hit = [
        pid for pid in sorted(descendants(run.pid) - children(run.pid)) if b"design.engines" in command(pid)
    ]
    for pid in random.sample(hit, min(1, len(hit))):
        os.kill(pid, how)
    _, err = ended(run, limit=150)
    assert run.returncode == 0, err
    same(tmp_path / "run", undisturbed)


def command(pid):
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return b""


@pytest.mark.parametrize("seed", range(TRIES))
def test_a_kill_while_a_finished_run_is_extended_leaves_every_file_whole(seed, undisturbed, tmp_path):
    random.seed(seed)
    first = [*BRIEF, "solver=nsga2", "hydra.run.dir=run"]
    assert footopt(*first, cwd=tmp_path).returncode == 0
    files = [
        path
        for path in (tmp_path / "run").rglob("*")
        if path.suffix in (".csv", ".dxf", ".svg", ".stl", ".nc", ".json")
    ]
    run = started("resume=run", "solver.n_gen=26", cwd=tmp_path)
    wait_for(run, "Searching")
    time.sleep(random.uniform(0.0, 2.5))
    run.kill()
    ended(run)
    for path in files:
        assert path.stat().st_size > 0, path
    json.loads((tmp_path / "run" / "result.json").read_text())
    done = footopt("resume=run", "solver.n_gen=26", cwd=tmp_path)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("megabytes", random.Random(1).sample(range(300, 1200, 10), min(TRIES, 90)))
def test_a_small_address_space_is_no_bug(megabytes, tmp_path):
    limit = megabytes << 20
    done = subprocess.run(
        [sys.executable, "-m", "footopt", *BRIEF, "hydra.run.dir=run"],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=300,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
    )
    assert "This is a bug" not in done.stderr
