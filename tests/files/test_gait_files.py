"""Gaits from a laboratory's files: what was written is read, whatever the dialect, or a message says why not.

What markers and angles must be for a walk is in `test_markers`.
"""

import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from motion_files import (
    HUMAN,
    OPENSIM,
    misfit,
    record,
    write_mot,
    write_motive,
    write_nexus,
    write_table,
    write_trc,
)

import footopt as fo
from footopt.errors import FileError, SettingError
from footopt.files.gaits import read_strides
from footopt.files.gaits.c3d import read_c3d
from footopt.files.gaits.leg import leg_angles
from footopt.gait import Fourier

TREADMILL = Path(__file__).parents[2] / "examples" / "gait" / "treadmill.c3d"
PATHS = tuple(
    f"/jointset/{joint}/{name}/value"
    for joint, name in zip(("ground", "hip_r", "knee_r", "ankle_r"), OPENSIM, strict=True)
)


@pytest.fixture(scope="module")
def markers():
    """A walk in which a knee is hidden for five frames."""
    t, places = record(HUMAN, strides=3.3, rate=50.0)
    places["R_KJC"][50:55] = np.nan
    return t, places


def edited(path, change):
    """A text file whose lines are changed."""
    path.write_text("\n".join([*change(path.read_text().splitlines()), ""]))
    return path


def notes(path, **settings):
    return " | ".join(read_strides(path, **settings).notes)


def assert_walk(path, **settings):
    strides = read_strides(path, **settings)
    gait = fo.Gait.from_strides(strides)
    assert misfit(gait) < 0.4
    assert gait.period == pytest.approx(HUMAN.period, rel=5e-3)
    return gait, " | ".join(strides.notes)


def each_column(header):
    """A name over each column of a marker."""
    return re.sub(r"(\w_\w+)(\t\t\t|\t\t$)", lambda m: "\t".join(f"{m[1]}_{x}" for x in "xyz") + "\t", header)


TRC = {
    "as it is": lambda rows: rows,
    "doubled tabs in the header": lambda rows: [
        rows[0], *(r.replace("\t", "\t\t") for r in rows[1:4]), *rows[4:],
    ],
    "no frame rate": lambda rows: [*rows[:2], rows[2].replace("50.00\t50", "0\t50"), *rows[3:]],
    "columns without a name": lambda rows: [*rows[:6], *(f"{row}\t1.0\t2.0\t3.0\t4.0" for row in rows[6:])],
    "a marker without a name": lambda rows: [r.replace("L_HJC", "") for r in rows],
    "the last time again": lambda rows: [*rows, rows[-1]],
    "a name over each column": lambda rows: [*rows[:3], each_column(rows[3]), *rows[4:]],
    "other words and no blank line": lambda rows: [
        *rows[:3], rows[3].rstrip("\t").replace("Frame#", "frame"), rows[4].rstrip("\t"), *rows[6:], "", "",
    ],
    "zeros in gaps": lambda rows: [*rows[:5], *(r.replace("\t\t\t\t", "\t0.0\t0\t0\t") for r in rows[5:])],
    "words in gaps": lambda rows: [*rows[:5], *(r.replace("\t\t\t\t", "\tNaN\t\tNaN\t") for r in rows[5:])],
}  # fmt: skip


