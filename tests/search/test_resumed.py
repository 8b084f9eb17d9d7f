"""A search that dies at any moment and is begun again ends as one that nothing happened to.

FOOTOPT_TRIES says how many random searches are drawn for each solver.
"""

from contextlib import suppress

import numpy as np
import pytest
from running import QUICK, footopt, tries
from searching import assert_same, problem

import footopt as fo
from footopt.design import Store, search

TWO, THREE = ["distance", "work"], ["distance", "work", "peak_power"]
#: Of each solver: objectives to choose from, and walks that it has at most.
SEARCHES = {
    "memetic": ([["efficiency"], ["peak_power"]], 260),
    "archive": ([TWO, THREE], 120),
    "nsga2": ([THREE, "pareto"], 120),
    "auto": ([["efficiency"], TWO], 120),
}


class Killed(BaseException):
    """The process is no more."""


def dying(store, after, kept):
    """A store whose process dies with its so-manieth batch of walks, which are kept or lost."""
    add = store.add

    def added(*designs):
        nonlocal after
        after -= 1
        if after or kept:
            add(*designs)
        if not after:
            raise Killed

    store.add = added
    return store


@pytest.mark.parametrize("name", SEARCHES)
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


def test_a_run_s_search_again_begins_where_it_did_and_a_choice_beyond_its_limits_is_told(tmp_path):
    words = ["study.start=[1,2,3,4,5,6,7,8,8,8,8]", "objective=[distance,work]", "report=light", "sand=soft"]
    choice = ["choose=limits", "choose.limits={work: 1}", "study.confirm=null", "hydra.run.dir=run"]
    done = footopt(*QUICK, *words, *choice, cwd=tmp_path)
    assert "choose.limits.work=1" in done.stdout + done.stderr
    run = fo.load(tmp_path / "run")
    again = run.search()
    assert again.reused == again.evaluations
    assert run.foot.k == tuple(again.k[again.best].tolist())
