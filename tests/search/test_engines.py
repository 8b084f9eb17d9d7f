"""Engines: the same result everywhere, to the last bit; a run whose worker dies says so, and is resumed."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import Executor, Future
from pathlib import Path

import numpy as np
import pytest
from running import BRIEF, descendants, ended, footopt, started, wait_for
from searching import assert_same, problem, stop_after

import footopt as fo
from footopt.design import executor, make_executor, search
from footopt.errors import EngineError, FootoptError

BUDGET = {"pop_size": 16, "n_gen": 6, "seed": 3}


class Slow(fo.FootProblem):
    """Each walk takes a while, so that something can happen meanwhile."""

    def walk(self, k):
        time.sleep(0.01 * len(k))
        return super().walk(k)


class Fragile(fo.FootProblem):
    """Some walks raise an exception."""

    def walk(self, k):
        if (k[:, 0] == 2).any():
            raise ZeroDivisionError("a plate without length")
        return super().walk(k)


@pytest.fixture(scope="module")
def undisturbed():
    return search(problem("pareto"), "nsga2", **BUDGET)


class Here(Executor):
    """Makes calls at once, as a worker whose memory is empty."""

    def __init__(self, workers=1):
        self.workers, self.calls = workers, 0

    def submit(self, fn, /, *args):
        self.calls += 1
        executor._received.cache_clear()
        future = Future()
        future.set_result(fn(*args))
        return future


@pytest.mark.parametrize("workers", [1, 3, 1000])
def test_results_do_not_depend_on_chunks(workers, undisturbed):
    there = Here(workers)
    assert_same(undisturbed, search(problem("pareto"), "nsga2", executor=there, **BUDGET))
    assert there.calls >= min(workers, 16)


def test_a_problem_that_no_worker_can_import_is_said():
    class Inner(fo.FootProblem):
        pass

    with pytest.raises(FootoptError, match=r"cannot be sent .*module"):
        search(problem(kind=Inner), "ga", executor=Here(), **BUDGET)
    assert "cannot load the problem (ModuleNotFoundError" in executor.walk_chunk(b"cmissing\nThing\n.", None)


def test_walks_that_raise_are_left_out_and_tried_again(tmp_path, caplog, monkeypatch):
    """Each of its own: those that are walked in one batch with them are good."""
    here, there = (
        search(problem(kind=Fragile), "ga", store=tmp_path / name, executor=pool, **BUDGET)
        for name, pool in (("here", None), ("there", Here(2)))
    )
    assert_same(here, there)
    failed = here.k[:, 0] == 2
    assert 0 < failed.sum() < len(failed)
    assert set(here.reasons[failed]) == {"error: ZeroDivisionError: a plate without length"}
    assert not np.char.startswith(here.reasons[~failed], "error").any()
    assert caplog.text.count("is left out: error: ZeroDivisionError") == 2 * failed.sum()
    again = search(problem(kind=Fragile), "ga", store=tmp_path / "here", **BUDGET)
    assert_same(here, again)
    assert again.reused == (~failed).sum()
    monkeypatch.setattr(Fragile, "walk", fo.FootProblem.walk)  # mended
    mended = search(problem(kind=Fragile), "ga", store=tmp_path / "here", **BUDGET)
    assert not np.char.startswith(mended.reasons, "error").any()
    monkeypatch.setattr(Fragile, "walk", lambda self, k: 1 / 0)
    with pytest.raises(FootoptError, match=r"All 16 designs .* error: ZeroDivisionError: division by zero"):
        search(problem(kind=Fragile), "ga", **BUDGET)


@pytest.mark.slow
class TestProcesses:
    def test_find_what_this_one_finds_are_used_again_and_do_not_hear_ctrl_c(self, undisturbed):
        p, found = problem("pareto"), set()
        for _ in range(2):
            with make_executor("processes", 2) as two:
                found |= set(two._processes)
                for pid in two._processes:
                    os.kill(pid, signal.SIGINT)
                assert_same(undisturbed, search(p, "nsga2", executor=two, **BUDGET))
        assert len(found) == 2
        with make_executor("processes", 2) as two:
            assert len(search(p, "nsga2", stop_after(2), executor=two, **BUDGET).history) == 2

    def test_one_that_dies_ends_the_search_and_the_next_one_goes_on(self, undisturbed, tmp_path):
        path = tmp_path / "designs.sqlite"

        def kill(generation):
            if generation.generation == 3:
                threading.Timer(0.03, os.kill, (next(iter(two._processes)), signal.SIGKILL)).start()

        with pytest.raises(EngineError, match="died"), make_executor("processes", 2) as two:
            search(problem("pareto", kind=Slow), "nsga2", kill, path, two, **BUDGET)
        with make_executor("processes", 2) as two:
            resumed = search(problem("pareto", kind=Slow), "nsga2", None, path, two, **BUDGET)
        assert resumed.reused == len(resumed.k[resumed.generation <= 3])
        assert_same(undisturbed, resumed)

    def test_a_run_whose_worker_dies_says_how_to_go_on_and_does(self, tmp_path):
        words = [*BRIEF, "solver=nsga2", "report=light"]
        assert footopt(*words, "hydra.run.dir=whole", cwd=tmp_path).returncode == 0
        run = started(*words, "engine=processes", "engine.workers=2", "hydra.run.dir=run", cwd=tmp_path)
        wait_for(run, "Searching")
        time.sleep(1.0)
        commands = {pid: Path(f"/proc/{pid}/cmdline").read_bytes() for pid in descendants(run.pid)}
        workers = [pid for pid, command in commands.items() if b"popen_loky" in command]
        os.kill(workers[0], signal.SIGKILL)
        _, err = ended(run)
        assert run.returncode == 1
        assert "error: A worker process has died" in err
        assert "go on with: footopt resume=" in err
        assert "Traceback" not in err
        assert footopt("resume=run", cwd=tmp_path).returncode == 0
        assert (tmp_path / "run/designs.csv").read_bytes() == (tmp_path / "whole/designs.csv").read_bytes()


@pytest.mark.slow
def test_dask_finds_the_same_to_the_byte_and_no_scheduler_is_said(tmp_path):
    pytest.importorskip("distributed", reason="needs the extra footopt[dask]")
    with pytest.raises(EngineError, match=r"'tcp://127\.0\.0\.1:1': no scheduler .* within 0\.5 s"):
        make_executor("dask", address="tcp://127.0.0.1:1", timeout=0.5).__enter__()
    file, env = tmp_path / "scheduler.json", os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}

    def start(kind, *options):
        command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", "--scheduler-file", file, *options]
        command += ["--host", "127.0.0.1", "--no-dashboard"]
        return subprocess.Popen(command, env=env, stderr=subprocess.DEVNULL)

    alone = ("--nthreads", "1", "--no-nanny", "--local-directory", tmp_path)
    processes = [start("scheduler", "--port", "0"), start("worker", *alone), start("worker", *alone)]
    try:
        while not (file.is_file() and file.stat().st_size):
            time.sleep(0.05)
        there = f"engine.address={json.loads(file.read_text())['address']}", "engine.timeout=60"
        found = []
        for engine in ("local",), ("processes",), ("dask", *there):
            words = [*BRIEF, "solver.n_gen=5", "report=light", f"hydra.run.dir={engine[0]}"]
            done = footopt(*words, f"engine={engine[0]}", *engine[1:], cwd=tmp_path)
            assert done.returncode == 0, done.stderr
            found.append((tmp_path / engine[0] / "designs.csv").read_bytes())
        assert found == [found[0]] * 3
    finally:
        for process in processes:
            process.kill()
            process.wait()
