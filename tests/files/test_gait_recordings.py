"""What real recordings hold besides a long clean walk: read to what was walked, or refused for what it is."""

import os
import re
from dataclasses import replace

import numpy as np
import pytest
from motion_files import (
    HUMAN,
    OPENSIM,
    misfit,
    record,
    turned,
    write_mot,
    write_table,
    write_trc,
)

import footopt as fo
from footopt.errors import FileError
from footopt.files.gaits import read_strides
from footopt.gait import Fourier

#: Squats: knee and thigh bend together, the ankle stays below the hip.
SQUATS = replace(
    HUMAN,
    thigh=Fourier(35.0, (-35.0,), (0.0,)),
    knee=Fourier(60.0, (-58.0,), (0.0,)),
    foot=Fourier(0.0, (0.0,), (0.0,)),
    period=2.4,
)
DRAWS = int(os.environ.get("FOOTOPT_TRIALS", "12"))


def trc(path, change=None, **options):
    t, places = record(HUMAN, **options)
    if change is not None:
        t, places = change(t, places) or (t, places)
    return write_trc(path / "walk.trc", t, places)


def lines(path, change):
    """A text file whose lines are changed."""
    path.write_text("\n".join(change(path.read_text().splitlines())) + "\n")
    return path


def notes(path, **settings):
    return " | ".join(read_strides(path, **settings).notes)


class TestStrides:
    """One heel strike of each foot a stride, half a stride apart."""

    @pytest.mark.parametrize("side", ["right", "left"])
    @pytest.mark.parametrize("strides", [5.2, 7.3])
    @pytest.mark.parametrize("begin", [0.25, 0.75])
    def test_two_strides_are_never_one(self, tmp_path, side, strides, begin):
        """Every second stride is longer, so that two of them repeat better than one."""

        def phase(t):
            return begin + t / HUMAN.period + 0.08 * np.sin(np.pi * t / HUMAN.period + begin)

        path = write_mot(tmp_path / "a.mot", HUMAN, OPENSIM, other=0.5, strides=strides, phase=phase)
        assert read_strides(path, side=side).period == pytest.approx(HUMAN.period, rel=0.15)

    def test_a_stride_that_the_other_foot_does_not_share_is_left_out(self, tmp_path):
        def stop(t, places):
            late = t > 3.6  # the left leg stands; the right one goes on
            for name, place in places.items():
                if name.startswith("L_"):
                    place[late] = places["L_HJC"][late] + (place - places["L_HJC"])[np.argmax(late)]

        path = trc(tmp_path, stop)
        assert "without one strike of the other foot left out" in notes(path)
        assert fo.Gait.from_file(path).period == pytest.approx(HUMAN.period, rel=0.01)

    @pytest.mark.parametrize("ending", ["trc", "mot", "csv"])
    def test_squats_are_no_walk(self, tmp_path, ending):
        path = tmp_path / f"squats.{ending}"
        if ending == "trc":
            write_trc(path, *record(SQUATS, speed=0.0, apart=0.0))
        elif ending == "mot":
            write_mot(path, SQUATS, OPENSIM, other=0.0)
        else:
            write_table(path, SQUATS, 4.4)
        with pytest.raises(FileError, match=r"squats.*no walk"):
            fo.Gait.from_file(path)

    def test_jumps_with_both_feet_are_no_walk(self, tmp_path):
        with pytest.raises(FileError, match=r"both legs swing together .*correlate at \+1\.00.*no walk"):
            fo.Gait.from_file(write_mot(tmp_path / "jumps.mot", HUMAN, OPENSIM, other=0.0))

    def test_stairs_are_named(self, tmp_path):
        path = trc(tmp_path, climb=0.3)
        assert misfit(fo.Gait.from_file(path)) < 0.5
        assert "the hip rises by" in notes(path)
        assert "stairs or a slope" in notes(path)
        assert "stairs" not in notes(trc(tmp_path))


