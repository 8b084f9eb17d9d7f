"""Gaits from a laboratory: the angles come back, whatever the file's dialect, or a message says why."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from motion_files import (
    DIALECTS,
    HUMAN,
    L1,
    L2,
    OPENSIM,
    misfit,
    record,
    turned,
    write_c3d,
    write_mot,
    write_motive,
    write_nexus,
    write_table,
    write_trc,
)

import footopt as fo
from footopt.errors import FileError, SettingError
from footopt.files.gaits import Strides, read_strides
from footopt.files.gaits.c3d import read_c3d
from footopt.files.gaits.leg import leg_angles

TREADMILL = Path(__file__).parents[2] / "examples" / "gait" / "treadmill.c3d"
PATHS = tuple(
    f"/jointset/{joint}/{name}/value"
    for joint, name in zip(("ground", "hip_r", "knee_r", "ankle_r"), OPENSIM, strict=True)
)


def trc(path, change=None, heading=0.0, up="y", unit=1000.0, units="mm", **options):
    """A TRC file of the human walk; `change` alters the markers before it is written."""
    given = {k: options.pop(k) for k in ("blank", "empty") if k in options}
    t, places = record(HUMAN, **options)
    places = turned(places, heading, up)
    if change is not None:
        change(t, places)
    return write_trc(path, t, places, unit, units, **given)


class TestMarkers:
    @pytest.mark.parametrize("dialect", DIALECTS)
    def test_angles_come_back_in_every_dialect(self, tmp_path, dialect):
        gait = fo.Gait.from_file(trc(tmp_path / "walk.trc", dialect=dialect))
        assert misfit(gait) < 0.3
        assert gait.period == pytest.approx(HUMAN.period, rel=2e-3)
        assert (gait.foot is None) == (dialect == "words")
        assert max(rms for _, rms in gait.residual) < 0.3

    def test_the_foot_is_level_in_stance(self, tmp_path):
        """What markers do not know is how high they sit: the pitch comes back but for a constant."""
        gait = fo.Gait.from_file(trc(tmp_path / "walk.trc"))
        shifted = replace(gait, foot=gait.foot._replace(a0=HUMAN.foot.a0))
        assert misfit(shifted, ("foot",)) < 1.0
        assert abs(gait.foot.a0 - HUMAN.foot.a0) < 6.0

    @pytest.mark.parametrize("heading", [0, 180, 90, -35])
    @pytest.mark.parametrize("up", ["y", "z"])
    def test_any_direction_and_either_axis_up(self, tmp_path, heading, up):
        assert misfit(fo.Gait.from_file(trc(tmp_path / "walk.trc", heading=heading, up=up))) < 0.3

    def test_on_a_treadmill(self, tmp_path):
        assert misfit(fo.Gait.from_file(trc(tmp_path / "walk.trc", speed=0.0, heading=180))) < 0.3

    @pytest.mark.parametrize(("unit", "units"), [(1.0, "m"), (100.0, "cm"), (1000.0, "mm"), (1.0, "meters")])
    def test_units_are_the_files_own(self, tmp_path, unit, units):
        strides = read_strides(trc(tmp_path / "walk.trc", unit=unit, units=units))
        assert any(
            f"(to walk with such legs: walker.l1={L1:.3f} walker.l2={L2:.3f})" in note
            for note in strides.notes
        )

    def test_noise_of_three_millimetres_averages_out(self, tmp_path):
        assert misfit(fo.Gait.from_file(trc(tmp_path / "walk.trc", noise=0.003, strides=12.3))) < 1.2

    @pytest.mark.parametrize("rate", [50.0, 120.0, 240.0])
    def test_any_frame_rate(self, tmp_path, rate):
        gait = fo.Gait.from_file(trc(tmp_path / "walk.trc", rate=rate))
        assert misfit(gait) < 0.4
        assert gait.period == pytest.approx(HUMAN.period, rel=5e-3)

    @pytest.mark.parametrize("missing", ["empty", "zero", "word"])
    def test_short_gaps_are_filled(self, tmp_path, missing):
        def hide(t, places):
            for begin in (0.8, 2.1, 3.3):
                gap = (t >= begin) & (t < begin + 0.12)
                places["R_KJC"][gap] = 0.0 if missing == "zero" else np.nan

        path = trc(tmp_path / "walk.trc", hide, empty="NaN" if missing == "word" else "")
        assert misfit(fo.Gait.from_file(path)) < 0.5
        assert any("knee: 36 frames in gaps" in note for note in read_strides(path).notes)

    def test_a_long_gap_is_refused_with_its_place(self, tmp_path):
        def hide(t, places):
            places["R_AJC"][(t >= 1.995) & (t < 2.495)] = np.nan

        path = trc(tmp_path / "walk.trc", hide)
        with pytest.raises(
            FileError, match=r"the ankle is not seen from 1\.990 to 2\.500 s.*gait\.max_gap = 0\.2"
        ):
            fo.Gait.from_file(path)
        assert misfit(fo.Gait.from_file(path, max_gap=0.6)) < 8.0

    def test_a_toe_that_is_lost_costs_only_the_pitch_of_the_foot(self, tmp_path):
        def hide(t, places):
            places["R_MT2"][(t > 2.0) & (t < 2.5)] = np.nan

        path = trc(tmp_path / "walk.trc", hide)
        assert fo.Gait.from_file(path).foot is None
        assert misfit(fo.Gait.from_file(path)) < 0.3
        assert any("the toe is not seen from" in note for note in read_strides(path).notes)

    def test_a_marker_that_comes_late_and_goes_early_shortens_the_walk(self, tmp_path):
        def hide(t, places):
            places["R_AJC"][(t < 0.7) | (t > 5.0)] = np.nan

        assert misfit(fo.Gait.from_file(trc(tmp_path / "walk.trc", hide))) < 0.3

    def test_left_and_right_that_change_places_are_put_back(self, tmp_path):
        def swap(t, places):
            now = (t > 2.0) & (t < 2.6)
            for joint in ("KJC", "AJC"):
                right, left = places[f"R_{joint}"].copy(), places[f"L_{joint}"].copy()
                places[f"R_{joint}"][now], places[f"L_{joint}"][now] = left[now], right[now]

        path = trc(tmp_path / "walk.trc", swap)
        assert misfit(fo.Gait.from_file(path)) < 0.3
        assert sum("left and right exchanged in 59 frames" in note for note in read_strides(path).notes) == 2

    @pytest.mark.parametrize("side", ["left", None])
    def test_the_left_leg(self, tmp_path, side):
        def drop(t, places):
            if side is None:
                del places["R_KJC"]

        path = trc(tmp_path / "walk.trc", drop)
        assert misfit(fo.Gait.from_file(path, side=side)) < 0.3
        assert "the left leg" in read_strides(path, side=side).notes

    def test_a_missing_marker_is_named_with_what_the_file_has(self, tmp_path):
        def drop(t, places):
            for side in "RL":
                places[f"{side}4711"] = places.pop(f"{side}_KJC")

        path = trc(tmp_path / "walk.trc", drop)
        message = r"no marker for the right knee\. For the knee, looked for RKJC, .*The file has R_HJC.*R4711"
        with pytest.raises(FileError, match=message):
            fo.Gait.from_file(path)
        assert misfit(fo.Gait.from_file(path, names={"knee": "R4711"})) < 0.3

    def test_walking_backwards_is_refused(self, tmp_path):
        with pytest.raises(FileError, match=r"the hip goes \d\.\d\d m backwards"):
            fo.Gait.from_file(trc(tmp_path / "walk.trc", speed=-1.0))

    def test_dialects_of_the_header(self, tmp_path):
        path = trc(tmp_path / "walk.trc", blank=False)
        one = fo.Gait.from_file(path)
        lines = path.read_text().split("\n")
        for number in (3, 4):
            lines[number] = lines[number].rstrip("\r").rstrip("\t")
        lines[3] = lines[3].replace("Frame#", "frame")
        path.write_text("\n".join([*lines, "", ""]))
        assert fo.Gait.from_file(path).thigh == one.thigh

    def test_a_part_cut_out_of_a_longer_recording_keeps_its_header(self, tmp_path):
        """As OpenSim's own examples have it: 60 Hz, times to the millisecond, frames 185 to 402 of 900."""
        path = trc(tmp_path / "walk.trc", rate=60.0)
        lines = path.read_text().splitlines()
        lines[2] = "60.00\t60.00\t       900\t41\tmm\t60.00\t1\t       900"
        for i, line in enumerate(lines[6:], start=6):
            frame, time, *cells = line.split("\t")
            lines[i] = "\t".join([f"{int(frame) + 184}", f"{float(time) + 3.067:.3f}000", *cells, ""])
        path.write_text("\n".join(lines) + "\n")
        assert misfit(fo.Gait.from_file(path)) < 0.5
        assert read_strides(path).notes[:2] == (
            "the header says 900 frames, and there are 382",
            "the header says 41 markers, and there are 10",
        )

    @pytest.mark.parametrize(
        ("spoil", "message"),
        [
            (lambda s: "", r"cannot be read as TRC \(no line begins with Frame#"),
            (
                lambda s: s.replace("mm", "furlong"),
                "unit of length must be one of mm, .*is 'furlong'.*gait.units",
            ),
            (lambda s: s.replace("\n10\t", "\n10\tx"), "TRC .line 16: .* is no number"),
            (lambda s: "\n".join(s.splitlines()[:6]), "holds no markers"),
            (lambda s: "\n".join(s.splitlines()[:60]), "not one whole stride"),
            (lambda s: s[: s.rindex(".") + 3], "may be cut off: its last number"),
        ],
    )
    def test_what_is_no_such_file_is_named(self, tmp_path, spoil, message):
        path = trc(tmp_path / "walk.trc")
        path.write_text(spoil(path.read_text()))
        with pytest.raises((FileError, SettingError), match=message) as caught:
            fo.Gait.from_file(path)
        assert "walk.trc" in str(caught.value)

    @pytest.mark.parametrize("given", [{"side": "both"}, {"max_gap": -1.0}])
    def test_settings_are_checked(self, tmp_path, given):
        (setting,) = given
        with pytest.raises(SettingError, match=rf"gait\.{setting} = "):
            fo.Gait.from_file(trc(tmp_path / "walk.trc"), **given)


