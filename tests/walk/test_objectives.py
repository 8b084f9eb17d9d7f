"""What a walk is judged by: each objective recomputed from a fine trace by numpy, and J_W."""

import math
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import footopt as fo
from footopt.errors import SettingError
from footopt.walk import FIVE, OBJECTIVES, gain_shares
from footopt.walk.metrics import RAW, Four, peak
from footopt.walk.objectives import FLOORS, by_name, lookup, objective, offered

STRIKE = 1.1  # s, the first heel strike


@cache
def recomputed(walk):
    """The objectives of a walk from its trace, by their definitions, without interpolation."""
    walker, t, vx = walk.scene.walker, walk.t, walk.velocity[:, 0]
    late = t >= STRIKE - 1e-9
    joint = np.sum(walk.force * walk.velocity[:, None], axis=-1) - walk.power
    height = np.concatenate([[walk.start[1]], walk.com[:, 1]])
    work = abs(np.trapezoid(walk.power.sum(axis=1), t))
    pose, (x, z) = walk.pose(np.arange(0, len(t), 10)), (walk.foot.contour - walk.foot.ankle).T
    under = pose.z[..., None] + np.sin(pose.pitch)[..., None] * x + np.cos(pose.pitch)[..., None] * z
    return {
        "distance": walk.com[-1, 0],
        "mean_height": np.trapezoid(height, np.concatenate([[0.0], t])) / t[-1],
        "work": work,
        "peak_power": np.abs(walk.power[late]).max(),
        "speed_loss": (np.maximum.accumulate(vx[late]) - vx[late]).max(),
        "joint_work": np.trapezoid(np.maximum(joint, 0).sum(axis=1), t),
        "cost_of_transport": work / (walker.mass * walker.g * walk.com[-1, 0]),
        "maximum_sinkage": -(walk.com[::10, 1, None, None] + under).min(),
        "peak_vertical_force": walk.force[..., 1].sum(axis=1).max(),
    }


class TestAgainstTheTrace:
    @pytest.mark.parametrize("name", sorted({*offered(fo.Scene())} & {*OBJECTIVES} - {"efficiency"}))
    def test_of_a_fine_walk(self, name, fine_walk):
        assert fine_walk.objectives[name] == pytest.approx(recomputed(fine_walk)[name], rel=2e-4)

    @pytest.mark.parametrize("name", FIVE)
    def test_of_an_ordinary_walk(self, name, walk, fine_walk):
        """Peaks between its longer steps are interpolated."""
        rel = 1e-2 if name in ("peak_power", "speed_loss") else 3e-3
        assert walk.objectives[name] == pytest.approx(recomputed(fine_walk)[name], rel=rel)

    @pytest.mark.parametrize("t_f", [1.13, 1.85])
    def test_of_walks_that_end_anywhere_in_a_step(self, t_f, scene, ramp_foot):
        """In the middle of a fall of the speed or a rise of the power, too."""
        accuracy = fo.Accuracy(dt=2e-3, plates=200, creep=2e-5, control=1e-4)
        walk = fo.simulate(ramp_foot, fo.Scene(scene.sand, t_f=t_f), accuracy)
        expected = recomputed(walk)
        for name in ("peak_power", "speed_loss"):
            assert walk.objectives[name] == pytest.approx(expected[name], rel=5e-3, abs=1e-3)

    def test_peaks_before_the_first_heel_strike_do_not_count(self, flat_foot):
        """The start is not a step: here it takes more power than the 10 ms after the first strike."""
        walk = fo.simulate(flat_foot, fo.Scene(sand=fo.Sand.named("soft"), t_f=STRIKE + 0.01), "fine")
        late = walk.t >= STRIKE - 1e-9
        assert walk.objectives["peak_power"] == pytest.approx(np.abs(walk.power[late]).max(), rel=1e-3)
        assert np.abs(walk.power[~late]).max() > 1.2 * walk.objectives["peak_power"]


def test_a_smooth_peak_between_samples_is_found_and_a_jump_is_no_peak():
    times = np.array([0.0, 0.01, 0.03, 0.04])  # uneven, as steps under control are
    parabola = 7.0 - 1e4 * (times - 0.021) ** 2
    assert peak(Four(*parabola), Four(*times)) == pytest.approx(7.0, rel=1e-12)
    for samples in ((52.0, 98.7, 97.7, 96.7), (96.7, 97.7, 98.7, 52.0), (1.0, 2.0, 3.0, 4.0)):
        assert peak(Four(*samples), Four(*times)) == max(samples[1:3])


