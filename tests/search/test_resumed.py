"""A search that dies at any moment and is begun again ends as one that nothing happened to.

FOOTOPT_TRIES says how many random searches are drawn for each solver.
"""

import time
from contextlib import suppress

import numpy as np
import pytest
from running import BRIEF, ended, footopt, started, tries
from searching import assert_same, problem

from footopt.design import Store, search

TWO, THREE = ["distance", "work"], ["distance", "work", "peak_power"]
#: Of each solver: objectives to choose from, and walks that it has at most.
SEARCHES = {
    "memetic": ([["efficiency"], ["peak_power"]], 260),
    "archive": ([TWO, THREE], 120),
    "agemoea2": ([THREE, "pareto"], 120),
    "auto": ([["efficiency"], TWO], 120),
}


class Killed(BaseException):
    """The process is no more."""


def dying(store, after, kept):
    """A store whose process dies with its so-manieth batch of walks, which are kept or lost."""
    add = store.add

    def added(k, evaluations):
        nonlocal after
        after -= 1
        if after or kept:
            add(k, evaluations)
        if not after:
            raise Killed

    store.add = added
    return store


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow) if n == "agemoea2" else n for n in SEARCHES]
)
@pytest.mark.parametrize("seed", range(tries(1)))
def test_a_search_that_dies_anywhere_ends_as_one_that_did_not(name, seed, tmp_path):
    draw, (objectives, most) = np.random.default_rng([seed, len(name)]), SEARCHES[name]
    objective = objectives[draw.integers(len(objectives))]
    zeta, walks = float(np.exp(draw.uniform(-1.0, 2.0))), int(draw.integers(most // 2, most))
    budget = {"walks": walks, "seed": int(draw.integers(100))}
    if name != "auto":
        low, high = (4, 7) if name == "memetic" else (4, 21)  # memetic: it begins anew
        budget["pop_size"] = int(draw.integers(low, high))
    p = problem(objective, zeta)
    whole = search(p, name, **budget)
    path = tmp_path / "feet.sqlite"
    for _ in range(draw.integers(1, 4)):
        with Store(path, p) as store, suppress(Killed):  # it may have too few batches left to die
            search(p, name, store=dying(store, draw.integers(1, 3), draw.random() < 0.5), **budget)
    r = search(p, name, store=path, **budget)
    assert r.evaluations >= walks or "nothing more" in r.stopped
    assert_same(r, whole)


@pytest.mark.slow
def test_a_run_that_is_killed_while_figures_are_drawn_is_resumed_at_once(tmp_path):
    """Nothing of it holds the folder, and what was half-written is replaced."""
    run, folder = started(*BRIEF, "hydra.run.dir=run", cwd=tmp_path, drawn=True), tmp_path / "run"
    while not (folder / "figures").exists():
        assert run.poll() is None, run.stderr.read()
        time.sleep(0.01)
    run.kill()
    run.wait()
    (folder / ".contour.new.csv").write_text("half")
    done = footopt("resume=run", cwd=tmp_path)
    ended(run)
    assert done.returncode == 0, done.stderr
    assert not list(folder.rglob(".*"))