class TestC3d:
    @pytest.mark.parametrize("dialect", ["plug_in_gait", "opensim"])
    def test_angles_come_back(self, tmp_path, dialect):
        t, places = record(HUMAN, dialect)
        places = turned(places, 180)
        hidden = next(name for name in places if "K" in name[1:3])
        places[hidden][100:110] = np.nan
        write_c3d(tmp_path / "walk.c3d", t, places)
        gait = fo.Gait.from_file(tmp_path / "walk.c3d")
        assert misfit(gait) < 0.4
        assert gait.period == pytest.approx(HUMAN.period, rel=2e-3)
        assert any("knee: 10 frames in gaps" in note for note in read_strides(tmp_path / "walk.c3d").notes)


@pytest.fixture(scope="module")
def markers():
    return read_c3d(TREADMILL.read_bytes())


class TestRealRecording:
    """A person on a treadmill (examples/gait), against the angles that the laboratory's program computed."""

    @pytest.mark.parametrize("side", ["right", "left"])
    def test_angles_are_those_of_the_laboratory(self, markers, side):
        """Vicon's model has centres of joints and turns about their axes; here are markers in a plane."""
        found = leg_angles(markers, {}, side, 0.2)
        knee, hip, pelvis = (
            1e3 * markers.places[f"{side[0].upper()}{joint}Angles"][:, 0]
            for joint in ("Knee", "Hip", "Pelvis")
        )
        for ours, theirs, sd, mean in (
            (found.angles["knee"], knee, 1.5, 1.0),
            (found.angles["thigh"], hip - pelvis, 1.2, 4.0),  # where a pelvis is level is a convention
        ):
            assert np.std(ours - theirs) < sd
            assert abs(np.mean(ours - theirs)) < mean
            assert np.ptp(theirs) > 35.0

    @pytest.mark.parametrize(("side", "many"), [("right", 4), ("left", 5)])
    def test_its_strides(self, side, many):
        strides = read_strides(TREADMILL, side=side)
        assert len(strides.periods) == many
        assert strides.periods == pytest.approx(np.full(many, 1.135), abs=0.02)
        gait = fo.Gait.from_file(TREADMILL, side=side)
        assert gait.foot is not None
        assert all(rms < 1.0 for _, rms in gait.residual)

    def test_both_legs_walk_alike(self):
        phase = np.arange(100) / 100
        right, left = (fo.Gait.from_file(TREADMILL, side=side) for side in ("right", "left"))
        for joint in ("thigh", "knee"):
            apart = getattr(right, joint).at(phase)[0] - getattr(left, joint).at(phase)[0]
            assert np.degrees(abs(apart)).max() < 6.0


