"""The problem and the search: whole numbers, honest failures, the same result for the same seed."""

import hashlib
from dataclasses import replace

import numpy as np
import pytest
from pymoo.core.problem import Problem
from searching import SMALL, objective_of, problem

import footopt as fo
from footopt.design import SINGLE, Solver, search
from footopt.errors import FootoptError, SettingError

#: Digests of the soles that a search asks for: pop_size=12, n_gen=4, seed=1, n=7, K=10.
ASKED = {
    "memetic": "f1454715b3afb0a6",
    "archive": "c790832f09242d63",
    "ga": "4be32f3df281d981",
    "nsga2": "d93368f6e17a660d",
    "agemoea2": "e4a3946d6a77b802",
    "smsemoa": "db5ed6362d584983",
    "rvea": "1848fb308112d57a",
}


class TestProblem:
    def test_one_call_gives_a_population_s_f_g_and_all_that_is_known(self):
        p, k = problem("pareto"), SMALL.random(6, seed=1)
        assert isinstance(p, Problem)
        assert (p.n_var, p.n_obj, p.n_ieq_constr, p.vtype) == (5, 5, 2, int)
        assert (p.xl.tolist(), p.xu.tolist()) == ([1] * 5, [4] * 5)
        out, found = p.evaluate(k, return_as_dictionary=True), p.evaluate_designs(k)
        for name, column in found._asdict().items():
            np.testing.assert_array_equal(out[name], column)
        np.testing.assert_array_equal(out["F"], p.minimised(found.values))
        np.testing.assert_array_equal(out["G"], p.constraints(*found))

    def test_objectives_are_minimised_with_natural_signs_kept_apart(self):
        p, k = problem("pareto"), SMALL.random(6, seed=1)
        values = p.evaluate_designs(k).values
        table = fo.evaluate(k, p.scene, p.accuracy, space=SMALL)
        np.testing.assert_array_equal(p.minimised(values), table.values * [-1, -1, 1, 1, 1])
        np.testing.assert_array_equal(values[:, :5], table.values)
        np.testing.assert_array_equal(values[:, 5], table.efficiency)

    def test_a_failed_walk_is_finite_and_infeasible_inside_and_nan_outside(self):
        p = problem("pareto", zeta=1e-3)
        found = p.evaluate_designs(SMALL.random(4, seed=3))
        assert np.isfinite(p.minimised(found.values)).all()
        assert (p.constraints(*found)[:, 0] > 0).all()
        assert np.isnan(found.values).all()
        assert set(found.reasons) == {"sunk"}

    def test_leaving_the_box_violates_the_second_constraint_and_no_box_is_the_paper(self):
        spiky = np.array([[1, 4, 1, 4, 1], [2, 2, 2, 2, 2]])
        g = problem().constraints(*problem().evaluate_designs(spiky))
        assert g[0, 1] == pytest.approx(SMALL.box_violation(spiky)[0] / SMALL.H - SMALL.box_tolerance)
        assert g[0, 1] > 0 > g[1, 1]
        free = problem(space=replace(SMALL, box_tolerance=float("inf")))
        assert (free.constraints(*free.evaluate_designs(spiky))[:, 1] < 0).all()

    def test_a_scene_without_a_heel_strike_is_refused(self):
        with pytest.raises(SettingError, match=r"scene\.t_f = 0\.8"):
            problem(t_f=0.8)
        with pytest.raises(SettingError, match="stands still"):
            problem(gait=fo.Gait.human(start=float("inf")), t_f=5.0)


