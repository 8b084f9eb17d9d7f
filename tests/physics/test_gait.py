"""The gait: real joint angles, the ankle path they imply, and a smooth start from standing."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from motion_files import write_table

import footopt as fo
from footopt.errors import FileError, SettingError
from footopt.gait import HUMAN, LEFT, RIGHT, Fourier

L1, L2 = 0.47, 0.45
STANDING_STILL = fo.Gait.human(start=math.inf)
CHECKS = json.loads(HUMAN.read_text())["checks_at_6_harmonics_l1_0.47_l2_0.45_T_1.2"]
PERIODS = st.floats(0.4, 4.0)


def stride(gait, samples=2001):
    """Pose over one steady stride of the left leg, and its phase."""
    begin = gait.start + gait.period / 2
    phase = np.linspace(0.0, 1.0, samples)
    return phase, gait.pose(begin + (phase + 0.5) * gait.period, L1, L2)


class TestHumanWalk:
    """The definitions and values are those that come with the data."""

    def test_implied_speed_of_the_hip_in_mid_stance(self):
        phase, pose = stride(fo.Gait.human())
        stance = (phase >= 0.12) & (phase <= 0.38)
        speed = -pose.vx[stance, LEFT].mean()
        assert speed == pytest.approx(CHECKS["implied_hip_speed_midstance_m_s"], abs=5e-4)
        assert speed == pytest.approx(0.986, abs=5e-4)

    @pytest.mark.parametrize("foot", [LEFT, RIGHT])
    def test_range_of_the_ankle(self, foot):
        _, pose = stride(fo.Gait.human())
        for value, name in ((pose.x, "x"), (pose.z, "z")):
            found = [value[:, foot].min(), value[:, foot].max()]
            np.testing.assert_allclose(found, CHECKS[f"ankle_{name}_range_m"], rtol=0, atol=6e-4)

    def test_the_knee_hardly_bends_backwards(self):
        knee, _ = fo.Gait.human().knee.at(np.linspace(0, 1, 1001))
        assert np.degrees(knee.min()) == pytest.approx(CHECKS["knee_minimum_deg"], abs=0.05)

    def test_says_where_it_comes_from_and_how_well_it_fits(self):
        gait = fo.Gait.human()
        assert "PeerJ" in gait.source
        assert dict(gait.residual) == {"thigh": 0.23, "knee": 0.55}
        assert dict(fo.Gait.human(harmonics=3).residual) == {"thigh": 0.5, "knee": 1.83}

    def test_harmonics_may_be_of_numpy(self):
        assert fo.Gait.human(harmonics=np.int64(3)) == fo.Gait.human(harmonics=3)

    @pytest.mark.parametrize("harmonics", [0, -1, 9, 2.5, True])
    def test_harmonics_beyond_the_data_are_refused(self, harmonics):
        with pytest.raises(SettingError, match=rf"gait\.harmonics = {harmonics}: .*from 1 to 8"):
            fo.Gait.human(harmonics=harmonics)


class TestHeelStrikes:
    def test_of_the_paper(self):
        gait = fo.Gait.human()
        assert gait.heel_strike == pytest.approx(1.1)
        np.testing.assert_allclose(gait.heel_strikes(2.9), [1.1, 1.7, 2.3, 2.9], atol=1e-12)
        np.testing.assert_allclose(gait.heel_strikes(2.8), [1.1, 1.7, 2.3], atol=1e-12)

    @given(PERIODS, st.floats(0.0, 2.0), st.integers(1, 6))
    def test_come_every_half_stride(self, period, start, count):
        gait = fo.Gait.human(period=period, start=start)
        last = start + count * period / 2  # in floating point, this may fall just short of the strike
        np.testing.assert_allclose(
            gait.heel_strikes(last + 1e-6), start + np.arange(1, count + 1) * period / 2, atol=1e-9
        )

    def test_are_the_legs_phase_zero_in_turn(self):
        """At the first strike the right leg begins its cycle; half a stride later the left one."""
        gait = fo.Gait.human()
        (begin, *_), *_ = gait.cycle(np.zeros(1))
        (thigh, _), *_ = gait.angles([1.1, 1.7, 2.3])
        np.testing.assert_allclose(thigh[[0, 1, 2], [RIGHT, LEFT, RIGHT]], begin[0], rtol=1e-9)

    def test_none_before_the_first_and_none_for_who_stands(self):
        assert len(fo.Gait.human().heel_strikes(1.0)) == 0
        assert math.isinf(STANDING_STILL.heel_strike)
        assert len(STANDING_STILL.heel_strikes(1e6)) == 0


class TestMotion:
    @given(PERIODS, st.floats(0.0, 1.0), st.sampled_from(["shank", "measured"]))
    def test_pose_and_velocity_are_continuous_at_every_join(self, period, start, pitch):
        """The start, the end of the left leg's blend, the end of the right leg's and of the ramp."""
        gait = fo.Gait.human(period=period, start=start, pitch=pitch)
        for join in (start, start + period / 3, start + period / 2):
            d = 1e-7 * period
            before, after = (np.array(gait.pose([t], L1, L2)) for t in (join - d, join + d))
            np.testing.assert_allclose(before[[0, 1, 4]], after[[0, 1, 4]], rtol=0, atol=1e-5)
            np.testing.assert_allclose(before[[2, 3, 5]], after[[2, 3, 5]], rtol=0, atol=1e-4 / period)

    @given(PERIODS, st.floats(-0.4, 3.0), st.sampled_from(["shank", "measured"]))
    def test_velocities_are_the_derivatives(self, period, strides, pitch):
        gait = fo.Gait.human(period=period, start=0.5, pitch=pitch)
        t, d = 0.5 + strides * period, 1e-5 * period
        pose, before, after = gait.pose([t], L1, L2), gait.pose([t - d], L1, L2), gait.pose([t + d], L1, L2)
        for value, rate in (("x", "vx"), ("z", "vz"), ("pitch", "rate")):
            difference = (getattr(after, value) - getattr(before, value)) / (2 * d)
            np.testing.assert_allclose(getattr(pose, rate), difference, rtol=0, atol=1e-6 / period)

    @given(PERIODS)
    def test_the_walk_after_the_start_is_periodic(self, period):
        gait = fo.Gait.human(period=period)
        t = 0.5 + period / 2 + np.linspace(0, period, 7)
        for now, later in zip(gait.pose(t, L1, L2), gait.pose(t + 3 * period, L1, L2), strict=True):
            np.testing.assert_allclose(now, later, rtol=0, atol=1e-9 / period)

    def test_the_legs_do_the_same_half_a_stride_apart(self):
        gait = fo.Gait.human()
        t = 1.1 + np.linspace(0, 1, 11)
        now, later = gait.pose(t, L1, L2), gait.pose(t + 0.6, L1, L2)
        for a, b in zip(now, later, strict=True):
            np.testing.assert_allclose(a[:, LEFT], b[:, RIGHT], rtol=0, atol=1e-9)

    def test_the_hip_does_not_go_backwards_while_starting(self):
        """The standing leg carries the hip: its ankle moves back from the start on."""
        t = np.linspace(0.5, 1.1, 601)[1:-1]
        pose = fo.Gait.human().pose(t, L1, L2)
        assert pose.vx[:, LEFT].max() < 0.05


class TestStanding:
    @pytest.mark.parametrize("gait", [STANDING_STILL, fo.Gait.human()], ids=["for ever", "before the start"])
    def test_left_leg_straight_right_foot_level_and_higher(self, gait):
        pose = gait.pose([0.0, 0.3, 0.5], L1, L2)
        np.testing.assert_allclose(pose.x[:, LEFT], 0.0, atol=1e-15)
        np.testing.assert_allclose(pose.z[:, LEFT], -(L1 + L2), rtol=1e-15)
        np.testing.assert_allclose(pose.pitch, 0.0, atol=1e-15)
        rise = pose.z[:, RIGHT] - pose.z[:, LEFT]
        np.testing.assert_allclose(rise, L1 * (1 - math.cos(math.radians(20))), rtol=1e-12)
        np.testing.assert_allclose(rise, 0.0283, atol=5e-5)

    def test_lasts_for_ever_without_a_start(self):
        pose = STANDING_STILL.pose([0.0, 1.0, 1e3, 1e6], L1, L2)
        for rate in (pose.vx, pose.vz, pose.rate):
            np.testing.assert_array_equal(rate, 0.0)
        for value in (pose.x, pose.z, pose.pitch):
            np.testing.assert_array_equal(value, np.broadcast_to(value[0], value.shape))


class TestPitch:
    def test_measured_is_the_foots_own_series(self):
        gait = fo.Gait.human(pitch="measured")
        phase = np.linspace(0, 1, 50)
        np.testing.assert_array_equal(gait.cycle(phase)[2][0], gait.foot.at(phase)[0])
        np.testing.assert_array_equal(gait.cycle(phase)[1][0], fo.Gait.human().cycle(phase)[1][0])


class TestFourier:
    SERIES = st.builds(
        Fourier,
        st.floats(-90, 90),
        st.tuples(*[st.floats(-30, 30)] * 3),
        st.tuples(*[st.floats(-30, 30)] * 3),
    )

    @given(SERIES, st.floats(-3, 3))
    def test_rate_is_the_derivative(self, series, phase):
        d = 1e-5
        (before, _), (_, rate), (after, _) = (series.at(np.array([p])) for p in (phase - d, phase, phase + d))
        np.testing.assert_allclose(rate, (after - before) / (2 * d), rtol=0, atol=1e-5)

    @given(SERIES)
    def test_a_fit_of_the_curve_gives_the_series_back(self, series):
        phase = np.arange(50) / 50
        found = Fourier.fit(phase, np.degrees(series.at(phase)[0]), 3)
        np.testing.assert_allclose(
            [found.a0, *found.a, *found.b], [series.a0, *series.a, *series.b], atol=1e-10
        )


class TestFromAngles:
    def test_are_those_of_a_file_of_the_same(self, tmp_path):
        path = write_table(tmp_path / "mine.csv", fo.Gait.human(), 1.0)
        rows = np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)
        assert replace(fo.fit_gait(*rows), name="mine") == fo.read_gait(path)
        assert fo.fit_gait(*rows[:3].tolist(), harmonics=3).foot is None

    def test_what_is_no_walk_is_refused(self):
        t = np.linspace(0.0, 1.2, 50)
        with pytest.raises(SettingError, match="as many angles as times"):
            fo.fit_gait(t, t, t[1:])
        with pytest.raises(FileError, match=r"gait = 'angles': the thigh reaches"):
            fo.fit_gait(t, np.full(50, 200.0), np.zeros(50))
