"""What may be asked of a search: limits, measures in plain Python, and which design of a front is best."""

import math

import numpy as np
import pytest
from moocore import hypervolume, is_nondominated
from searching import QUICK, SMALL, problem

import footopt as fo
from footopt.design import Choice, confirm, search
from footopt.walk.checks import diagnose
from footopt.walk.objectives import MEASURES, OBJECTIVES, SLOW, Objective, measure


@pytest.fixture(scope="module")
def found():
    """A small search of three objectives."""
    return search(problem(["distance", "work", "peak_power"]), "nsga2", pop_size=20, n_gen=5, seed=1)


class TestMeasures:
    """Geometry and validity cost more than what the compiled loop knows, and are made on request only."""

    def test_are_the_same_of_a_batch_and_of_a_walk(self):
        k = SMALL.random(5, seed=1)
        table = fo.evaluate(k, fo.Scene(), QUICK, (*SLOW, "work"), SMALL)
        for heights, row in zip(k, table.values, strict=True):
            foot = fo.Foot.from_waypoints(heights, SMALL)
            walk = fo.simulate(foot, fo.Scene(), QUICK)
            assert dict(zip(table.names, row, strict=True)) == pytest.approx(
                walk.measures(table.names), rel=1e-12
            )
            assert row[0] == foot.hollow
            assert row[1] == foot.top - foot.contour[:, 1].max()
            assert row[2] == {d.name: d.value for d in diagnose(walk)}["depth of the ankle"]
        assert table.column("hollow").tolist() == table.values[:, 0].tolist()

    def test_are_no_number_for_a_walk_that_failed(self):
        nowhere = fo.Scene(sand=fo.Sand(1e-3))
        assert np.isnan(fo.evaluate(SMALL.random(3, seed=1), nowhere, QUICK, tuple(SLOW), SMALL).values).all()
        walk = fo.simulate(fo.Foot.flat(), nowhere, QUICK)
        assert all(map(math.isnan, walk.measures(tuple(SLOW)).values()))

    def test_one_of_ones_own_is_a_python_function_of_the_walk(self):
        @measure("walk", "$x$", "m/s", maximise=False, worst=1e3)
        def ripple(walk):
            """How much the forward speed differs over the second half of the walk."""
            return float(np.ptp(walk.velocity[len(walk.t) // 2 :, 0]))

        try:
            result = search(problem("ripple"), "ga", pop_size=6, n_gen=2, seed=1)
            walk = fo.simulate(result.foot, result.problem.scene, result.problem.accuracy)
            assert result.column("ripple")[result.best] == ripple(walk)
            assert result.column("ripple")[result.best] == np.nanmin(result.column("ripple")[result.feasible])
        finally:
            SLOW.pop("ripple")
        assert "ripple" not in MEASURES


class TestLimits:
    LIMITS = {"peak_power": 260.0, "distance": 2.1, "thickness": 0.008}  # noqa: RUF012

    def test_are_kept_by_every_feasible_design_and_no_other_is_lost(self):
        free = search(problem(), "ga", pop_size=30, n_gen=4, seed=1)
        limited = fo.FootProblem(free.problem.scene, space=SMALL, accuracy=QUICK, limits=self.LIMITS)
        kept = search(limited, "ga", pop_size=30, n_gen=4, seed=1)
        good = (kept.column("peak_power") <= 260) & (kept.column("distance") >= 2.1)
        good &= (kept.column("thickness") >= 0.008) & (SMALL.box_violation(kept.k) <= 0.05 * SMALL.H)
        np.testing.assert_array_equal(kept.feasible, good)
        assert 0 < good.sum() < len(good)
        assert set(kept.failures) <= {"box", *self.LIMITS}
        j = kept.column("efficiency")
        assert j[kept.best] == j[good].min() >= free.column("efficiency")[free.best]


class TestChoice:
    """One design of a front is the answer, by what one asks for and never by J_W unasked."""

    def chosen(self, found, choice):
        p = fo.FootProblem(found.problem.scene, found.problem.names, SMALL, QUICK, choose=choice)
        return found.values[found.front][np.argmin(p.scores(found.values[found.front]))], p

    def test_weights_draw_towards_an_objective(self, found):
        work = found.column("work")[found.front]
        heavy, p = self.chosen(found, Choice("weights", {"work": 1e6}))
        assert heavy[p.record.index("work")] == work.min()
        even, _ = self.chosen(found, Choice("weights", {"work": 1.0}))
        f = p.minimised(found.values[found.front])
        worst = ((f - f.min(axis=0)) / np.ptp(f, axis=0)).max(axis=1)
        np.testing.assert_array_equal(even, found.values[found.front][worst.argmin()])
        assert even[p.record.index("work")] > work.min()

    def test_limits_leave_the_best_in_the_first_objective(self, found):
        power, distance = (found.column(name)[found.front] for name in ("peak_power", "distance"))
        limit = float(np.median(power))
        row, p = self.chosen(found, Choice("limits", limits={"peak_power": limit}))
        assert row[p.record.index("distance")] == distance[power <= limit].max()

    def test_efficiency_is_j_w_for_who_asks_for_it(self, found):
        row, p = self.chosen(found, Choice("efficiency"))
        assert row[p.record.index("efficiency")] == found.column("efficiency")[found.front].min()


class TestFronts:
    def test_the_history_is_the_hypervolume_of_the_front(self, found):
        """In units of the box that the first generation's walks span, from its worst corner."""
        f = found.problem.minimised(found.values)
        walked = (found.generation == 1) & (found.reasons != "sunk")
        worst, span = f[walked].max(axis=0), np.ptp(f[walked], axis=0)
        for g in found.history:
            known = f[(found.generation <= g.generation) & found.feasible]
            assert g.hypervolume == pytest.approx(hypervolume((known - worst) / span, ref=[0.0] * 3))
            assert math.isnan(g.best)
        volumes = [g.hypervolume for g in found.history]
        assert volumes == sorted(volumes)
        assert volumes[-1] > volumes[0]

    def test_designs_without_a_value_do_not_stretch_the_box_of_the_hypervolume(self, monkeypatch):
        def some(raw, scene):
            return np.where(raw["work"] > np.median(raw["work"]), np.nan, raw["work"])

        volumes = []
        for worst in (1e3, 1e6):
            own = Objective("some", "s", "J", maximise=False, worst=worst, value=some)
            monkeypatch.setitem(OBJECTIVES, "some", own)
            two = fo.FootProblem(objective=["distance", "some"], space=SMALL, accuracy=QUICK)
            volumes.append(fo.search(two, "nsga2", pop_size=20, n_gen=2, seed=1).history[0].hypervolume)
        assert volumes[0] == volumes[1] > 0.0

    def test_all_of_it_is_walked_again_and_what_is_dominated_then_is_said(self, found):
        confirmed = confirm(found, fo.Accuracy(dt=5e-3, plates=40), finalists=3)
        assert sorted(confirmed.designs) == sorted(found.front)
        assert confirmed.good[0]
        f = found.problem.minimised(confirmed.values)
        assert set(map(tuple, f[confirmed.good])) == set(map(tuple, f[is_nondominated(f, keep_weakly=True)]))

    def test_at_the_same_accuracy_nothing_is_walked_again(self, found, monkeypatch):
        monkeypatch.setattr(fo.FootProblem, "walk", None)
        confirmed = confirm(found, found.problem.accuracy)
        assert confirmed.good.all()
        assert confirmed.agrees
        assert confirmed.largest_change == 0.0
