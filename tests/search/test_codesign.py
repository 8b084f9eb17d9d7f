"""Foot and gait together: four numbers of the gait beside the waypoints, within a person's range."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from running import composed, unrender
from searching import QUICK, SMALL, assert_same

import footopt as fo
from footopt import studies
from footopt.design import Solver, search
from footopt.design.codesign import CoDesign, FootAndGait, shares, speed
from footopt.errors import SettingError
from footopt.gait.genes import GENES, values_of, varied

HUMAN = fo.Gait.human()
PHASE = np.linspace(0.0, 1.0, 50)
LEVELS = st.lists(st.integers(1, 10), min_size=4, max_size=4)


def degrees(angle):
    return np.degrees(angle.at(PHASE)[0])


class TestGenes:
    @pytest.mark.parametrize("pitch", ["shank", "measured"])
    @pytest.mark.parametrize("levels", [3, 4, 10, 11])
    def test_the_middle_level_is_the_gait_as_it_is_given(self, pitch, levels):
        gait = fo.Gait.human(pitch=pitch, period=1.23)
        assert varied(gait, values_of(gait, [(levels + 1) // 2] * 4, levels)) == gait

    @given(LEVELS)
    def test_values_are_in_a_person_s_range_and_the_ends_are_its_ends(self, levels):
        for (name, value), level in zip(values_of(HUMAN, levels, 10).items(), levels, strict=True):
            gene = GENES[name]
            assert gene.low <= value <= gene.high
            assert gene.at_end(value) == (level in (1, 10))

    def test_a_gait_out_of_range_has_its_own_value_as_that_end(self):
        slow = fo.Gait.human(period=2.0)
        assert values_of(slow, [10, 5, 5, 5], 10)["stride_time"] == 2.0
        assert values_of(slow, [1, 5, 5, 5], 10)["stride_time"] == GENES["stride_time"].low

    def test_each_changes_what_it_is_called_after_and_nothing_else(self):
        own = values_of(HUMAN, [5] * 4, 10)
        stride = varied(HUMAN, own | {"stride_time": 1.1})
        assert (stride.period, stride.thigh, stride.knee) == (1.1, HUMAN.thigh, HUMAN.knee)
        step = varied(HUMAN, own | {"step": 1.1})
        thigh = degrees(HUMAN.thigh) - HUMAN.thigh.a0
        np.testing.assert_allclose(degrees(step.thigh) - HUMAN.thigh.a0, 1.1 * thigh)
        assert step.knee == HUMAN.knee
        lift = varied(HUMAN, own | {"lift": 1.2})
        assert degrees(lift.knee).min() == pytest.approx(degrees(HUMAN.knee).min(), abs=0.05)
        assert np.ptp(degrees(lift.knee)) == pytest.approx(1.2 * np.ptp(degrees(HUMAN.knee)))
        for pitch in ("shank", "measured"):
            gait = fo.Gait.human(pitch=pitch)
            turned = varied(gait, own | {"pitch": -5.0})
            before, after = (np.degrees(g.cycle(PHASE)[2][0]) for g in (gait, turned))
            np.testing.assert_allclose(after - before, -5.0, atol=1e-9)
            assert turned.knee == gait.knee


class TestProblem:
    both = CoDesign(fo.Scene(), space=SMALL, accuracy=QUICK)

    def test_with_the_gait_as_it_is_given_it_is_the_plain_problem_to_the_last_bit(self):
        k = SMALL.random(9, seed=1)
        plain = fo.FootProblem(fo.Scene(), space=SMALL, accuracy=QUICK)
        own = np.concatenate([k, np.tile(self.both.space.own, (9, 1))], axis=1)
        np.testing.assert_array_equal(self.both.walk(own)[0], plain.walk(k)[0])
        np.testing.assert_array_equal(self.both.space.box_violation(own), SMALL.box_violation(k))
        np.testing.assert_array_equal(
            self.both.foot_of(own[0]).contour, fo.Foot.from_waypoints(k[0], SMALL).contour
        )

    def test_a_design_does_not_depend_on_its_batch_and_walks_with_its_own_gait(self):
        k = self.both.space.random(12, seed=2)
        whole, _ = self.both.walk(k)
        for i in (0, 7):
            np.testing.assert_array_equal(self.both.walk(k[i : i + 1])[0][0], whole[i])
            walk = fo.evaluate([self.both.foot_of(k[i])], self.both.scene_of(k[i]), QUICK, ("distance",))
            assert walk.values[0, 0] == whole[i, 0]

    def test_walks_last_as_long_whatever_the_stride_time(self):
        k = self.both.space.random(20, seed=3)
        assert {self.both.scene_of(row).duration for row in k} == {fo.Scene().duration}
        assert len({self.both.scene_of(row).gait.period for row in k}) > 2
        assert speed(2.4, fo.Scene()) == pytest.approx(1.0)

    def test_a_search_of_it_is_kept_and_goes_on_to_the_same_result(self, tmp_path):
        solver = Solver("memetic", 10, 4, 1)
        whole = search(self.both, solver)
        search(self.both, Solver("memetic", 10, 2, 1), store=tmp_path / "s.sqlite")
        resumed = search(self.both, solver, store=tmp_path / "s.sqlite")
        assert resumed.reused >= 20
        assert_same(whole, resumed)

    def test_two_levels_leave_no_room_for_the_gait_s_own(self):
        with pytest.raises(SettingError, match=r"foot\.K = 2: must be 3 or more"):
            FootAndGait.of(fo.Waypoints(K=2))


@given(*[st.floats(0.1, 10.0)] * 4)
def test_shares_sum_to_the_gain_and_who_does_nothing_has_none(alone, foot, gait, both):
    parts = shares(alone, foot, gait, both)
    assert sum(parts) == pytest.approx(math.log(both / alone), abs=1e-12)
    assert shares(-alone, -gait, -foot, -both) == pytest.approx(parts[::-1], abs=1e-12)
    assert shares(alone, foot, alone, foot) == pytest.approx((math.log(foot / alone), 0.0), abs=1e-12)
    assert all(map(math.isnan, shares(alone, foot, gait, math.nan)))


BRIEF = ("study=codesign", "study.quick=true", "foot.n=4", "foot.K=4", "solver.pop_size=10", "accuracy=draft",
         "study.confirm=null")  # fmt: skip


class TestStudy:
    def test_both_together_are_no_worse_at_the_same_speed(self, tmp_path, monkeypatch, capsys):
        unrender(monkeypatch)
        studies.run(composed(*BRIEF), tmp_path, {})
        found = json.loads((tmp_path / "result.json").read_text())["codesign"]
        assert list(found) == ["soft", "regular", "hard"]
        for sand, f in found.items():
            values = f["values"]
            assert values["together"]["efficiency"] <= values["foot_alone"]["efficiency"]
            assert values["together"]["distance"] >= 0.998 * values["foot_alone"]["distance"]
            if f["gain"] > 0:
                assert f["share_of_foot"] + f["share_of_gait"] == pytest.approx(1.0)
            gait = fo.Gait.from_file(tmp_path / f"gait_{sand}.json")
            assert gait.period == f["gait"]["stride_time"]
        assert "by the gait" in capsys.readouterr().out

    @pytest.mark.parametrize(
        ("setting", "message"),
        [
            ("study.speed=-1", r"study\.speed = -1"),
            ("study.speed=9", r"study\.speed = 9\.0: .* on soft sand at most 0\.\d+ m/s.* distance"),
            ("solver=exhaustive", "a solver that searches"),
            ("objective=pareto", "one objective"),
            ("foot=ellipse", "foot = 'ellipse'"),
        ],
    )
    def test_what_cannot_be_is_refused(self, tmp_path, setting, message):
        with pytest.raises(SettingError, match=message):
            studies.run(composed(*BRIEF, setting), tmp_path, {})