class TestShortTrials:
    """Phones and small laboratories record 1.3 to 2 s: one stride, which two strikes rarely bound."""

    @pytest.mark.parametrize("draw", range(DRAWS))
    def test_any_window_of_more_than_a_stride_gives_it(self, tmp_path, draw):
        rng = np.random.default_rng(draw)
        gait = replace(HUMAN, period=rng.uniform(0.9, 1.3))
        t, places = record(
            gait, strides=rng.uniform(1.12, 1.9), rate=rng.choice([60.0, 100.0, 120.0]),
            phase=rng.uniform(0, 1), noise=1e-3, seed=draw,
        )  # fmt: skip
        path = write_trc(tmp_path / "walk.trc", t, places)
        found = fo.Gait.from_file(path)
        assert found.period == pytest.approx(gait.period, rel=0.05)
        assert misfit(found) < 6.0
        said = notes(path)
        assert "1 stride of" in said or "its ends differ by" in said

    @pytest.mark.parametrize("phase", [0.0, 0.3, 0.55, 0.8])
    def test_half_a_stride_of_both_legs_is_one_by_symmetry(self, tmp_path, phase):
        path = trc(tmp_path, strides=0.62, phase=phase)
        assert "half a stride of each leg" in notes(path)
        assert misfit(fo.Gait.from_file(path)) < 4.0
        assert fo.Gait.from_file(path).period == pytest.approx(HUMAN.period, rel=0.05)

    def test_less_is_refused(self, tmp_path):
        with pytest.raises(FileError, match=r"not one whole stride: in 0\.4\d* s no stride closes"):
            fo.Gait.from_file(trc(tmp_path, strides=0.4))

    def test_standing_is_called_so(self, tmp_path):
        def stand(t, places):
            for place in places.values():
                place[:] = place[0]

        with pytest.raises(FileError, match=r"the thigh moves by 0 deg only: the subject stands"):
            fo.Gait.from_file(trc(tmp_path, stand))

    def test_a_step_after_standing_is_called_so(self, tmp_path):
        path = write_table(tmp_path / "a.csv", HUMAN, 3.0, phase=lambda t: 0.3 + np.maximum(t - 2.4, 0) / 1.5)
        with pytest.raises(FileError, match=r"the leg stands still for \d\d % of .* moves from 2\.4"):
            fo.Gait.from_file(path)

    def test_the_other_leg_is_suggested_where_it_would_do(self, tmp_path):
        def hide(t, places):
            places["R_KJC"][(t > 2.0) & (t < 2.6)] = np.nan

        path = trc(tmp_path, hide)
        with pytest.raises(FileError, match=r"The left leg can be read: set gait\.side=left"):
            fo.Gait.from_file(path)
        assert misfit(fo.Gait.from_file(path, side="left")) < 0.3


class TestSides:
    """A repair makes rigid things more rigid and fast ones slower, or is not made."""

    def test_heels_that_cross_are_left_where_they_are(self, tmp_path):
        def cross(t, places):
            for side, sign in (("R", 1.0), ("L", -1.0)):
                for part in ("Heel", "MT2"):
                    places[f"{side}_{part}"][:, 1] += 0.2 * sign * np.exp(-(((t % 1.5) - 0.7) ** 2) / 0.02)

        path = trc(tmp_path, cross)
        assert "exchanged" not in notes(path)
        assert fo.Gait.from_file(path).foot is not None

    @pytest.mark.parametrize("heading", [0.0, 37.0, 90.0, 200.0])
    @pytest.mark.parametrize("begin", [0.0, 2.0])
    def test_what_changed_sides_is_put_back_in_any_direction(self, tmp_path, heading, begin):
        def swap(t, places):
            now = (t >= begin) & (t < begin + 0.6)
            for joint in ("KJC", "AJC", "Heel"):
                right, left = places[f"R_{joint}"].copy(), places[f"L_{joint}"].copy()
                places[f"R_{joint}"][now], places[f"L_{joint}"][now] = left[now], right[now]
            return t, turned(places, heading)

        path = trc(tmp_path, swap)
        assert misfit(fo.Gait.from_file(path)) < 0.3
        assert notes(path).count("left and right exchanged in") == 3

    @pytest.mark.parametrize("both", [True, False])
    @pytest.mark.parametrize("turn", [60.0, 180.0])
    def test_a_turn_is_called_a_turn(self, tmp_path, both, turn):
        def around(t, places):
            angle = np.radians(turn) * np.clip((t - 2.5) / 1.5, 0, 1)
            c, s = np.cos(angle), np.sin(angle)
            for place in places.values():
                x, y = place[:, 0] - 2.5, place[:, 1] + 1.0
                place[:, 0], place[:, 1] = c * x - s * y, s * x + c * y
            if not both:
                for name in [name for name in places if name.startswith("L_")]:
                    del places[name]

        with pytest.raises(FileError, match=r"the subject turns by \d+ deg from \d.* to \d.* s"):
            fo.Gait.from_file(trc(tmp_path, around, speed=1.2))

    def test_a_foot_that_jumps_costs_only_its_pitch(self, tmp_path):
        def jump(t, places):
            places["R_Heel"][100:103] += 0.9

        path = trc(tmp_path, jump)
        assert misfit(fo.Gait.from_file(path)) < 0.3
        assert fo.Gait.from_file(path).foot is None
        assert "no pitch of the foot: the toe is 1." in notes(path)

    def test_a_foot_s_angle_that_cannot_be_one_costs_only_its_pitch(self, tmp_path):
        path = write_table(tmp_path / "a.csv", HUMAN, 4.4)
        lines(path, lambda rows: [rows[0], *(r.rpartition(",")[0] + ",300" for r in rows[1:])])
        assert fo.Gait.from_file(path).foot is None
        assert "no pitch of the foot: the foot goes from 300" in notes(path)