class TestTrc:
    @pytest.mark.parametrize("what", TRC)
    def test_of_any_dialect(self, tmp_path, markers, what):
        _, said = assert_walk(edited(write_trc(tmp_path / "walk.trc", *markers), TRC[what]))
        assert "knee: 5 frames in gaps" in said
        assert ("columns without a name are left out" in said) == ("without a name" in what)

    @pytest.mark.parametrize(("unit", "units"), [(1.0, "m"), (100.0, "cm"), (1.0, "meters")])
    def test_of_any_unit(self, tmp_path, markers, unit, units):
        assert_walk(write_trc(tmp_path / "walk.trc", *markers, unit, units))

    @pytest.mark.parametrize("stated", ["", "furlong", "m"])
    def test_units_can_be_set(self, tmp_path, markers, stated):
        path = write_trc(tmp_path / "walk.trc", *markers, units=stated)
        with pytest.raises(FileError, match=r"gait\.units|would be 4\d\d m long"):
            read_strides(path)
        assert_walk(path, units="mm")

    def test_cut_out_of_a_longer_recording_keeps_its_header(self, tmp_path):
        """As OpenSim's own examples have it: 60 Hz, times to the millisecond, frames 185 to 402 of 900."""
        path = write_trc(tmp_path / "walk.trc", *record(HUMAN, rate=60.0))
        lines = path.read_text().splitlines()
        lines[2] = "60.00\t60.00\t       900\t41\tmm\t60.00\t1\t       900"
        for i, line in enumerate(lines[6:], start=6):
            frame, time, *cells = line.split("\t")
            lines[i] = "\t".join([f"{int(frame) + 184}", f"{float(time) + 3.067:.3f}000", *cells, ""])
        path.write_text("\n".join(lines) + "\n")
        _, said = assert_walk(path)
        assert "says 900 frames, and there are 382 | the header says 41 markers, and there are 10" in said

    @pytest.mark.parametrize(
        ("spoil", "message"),
        [
            (lambda s: "", "is empty"),
            (lambda s: s.replace("Frame#", "Bild"), r"cannot be read as TRC \(no line begins with Frame#"),
            (lambda s: s.replace("mm", "furlong"), "must be one of mm, .*is 'furlong'.*gait.units"),
            (lambda s: s.replace("\n10\t", "\n10\tx"), "TRC .line 16: .* is no number"),
            (lambda s: s.replace("\n10\t", "\n10\t1\t2\t"), r"TRC \(line 16 has 33 cells"),
            (lambda s: "\n".join(s.splitlines()[:6]), "holds no markers"),
            (lambda s: "\n".join(s.splitlines()[:8])[:-40], ""),  # two rows of different widths
            (lambda s: s[: s.rindex(".") + 3], "may be cut off: its last number"),
            (lambda s: s.replace("50.00\t50", "100.00\t50"), "says 100 frames a second, and its times 50"),
            (
                lambda s: s.replace("L_HJC", "").replace("R_KJC\t", "\tR_KJC"),
                "do not stand over every third column",
            ),
        ],
    )
    def test_what_is_none_is_named(self, tmp_path, markers, spoil, message):
        path = write_trc(tmp_path / "walk.trc", *markers)
        path.write_text(spoil(path.read_text() + "\n"))
        with pytest.raises(FileError, match=rf"gait\.path = .*walk\.trc.*{message}"):
            read_strides(path)

    @pytest.mark.parametrize("given", [{"side": "both"}, {"max_gap": -1.0}, {"units": "ell"}])
    def test_settings_are_checked(self, given):
        (setting,) = given
        with pytest.raises(SettingError, match=rf"gait\.{setting} = "):
            read_strides("walk.trc", **given)

    def test_the_other_leg_is_suggested_where_it_would_do(self, tmp_path):
        t, places = record(HUMAN, rate=50.0)
        places["R_KJC"][(t > 2.0) & (t < 2.6)] = np.nan
        path = write_trc(tmp_path / "walk.trc", t, places)
        with pytest.raises(FileError, match=r"The left leg can be read: set gait\.side=left"):
            read_strides(path)
        assert_walk(path, side="left")


class TestRealRecording:
    """A person on a treadmill (examples/gait), against the angles that the laboratory's program computed."""

    @pytest.mark.parametrize(("side", "many"), [("right", 4), ("left", 5)])
    def test_its_strides_and_angles_are_those_of_the_laboratory(self, side, many):
        markers = read_c3d(TREADMILL.read_bytes())
        found = leg_angles(markers, {}, side, 0.2).angles
        pelvis, hip, knee = (
            markers.places[f"{side[0].upper()}{j}Angles"][:, 0] for j in ("Pelvis", "Hip", "Knee")
        )
        for ours, theirs in ((found["thigh"], hip - pelvis), (found["knee"], knee)):
            assert np.sqrt(np.mean((ours - theirs) ** 2)) < 3.0
        strides = read_strides(TREADMILL, side=side)
        assert strides.periods == pytest.approx(np.full(many, 1.135), abs=0.02)
        gait = fo.Gait.from_strides(strides)
        assert gait.foot is not None
        assert all(rms < 1.0 for _, rms in gait.residual)

    @pytest.mark.parametrize(("side", "off"), [("right", 3.5), ("left", 1.6)])
    def test_its_markers_differ_by_where_the_knee_is_beside_them(self, side, off):
        """The model's centre of the knee is 59 mm beside the marker, about an axis turned by 25 and 8 deg."""
        markers = read_c3d(TREADMILL.read_bytes())
        own = leg_angles(markers, {}, side, 0.2).angles["thigh"]
        named = leg_angles(markers, {"knee": f"{side[0].upper()}LEK"}, side, 0.2).angles["thigh"]
        assert np.sqrt(np.mean((own - named) ** 2)) == pytest.approx(off, abs=0.1)

    def test_angles_of_another_convention_are_left_out(self):
        markers = read_c3d(TREADMILL.read_bytes())
        markers.places["RHipAngles"] *= -1.0
        assert any(
            "own angles of thigh and knee are left out" in note
            for note in leg_angles(markers, {}, "right", 0.2).notes
        )