class TestCaptures:
    """CSV of motion capture programs."""

    def hidden(self):
        t, places = record(HUMAN, "plug_in_gait")
        places = turned(places, 180)
        places["RKNE"][100:110] = np.nan
        return t, places

    @pytest.mark.parametrize(
        ("before", "after"),
        [
            ("", ""),
            ("Devices\n1000\n,,Force\nFrame,Sub Frame,Fx,Fy,Fz\n,,N,N,N\n1,0,1,2,3\n\n", ""),
            (
                "\n\n",
                "Model Outputs\n100\n,,Sandra:LHipAngles\nFrame,Sub Frame,X,Y,Z\n,,deg,deg,deg\n1,0,1,2,3\n",
            ),
        ],
    )
    def test_vicon_nexus(self, tmp_path, before, after):
        path = write_nexus(tmp_path / "walk.csv", *self.hidden(), before, after)
        assert misfit(fo.Gait.from_file(path)) < 0.4
        assert fo.Gait.from_file(path).period == pytest.approx(HUMAN.period, rel=2e-3)
        assert any("knee: 10 frames in gaps" in note for note in read_strides(path).notes)

    @pytest.mark.parametrize("unit", [("Meters", 1.0), ("Millimeters", 1e3)])
    def test_optitrack_motive(self, tmp_path, unit):
        path = write_motive(tmp_path / "walk.csv", *self.hidden(), unit)
        assert misfit(fo.Gait.from_file(path)) < 0.4
        assert any("knee: 10 frames in gaps" in note for note in read_strides(path).notes)

    @pytest.mark.parametrize(
        ("spoil", "message"),
        [
            (lambda s: s.replace("Trajectories", "Model Outputs"), "no line is Trajectories"),
            (lambda s: s.replace("\n100\n", "\nfast\n"), "'fast' is no number"),
            (lambda s: s.replace("\n100\n", "\n0\n"), "it says 0 frames a second"),
            (lambda s: s.replace("mm,mm,mm", "mm,cm,mm"), "lengths in mm and in cm"),
            (lambda s: s.replace("mm,mm,mm", ",,"), "unit of length must be one of mm"),
            (lambda s: "\n".join(s.splitlines()[:5]) + "\n", "it holds no frames"),
            (lambda s: "\n".join(s.splitlines()[:4]) + "\n", "its header is not whole"),
            (lambda s: s.replace("\n110,0,", "\n110,0,x"), "line 15: .* is no number"),
            (lambda s: s.replace("KNE", "4711"), "no marker for the right knee"),
            (
                lambda s: s.replace("\n110,0,", "\n109,0,"),
                "the time must increase, and goes from 1.09 s to 1.09 s after row 9 ",
            ),
        ],
    )
    def test_what_is_wrong_with_one_is_named(self, tmp_path, spoil, message):
        path = write_nexus(tmp_path / "walk.csv", *self.hidden())
        path.write_text(spoil(path.read_text()))
        with pytest.raises((FileError, SettingError), match=message) as caught:
            fo.Gait.from_file(path)
        assert "walk.csv" in str(caught.value)


