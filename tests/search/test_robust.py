"""Robust feet: scenarios drawn once, measures over them, one foot for many scenes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from searching import QUICK as COARSE
from searching import SMALL

import footopt as fo
from footopt.design import Solver, Store, confirm, search
from footopt.design.robust import RISK_MEASURES, regret, risk
from footopt.design.scenarios import sands
from footopt.design.store import differences, digest, key_of
from footopt.errors import FootoptError, SettingError
from footopt.walk.accuracy import PRESETS

SANDS = sands(fo.Scene())
NOTHING = fo.Spread(**dict.fromkeys(vars(fo.Spread()), 0.0))


def problem(scenarios=SANDS, objective="efficiency", **options):
    """A robust problem; of the values as they are, unless it is given references."""
    options.setdefault("references", np.ones(len(scenarios)))
    return fo.RobustProblem(scenarios, objective, SMALL, COARSE, **options)


class TestScenarios:
    def test_the_same_seed_draws_the_same_and_another_seed_does_not(self):
        one, again, other = (fo.draw(fo.Scene(), fo.Spread(), 4, seed) for seed in (1, 1, 2))
        assert one == again
        assert {s.scene.sand.zeta for s in one}.isdisjoint(s.scene.sand.zeta for s in other)

    def test_a_parameter_keeps_its_numbers_when_others_become_uncertain(self):
        everything = fo.draw(fo.Scene(), fo.Spread(), 8)
        sand_only = fo.draw(fo.Scene(), replace(NOTHING, zeta=0.3), 8)
        assert [s.scene.sand.zeta for s in everything] == [s.scene.sand.zeta for s in sand_only]
        assert all(s.scene.walker == fo.Walker() and s.scene.gait == fo.Gait.human() for s in sand_only)
        assert all(s.scene.walker != fo.Walker() for s in everything)

    def test_the_median_and_the_spread_are_those_asked_for(self):
        drawn = fo.draw(fo.Scene(sand=fo.Sand(2.0)), fo.Spread(zeta=0.5, mass=0.2, ankle_x=0.01), 400)
        for values, middle, sigma in (
            (np.log([s.scene.sand.zeta for s in drawn]), np.log(2.0), 0.5),
            (np.log([s.scene.walker.mass for s in drawn]), np.log(60.0), 0.2),
            (np.log([s.scene.gait.period for s in drawn]), np.log(1.2), 0.05),
            ([s.ankle[0] for s in drawn], 0.0, 0.01),
        ):
            assert np.mean(values) == pytest.approx(middle, abs=0.02 * sigma)
            assert np.std(values) == pytest.approx(sigma, rel=0.05)

    def test_a_robot_that_tracks_a_gait_is_told_another_and_keeps_its_body(self):
        pytest.importorskip("mujoco")
        robot = fo.mujoco.Robot()
        gaits = [s.scene.gait for s in fo.draw(fo.Scene(sand=robot.sand), fo.Spread(), 3)]
        for scenario, gait in zip(fo.draw(robot, fo.Spread(), 3), gaits, strict=True):
            moved = scenario.scene
            assert (moved.gait, moved.model) == (gait, robot.model)
            assert moved.duration == gait.start + 2.0 * gait.period
            assert moved.after == gait.heel_strike
            assert moved.sand.zeta != robot.sand.zeta
        (own,) = fo.draw(replace(robot, duration=1.4), fo.Spread(), 1)
        assert own.scene.duration == 1.4
        with pytest.raises(SettingError, match=r"study.scenarios"):
            fo.draw(replace(robot, controller=print), fo.Spread(), 1)

    def test_angles_differ_by_as_much_at_every_phase_of_the_stride(self):
        drawn = fo.draw(fo.Scene(), replace(NOTHING, angles=3.0), 400)
        phase = np.linspace(0, 1, 7)
        for joint in ("thigh", "knee"):
            angles = [np.degrees(getattr(s.scene.gait, joint).at(phase)[0]) for s in drawn]
            np.testing.assert_allclose(np.std(angles, axis=0), 3.0, rtol=0.1)
            middle = np.degrees(getattr(fo.Gait.human(), joint).at(phase)[0])
            np.testing.assert_allclose(np.mean(angles, axis=0), middle, atol=0.5)

    def test_nothing_spread_is_the_scene_itself(self):
        (same,) = fo.draw(fo.Scene(), NOTHING, 1)
        assert same.scene == fo.Scene()
        assert same.space(SMALL) == SMALL


VALUES = arrays(float, (5, 3), elements=st.floats(-1e3, 1e3))


class TestMeasures:
    @given(VALUES, st.floats(0.01, 1.0), st.floats(0.01, 1.0))
    def test_the_tail_is_between_mean_and_worst_and_falls_with_its_share(self, values, a, b):
        mean, worst = (risk(values, m, 0.5) for m in ("mean", "worst"))
        few, many = (risk(values, "tail", t) for t in sorted((a, b)))
        slack = 1e-9 * (1 + np.abs(values).max())
        assert (mean <= many + slack).all()
        assert (many <= few + slack).all()
        assert (few <= worst + slack).all()

    @given(VALUES)
    def test_mean_and_worst_are_the_tail_s_limits_and_a_part_of_a_scenario_counts(self, values):
        np.testing.assert_allclose(risk(values, "mean", 0.5), values.mean(axis=0), atol=1e-9)
        np.testing.assert_allclose(risk(values, "tail", 0.1), values.max(axis=0), atol=1e-9)
        first, second = -np.sort(-values, axis=0)[:2]
        np.testing.assert_allclose(risk(values, "tail", 0.3), (first + 0.5 * second) / 1.5, atol=1e-9)

    @pytest.mark.parametrize("measure", RISK_MEASURES)
    def test_a_design_s_measure_does_not_depend_on_its_batch(self, measure):
        values = np.random.default_rng(2).normal(size=(33, 50, 6))
        whole = risk(values, measure, 0.3)
        alone = [risk(values[:, i : i + 1], measure, 0.3)[0] for i in range(50)]
        np.testing.assert_array_equal(whole, alone)


class TestRobustProblem:
    k = SMALL.random(6, seed=1)

    def test_measures_are_those_of_the_scenes_one_by_one(self):
        tables = np.stack([fo.evaluate(self.k, s.scene, COARSE, space=SMALL).values for s in SANDS])
        worst, _ = problem(measure="worst").walk(self.k)
        np.testing.assert_array_equal(worst[:, :2], tables[..., :2].min(axis=0))  # to be maximised
        np.testing.assert_array_equal(worst[:, 2:5], tables[..., 2:].max(axis=0))
        mean, _ = problem(measure="mean").walk(self.k)
        np.testing.assert_allclose(mean[:, :5], tables.mean(axis=0), rtol=1e-14)

    def test_a_moved_ankle_is_a_foot_worn_otherwise(self):
        moved = [replace(SANDS[2], ankle=(0.02, 0.01))]
        foot = fo.evaluate(self.k, SANDS[2].scene, COARSE, space=replace(SMALL, ankle=(0.02, 0.01)))
        np.testing.assert_array_equal(problem(moved).walk(self.k)[0][:, :5], foot.values)
        assert (foot.values != fo.evaluate(self.k, SANDS[2].scene, COARSE, space=SMALL).values).any()

    def test_a_walk_that_fails_anywhere_is_infeasible_and_says_where(self):
        nowhere = fo.Scenario("quicksand", fo.Scene(sand=fo.Sand(1e-3)))
        p = problem([SANDS[1], nowhere])
        found = p.evaluate_designs(self.k)
        assert set(found.reasons) == {"sunk (quicksand)"}
        assert (p.constraints(*found)[:, 0] > 0).all()
        assert np.isfinite(p.minimised(found.values)).all()
        assert np.isnan(found.values).all()

    def test_references_make_the_measure_one_of_the_regret(self):
        best = np.array([-2e-5, -5e-5, -2e-4])
        own = problem().walk_each(self.k)[0][..., 5]
        relative = problem(references=best).walk(self.k)[0][:, 5]
        np.testing.assert_allclose(1 + relative, regret(own, best[:, None], "efficiency").max(axis=0))
        assert regret(np.array([0.9, 1.0]), np.array(1.0), "distance").tolist() == pytest.approx([0.1, 0])
        assert regret(np.array([110.0]), np.array(100.0), "work").tolist() == pytest.approx([0.1])
        for bad in ([1.0, 2.0], [1.0, 0.0, 1.0], [1.0, np.nan, 1.0]):
            with pytest.raises(SettingError, match="references"):
                problem(references=bad)

    def test_a_search_keeps_confirms_and_resumes_it(self, tmp_path):
        p, solver = problem(measure="mean", references=[-2e-5, -5e-5, -2e-4]), Solver("ga", 10, 4, 3)
        first = search(p, solver, store=tmp_path / "s.sqlite")
        again = search(p, solver, store=tmp_path / "s.sqlite")
        np.testing.assert_array_equal(first.values, again.values)
        assert again.reused == len(again.k)
        finer = problem(measure="mean", references=p.references)
        finer.accuracy = PRESETS["standard"]
        confirmed = confirm(first, "standard", 3)
        np.testing.assert_array_equal(confirmed.values, finer.walk(first.k[confirmed.designs])[0])
        assert p.accuracy == COARSE

    def test_the_robust_optimum_is_the_sole_of_least_worst_regret_of_all(self):
        space = fo.Waypoints(n=4, K=4)
        every = np.indices((4,) * 4).reshape(4, -1).T + 1
        every = every[space.box_violation(every) <= space.box_tolerance * space.H]
        j = np.stack([fo.evaluate(every, s.scene, COARSE, ("efficiency",), space).values for s in SANDS])
        worst = regret(j[..., 0], j.min(axis=1), "efficiency").max(axis=0)
        together = fo.RobustProblem(SANDS, space=space, accuracy=COARSE)  # against each scenario's own best
        robust = search(together, "exhaustive")
        np.testing.assert_array_equal(together.references, j.min(axis=1)[:, 0])
        np.testing.assert_array_equal(robust.X, every[worst.argmin()])
        assert 1 + robust.F[0] == pytest.approx(worst.min())
        specialists = every[j[..., 0].argmin(axis=1)]
        assert 0 < worst.min() < (1 + together.walk(specialists)[0][:, 5]).min()
        finer = fo.Accuracy(plates=40, dt=0.01)  # at which regrets are against the same soles
        each = [fo.evaluate(specialists, s.scene, finer, ("efficiency",), space).values for s in SANDS]
        np.testing.assert_array_equal(together.at(finer).references, np.min(each, axis=1)[:, 0])

    def test_a_scenario_in_which_no_foot_walks_is_named(self):
        quicksand = fo.Scenario("quicksand", fo.Scene(sand=fo.Sand(1e-3)))
        with pytest.raises(FootoptError, match=r"quicksand: No feasible design"):
            fo.RobustProblem([quicksand], space=fo.Waypoints(n=4, K=3))

    def test_a_store_knows_the_scenarios_and_how_they_are_judged(self, tmp_path):
        others = [
            problem(),
            problem(SANDS[:2]),
            problem([replace(SANDS[0], ankle=(0.01, 0.0)), *SANDS[1:]]),
            problem(measure="tail", tail=0.3),
            problem(references=[1.0, 2.0, 3.0]),
            problem(objective="distance"),
            fo.FootProblem(SANDS[0].scene, "efficiency", SMALL, COARSE),
        ]
        digests = [digest(key_of(p)) for p in others]
        assert len(set(digests)) == len(digests)
        assert digest(key_of(problem())) == digests[0]
        (said,) = differences(key_of(others[2]), key_of(others[0])).values()
        assert said == "scenarios.0.ankle ([0.01, 0.0] there, [0.0, 0.0] here)"
        with Store(tmp_path / "s.sqlite", problem()) as store:
            assert len(store) == 0
