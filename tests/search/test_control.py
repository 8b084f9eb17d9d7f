"""A search can be stopped, begun with designs, and watched."""

import pytest
from searching import SMALL, objective_of, problem

from footopt.design import search

BUDGET = {"pop_size": 8, "n_gen": 12, "seed": 1}


class TestStop:
    def test_a_progress_that_returns_true_ends_it_with_all_that_was_found(self):
        seen = []

        def watch(generation):
            seen.append(generation.generation)
            return generation.generation == 3

        found = search(problem(), "ga", watch, **BUDGET)
        assert seen == [1, 2, 3]
        assert (len(found.history), found.stopped, found.interrupted) == (3, "by its progress", False)
        whole = search(problem(), "ga", **BUDGET | {"n_gen": 3})
        assert whole.k.tolist() == found.k.tolist()
        assert whole.stopped == ""

    def test_after_a_time(self):
        found = search(problem(), "ga", seconds=1e-9, **BUDGET)
        assert len(found.history) == 1
        assert found.stopped == "after 1e-09 s"


class TestStart:
    @pytest.mark.parametrize("name", ["memetic", "ga", "nsga2"])
    def test_the_first_generation_holds_the_designs(self, name):
        k = SMALL.random(3, seed=5)
        found = search(problem(objective_of(name)), name, start=k, pop_size=8, n_gen=2, seed=1)
        first = set(map(tuple, found.k[found.generation == 1]))
        assert set(map(tuple, k)) <= first
        assert len(first) > 3

    def test_a_search_that_begins_with_the_best_never_loses_it(self):
        best = search(problem(), "exhaustive")
        found = search(problem(), "ga", start=[best.X], **BUDGET)
        assert found.X.tolist() == best.X.tolist()