class TestMot:
    @pytest.mark.parametrize("names", [OPENSIM, PATHS], ids=["names", "paths"])
    @pytest.mark.parametrize("knee_sign", [1.0, -1.0])
    @pytest.mark.parametrize("ending", ["mot", "sto"])
    def test_angles_come_back(self, tmp_path, names, knee_sign, ending):
        gait = fo.Gait.from_file(write_mot(tmp_path / f"walk.{ending}", HUMAN, names, knee_sign))
        assert misfit(gait, ("thigh", "knee", "foot")) < 0.3
        assert gait.period == pytest.approx(HUMAN.period, rel=2e-3)

    @pytest.mark.parametrize("said", [True, False])
    def test_radians(self, tmp_path, said):
        path = write_mot(tmp_path / "walk.mot", HUMAN, OPENSIM, degrees=False, said=said)
        assert misfit(fo.Gait.from_file(path)) < 0.3

    def test_own_names_and_a_pelvis_that_is_not_there(self, tmp_path):
        own = ("tilt", "hip", "knee", "ankle")
        path = write_mot(tmp_path / "walk.mot", HUMAN, own, tilt=0.0)
        with pytest.raises(
            FileError, match=r"no column for the hip; looked for hip_flexion_r, .*gait\.names\.hip"
        ):
            fo.Gait.from_file(path)
        gait = fo.Gait.from_file(path, names={"hip": "hip", "knee": "knee"})
        assert misfit(gait) < 0.3
        assert gait.foot is None
        assert any("no pelvis_tilt" in n for n in read_strides(path, {"hip": "hip", "knee": "knee"}).notes)

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("time hip\n1 2\n", "no line says endheader"),
            ("x\nendheader\ntime a\n1 2\n3\n", "cannot be read as MOT/STO"),
        ],
    )
    def test_what_is_no_such_file_is_named(self, tmp_path, text, message):
        (tmp_path / "walk.mot").write_text(text)
        with pytest.raises(FileError, match=message):
            fo.Gait.from_file(tmp_path / "walk.mot")


