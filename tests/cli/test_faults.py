"""Faults at random moments, from a seed; FOOTOPT_TRIES says how many of each, FOOTOPT_SEED where seeds begin.

Whatever happens to a run, it ends with what a run finds that nothing happened to, or says what is wrong and
does so when it is resumed.
"""

import json
import os
import random
import re
import resource
import signal
import subprocess
import sys
import time

import pytest
from running import (
    BRIEF,
    assert_gone,
    descendants,
    ended,
    environment,
    footopt,
    outcome,
    program,
    seeds,
    started,
    tries,
    wait_for,
)

from footopt.design import EXHAUSTIVE, SOLVERS
from footopt.files import identity

ENGINES = {
    "local": ["engine=local"],
    "processes": ["engine=processes", "engine.workers=2"],
}
HERE = ["engine=local", "engine.workers=null"]
#: A space that is walked whole takes other words.
WHOLE = [*(w for w in BRIEF if not w.startswith(("foot", "solver"))), "foot.n=4", "foot.K=4",
         "solver.pop_size=16"]  # fmt: skip

pytestmark = pytest.mark.slow


def words_of(solver):
    return [*(WHOLE if solver == EXHAUSTIVE else BRIEF), f"solver={solver}", "report=light"]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """Folders of runs that nothing happened to, by solver."""
    cwd = tmp_path_factory.mktemp("undisturbed")

    def folder(solver="nsga2"):
        if not (cwd / solver).exists():
            done = footopt(*words_of(solver), f"hydra.run.dir={solver}", cwd=cwd)
            assert done.returncode == 0, done.stderr
        return cwd / solver

    return folder


def same(folder, other):
    one, two = outcome(folder), outcome(other)
    assert one[0] | {"settings": 0} == two[0] | {"settings": 0}
    assert one[1:] == two[1:]


def finished(folder, first):
    """Go on with a run, or begin it, in this process, until it has ended."""
    begun = (folder / identity.FILE).is_file()
    done = footopt(*([f"resume={folder.name}", *HERE] if begun else first), cwd=folder.parent)
    assert done.returncode == 0, done.stderr


def clear(err):
    assert "Traceback" not in err
    assert "This is a bug" not in err
    assert "unexpected" not in err