class TestCaptures:
    """CSV of motion capture programs."""

    @pytest.mark.parametrize(
        ("before", "after"),
        [
            ("Devices\n1000\n,,Force\nFrame,Sub Frame,Fx,Fy,Fz\n,,N,N,N\n1,0,1,2,3\n\n", ""),
            (
                "\n\n",
                "Model Outputs\n100\n,,Sandra:LHipAngles\nFrame,Sub Frame,X,Y,Z\n,,deg,deg,deg\n1,0,1,2,3\n",
            ),
        ],
    )
    def test_vicon_nexus(self, tmp_path, markers, before, after):
        _, said = assert_walk(write_nexus(tmp_path / "walk.csv", *markers, before, after))
        assert "knee: 5 frames in gaps" in said

    @pytest.mark.parametrize("unit", [("Meters", 1.0), ("Millimeters", 1e3)])
    def test_optitrack_motive(self, tmp_path, markers, unit):
        _, said = assert_walk(write_motive(tmp_path / "walk.csv", *markers, unit))
        assert "knee: 5 frames in gaps" in said

    @pytest.mark.parametrize(
        ("spoil", "message"),
        [
            (lambda s: s.replace("Trajectories", "Model Outputs"), "no line is Trajectories"),
            (lambda s: s.replace("\n50\n", "\nfast\n"), "'fast' is no number"),
            (lambda s: s.replace("\n50\n", "\n0\n"), "it says 0 frames a second"),
            (lambda s: s.replace("mm,mm,mm", "mm,cm,mm"), "lengths in mm and in cm"),
            (lambda s: s.replace("mm,mm,mm", ",,"), "unit of length must be one of mm"),
            (lambda s: "\n".join(s.splitlines()[:5]) + "\n", "it holds no frames"),
            (lambda s: "\n".join(s.splitlines()[:4]) + "\n", "its header is not whole"),
            (lambda s: s.replace("\n110,0,", "\n110,0,x"), "line 15: .* is no number"),
            (lambda s: s.replace("KJC", "4711"), "no marker for the right knee"),
            (
                lambda s: s.replace("\n110,0,", "\n109,0,"),
                "the time must increase, and goes from 2.18 s to 2.18 s after row 9 ",
            ),
        ],
    )
    def test_what_is_wrong_with_one_is_named(self, tmp_path, markers, spoil, message):
        path = write_nexus(tmp_path / "walk.csv", *markers)
        path.write_text(spoil(path.read_text()))
        with pytest.raises(FileError, match=rf"gait\.path = .*walk\.csv.*{message}"):
            read_strides(path)


def without(rows, column):
    """Two rows in which a column's cell is empty."""
    cells = [[*row.split("\t")] for row in rows]
    return [*rows[:20], *("\t".join([*c[:column], "", *c[column + 1 :]]) for c in cells[20:22]), *rows[22:]]


def speeds_first(rows):
    """As OpenSim 4 writes states: the speed of a joint before its angle."""
    head, hip = rows.index("endheader") + 1, "/jointset/hip_r/hip_flexion_r"
    names = rows[head].replace("hip_flexion_r", f"{hip}/value").split("\t")
    cells = [[*r.split("\t")[:1], "0.1", *r.split("\t")[1:]] for r in rows[head + 1 :]]
    return [*rows[:head], "\t".join([names[0], f"{hip}/speed", *names[1:]]), *map("\t".join, cells)]