class TestTrade:
    """J_W = -(distance * mean height) / (|W| p_max dV_x)."""

    @pytest.mark.parametrize(("name", "floor"), [("work", 1.0), ("peak_power", 1.0), ("speed_loss", 1e-3)])
    def test_a_walk_that_loses_nothing_is_not_infinitely_good(self, name, floor):
        values = {"distance": 2.0, "mean_height": 0.9, "work": 50.0, "peak_power": 20.0, "speed_loss": 0.1}
        assert FLOORS[name] == floor

        def j_w(**changed):
            row = [{**values, **changed}.get(column, 0.0) for column in RAW]
            return OBJECTIVES["efficiency"].value(by_name(np.array([row])), fo.Scene())[0]

        assert j_w(**{name: 0.0}) == j_w(**{name: floor}) == j_w(**{name: floor / 2})
        assert j_w(**{name: 2 * floor}) == pytest.approx(j_w(**{name: floor}) / 2)
        assert j_w() == pytest.approx(-1.8 / (50 * 20 * 0.1))

    POSITIVE = st.fixed_dictionaries({name: st.floats(0.01, 1000) for name in FIVE})

    @given(POSITIVE, POSITIVE)
    def test_shares_of_a_gain_sum_to_one(self, values, base):
        shares = gain_shares(values, base)
        assert list(shares) == list(FIVE)
        total = sum(shares.values())
        assert (
            total == pytest.approx(1.0, rel=1e-3) or max(map(abs, shares.values())) > 1e6 or math.isnan(total)
        )

    def test_a_gain_in_one_factor_is_all_its_own(self):
        base = dict.fromkeys(FIVE, 10.0)
        assert gain_shares({**base, "work": 5.0}, base) == {**dict.fromkeys(FIVE, 0.0), "work": 1.0}

    def test_no_gain_has_no_shares(self):
        base = dict.fromkeys(FIVE, 10.0)
        worse = {**base, "work": 12.0, "distance": 9.0, "peak_power": 9.9}
        for values in (base, worse):
            assert all(math.isnan(share) for share in gain_shares(values, base).values())


@pytest.mark.usefixtures("clean")
def test_one_of_a_quantity_that_no_walk_has_is_refused_by_that():
    objective("d", "m", maximise=True, worst=0.0)(lambda raw, scene: raw["disance"])
    with pytest.raises(SettingError, match="lacks the quantity 'disance'"):
        lookup(["<lambda>"], fo.Scene())


class TestTable:
    def test_columns_come_in_the_order_they_are_asked_for(self, ramp_foot, flat_foot, regular):
        names = ("speed_loss", "maximum_sinkage", "efficiency", "distance")
        table = fo.evaluate([ramp_foot, flat_foot], regular, objectives=names)
        assert table.names == names
        for i, name in enumerate(names):
            np.testing.assert_array_equal(table.values[:, i], table.column(name))
        five = fo.evaluate([ramp_foot, flat_foot], regular)
        np.testing.assert_array_equal(table.values[:, [3, 0]], five.values[:, [0, 4]])
        np.testing.assert_array_equal(table.efficiency, five.efficiency)

    def test_a_string_is_one_name(self, ramp_foot, regular):
        table = fo.evaluate(ramp_foot, regular, objectives="distance")
        assert table.names == ("distance",)
        assert table.values[0, 0] == fo.evaluate(ramp_foot, regular).column("distance")[0]

    @pytest.mark.parametrize("name", ["maximum_sinkage", "hollow", "speed"])
    def test_a_column_that_is_not_there_is_a_key_error_that_names_those_that_are(
        self, name, ramp_foot, regular
    ):
        table = fo.evaluate(ramp_foot, regular, objectives=("distance", "thickness"))
        assert np.isfinite(table.column("thickness")).all()
        assert np.isfinite(table.column("work")).all()  # what costs nothing is there unasked
        with pytest.raises(KeyError, match=f"{name}.* distance, thickness.*work"):
            table.column(name)