@pytest.mark.parametrize("seed", seeds(3))
def test_signals_at_any_moment_change_no_result(seed, undisturbed, tmp_path):
    """Two or three a run: Ctrl-C, a kill, SIGTERM, or a stop for a while; every solver, every engine.

    From the first line of footopt on; before that, Python itself says what it thinks of Ctrl-C. A terminal
    sends it to workers, too. No process outlives its run.
    """
    draw, folder = random.Random(seed), tmp_path / "run"
    solvers, engines = [*SOLVERS, EXHAUSTIVE], [*ENGINES]
    solver, engine = solvers[(4 * seed + 3) % len(solvers)], engines[(seed + seed // len(solvers)) % 2]
    first = [*words_of(solver), "hydra.run.dir=run"]
    for _ in range(2 + seed % 2):
        begun = (folder / identity.FILE).is_file()
        words = ["resume=run"] if begun else first
        run = started(*words, *ENGINES[engine], cwd=tmp_path, start_new_session=True)
        if draw.random() < 0.5:
            wait_for(run, "Searching")
            time.sleep(draw.uniform(0.0, 1.5))
        else:
            time.sleep(0.4 + draw.uniform(0.0, 5.0))
        sent = draw.choice([signal.SIGINT, signal.SIGINT, signal.SIGKILL, signal.SIGTERM, signal.SIGSTOP])
        family = descendants(run.pid)
        (os.killpg if sent == signal.SIGINT else os.kill)(run.pid, sent)
        if sent == signal.SIGSTOP:
            time.sleep(1.0)
            run.send_signal(signal.SIGCONT)
        _, err = ended(run)
        clear(err)
        assert_gone(family)
        assert run.returncode in (0, {signal.SIGINT: 130, signal.SIGSTOP: 0}.get(sent, -sent)), err
        assert run.returncode != 130 or "footopt: stopped" in err
    finished(folder, first)
    same(folder, undisturbed(solver))


LOADING = """
import pathlib, sys, time, footopt.studies.simulate
pathlib.Path("half.py").write_text("import signal; signal.raise_signal(signal.SIGINT); print('whole')")
sys.path.append(".")
def run(study):
    import half
    time.sleep(60.0)
footopt.studies.simulate.run = run
"""


@pytest.mark.parametrize("code", ['exec("raise KeyboardInterrupt")', LOADING], ids=["exec", "loading"])
def test_ctrl_c_inside_code_that_a_library_makes_has_its_exit_code_too(code, tmp_path):
    """Python -m would end itself by SIGINT once `exec` has been interrupted, whatever is done about it, and
    half a library of compiled code would abort it: an import is ended first.
    """
    (tmp_path / "made.py").write_text(code)
    done = program("study=simulate", "plugins=[made.py]", cwd=tmp_path)
    assert (done.returncode, done.stderr.partition(";")[0]) == (130, "footopt: stopped")
    assert ("whole" in done.stdout) == (code == LOADING)


@pytest.mark.parametrize("seed", seeds(1))
def test_ctrl_c_in_a_job_s_first_generation_stops_the_sweep(seed, tmp_path):
    slow = [*BRIEF, "solver.pop_size=2000", "foot.n=11", "accuracy.dt=2e-4", "solver.n_gen=2"]
    run = started("-m", "solver.seed=1,2", *slow, "hydra.sweep.dir=sweep", cwd=tmp_path)
    wait_for(run, "Searching")
    time.sleep(random.Random(seed).uniform(0.0, 1.0))
    run.send_signal(signal.SIGINT)
    _, err = ended(run)
    assert run.returncode == 130, err
    assert "stopped before a feasible design was found; go on with" in err
    assert not (tmp_path / "sweep" / "1" / "designs.sqlite").exists()


@pytest.mark.parametrize("seed", seeds(1))
def test_a_kill_while_a_finished_run_is_extended_leaves_every_file_whole(seed, tmp_path):
    folder = tmp_path / "run"
    assert footopt(*words_of("nsga2"), "hydra.run.dir=run", cwd=tmp_path).returncode == 0
    endings = (".csv", ".dxf", ".svg", ".stl", ".nc", ".json", ".html", ".yaml")
    files = [path for path in folder.rglob("*") if path.suffix in endings]
    run = started("resume=run", "solver.n_gen=26", cwd=tmp_path)
    wait_for(run, "Searching")
    time.sleep(random.Random(seed).uniform(0.0, 2.5))
    run.kill()
    ended(run)
    for path in files:
        assert path.stat().st_size > 0, path
    result = json.loads((folder / "result.json").read_text())
    assert identity.read(folder).settings == result["settings"]
    done = footopt("resume=run", "solver.n_gen=26", cwd=tmp_path)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("seed", seeds(1))
def test_a_disk_that_fills_at_any_moment_is_said_and_what_was_kept_is_used(seed, undisturbed, tmp_path):
    """No file may grow beyond a size, of 1 to 250 kB: the store, a table or a drawing is cut first."""
    size, folder = int(10 ** random.Random(seed).uniform(3.0, 5.4)), tmp_path / "run"
    first = [*words_of("memetic"), "hydra.run.dir=run"]

    def full():
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    run = started(*first, cwd=tmp_path, preexec_fn=full)
    _, err = ended(run)
    clear(err)
    assert run.returncode == 0 or re.search(
        "footopt: error: .*(cannot be written|cannot write|Make room)", err
    )
    assert not list(folder.rglob(".*"))  # nothing half-written stays
    finished(folder, first)
    same(folder, undisturbed("memetic"))


@pytest.mark.skipif(os.geteuid() != 0, reason="only root mounts a disk")
@pytest.mark.parametrize("seed", seeds(1))
def test_a_small_disk_that_is_full_is_said_and_a_larger_one_is_enough(seed, undisturbed, tmp_path):
    """A disk in memory of 4 kB to 2 MB; once it is larger the run goes on."""
    draw, disk = random.Random(seed), tmp_path / "disk"
    size = int(4 * 10 ** draw.uniform(0.0, 2.7))
    engine, solver = list(ENGINES)[draw.randrange(2)], draw.choice(["memetic", "nsga2"])
    first = [*words_of(solver), "hydra.run.dir=run"]
    disk.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "tmpfs", disk], check=True)
    try:
        run = started(*first, *ENGINES[engine], cwd=disk)
        _, err = ended(run)
        clear(err)
        assert run.returncode == 0 or "footopt: error: " in err, err
        assert not list((disk / "run").rglob(".*"))
        subprocess.run(["mount", "-o", "remount,size=200m", disk], check=True)
        finished(disk / "run", first)
        same(disk / "run", undisturbed(solver))
    finally:
        subprocess.run(["umount", "-l", disk], check=False)


@pytest.mark.parametrize("seed", seeds(1))
def test_of_runs_begun_at_once_in_a_folder_one_goes_on(seed, tmp_path):
    draw = random.Random(seed)
    words = ["sand=soft", "engine.threads=1", "accuracy=draft", "solver.pop_size=10", "solver.n_gen=3"]
    runs = []
    for number in range(3):
        runs.append(started(*words, "hydra.run.dir=run", f"solver.seed={number}", cwd=tmp_path))
        time.sleep(draw.uniform(0.0, 0.5) * (seed % 3))
    ends = [(ended(run)[1], run.returncode) for run in runs]
    assert sorted(code for _, code in ends) == [0, 1, 1]
    winner = [code for _, code in ends].index(0)
    for said, code in ends:
        assert code == 0 or re.search(r"is at work in this folder|holds (a|another) run", said)
    result = json.loads((tmp_path / "run" / "result.json").read_text())
    assert result["seed"] == identity.read(tmp_path / "run").settings["solver"]["seed"] == winner


@pytest.mark.parametrize("megabytes", random.Random(1).sample(range(300, 1200, 10), min(tries(1), 90)))
def test_a_small_address_space_is_no_bug(megabytes, tmp_path):
    most = megabytes << 20
    done = subprocess.run(
        [sys.executable, "-m", "footopt", *BRIEF, "hydra.run.dir=run"],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=300,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (most, most)),
    )
    clear(done.stderr)
    assert done.returncode == 0 or done.stderr.startswith("footopt: error: ")