class TestMot:
    @pytest.mark.parametrize("names", [OPENSIM, PATHS], ids=["names", "paths"])
    @pytest.mark.parametrize("knee_sign", [1.0, -1.0])
    def test_angles_come_back(self, tmp_path, names, knee_sign):
        path = write_mot(tmp_path / "walk.sto", HUMAN, names, knee_sign)
        path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())  # a byte order mark changes nothing
        gait, _ = assert_walk(path)
        assert misfit(gait, ("foot",)) < 0.3

    @pytest.mark.parametrize("said", [True, False])
    def test_radians(self, tmp_path, said):
        assert_walk(write_mot(tmp_path / "walk.mot", HUMAN, OPENSIM, degrees=False, said=said))

    def test_own_names_and_a_pelvis_that_is_not_there(self, tmp_path):
        path = write_mot(tmp_path / "walk.mot", HUMAN, ("tilt", "hip", "knee", "ankle"), tilt=0.0)
        with pytest.raises(FileError, match=r"no column for the hip; looked for hip_flexion_r.*names\.hip"):
            read_strides(path)
        forces = write_mot(tmp_path / "grf.mot", HUMAN, [f"ground_force_{i}" for i in "xyzp"])
        with pytest.raises(FileError, match="holds no angles, and forces alone are no gait"):
            read_strides(forces)
        gait, said = assert_walk(path, names={"hip": "hip", "knee": "knee"})
        assert gait.foot is None
        assert "no pelvis_tilt" in said

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            (lambda rows: without(rows, 5), ""),
            (lambda rows: without(rows, 3), r"row 14 of the data, at 0\.13 s, has no finite .*knee"),
            (lambda rows: [r.replace("hip_flexion_l", "pro_sup") for r in rows], ""),
            (lambda rows: [r.replace("knee_angle_l", "knee_angle_r") for r in rows], "columns are called"),
            (speeds_first, ""),
            (lambda rows: [r.replace("e_angle", "e_flex").replace("flexion", "flex") for r in rows], ""),
            (lambda rows: [r.replace("s=yes", "s=maybe") for r in rows], "must be yes or no, and is maybe"),
            (lambda rows: [r for r in rows if r != "endheader"], "no line says endheader"),
            (lambda rows: [*rows[:9], "3", *rows[10:]], r"cannot be read as MOT/STO \(line 10 has 1 cells"),
            (lambda rows: [r.replace("knee_angle_r", "k") for r in rows], "The left leg can be read"),
        ],
    )  # fmt: skip
    def test_what_matters_only_in_columns_that_are_read(self, tmp_path, change, message):
        path = write_mot(tmp_path / "walk.mot", HUMAN, (*OPENSIM[:3], "pro_sup"), other=0.5)
        edited(path, change)
        if message:
            with pytest.raises(FileError, match=message):
                read_strides(path)
        else:
            assert_walk(path)

    def test_legs_that_swing_together_are_no_walk(self, tmp_path):
        with pytest.raises(FileError, match="both legs swing together"):
            read_strides(write_mot(tmp_path / "jumps.mot", HUMAN, OPENSIM, other=0.0))


