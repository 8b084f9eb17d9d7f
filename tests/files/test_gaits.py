"""Gaits from files: strides by a window or by their period, OpenSim's conventions, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from motion_files import HUMAN, OPENSIM, degrees, misfit, write_mot, write_table
from running import tries

import footopt as fo
from footopt.errors import FileError, SettingError
from footopt.files.gaits import read_strides
from footopt.gait import Fourier

SECONDS = np.arange(0.0, 6.0, 0.01)


def another(rng):
    """The built-in gait as another person may walk it."""

    def varied(series, scale, more):
        a, b = (
            tuple(scale * c + rng.normal(0.0, (k + 1) ** -1.5) for k, c in enumerate(each))
            for each in (series.a, series.b)
        )
        return Fourier(series.a0 + more, a, b)

    bend = rng.uniform(0.8, 1.1)
    return replace(
        HUMAN,
        thigh=varied(HUMAN.thigh, rng.uniform(0.75, 1.2), rng.normal(0.0, 3.0)),
        knee=varied(HUMAN.knee, bend, (bend - 1.0) * HUMAN.knee.a0 + abs(rng.normal(0.0, 5.0))),
        period=rng.uniform(0.85, 1.6),
    )


def drawn(seed):
    """Another gait and its recording: times (s) and angles (deg) with noise, cut anywhere."""
    rng = np.random.default_rng(seed)
    gait, rate = another(rng), rng.uniform(40.0, 240.0)
    t = np.arange(int(rng.uniform(2.05, 10.0) * gait.period * rate)) / rate
    angles = degrees(gait, rng.uniform() + t / gait.period)
    return gait, t, {joint: values + rng.normal(0.0, 0.5, len(t)) for joint, values in angles.items()}


class TestStrides:
    def test_of_random_recordings_period_and_angles_are_right(self):
        """In 400 the largest error of an angle was half a degree: docs/evidence/gaits.md."""
        for seed in range(tries(4)):
            gait, t, angles = drawn(seed)
            found = fo.fit_gait(t, *angles.values())
            assert found.period == pytest.approx(gait.period, rel=0.002), seed
            assert misfit(found, gait) < 0.6, seed

    def test_strides_of_a_small_robot_are_found(self):
        t, rng = np.arange(200) * 0.003, np.random.default_rng(4)
        angles = {joint: v + rng.normal(0.0, 0.5, len(t)) for joint, v in degrees(HUMAN, t / 0.15).items()}
        assert fo.fit_gait(t, *angles.values()).period == pytest.approx(0.15, rel=0.002)

    def test_of_uneven_strides_the_mean_is_fitted(self):
        """Periods differ by 3 %, angles by 2 deg."""
        rng = np.random.default_rng(3)
        periods = 1.2 * np.exp(rng.normal(0.0, 0.03, 12))
        bounds = np.concatenate([[0.0], np.cumsum(periods)])
        t = np.arange(0.0, bounds[-1], 0.01)
        phase = np.interp(t, bounds, np.arange(13))
        more = np.interp(phase, np.arange(13), rng.normal(0.0, 2.0, 13))
        gait = fo.fit_gait(t, *(values + more for values in degrees(HUMAN, phase).values()))
        assert gait.period == pytest.approx(periods.mean(), rel=0.01)
        assert misfit(gait) < 2.0

    def test_a_window_is_the_stride(self, tmp_path):
        path = write_table(tmp_path / "walk.csv", HUMAN, 3.0, rate=100.0)
        begin = 0.7 * HUMAN.period  # the file begins at 30 % of a stride
        gait = fo.read_gait(path, window=(begin, begin + HUMAN.period))
        assert gait.period == pytest.approx(HUMAN.period, rel=1e-12)
        assert misfit(gait) < 0.05

    def test_a_stride_begins_where_the_ankle_is_farthest_ahead(self):
        """Between rows, and whatever the noise."""
        p, recordings = np.linspace(-0.02, 0.02, 401), [drawn(seed)[1:] for seed in range(tries(4))]
        begun = np.random.default_rng(0).uniform(size=5)
        recordings += [(SECONDS, degrees(HUMAN, begin + SECONDS / HUMAN.period)) for begin in begun]
        for t, angles in recordings:
            (thigh, _), (shank, _), _ = fo.fit_gait(t, *angles.values()).cycle(p)
            assert abs(p[np.argmax(np.sin(thigh) + np.sin(shank))]) < 3e-3

    def test_a_stride_unlike_the_others_is_refused(self):
        angles = degrees(HUMAN, SECONDS / HUMAN.period)
        angles["knee"][280:320] += 40.0
        with pytest.raises(FileError, match=r"differs from the mean .* knee: no steady walk.*gait\.window"):
            fo.fit_gait(SECONDS, *angles.values())

    def test_a_walk_backwards_is_refused(self):
        with pytest.raises(FileError, match="walk backwards"):
            fo.fit_gait(SECONDS, *degrees(HUMAN, -SECONDS / HUMAN.period).values())

    def test_a_pitch_of_the_other_sign_is_refused_and_a_level_foot_is_not(self):
        thigh, knee, foot = degrees(HUMAN, SECONDS / HUMAN.period).values()
        with pytest.raises(FileError, match="toes are up"):
            fo.fit_gait(SECONDS, thigh, knee, -foot)
        for share in (-0.2, 0.0, 0.5, 1.5):
            fo.fit_gait(SECONDS, thigh, knee, share * (thigh - knee))

    def test_radians_are_refused_and_a_straight_knee_is_not(self):
        t, (thigh, knee, _) = 0.02 * np.arange(61), degrees(HUMAN, np.linspace(0.0, 1.0, 61)).values()
        fo.fit_gait(t, thigh, 0.0 * knee)
        with pytest.raises(FileError, match="in degrees"):
            fo.fit_gait(t, np.radians(thigh), np.radians(knee))


class TestOpenSim:
    @pytest.mark.parametrize("knee_sign", [1.0, -1.0])
    @pytest.mark.parametrize(("unit", "said"), [("deg", True), ("rad", True), ("deg", False), ("rad", False)])
    def test_units_and_the_sign_of_the_knee_change_nothing(self, tmp_path, knee_sign, unit, said):
        """thigh = tilt + hip, foot = thigh - knee + ankle; models differ in the sign of the knee."""
        path = write_mot(tmp_path / "walk.mot", HUMAN, knee_sign=knee_sign, unit=unit, said=said)
        gait = fo.read_gait(path)
        if knee_sign > 0:  # the ankle is written for a knee that bends above zero
            assert misfit(gait, joints=("thigh", "knee", "foot")) < 0.02
        assert misfit(gait) < 0.02
        assert gait.period == pytest.approx(HUMAN.period, rel=1e-4)

    def test_without_a_tilt_the_pelvis_is_level(self, tmp_path):
        path = write_mot(tmp_path / "walk.mot", HUMAN, ("other", *OPENSIM[1:]), tilt=4.0)
        gait = fo.read_gait(path)
        assert gait.thigh.a0 == pytest.approx(HUMAN.thigh.a0 - 4.0, abs=0.01)
        assert "pelvis: level" in " ".join(read_strides(path).notes)

    def test_the_side_that_is_there_is_read(self, tmp_path):
        names = [name.replace("_r", "_l") for name in OPENSIM]
        path = write_mot(tmp_path / "walk.mot", HUMAN, names)
        assert misfit(fo.read_gait(path)) < 0.02
        with pytest.raises(FileError, match="no column for the thigh or the hip"):
            fo.read_gait(path, side="right")
        with pytest.raises(SettingError, match=r"gait\.side"):
            fo.read_gait(path, side="both")


class TestCsv:
    @pytest.mark.parametrize("unit", ["", " [deg]", " [rad]"])
    def test_the_leg_that_is_asked_for_and_units_of_the_header_are_read(self, tmp_path, unit):
        thigh, knee, _ = degrees(HUMAN, SECONDS / HUMAN.period).values()
        shown = np.radians(thigh) if "rad" in unit else thigh
        table = np.column_stack([SECONDS, shown, knee, 0.8 * shown, 0.8 * knee])
        head, path = f"time,thigh{unit},knee (deg),thigh_l{unit},knee_l (deg)", tmp_path / "two.csv"
        np.savetxt(path, table, delimiter=",", header=head, comments="")
        assert misfit(fo.read_gait(path)) < 0.05
        left = degrees(fo.read_gait(path, side="left"), SECONDS)
        assert [np.ptp(left["thigh"]), np.ptp(left["knee"])] == pytest.approx(
            [0.8 * np.ptp(thigh), 0.8 * np.ptp(knee)], rel=0.01
        )
        path.write_text(path.read_text().replace("thigh_l", "a").replace("knee_l", "b"))
        with pytest.raises(SettingError, match=r"gait\.side"):
            fo.read_gait(path, side="left")

    def test_a_window_of_several_strides_a_gap_and_a_name_given_twice_are_refused(self, tmp_path):
        table = write_table(tmp_path / "a.csv", HUMAN, 4.4).read_text().splitlines()
        path, rows = tmp_path / "b.csv", (len(table) - 1) / (4.4 * HUMAN.period)
        for content, window, words in (
            (table, (0.5, 0.5 + 2.0 * HUMAN.period), "more than one stride"),
            (table[: round(rows)] + table[round(rows * (1.0 + 0.4 * HUMAN.period)) :], None, "no rows from"),
            ([table[0].replace("thigh", "knee"), *table[1:]], None, "two columns are called knee"),
        ):
            path.write_text("\n".join(content))
            with pytest.raises(FileError, match=words):
                fo.read_gait(path, window=window)

    @pytest.mark.parametrize("pitch", ["shank", "measured"])
    def test_gives_back_the_gait_that_was_measured(self, tmp_path, pitch):
        human = fo.Gait.human(period=0.9)
        found = replace(fo.read_gait(write_table(tmp_path / "mine.csv", human, 1.0)), pitch=pitch)
        assert (found.name, found.period) == ("mine", pytest.approx(0.9, abs=1e-8))
        assert max(rms for _, rms in found.residual) < 1e-7
        t = np.linspace(0, 4, 201)
        expected = replace(human, pitch=pitch).pose(t, 0.47, 0.45)
        for a, b in zip(found.pose(t, 0.47, 0.45), expected, strict=True):
            np.testing.assert_allclose(a, b, rtol=0, atol=1e-6)

    def test_the_foot_is_optional_and_names_units_and_order_do_not_matter(self, tmp_path):
        columns = ("note", "Knee angle (deg)", "thigh_R", "Time [s]")
        path = write_table(tmp_path / "G.CSV", HUMAN, 2.5, columns=("note", "knee", "thigh", "time"))
        path.write_text(path.read_text().replace("note,knee,thigh,time", ",".join(columns)))
        gait = fo.read_gait(path)
        assert gait.foot is None
        assert misfit(gait) < 0.3  # 60 rows a second
        text = path.read_text().replace("Knee angle (deg)", "Knie")
        path.write_text(text.replace(",", ";").replace(".", ","))
        assert fo.read_gait(path, names={"knee": "Knie"}).knee == gait.knee

    @pytest.mark.parametrize(("first", "last"), [(0, 100), (0, 99), (1, 100), (0.5, 99.5), (-50, 50)])
    def test_a_phase_in_percent_is_one_stride(self, tmp_path, first, last):
        percent = np.arange(first, last + 0.1)
        angles = degrees(HUMAN, (percent - min(first, 0)) / 100)  # from -50 on that is where it begins
        rows = np.stack([percent, angles["thigh"], angles["knee"]], axis=1)
        np.savetxt(tmp_path / "g.csv", rows, delimiter=",", header="percent,thigh,knee", comments="")
        gait = fo.read_gait(tmp_path / "g.csv")
        assert gait.period == 1.2
        assert misfit(gait) < 0.02
