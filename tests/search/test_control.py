"""A search can be stopped, begun with designs, and watched."""

import numpy as np
import pytest
from searching import SMALL, objective_of, problem

import footopt as fo
from footopt.design import search
from footopt.design.solvers.moves import IDLE, RandomInside

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

    def test_the_line_that_is_kept_up_to_date_ends_with_the_search(self, capsys):
        search(problem(), "ga", True, **BUDGET | {"n_gen": 2})
        said = capsys.readouterr().err
        assert said.count("\n") == 1
        assert said.endswith("\n")

    def test_a_local_search_that_asks_for_the_same_again_is_told_and_a_plan_is_not(self):
        from pymoo.algorithms.soo.nonconvex.nelder import NelderMead

        again = search(problem(), NelderMead(), walks=300)
        assert again.designs < 300
        assert "nothing more" in again.stopped
        assert search(problem(), NelderMead(), n_gen=2).stopped == ""
        assert search(problem(), NelderMead(), stop=("n_gen", 2)).stopped == ""

    def test_after_a_time(self):
        found = search(problem(), "ga", seconds=1e-9, **BUDGET)
        assert len(found.history) == 1
        assert found.stopped == "after 1e-09 s"


class TestStart:
    def test_random_designs_are_drawn_until_some_draws_bring_nothing_new(self):
        """Of one design, which each draw finds."""
        drawn, space = [], fo.Waypoints(n=4, K=1)

        class Draw:
            def integers(self, low, high, shape):
                drawn.append(np.broadcast_to(low, shape))
                return drawn[-1]

        found = RandomInside()._do(problem(space=space), 5, Draw())
        assert found.tolist() == [[1] * 4]
        assert len(drawn) == 1 + IDLE

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