class TestSearch:
    @pytest.mark.parametrize(
        "name", [pytest.param(n, marks=pytest.mark.slow) if n in ("agemoea2", "rvea") else n for n in ASKED]
    )
    def test_a_seed_asks_for_the_soles_that_it_always_has(self, name):
        k = search(problem(objective_of(name), space=fo.Waypoints(n=7)), name, pop_size=12, n_gen=4, seed=1).k
        assert ((k >= 1) & (k <= 10)).all()
        assert hashlib.sha256(k.astype("<i8").tobytes()).hexdigest()[:16] == ASKED[name]

    def test_so_do_generations_of_a_few(self):
        """Of which one design is for the best by one objective alone."""
        p = problem(["distance", "work"], space=fo.Waypoints(n=7))
        k = search(p, "archive", pop_size=8, n_gen=8, seed=1).k
        assert hashlib.sha256(k.astype("<i8").tobytes()).hexdigest()[:16] == "fb0261654b959ab6"

    @pytest.mark.parametrize("name", SINGLE)
    def test_a_scalar_search_finds_the_best_of_a_space_it_can_enumerate(self, name):
        space = fo.Waypoints(n=4, K=4)
        everything = np.stack(np.meshgrid(*[range(1, 5)] * 4), axis=-1).reshape(-1, 4)
        p = problem(space=space)
        table = fo.evaluate(everything, p.scene, p.accuracy, space=space)
        inside = space.box_violation(everything) <= space.box_tolerance * space.H
        best = np.min(table.efficiency[inside & table.feasible])
        found = search(p, name, pop_size=20, n_gen=20, seed=1)
        assert found.column("efficiency")[found.best] == best

    def test_the_front_is_that_of_every_design_ever_evaluated(self):
        r = search(problem("pareto"), "nsga2", pop_size=16, n_gen=6, seed=1)
        f = r.problem.minimised(r.values)
        keep = np.flatnonzero(r.feasible)
        dominated = [any((f[j] <= f[i]).all() and (f[j] < f[i]).any() for j in keep) for i in keep]
        assert set(r.front) == set(keep[~np.array(dominated)])
        front = f[r.front]
        scaled = (front - front.min(axis=0)) / np.ptp(front, axis=0)
        assert r.best == r.front[0] == r.front[np.argmin((scaled**2).sum(axis=1))]  # the knee

    def test_no_design_is_walked_twice_and_the_history_counts_what_was_asked_for(self, monkeypatch):
        walked, walk = [], fo.FootProblem.walk

        def counted(problem, k):
            walked.extend(map(tuple, k))
            return walk(problem, k)

        monkeypatch.setattr(fo.FootProblem, "walk", counted)
        r = search(problem(), "ga", pop_size=12, n_gen=8, seed=1)
        assert len(walked) == len(set(walked)) == len(r.k) < r.evaluations == 96
        assert [g.evaluations for g in r.history] == [12 * (i + 1) for i in range(8)]
        best = [g.best for g in r.history]
        assert best == sorted(best, reverse=True)
        assert best[-1] == r.column("efficiency")[r.best]

    def test_infeasible_designs_are_kept_with_their_reason_and_are_never_best(self):
        r = search(problem(zeta=0.04), "ga", pop_size=40, n_gen=2, seed=1)
        assert set(r.reasons) == {"", "box", "sunk"}
        assert r.feasible[r.best]
        assert ((r.reasons == "") == r.feasible).all()
        assert sum(r.failures.values()) == (~r.feasible).sum()
        assert list(r.failures.values()) == sorted(r.failures.values(), reverse=True)

    def test_nothing_feasible_says_so_with_counts(self):
        with pytest.raises(FootoptError, match=r"No feasible design among \d+: \d+ sunk"):
            search(problem(zeta=1e-3), "ga", pop_size=6, n_gen=2)

    def test_a_maximised_single_objective(self):
        r = search(problem("distance"), "ga", pop_size=10, n_gen=4, seed=1)
        assert r.column("distance")[r.best] == r.column("distance")[r.feasible].max()
        assert r.history[-1].best == r.column("distance")[r.best]


def test_a_budget_changes_that_of_a_solver():
    r = search(problem(), Solver("ga", pop_size=8, n_gen=9, seed=3), n_gen=2)
    assert (r.solver, r.evaluations) == (Solver("ga", pop_size=8, n_gen=2, seed=3), 16)