class TestCsv:
    def test_several_strides_by_ones_own_names_and_in_radians(self, tmp_path):
        path = write_table(tmp_path / "a.csv", HUMAN, 4.4)
        rows = np.loadtxt(path, delimiter=",", skiprows=1)
        rows[:, 1:] = np.radians(rows[:, 1:])
        np.savetxt(path, rows, delimiter=",", header="t,theta_1,theta_2,foot", comments="", fmt="%.9f")
        names = {"time": "t", "thigh": "theta_1", "knee": "theta_2"}
        with pytest.raises(FileError, match=r"the thigh moves by 0\.\d+ deg only: .*gait\.units=rad"):
            read_strides(path, names)
        assert_walk(path, names=names, units="rad")

    @pytest.mark.parametrize(
        ("header", "settings", "note"),
        [
            ("Time (s),Thigh angle (deg),Knee (deg),Foot pitch", {}, ""),
            (
                "time,hip_flexion_r,knee_angle_r,ankle_angle_r",
                {},
                "the thigh is hip_flexion_r from the pelvis",
            ),
            ("time_s,RightHipAngle[deg],RightKneeAngle[deg],", {"side": "right"}, "taken to be level"),
            ("t,L Hip Angle,L Knee Angle,other", {}, "the thigh is L Hip Angle"),
            ("timestamp,hip_flexion_ipsi,knee_flexion_ipsi_deg,", {}, "the thigh is hip_flexion_ipsi"),
        ],
    )
    def test_of_any_dialect(self, tmp_path, header, settings, note):
        rows = np.loadtxt(write_table(tmp_path / "a.csv", HUMAN, 4.4), delimiter=",", skiprows=1)
        for sign in (1.0, -1.0) if note else (1.0,):  # OpenSim's knee bends below zero
            rows[:, 2] *= sign
            np.savetxt(tmp_path / "a.csv", rows, delimiter=",", header=header, comments="", fmt="%.6f")
            _, said = assert_walk(tmp_path / "a.csv", **settings)
            assert note in said
            assert ("is turned round" in said) == (sign < 0.0)

    def test_whose_pelvis_leans_back_by_what_it_says(self, tmp_path):
        rows = np.loadtxt(write_table(tmp_path / "a.csv", HUMAN, 4.4), delimiter=",", skiprows=1)
        time, thigh, knee, _ = rows.T
        tilt = -10.0 + np.sin(time)
        header = "time,hip_flexion_r,knee_angle_r,pelvis_tilt"
        table = np.stack([time, thigh - tilt, knee, tilt], axis=1)
        np.savetxt(tmp_path / "a.csv", table, delimiter=",", header=header, comments="", fmt="%.6f")
        _, said = assert_walk(tmp_path / "a.csv")
        assert "pelvis_tilt is added to it, positive backwards as in OpenSim" in said

    @pytest.mark.parametrize(
        ("name", "whole"), [("Phase", 1.0), ("% gait cycle", 100.0), ("phase_ipsi", 1.0)]
    )
    def test_a_phase_is_a_time_that_is_not_known(self, tmp_path, name, whole):
        rows = np.loadtxt(write_table(tmp_path / "a.csv", HUMAN, 1.0), delimiter=",", skiprows=1)
        rows[:, 0] *= whole / rows[-1, 0]
        rows[:, 1:] = np.radians(rows[:, 1:])
        header = f"{name},thigh (rad),knee_ipsi_rad,foot"
        for strides in (1, 2):
            table = np.concatenate([rows] * strides)
            np.savetxt(tmp_path / "a.csv", table, delimiter=",", header=header, comments="", fmt="%.9f")
            if strides == 1:
                gait = fo.Gait.from_file(tmp_path / "a.csv")
                assert gait.period == pytest.approx(1.2)  # the row at 100 % is that at 0 %
                assert misfit(gait) < 0.6
                assert "of a stride, of 1.2 s where gait.period is not given" in notes(tmp_path / "a.csv")
            else:
                with pytest.raises(FileError, match=rf"{name} begins again after row {len(rows)} of the"):
                    read_strides(tmp_path / "a.csv")

    @staticmethod
    def of_phase(tmp_path, phase, thigh=1.0):
        """What is read of a table of whole degrees at phases in parts of a stride."""
        rows = [np.degrees(joint.at(phase)[0]) for joint in (HUMAN.thigh, HUMAN.knee)]
        table = np.array([phase, thigh * rows[0], rows[1]]).T
        form = ["%.3f", "%.0f", "%.0f"]
        np.savetxt(tmp_path / "a.csv", table, form, ",", header="phase,thigh,knee", comments="")
        return fo.Gait.from_file(tmp_path / "a.csv")

    @pytest.mark.parametrize("rows", [20, 25, 51])
    @pytest.mark.parametrize("begin", [0.0, 0.5, 1.0])
    def test_a_phase_says_where_the_stride_ends(self, tmp_path, rows, begin):
        """Whichever of its rows is the first, and however few there are."""
        gait = self.of_phase(tmp_path, (np.arange(rows) + begin) / rows)
        assert gait.period == pytest.approx(1.2, rel=1e-9)
        # phases begin at the table's first row
        at = np.linspace(0.0, 1.0, 101)
        off = gait.thigh.at(at)[0] - HUMAN.thigh.at(at + begin / rows)[0]
        assert np.degrees(abs(off)).max() < 1.2

    @pytest.mark.parametrize(
        ("phase", "message"),
        [
            (np.arange(31) / 50, "the phase covers 62 % of one"),
            (1.0 - np.arange(50) / 50, "begins again"),
        ],
    )
    def test_a_part_of_a_stride_is_none(self, tmp_path, phase, message):
        with pytest.raises(FileError, match=message):
            self.of_phase(tmp_path, phase)

    def test_the_sign_of_a_thigh_is_seen(self, tmp_path):
        with pytest.raises(FileError, match=r"as in a walk backwards.*the sign of thigh or hip"):
            self.of_phase(tmp_path, np.arange(50) / 50, thigh=-1.0)

    def test_a_leg_that_trails_all_the_time_is_none(self, tmp_path):
        phase = np.arange(50) / 50
        rows = [np.degrees(joint.at(phase)[0]) for joint in (HUMAN.thigh, HUMAN.knee)]
        table = np.array([phase, 0.5 * rows[0] - 30.0, 0.3 * rows[1] + 55.0]).T
        np.savetxt(tmp_path / "a.csv", table, delimiter=",", header="phase,thigh,knee", comments="")
        with pytest.raises(FileError, match=r"the ankle lies .* behind the hip on average.*the sign"):
            read_strides(tmp_path / "a.csv")

    def test_two_strides_that_are_not_alike_are_no_walk(self, tmp_path):
        t = np.arange(0.0, 3.0, 0.01)
        phase = np.interp(t, [0.0, 0.3, 1.1, 2.5, 3.0], [-0.3, 0.0, 1.0, 2.0, 2.4])
        rows = [np.degrees(joint.at(phase)[0]) for joint in (HUMAN.thigh, HUMAN.knee)]
        header = "time,thigh,knee"
        np.savetxt(tmp_path / "a.csv", np.array([t, *rows]).T, delimiter=",", header=header, comments="")
        with pytest.raises(FileError, match=r"its strides take .* s, no two of which are alike"):
            read_strides(tmp_path / "a.csv")

    def test_a_squat_of_one_leg_is_seen(self, tmp_path):
        phase = np.arange(101)
        down = np.sin(np.pi * phase / 100) ** 4
        table = np.array([phase, 4.0 + 88.0 * down, 8.0 + 95.0 * np.roll(down, 1)]).T
        header = "percent,hip_angle,knee_angle"
        np.savetxt(tmp_path / "a.csv", table, delimiter=",", header=header, comments="")
        with pytest.raises(FileError, match="a squat or sitting down, and no walk"):
            read_strides(tmp_path / "a.csv")

    @pytest.mark.parametrize(
        ("header", "message"),
        [
            ("0,24.1,-3.9,1", "the first line must name the columns"),
            (
                "ankle_angle,knee_angle,hip_angle,foot",
                "no column for the time; .* the file has ankle_angle, kn",
            ),
            ("time,,knee,theta3", r"the file has time, knee, theta3\. "),
            ("time,theta1,knee,theta3", r"gait\.names\.thigh=\.\.\. \(or gait\.names\.hip"),
            ("time,hip_x,hip_y,knee_x", "Markers are read from TRC and C3D"),
        ],
    )
    def test_what_a_table_lacks(self, tmp_path, header, message):
        (tmp_path / "a.csv").write_text(f"{header}\n" + "".join(f"{i},{i},{i},{i}\n" for i in range(9)))
        with pytest.raises(FileError, match=message):
            read_strides(tmp_path / "a.csv")

    def test_of_a_tenth_of_a_second_is_too_short_for_a_stride(self, tmp_path):
        for begin in np.arange(20) / 20:
            write_table(tmp_path / "a.csv", HUMAN, 0.09, phase=lambda t, begin=begin: begin + t)
            with pytest.raises(FileError, match=r"its 6 rows are 0\.0833 s in all, too short for a stride"):
                read_strides(tmp_path / "a.csv")

    def test_that_was_read_in_radians_is_not_said_to_need_it(self, tmp_path):
        still = replace(HUMAN, thigh=Fourier(0.1, (0.01,), (0.0,)))
        path = write_mot(tmp_path / "a.mot", still, OPENSIM, degrees=False)
        with pytest.raises(FileError, match=r"subject stands\. They are read in radians: gait\.units=deg"):
            read_strides(path)

    @pytest.mark.skipif(os.name != "posix", reason="no pipe has a name there")
    def test_a_pipe_is_not_waited_for(self, tmp_path):
        os.mkfifo(tmp_path / "a.csv")
        with pytest.raises(FileError, match=r"cannot be read \(a pipe, and no file\)"):
            read_strides(tmp_path / "a.csv")

    def test_the_angle_between_thigh_and_shank_is_no_flexion(self, tmp_path):
        rows = np.loadtxt(write_table(tmp_path / "a.csv", HUMAN, 4.4), delimiter=",", skiprows=1)
        rows[:, 2] = 170.0 - rows[:, 2]
        np.savetxt(tmp_path / "a.csv", rows, delimiter=",", header="time,thigh,knee,foot", comments="")
        with pytest.raises(FileError, match="is it the angle between thigh and shank"):
            read_strides(tmp_path / "a.csv")
