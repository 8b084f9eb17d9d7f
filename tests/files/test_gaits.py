"""Gaits from files: strides by a window or by their period, OpenSim's conventions, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from motion_files import HUMAN, OPENSIM, degrees, misfit, write_mot, write_table

import footopt as fo
from footopt.errors import FileError, SettingError
from footopt.files.gaits import read_strides
from footopt.files.strides import cut
from footopt.gait import Fourier


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
    @pytest.mark.parametrize("seeds", [range(15), pytest.param(range(15, 30), marks=pytest.mark.slow)])
    def test_of_random_recordings_period_and_angles_are_right(self, seeds):
        """In 400 the largest error of an angle was half a degree: docs/files.md."""
        for seed in seeds:
            gait, t, angles = drawn(seed)
            found = fo.fit_gait(t, *angles.values())
            assert found.period == pytest.approx(gait.period, rel=0.002), seed
            assert misfit(found, gait) < 0.6, seed

    def test_spread_is_that_of_the_strides(self):
        """Strides whose periods differ by 3 % and whose angles differ by 2 deg give that spread."""
        rng = np.random.default_rng(3)
        periods = 1.2 * np.exp(rng.normal(0.0, 0.03, 12))
        bounds = np.concatenate([[0.0], np.cumsum(periods)])
        t = np.arange(0.0, bounds[-1], 0.01)
        phase = np.interp(t, bounds, np.arange(13))
        more = np.interp(phase, np.arange(13), rng.normal(0.0, 2.0, 13))
        angles = {joint: values + more for joint, values in degrees(HUMAN, phase).items()}
        strides = cut(t, angles)
        assert len(strides.periods) >= 11
        period, apart = strides.variation()
        assert period == pytest.approx(np.std(np.log(periods), ddof=1), rel=0.3)
        assert 0.8 < apart < 2.4
        gait = fo.fit_gait(t, *angles.values())
        assert gait.period == pytest.approx(periods.mean(), rel=0.01)
        assert misfit(gait) < 2.0

    def test_a_window_is_the_stride(self, tmp_path):
        path = write_table(tmp_path / "walk.csv", HUMAN, 3.0, rate=100.0)
        begin = 0.7 * HUMAN.period  # the file begins at 30 % of a stride
        gait = fo.read_gait(path, window=(begin, begin + HUMAN.period))
        assert gait.period == pytest.approx(HUMAN.period, rel=1e-12)
        assert misfit(gait) < 0.05
        turned = fo.read_gait(path, window=(0.2, 0.2 + HUMAN.period))  # from the middle of a stride
        assert misfit(turned) < 0.15

    @pytest.mark.parametrize("end", [1.0, 1.5])
    def test_a_window_that_does_not_close_is_refused(self, tmp_path, end):
        path = write_table(tmp_path / "walk.csv", HUMAN, 3.0)
        with pytest.raises(FileError, match=r"differs by .* deg at its ends.* Set gait\.window"):
            fo.read_gait(path, window=(0.0, end))

    @pytest.mark.parametrize("window", [(1.0, 99.0), (-1.0, 0.3)])
    def test_a_window_beside_the_file_is_refused(self, tmp_path, window):
        path = write_table(tmp_path / "walk.csv", HUMAN, 3.0)
        with pytest.raises(FileError, match=r"gait\.window = .* is not in the file"):
            fo.read_gait(path, window=window)
        with pytest.raises(SettingError, match=r"gait\.window = "):
            fo.read_gait(path, window=window[::-1])

    def test_what_repeats_nowhere_is_refused(self, tmp_path):
        path = write_table(tmp_path / "walk.csv", HUMAN, 1.5)
        with pytest.raises(FileError, match=r"no stride closes.*gait\.window=\[t0,t1\]"):
            fo.read_gait(path)

    def test_a_stride_unlike_the_others_is_refused(self):
        t = np.arange(0.0, 6.0, 0.01)
        angles = degrees(HUMAN, t / HUMAN.period)
        angles["knee"][280:320] += 40.0
        with pytest.raises(FileError, match=r"differs from the mean .* knee: no steady walk.*gait\.window"):
            fo.fit_gait(t, *angles.values())

    def test_a_walk_backwards_is_refused(self):
        t = np.arange(0.0, 6.0, 0.01)
        with pytest.raises(FileError, match="walk backwards"):
            fo.fit_gait(t, *degrees(HUMAN, -t / HUMAN.period).values())

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            (lambda t, thigh, knee: (t, 0.01 * thigh, knee), "the thigh moves by .* deg only"),
            (lambda t, thigh, knee: (t, thigh, 3.0 * knee), "the knee reaches from"),
            (lambda t, thigh, knee: (t[::-1], thigh, knee), "the time must increase"),
            (lambda t, thigh, knee: (10.0 * t, thigh, knee), "s is no walk"),
        ],
    )
    def test_what_is_no_walk_is_named(self, change, message):
        t = np.arange(0.0, 1.2 * 4, 0.01)
        angles = degrees(replace(HUMAN, period=1.2), t / 1.2)
        with pytest.raises(FileError, match=rf"gait = 'angles'.*{message}"):
            fo.fit_gait(*change(t, angles["thigh"], angles["knee"]))


class TestOpenSim:
    @pytest.mark.parametrize("knee_sign", [1.0, -1.0])
    @pytest.mark.parametrize(("unit", "said"), [("deg", True), ("rad", True), ("deg", False), ("rad", False)])
    def test_units_and_the_sign_of_the_knee_change_nothing(self, tmp_path, knee_sign, unit, said):
        """thigh = tilt + hip, foot = thigh - knee + ankle; models differ in the sign of the knee."""
        gait = fo.read_gait(
            write_mot(tmp_path / "walk.mot", HUMAN, knee_sign=knee_sign, unit=unit, said=said)
        )
        if knee_sign > 0:  # the ankle is written for a knee that bends above zero
            assert misfit(gait, joints=("thigh", "knee", "foot")) < 0.02
        assert misfit(gait) < 0.02
        assert gait.period == pytest.approx(HUMAN.period, rel=1e-4)

    def test_states_and_other_models_have_other_names(self, tmp_path):
        for i, names in enumerate(
            (
                [f"/jointset/a/{name}/value" for name in OPENSIM],
                ("pelvis_tilt", "hip_flex_r", "knee_flex_r", "ankle_flex_r"),
            )
        ):
            gait = fo.read_gait(write_mot(tmp_path / f"{i}.sto", HUMAN, names))
            assert misfit(gait, joints=("thigh", "knee", "foot")) < 0.02

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
        path.write_text(
            path.read_text().replace("Knee angle (deg)", "Knie").replace(",", ";").replace(".", ",")
        )
        assert fo.read_gait(path, names={"knee": "Knie"}).knee == gait.knee

    @pytest.mark.parametrize("last", [100, 99])
    def test_a_phase_in_percent_is_one_stride(self, tmp_path, last):
        percent = np.arange(last + 1)
        angles = degrees(HUMAN, percent / 100)
        rows = "\n".join(
            f"{p},{a},{b}" for p, a, b in zip(percent, angles["thigh"], angles["knee"], strict=True)
        )
        (tmp_path / "g.csv").write_text(f"percent,thigh,knee\n{rows}\n")
        gait = fo.read_gait(tmp_path / "g.csv")
        assert gait.period == 1.2
        assert misfit(gait) < 0.02

    def test_too_few_harmonics_show_in_the_residual(self, tmp_path):
        gait = fo.read_gait(write_table(tmp_path / "g.csv", HUMAN, 1.0), harmonics=3)
        assert 0.5 < dict(gait.residual)["knee"] < 5.0

    @pytest.mark.parametrize(
        ("spoil", "message"),
        [
            (lambda r: [r[0].replace("knee", "hip"), *r[1:]], r"no column for the knee.*gait\.names\.knee="),
            (lambda r: r[:32], r"deg at its ends.*gait\.window"),
            (lambda r: r[:1] + r[1::6], "at least 14 rows of a stride"),
            (lambda r: [*r[:4], "0.05,much,1,1", *r[5:]], "row 4: thigh is 'much'"),
            (lambda r: r[:1], "has 0 rows"),
        ],
    )
    def test_what_is_wrong_with_one_is_named(self, tmp_path, spoil, message):
        path = write_table(tmp_path / "g.csv", HUMAN, 1.0)
        path.write_text("\n".join([*spoil(path.read_text().splitlines()), ""]))
        with pytest.raises(FileError, match=rf"gait\.path = .*g\.csv.*{message}"):
            fo.read_gait(path)


@pytest.mark.parametrize("ending", ["trc", "c3d"])
def test_markers_are_refused_with_what_is_read_instead(tmp_path, ending):
    with pytest.raises(FileError, match=r"joint angles \(CSV, MOT, STO\).*inverse kinematics"):
        fo.read_gait(tmp_path / f"walk.{ending}")


def test_an_unknown_ending_is_refused(tmp_path):
    with pytest.raises(SettingError, match=r"gait\.path = .*\.csv, \.mot"):
        fo.read_gait(tmp_path / "gait.xlsx")