def with_columns(rows, more):
    """Columns of numbers behind the markers' that no name stands over."""
    return [*rows[:6], *(f"{row}\t{more}" for row in rows[6:])]


TRIVIA = {
    "doubled tabs in the header": lambda rows: [
        rows[0],
        *(r.replace("\t", "\t\t") for r in rows[1:4]),
        *rows[4:],
    ],
    "no frame rate": lambda rows: [*rows[:2], rows[2].replace("100.00\t100", "0\t100"), *rows[3:]],
    "columns without a name": lambda rows: with_columns(rows, "1.0\t2.0\t3.0\t4.0"),
    "the last time again": lambda rows: [*rows, rows[-1]],
    "a name over each column": lambda rows: [
        *rows[:3],
        re.sub(r"(\w_\w+)(\t\t\t|\t\t$)", lambda m: "\t".join(f"{m[1]}_{x}" for x in "xyz") + "\t", rows[3]),
        *rows[4:],
    ],
}


class TestTrivia:
    """What no program that shows a recording minds."""

    @pytest.mark.parametrize("what", TRIVIA)
    def test_of_trc(self, tmp_path, what):
        assert misfit(fo.Gait.from_file(lines(trc(tmp_path), TRIVIA[what]))) < 0.3

    def test_a_marker_without_a_name_is_left_out_and_shifts_no_other(self, tmp_path):
        path = lines(trc(tmp_path), lambda rows: [r.replace("L_HJC", "") for r in rows])
        assert misfit(fo.Gait.from_file(path)) < 0.3
        assert "3 columns without a name are left out" in notes(path)

    def test_of_two_markers_with_one_name_the_one_with_data_is_read(self, tmp_path):
        def twice(t, places):
            empty = {"R_KJC ": np.full((len(t), 3), np.nan)}
            return t, {**dict(list(places.items())[:1]), **empty, **places}

        path = trc(tmp_path, twice)
        assert misfit(fo.Gait.from_file(path)) < 0.3
        assert "of the markers called R_KJC, the first with data is read" in notes(path)

    def test_two_that_differ_are_read_only_if_they_are_not_wanted(self, tmp_path):
        def twice(t, places):
            return t, places | {"C7": places["R_HJC"] + 0.5, "C7 ": places["R_HJC"] + 0.6}

        assert misfit(fo.Gait.from_file(trc(tmp_path, twice))) < 0.3

        def knees(t, places):
            return t, places | {"R_KJC ": places["R_KJC"] + 0.05}

        with pytest.raises(FileError, match=r"no marker for the right knee\. Two markers are called R_KJC\."):
            fo.Gait.from_file(trc(tmp_path, knees), side="right")

    def test_steps_of_time_may_vary(self, tmp_path):
        rng = np.random.default_rng(3)
        t = np.cumsum(0.012 * rng.lognormal(0.0, 0.9, 600).clip(0.05, 3.5))
        path = write_mot(tmp_path / "walk.mot", HUMAN, OPENSIM, other=0.5, t=t)
        assert misfit(fo.Gait.from_file(path)) < 0.6
        assert fo.Gait.from_file(path).period == pytest.approx(HUMAN.period, rel=0.01)

    def test_two_columns_of_one_name_matter_only_if_they_are_read(self, tmp_path):
        path = write_mot(tmp_path / "walk.mot", HUMAN, (*OPENSIM[:3], "pro_sup"), other=0.5)
        two = lines(path, lambda rows: [r.replace("hip_flexion_l", "pro_sup") for r in rows])
        assert misfit(fo.Gait.from_file(two)) < 0.3
        same = lines(path, lambda rows: [r.replace("knee_angle_l", "knee_angle_r") for r in rows])
        with pytest.raises(FileError, match=r"two columns are called 'knee_angle_r'"):
            fo.Gait.from_file(same)

    def test_speeds_are_not_taken_for_angles(self, tmp_path):
        path = write_mot(tmp_path / "walk.sto", HUMAN, OPENSIM)
        hip = "/jointset/hip_r/hip_flexion_r"

        def speeds_first(rows):
            head = rows.index("endheader") + 1
            names = rows[head].replace("hip_flexion_r", f"{hip}/value").split("\t")
            cells = [[*r.split("\t")[:1], "0.1", *r.split("\t")[1:]] for r in rows[head + 1 :]]
            return [*rows[:head], "\t".join([names[0], f"{hip}/speed", *names[1:]]), *map("\t".join, cells)]

        assert misfit(fo.Gait.from_file(lines(path, speeds_first))) < 0.3

    def test_joint_centres_that_were_never_seen_give_way_to_the_pelvis(self, tmp_path):
        path = tmp_path / "walk.trc"
        t, places = record(HUMAN, "plug_in_gait")
        write_trc(path, t, {"RHJC": np.full((len(t), 3), np.nan), **places})
        assert misfit(fo.Gait.from_file(path)) < 0.3

    def test_one_marker_at_the_back_of_the_pelvis_is_enough(self, tmp_path):
        t, places = record(HUMAN, "plug_in_gait")
        del places["LPSI"]
        assert misfit(fo.Gait.from_file(write_trc(tmp_path / "walk.trc", t, places))) < 1.0

    @pytest.mark.parametrize(
        "names",
        [
            {"ASI": "FWT", "PSI": "BWT"},
            {"HEE": "HEEL", "TOE": "MTP"},
            {"HEE": "CPG", "TOE": "D2M"},
            {"HEE": "HEL", "TOE": "2MT"},
            {"KNE": "LEPI", "ANK": "LMAL", "HEE": "HEEL", "TOE": "TOE"},
        ],
    )
    def test_names_of_other_laboratories(self, tmp_path, names):
        t, places = record(HUMAN, "plug_in_gait")
        places = {n[0] + names.get(n[1:], n[1:]): place for n, place in places.items()}
        gait = fo.Gait.from_file(write_trc(tmp_path / "walk.trc", t, places))
        assert misfit(gait) < 0.3
        assert gait.foot is not None

    def test_of_opencap_s_two_sets_the_finished_one_is_read(self, tmp_path):
        t, places = record(HUMAN, "opencap")
        raw = {"RKnee": places["r_knee_study"] + 0.1 * np.sin(t)[:, None], "RHip": places["RHJC_study"] + 0.3}
        path = write_trc(tmp_path / "walk.trc", t, raw | places)
        assert misfit(fo.Gait.from_file(path)) < 0.3

    def test_an_empty_cell_of_a_column_that_is_not_read(self, tmp_path):
        path = write_mot(tmp_path / "a.mot", HUMAN, OPENSIM, other=0.5)

        def without(rows, column):
            cells = [row.split("\t") for row in rows]
            return [
                "\t".join("" if len(c) > 1 and i == column else v for i, v in enumerate(c)) for c in cells
            ]

        rows = path.read_text().splitlines()
        path.write_text("\n".join([*rows[:20], *without(rows[20:22], 5), *rows[22:], ""]))
        assert misfit(fo.Gait.from_file(path)) < 0.3
        path.write_text("\n".join([*rows[:20], *without(rows[20:22], 3), *rows[22:], ""]))
        with pytest.raises(
            FileError, match=r"row 14 of the data, at 0\.13 s, has no finite angle of the knee"
        ):
            fo.Gait.from_file(path)

    def test_of_two_subjects_the_first_whole_one_is_read(self, tmp_path):
        t, places = record(HUMAN)
        _, other = record(SQUATS, strides=len(t) / 100 / SQUATS.period)
        both = {f"A:{n}": p[: len(t)] for n, p in other.items() if n != "R_KJC"}
        both = {n: np.resize(p, (len(t), 3)) for n, p in both.items()} | {
            f"B:{n}": p for n, p in places.items()
        }
        path = write_trc(tmp_path / "walk.trc", t, both)
        assert misfit(fo.Gait.from_file(path, side="right")) < 0.3

    @pytest.mark.parametrize(("stated", "units"), [("", "mm"), ("furlong", "mm"), ("m", "mm")])
    def test_units_can_be_set(self, tmp_path, stated, units):
        t, places = record(HUMAN)
        path = write_trc(tmp_path / "walk.trc", t, places, units=stated)
        with pytest.raises(FileError, match=r"gait\.units|would be 4\d\d m long"):
            fo.Gait.from_file(path)
        assert misfit(fo.Gait.from_file(path, units=units)) < 0.3

    def test_angles_in_radians_can_be_said_to_be(self, tmp_path):
        path = write_table(tmp_path / "a.csv", HUMAN, 4.4)
        rows = np.loadtxt(path, delimiter=",", skiprows=1)
        rows[:, 1:] = np.radians(rows[:, 1:])
        np.savetxt(path, rows, delimiter=",", header="time,thigh,knee,foot", comments="", fmt="%.9f")
        with pytest.raises(FileError, match=r"the thigh moves by 0\.\d+ deg only: .*gait\.units=rad"):
            fo.Gait.from_file(path)
        assert misfit(fo.Gait.from_file(path, units="rad")) < 0.3


def test_the_row_at_fault_is_named(tmp_path):
    path = write_table(tmp_path / "a.csv", HUMAN, 4.4)
    lines(path, lambda rows: [*rows[:50], "0.1," + rows[50].partition(",")[2], *rows[51:]])
    with pytest.raises(FileError, match=r"the time must increase, and goes from .* after row 49 of the data"):
        fo.Gait.from_file(path)