class TestCsv:
    def test_several_strides_are_found_and_averaged(self, tmp_path):
        gait = fo.Gait.from_file(write_table(tmp_path / "a.csv", HUMAN, 6.4))
        assert misfit(gait) < 0.3
        assert gait.period == pytest.approx(HUMAN.period, rel=2e-3)

    def test_own_names(self, tmp_path):
        path = write_table(tmp_path / "a.csv", HUMAN, 6.4)
        path.write_text(path.read_text().replace("time,thigh,knee", "t,theta_1,theta_2"))
        names = {"time": "t", "thigh": "theta_1", "knee": "theta_2"}
        assert misfit(fo.Gait.from_file(path, names=names)) < 0.3

    def test_how_they_differ_is_measured(self):
        apart = np.array([-1.0, 0.0, 1.0])[:, None]
        curves = {"thigh": 20.0 + apart * np.ones(5), "knee": 40.0 + 2.0 * apart * np.ones(5)}
        strides = Strides(np.linspace(0.0, 1.0, 5), curves, 1.2 * np.exp([-0.1, 0.0, 0.1]), ())
        assert strides.variation() == pytest.approx((0.1, np.sqrt((1.0 + 4.0) / 2.0)))

    def test_a_stride_of_another_length_is_left_out(self, tmp_path):
        """As where the subject hesitates: the fourth stride takes half as long again."""
        path = write_table(
            tmp_path / "a.csv", HUMAN, 7.4,
            phase=lambda t: 0.3 + np.interp(t, [0, 3.2, 5.0, 9.8], [0, 8 / 3, 11 / 3, 23 / 3]),
        )  # fmt: skip
        strides = read_strides(path)
        assert any("of another length left out" in note for note in strides.notes)
        assert strides.period == pytest.approx(1.2, rel=0.02)

    def test_one_stride_that_begins_elsewhere_begins_at_the_heel_strike(self, tmp_path):
        path = write_table(tmp_path / "a.csv", HUMAN, 1.0, phase=lambda t: 0.4 + t / HUMAN.period)
        assert "the heel strikes at" in read_strides(path).notes[1]
        assert misfit(fo.Gait.from_file(path)) < 0.5
