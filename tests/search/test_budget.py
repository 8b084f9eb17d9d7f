"""A search's budget is in walks: it has just as many, of different soles, none outside its box by moves."""

import numpy as np
import pytest
from pymoo.core.problem import Problem
from pymoo.optimize import minimize
from searching import assert_same, problem
from threadpoolctl import threadpool_limits

import footopt as fo
from footopt.design import EXHAUSTIVE, Solver, search
from footopt.design.solvers.memetic import Memetic

SEVEN = fo.Waypoints(n=7)
GROWING = [("memetic", "efficiency"), ("archive", ["distance", "work"])]
BY_MOVES = [*GROWING, ("nsga2", ["distance", "work"])]


class Ridge(Problem):
    """Whole numbers with many local optima, a number of constraints, and walks that cost nothing."""

    def __init__(self, n_var=8, top=9):
        super().__init__(n_var=n_var, n_obj=1, n_ieq_constr=1, xl=1, xu=top, vtype=int)
        self.asked = []

    def _evaluate(self, x, out, *args, **kwargs):
        self.asked += x.astype(int).tolist()
        wave = (x * 7) % 5 + np.abs(np.diff(x, axis=1, append=1)) % 3
        out["F"] = ((x - 5) ** 2 + 4 * wave).sum(axis=1)
        out["G"] = -np.ones(len(x))


@pytest.mark.parametrize("walks", [57, 140])
@pytest.mark.parametrize(("name", "objective"), [*BY_MOVES, ("ga", "work"), ("soo.nonconvex.de.DE", "work")])
def test_a_search_has_as_many_walks_as_it_is_given(name, objective, walks):
    r = search(problem(objective, space=SEVEN), name, walks=walks, seed=1)
    assert r.designs == walks
    assert len(np.unique(r.k, axis=0)) == walks
    assert r.stopped == ""
    if (name, objective) in BY_MOVES:
        assert r.evaluations == r.designs
        assert "box" not in r.reasons


@pytest.mark.parametrize(("name", "objective"), GROWING)
def test_more_walks_go_on_where_fewer_ended(name, objective, tmp_path):
    """The first generations are small at any budget, so that nothing walked is walked in vain."""
    p, store = problem(objective, space=SEVEN), tmp_path / "feet.sqlite"
    few = search(p, name, walks=90, seed=1, store=store)
    many = search(p, name, walks=200, seed=1, store=store)
    assert many.k[:90].tolist() == few.k.tolist()
    assert many.reused == 90
    assert_same(many, search(p, name, walks=200, seed=1))


def test_generations_grow_from_ten_to_a_hundred():
    solver = Solver("memetic")
    r = search(problem(space=SEVEN), Solver("memetic", walks=260))
    sizes = np.diff([0, *(g.evaluations for g in r.history)]).tolist()
    expected = [size for size, _ in zip(solver.sizes(), sizes, strict=False)]
    assert sizes[:-1] == expected[:-1] == sorted(expected[:-1])
    assert sizes[0] == 10
    assert max(size for size, _ in zip(solver.sizes(), range(200), strict=False)) == 100
    assert len(sizes) == r.solver.generations(SEVEN)


@pytest.mark.parametrize(
    ("solver", "generations"),
    [
        (Solver("ga"), 100),
        (Solver("ga", walks=250), 3),
        (Solver("ga", pop_size=20, n_gen=7), 7),
        (Solver("memetic", pop_size=50, walks=120), 3),
        (Solver("memetic", n_gen=7, walks=50), 5),
        (Solver(EXHAUSTIVE), 2442),
    ],
)
def test_generations_follow_from_walks(solver, generations):
    assert solver.generations(SEVEN) == generations


def test_the_best_solver_for_the_number_of_objectives_is_the_default():
    assert [Solver().fitting(n).name for n in (1, 2, 3, 5)] == ["memetic", "archive", "archive", "archive"]
    assert Solver("rvea").fitting(5).name == "rvea"


def test_what_is_asked_for_does_not_depend_on_the_number_of_threads_of_sums():
    """Of the model's, which are those of a BLAS; it knows 300 designs at most."""
    asked = []
    for threads in (1, 2):
        with threadpool_limits(threads, "blas"):
            minimize(p := Ridge(), Memetic(), ("n_gen", 30), seed=1)
        asked.append(p.asked)
    assert asked[0] == asked[1]
    assert len(asked[0]) > 300


def test_it_begins_anew_where_it_stalls_and_ends_where_nothing_is_new():
    """Up to 3^4 soles of a space that it would have left a part of."""
    algorithm, p = Memetic().setup(Ridge(4, 3), termination=("n_gen", 1000), seed=1), Ridge(4, 3)
    algorithm.problem = p
    algorithm.run()
    assert len(p.asked) == len({tuple(x) for x in p.asked}) == 81
    r = search(problem(space=fo.Waypoints(n=4, K=3)), walks=1000)
    inside = search(problem(space=fo.Waypoints(n=4, K=3)), EXHAUSTIVE)
    assert r.designs == inside.evaluations
    assert "by the solver" in r.stopped


def test_operators_that_are_given_take_the_place_of_moves():
    p = problem(["distance", "work"], space=SEVEN)
    moves, textbook = (search(p, "nsga2", walks=60, seed=1, operators=given) for given in (None, {}))
    assert "box" not in moves.reasons
    assert "box" in textbook.reasons


@pytest.mark.slow
def test_tight_limits_are_met_within_three_hundred_walks():
    """What violates more is worse to the model of the walks, too: before, half of ten searches met none."""
    scene, limits = fo.Scene(sand=fo.Sand.named("hard")), {"peak_power": 200.0, "work": 180.0}
    problem = fo.FootProblem(scene, accuracy="draft", limits=limits)
    assert all(fo.search(problem, "memetic", walks=300, seed=seed).feasible.any() for seed in range(10))
