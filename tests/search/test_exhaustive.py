"""The true optimum: every design of a small space; and what the default search makes of large ones."""

from functools import partial

import numpy as np
import pytest
import searching
from hypothesis import given
from hypothesis import strategies as st
from searching import QUICK, stop_after

import footopt as fo
from footopt.design import Solver, search
from footopt.design.scenarios import sands
from footopt.design.solvers.moves import batches, shifts

SPACE = fo.Waypoints(n=4, K=4)
EVERYTHING = np.stack(np.meshgrid(*[range(1, 5)] * 4, indexing="ij"), axis=-1).reshape(-1, 4)


problem = partial(searching.problem, space=SPACE)


@pytest.fixture(scope="module")
def table():
    """All of the space by `evaluate`, and which designs are inside their box."""
    inside = SPACE.box_violation(EVERYTHING) <= SPACE.box_tolerance * SPACE.H
    assert 0 < inside.sum() < len(inside)
    return fo.evaluate(EVERYTHING, problem().scene, QUICK, space=SPACE), inside


@given(st.integers(4, 14), st.integers(1, 14), st.integers(0, 99))
def test_how_far_a_sole_leaves_its_box_is_seen_on_its_contour(n, K, seed):
    space = fo.Waypoints(n=n, K=K)
    k = np.concatenate([space.random(200, seed), np.sort(space.random(200, seed))])
    z = space.contour(k)[:, :, 1]
    far = np.maximum(np.maximum(z.max(axis=1), -space.H - z.min(axis=1)), 0.0)
    np.testing.assert_array_equal(space.box_violation(k), far)
    np.testing.assert_array_equal(space.inside(k), far <= space.box_tolerance * space.H)


class TestExhaustive:
    @given(st.integers(4, 6), st.integers(1, 4), st.integers(1, 700))
    def test_batches_hold_every_design_once(self, n, K, size):
        parts = list(batches(n, K, size))
        k = np.concatenate(parts)
        assert max(map(len, parts)) <= size
        assert len(np.unique(k, axis=0)) == len(k) == K**n
        assert k.min() == 1
        assert k.max() == K

    @pytest.mark.parametrize("size", [7, 1000])
    def test_every_design_inside_its_box_is_walked_once_and_the_best_is_that_of_all(self, table, size):
        values, inside = table
        r = search(problem(), "exhaustive", pop_size=size)
        np.testing.assert_array_equal(r.k, EVERYTHING[inside])
        np.testing.assert_array_equal(r.values[:, :5], values.values[inside])
        assert r.column("efficiency")[r.best] == values.efficiency[inside].min()
        assert (r.designs, r.evaluations, r.stopped) == (inside.sum(), inside.sum(), "")
        assert len(r.history) <= Solver("exhaustive", size).generations(SPACE) == -(-256 // size)
        assert [g.best for g in r.history] == sorted((g.best for g in r.history), reverse=True)

    @pytest.mark.parametrize("size", [7, 1000])
    def test_several_objectives_give_the_exact_front(self, table, size):
        values, inside = table
        f = (values.values * [-1, -1, 1, 1, 1])[inside]
        dominated = [((f <= row).all(axis=1) & (f < row).any(axis=1)).any() for row in f]
        r = search(problem("pareto"), "exhaustive", pop_size=size)
        exact = EVERYTHING[inside][~np.array(dominated)]
        assert sorted(map(tuple, r.k[r.front])) == sorted(map(tuple, exact))


class TestTheDefaultSearch:
    def test_shifts_are_every_run_of_neighbours_once(self):
        moves = shifts(6)
        assert len(np.unique(moves, axis=0)) == len(moves) == 6 * 7
        for move in moves:
            at = np.flatnonzero(move)
            assert len(at) == at[-1] - at[0] + 1
            assert abs(move[at].sum()) == len(at)

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("sand", "best"),
        [
            ("soft", (1, 3, 5, 7, 8, 9, 10, 10, 10, 10, 9)),
            ("regular", (1, 2, 3, 4, 5, 7, 9, 10, 10, 9, 7)),
            ("hard", (2, 6, 6, 2, 1, 1, 1, 1, 3, 4, 1)),
        ],
    )
    def test_the_default_search_finds_the_best_known_design(self, sand, best):
        p = fo.FootProblem(fo.Scene(sand=fo.Sand.named(sand)))
        known = p.minimised(p.evaluate_designs([best]).values)[0, 0]
        found = search(p, walks=1000, seed=1)
        assert found.column("efficiency")[found.best] <= 0.999 * known


@pytest.mark.parametrize("kind", [fo.FootProblem, fo.RobustProblem])
def test_an_enumeration_that_was_stopped_goes_on_to_the_same_end(kind, tmp_path):
    scene = fo.Scene() if kind is fo.FootProblem else sands(fo.Scene())
    problem = kind(scene, space=fo.Waypoints(n=4, K=3), accuracy=QUICK)
    whole = fo.search(problem, "exhaustive", pop_size=20)
    path = tmp_path / "feet.sqlite"
    part = fo.search(problem, "exhaustive", progress=stop_after(2), pop_size=20, store=path)
    assert part.interrupted
    again = fo.search(problem, "exhaustive", pop_size=20, store=path)
    assert again.reused >= part.evaluations
    searching.assert_same(again, whole)
