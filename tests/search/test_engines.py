"""Engines: the same result everywhere, to the last bit; a run whose worker dies says so, and is resumed."""

import os
import signal
import threading
import time
from concurrent.futures import Executor, Future

import numpy as np
import pytest
from searching import assert_same, problem

import footopt as fo
from footopt.design import executor, make_executor, search
from footopt.errors import EngineError, FootoptError
from footopt.walk.loop import at_once

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


def test_there_is_a_thread_for_each_processor_that_the_process_may_run_on(monkeypatch):
    allowed = {0: {0, 2, 5}}
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: allowed.get(process, {1}), raising=False)
    assert (at_once(), at_once(7)) == (3, 7)


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
    with pytest.raises(FootoptError, match=r"cannot load the problem \(ModuleNotFoundError"):
        executor.walk_chunk(b"cmissing\nThing\n.", None)


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
def test_processes_find_what_this_one_finds_and_one_that_dies_ends_the_search_which_goes_on(
    undisturbed, tmp_path
):
    """Those of a run that is over are used again, and Ctrl-C is not for them."""
    path, found = tmp_path / "designs.sqlite", set()
    for _ in range(2):
        with make_executor("processes", 2) as two:
            found |= set(two._processes)
            for pid in two._processes:
                os.kill(pid, signal.SIGINT)
            assert_same(undisturbed, search(problem("pareto"), "nsga2", executor=two, **BUDGET))
    assert len(found) == 2

    def kill(generation):
        if generation.generation == 3:
            threading.Timer(0.03, os.kill, (next(iter(two._processes)), signal.SIGKILL)).start()

    with pytest.raises(EngineError, match="died"), make_executor("processes", 2) as two:
        search(problem("pareto", kind=Slow), "nsga2", kill, path, two, **BUDGET)
    resumed = search(problem("pareto", kind=Slow), "nsga2", None, path, **BUDGET)
    assert resumed.reused == len(resumed.k[resumed.generation <= 3])
    assert_same(undisturbed, resumed)
