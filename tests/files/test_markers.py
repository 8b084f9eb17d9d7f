"""What real recordings hold besides a long clean walk: read to what was walked, or refused for what it is."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from motion_files import DIALECTS, HUMAN, L1, L2, misfit, record, turned, walked
from running import tries

import footopt as fo
from footopt.files.gaits import Strides, cut, recording
from footopt.files.gaits.names import find_leg
from footopt.files.io import Unusable
from footopt.gait import Fourier

#: Squats: knee and thigh bend together, the ankle stays below the hip.
SQUATS = replace(
    HUMAN,
    thigh=Fourier(35.0, (-35.0,), (0.0,)),
    knee=Fourier(60.0, (-58.0,), (0.0,)),
    foot=Fourier(0.0, (0.0,), (0.0,)),
    period=2.4,
)
JOINTS = ("HJC", "KJC", "AJC", "Heel", "MT2")
R_LEG = ("R_HJC", "R_KJC", "R_AJC")


def walk(change=None, heading=0.0, up="z", side=None, max_gap=0.2, **options):
    """The gait and notes of the human walk's markers, which `change` alters."""
    t, places = record(HUMAN, **({"rate": 60.0} | options))
    if change is not None:
        places = change(t, places) or places
    return walked(t, turned(places, heading, up), side, None, max_gap)


def refused(message, *arguments, **options):
    with pytest.raises(Unusable, match=message):
        walk(*arguments, **options)


def hide(name, begin, end):
    def change(t, places):
        places[name][(t >= begin) & (t < end)] = np.nan

    return change


def swap(joints, begin, end):
    def change(t, places):
        now = (t >= begin) & (t < end)
        for joint in joints:
            right, left = places[f"R_{joint}"].copy(), places[f"L_{joint}"].copy()
            places[f"R_{joint}"][now], places[f"L_{joint}"][now] = left[now], right[now]

    return change


class TestALeg:
    @pytest.mark.parametrize("dialect", DIALECTS)
    def test_of_every_laboratory_s_names(self, dialect):
        gait, _ = walked(*record(HUMAN, dialect))
        assert misfit(gait) < 0.3
        assert gait.period == pytest.approx(HUMAN.period, rel=2e-3)
        assert (gait.foot is None) == (dialect in ("rig", "words"))
        assert max(rms for _, rms in gait.residual) < 0.3

    @pytest.mark.parametrize(
        "names",
        [
            {"ASI": "FWT", "PSI": "BWT"},
            {"HEE": "HEEL", "TOE": "MTP"},
            {"HEE": "CPG", "TOE": "D2M"},
            {"HEE": "HEL", "TOE": "2MT"},
            {"KNE": "LEPI", "ANK": "LMAL"},
        ],
    )
    def test_of_other_names(self, names):
        t, places = record(HUMAN, "plug_in_gait", rate=60.0)
        gait, _ = walked(t, {n[0] + names.get(n[1:], n[1:]): place for n, place in places.items()})
        assert misfit(gait) < 0.3
        assert gait.foot is not None

    @given(
        heading=st.floats(-180, 180),
        up=st.sampled_from("yz"),
        rate=st.sampled_from([50.0, 120.0, 240.0]),
        speed=st.sampled_from([0.0, 1.4]),
        noise=st.sampled_from([0.0, 1e-3]),
        begin=st.floats(0, 1),
        side=st.sampled_from(["right", "left"]),
    )
    @settings(max_examples=tries(20))
    def test_comes_back_in_any_axes_at_any_rate_on_ground_and_treadmill(
        self, heading, up, rate, speed, noise, begin, side
    ):
        gait, notes = walk(None, heading, up, side, rate=rate, speed=speed, noise=noise, phase=begin)
        assert misfit(gait) < (1.2 if noise else 0.4)
        assert gait.period == pytest.approx(HUMAN.period, rel=5e-3)
        assert f"the {side} leg" in notes
        assert f"up is +{up}" in notes
        legs = f"(to walk with such legs: walker.l1={L1:.3f} walker.l2={L2:.3f})"
        assert noise or legs in notes

    def test_has_a_level_foot_in_stance(self):
        """What markers do not know is how high they sit: the pitch comes back but for a constant."""
        gait, _ = walk()
        shifted = replace(gait, foot=gait.foot._replace(a0=HUMAN.foot.a0))
        assert misfit(shifted, ("foot",)) < 1.0
        assert abs(gait.foot.a0 - HUMAN.foot.a0) < 6.0

    def test_is_the_left_one_if_the_right_one_is_not_whole(self):
        gait, notes = walk(lambda t, places: {n: p for n, p in places.items() if n != "R_KJC"})
        assert misfit(gait) < 0.3
        assert "the left leg" in notes

    @pytest.mark.parametrize(("up", "said"), [(0.0, None), (0.08, "hip: 0.08 m above where the markers")])
    def test_whose_own_hip_is_at_the_pelvis_s_crest_is_named(self, up, said):
        t, places = record(HUMAN, "plug_in_gait", rate=60.0)
        notes = walked(t, places)[1]
        assert "hip: from the markers of the pelvis" in notes
        _, joints = record(HUMAN, rate=60.0)
        hips = {f"{s}HJC": joints[f"{s}_HJC"] + [0.0, 0.0, up] for s in "RL"}
        notes = walked(t, places | hips)[1]
        assert said in notes if said else "hip:" not in notes

    def test_without_a_marker_is_refused_with_what_was_looked_for_and_what_there_is(self):
        t, places = record(HUMAN, rate=60.0)
        for side in "RL":
            places[f"{side}4711"] = places.pop(f"{side}_KJC")
        with pytest.raises(Unusable, match=r"no marker for the right knee\. .*RKJC, .*has R_HJC.*R4711"):
            walked(t, places)
        assert misfit(walked(t, places, names={"knee": "R4711"})[0]) < 0.3

    def test_whose_markers_are_empty_is_said_to_have_no_data(self):
        t, places = record(HUMAN, rate=60.0)
        places = {name: place if "HJC" in name else np.zeros_like(place) for name, place in places.items()}
        with pytest.raises(
            Unusable, match=r"right knee and ankle\. .* has R_HJC, L_HJC, and without data R_KJC"
        ):
            walked(t, places)

    @pytest.mark.parametrize("dialect", ["plug_in_gait", "helen_hayes", "opensim"])
    @pytest.mark.parametrize("axes", [(-1, 1, 1), (1, -1, 1), (1, 1, -1), None], ids=str)
    def test_is_right_in_mirrored_axes_and_with_sides_exchanged(self, dialect, axes):
        """The hip of a pelvis is on the side of the knees; and which side is which is said."""
        t, places = record(HUMAN, dialect, rate=60.0)
        if axes is None:
            places = {{"L": "R", "R": "L"}.get(n[0], n[0]) + n[1:]: place for n, place in places.items()}
        gait, notes = walked(t, {name: place * (axes or 1) for name, place in places.items()})
        assert misfit(gait) < 0.3
        assert "left and right are exchanged, or the axes mirrored" in notes
        assert "exchanged" not in walked(t, record(HUMAN, dialect, rate=60.0)[1])[1]

    def test_whose_hip_is_never_seen_with_the_other_one_has_no_side(self):
        def change(t, places):
            seen = np.arange(len(t)) % 100 < 5
            places["L_HJC"][~seen] = places["R_HJC"][seen] = np.nan

        gait, notes = walk(change)
        assert misfit(gait) < 0.4
        assert "exchanged" not in notes

    def test_that_is_stiff_goes_the_way_that_its_toes_point(self):
        """On a treadmill, with a marker behind the knee's axis, so that it seems to bend backwards."""
        stiff = replace(HUMAN, knee=Fourier(1.0, (-1.0,), (0.0,)))
        t, places = record(stiff, speed=0.0, rate=60.0)
        for side in "RL":
            places[f"{side}_KJC"][:, 0] -= 0.01
        gait, notes = walked(t, places)
        assert "forward about +x" in notes
        assert gait.foot is not None

    def test_has_the_joint_centres_that_vicon_has_computed(self):
        t, places = record(HUMAN, "plug_in_gait", rate=60.0)
        _, centres = record(HUMAN, rate=60.0)
        names = {"HJC": "FEP", "KJC": "FEO", "AJC": "TIO"}
        both = {
            **{name: place + ([0.02, 0.0, 0.0] if "KNE" in name else 0.0) for name, place in places.items()},
            **{n[0] + names[n[2:]]: place for n, place in centres.items() if n[2:] in names},
        }
        assert misfit(walked(t, both)[0]) < 0.3
        assert misfit(walked(t, {name: p for name, p in both.items() if not name.endswith("FEP")})[0]) > 1.0

    def test_of_two_subjects_is_the_first_whole_one_s(self):
        t, places = record(HUMAN)
        _, other = record(SQUATS, strides=len(t) / 100 / SQUATS.period)
        both = [(f"A:{n}", np.resize(p, (len(t), 3))) for n, p in other.items() if n != "R_KJC"]
        gait, _ = walked(t, [*both, *((f"B:{n}", p) for n, p in places.items())], "right")
        assert misfit(gait) < 0.3

    def test_is_of_opencap_s_finished_set(self):
        t, places = record(HUMAN, "opencap")
        raw = {"RKnee": places["r_knee_study"] + 0.1 * np.sin(t)[:, None], "RHip": places["RHJC_study"] + 0.3}
        assert misfit(walked(t, raw | places)[0]) < 0.3

    @pytest.mark.parametrize("lost", [["LPSI"], ["RPSI", "LPSI"]])
    def test_has_a_hip_from_what_there_is_of_the_pelvis(self, lost):
        """Joint centres that were never seen give way to it."""
        t, places = record(HUMAN, "plug_in_gait")
        places["RHJC"], places["SACR"] = np.full((len(t), 3), np.nan), 0.5 * (places["RPSI"] + places["LPSI"])
        places = {n: p for n, p in places.items() if n not in lost}
        assert misfit(walked(t, places)[0]) < 1.0
        asides = [np.mean(find_leg(places, {}, side)["hip"][:, 1]) for side in ("right", "left")]
        assert asides == pytest.approx([-0.0865, 0.0865], abs=0.005)  # left is +

    @pytest.mark.parametrize("begin", [True, False])
    def test_of_markers_with_one_name_is_of_the_one_with_data(self, begin):
        t, places = record(HUMAN)
        empty, whole = [("R_KJC", np.full((len(t), 3), np.nan))], list(places.items())
        gait, notes = walked(t, empty + whole if begin else whole + empty, "right")
        assert misfit(gait) < 0.3
        assert "of the markers called R_KJC, the first with data is read" in notes

    def test_of_two_that_differ_is_read_only_without_them(self):
        t, places = record(HUMAN)
        other = [("C7", places["R_HJC"] + 0.5), ("C7", places["R_HJC"] + 0.6)]
        assert misfit(walked(t, [*other, *places.items()])[0]) < 0.3
        with pytest.raises(Unusable, match=r"no marker for the right knee\. Two markers are called R_KJC\."):
            walked(t, [*places.items(), ("R_KJC", places["R_KJC"] + 0.05)], "right")


class TestGaps:
    def test_short_ones_are_filled(self):
        def change(t, places):
            for begin in (0.8, 2.1, 3.3):
                hide("R_KJC", begin, begin + 0.12)(t, places)
            places["R_AJC"][:30] = places["R_AJC"][-30:] = np.nan  # which shortens the walk

        gait, notes = walk(change, rate=100.0)
        assert misfit(gait) < 0.5
        assert "knee: 36 frames in gaps of at most 0.2 s filled" in notes

    def test_a_long_one_is_refused_with_its_place(self):
        gap = hide("R_AJC", 1.995, 2.295)
        message = r"the ankle is not seen from 1\.990 to 2\.300 s.*gait\.max_gap = 0\.2"
        refused(message, gap, rate=100.0)
        assert misfit(walk(gap, rate=100.0, max_gap=0.31)[0]) < 4.0

    @pytest.mark.parametrize(
        ("change", "said"),
        [
            (hide("R_MT2", 2.0, 2.5), "the toe is not seen from"),
            (hide("R_MT2", 2.0, 9.0), "it is seen for less than 90 % of the time"),
            (
                lambda t, places: places["R_Heel"].__setitem__(slice(100, 103), 3.0),
                "m from the heel at 1.66667 s",
            ),
            (
                lambda t, places: places["R_Heel"].__setitem__(slice(4, None), np.nan),
                "seen for less",
            ),
        ],
    )
    def test_in_the_foot_cost_only_its_pitch(self, change, said):
        gait, notes = walk(change)
        assert misfit(gait) < 0.3
        assert gait.foot is None
        assert "no pitch of the foot" in notes
        assert said in notes


class TestSides:
    """A repair makes rigid things more rigid and ways shorter, or is not made."""

    @given(
        joints=st.lists(st.sampled_from(JOINTS[1:]), min_size=1, unique=True),
        begin=st.floats(-0.5, 5.5),
        long=st.floats(0.1, 1.0),
        heading=st.floats(0, 360),
    )
    @settings(max_examples=tries(20))
    def test_what_changed_sides_is_put_back_in_any_direction(self, joints, begin, long, heading):
        gait, notes = walk(swap(joints, begin, begin + long), heading)
        assert misfit(gait) < 0.3
        assert gait.foot is not None
        frames = np.sum((np.arange(382) / 60 >= begin) & (np.arange(382) / 60 < begin + long))
        assert notes.count(f"left and right exchanged in {frames} frames") == (len(joints) if frames else 0)

    def test_feet_that_cross_are_left_where_they_are(self):
        def cross(t, places):
            for side, sign in (("R", 1.0), ("L", -1.0)):
                for part in ("Heel", "MT2"):
                    places[f"{side}_{part}"][:, 1] += 0.2 * sign * np.exp(-(((t % 1.5) - 0.7) ** 2) / 0.02)

        gait, notes = walk(cross)
        assert "exchanged" not in notes
        assert gait.foot is not None

    def test_nor_are_legs_that_scissor(self):
        """Exchanged, the ways would be shorter, but not the shanks more rigid."""

        def scissor(t, places):
            ahead = places["R_AJC"][:, 0] > places["L_AJC"][:, 0]
            for name, place in places.items():
                if name[2:] in ("AJC", "Heel", "MT2"):
                    place[ahead & (t > 1.5), 1] += 0.16 if name.startswith("R") else -0.16

        assert "exchanged" not in walk(scissor)[1]

    def test_nor_is_what_is_never_seen_with_its_joint(self):
        def hidden(t, places):
            places["L_KJC"][t < 3.0], places["L_AJC"][t >= 3.0] = np.nan, np.nan

        gait, notes = walk(hidden)
        assert misfit(gait) < 0.3
        assert "exchanged" not in notes

    def test_nor_anything_where_the_hips_are_in_one_place(self):
        def narrow(t, places):
            places["L_HJC"][10] = places["R_HJC"][10]

        assert "exchanged" not in walk(narrow)[1]


class TestNoWalk:
    """What is none is called what it is."""

    @pytest.mark.parametrize("both", [True, False])
    @pytest.mark.parametrize("turn", [60.0, 180.0])
    def test_a_turn(self, both, turn):
        def around(t, places):
            angle = np.radians(turn) * np.clip((t - 2.5) / 1.5, 0, 1)
            c, s = np.cos(angle), np.sin(angle)
            for place in places.values():
                x, y = place[:, 0] - 2.5, place[:, 1] + 1.0
                place[:, 0], place[:, 1] = c * x - s * y, s * x + c * y
            return {n: p for n, p in places.items() if both or n.startswith("R_")}

        refused(r"the subject turns by \d+ deg from \d.* to \d.* s", around, speed=1.2)

    @pytest.mark.parametrize("turn", [-50.0, 100.0])
    def test_a_turn_in_one_stride(self, turn):
        def around(t, places):
            s = t / t[-1]
            heading = np.radians(turn) * s
            way = np.cumsum([np.cos(heading), np.sin(heading)], axis=1) * (1.2 * t[1])
            for place in places.values():
                ahead, left = place[:, 0] - 1.2 * t, place[:, 1].copy()
                place[:, 0] = way[0] + np.cos(heading) * ahead - np.sin(heading) * left
                place[:, 1] = way[1] + np.sin(heading) * ahead + np.cos(heading) * left

        refused(r"the subject turns by \d+ deg from 0 to 1", around, speed=1.2, strides=1.05)

    @pytest.mark.parametrize("begin", [0.0, 0.25, 0.5, 0.75])
    def test_but_a_pelvis_that_turns_to_and_fro_in_each_stride_is_one(self, begin):
        """By 15 deg to either side, as in a run; alone it would pass for a turn of 38 deg."""

        def sway(t, places):
            yaw = np.radians(15.0) * np.sin(2 * np.pi * (t / HUMAN.period + begin))
            for side, sign in (("R", -1.0), ("L", 1.0)):
                for joint in JOINTS:  # the whole leg goes with its hip
                    places[f"{side}_{joint}"][:, 0] -= sign * 0.09 * np.sin(yaw)

        assert walk(sway, speed=1.2, strides=1.05)[0].period == pytest.approx(HUMAN.period, rel=0.05)

    def test_a_walk_that_hesitates_in_each_stride(self):
        def wait(t, places):
            for place in places.values():  # all of it stays behind, and then catches up
                place[:, 0] += 1.15 * HUMAN.period / (2 * np.pi) * np.sin(2 * np.pi * t / HUMAN.period)

        refused("does not go on", wait, speed=1.2)

    @pytest.mark.parametrize("side", ["left", "right"])
    def test_to_the_side(self, side):
        def aside(t, places):
            for joint in JOINTS:  # one hip ahead of the other
                places[f"L_{joint}"] += [0.2, -0.18, 0.0]

        refused("steps to the side, and no walk ahead", aside, side=side)

    def test_backwards(self):
        refused(r"the hip goes \d\.\d\d m backwards", speed=-1.0)

    def test_standing(self):
        def stand(t, places):
            for place in places.values():
                place[:] = place[0]

        refused(r"the thigh moves by 0 deg only: the subject stands", stand)

    def test_squats(self):
        with pytest.raises(Unusable, match=r"squats.*no walk"):
            walked(*record(SQUATS, speed=0.0, apart=0.0, rate=60.0))

    def test_squats_with_both_feet_on_the_floor(self):
        t, places = record(SQUATS, speed=0.0, apart=0.0, rate=60.0, noise=1e-3)
        moved = places["R_AJC"] - places["R_AJC"][0]
        with pytest.raises(Unusable, match=r"the ankle stays where it is: squats .*no walk"):
            walked(t, {name: place - moved for name, place in places.items()})

    def test_jumps_with_both_feet(self):
        refused(r"both legs swing together .*correlate at \+1\.00.*no walk", apart=0.0)

    @pytest.mark.parametrize(
        ("change", "said"),
        [
            (lambda t, p: {n: 10 * v for n, v in p.items()}, r"the thigh would be 4\.3 m long"),
            (lambda t, p: p["R_KJC"].__setitem__(100, 0.5), r"the knee is .* m from the hip at 1\.66667 s"),
            (lambda t, p: {n: p[{"R_HJC": "R_AJC", "R_AJC": "R_HJC"}.get(n, n)] for n in R_LEG}, "exchanged"),
            (lambda t, p: p["R_KJC"].__setitem__(slice(2, None), np.nan), "hardly ever seen together"),
        ],
    )
    def test_no_leg(self, change, said):
        refused(said, change, side="right")

    def test_stairs_are_read_and_named(self):
        gait, notes = walk(climb=0.3)
        assert misfit(gait) < 0.5
        assert "the hip rises by" in notes
        assert "stairs or a slope" in notes
        assert "stairs" not in walk()[1]


def angles(phase, strides=4.4, rate=60.0, gait=HUMAN, apart=None):
    """A recording of thigh and knee, and of the other leg that is ahead by a part of a stride."""
    t = np.arange(round(strides * gait.period * rate)) / rate
    legs = [
        np.degrees([j.at(phase(t) + ahead)[0] for j in (gait.thigh, gait.knee)]) for ahead in (0, apart or 0)
    ]
    own, other = (recording(np.array([t, *rows])) for rows in legs)
    return own if apart is None else own._replace(other=other)


def steady(t):
    return 0.2 + t / HUMAN.period


class TestStrides:
    """One heel strike of each foot a stride, half a stride apart."""

    @pytest.mark.parametrize("strides", [5.2, 7.3])
    @pytest.mark.parametrize("begin", [0.25, 0.75])
    def test_two_are_never_one(self, strides, begin):
        """Every second stride is longer, so that two of them repeat better than one."""

        def limping(t):
            return begin + t / HUMAN.period + 0.08 * np.sin(np.pi * t / HUMAN.period + begin)

        assert cut(angles(limping, strides, apart=0.5)).period == pytest.approx(HUMAN.period, rel=0.15)

    def test_that_the_other_foot_does_not_share_are_left_out(self):
        def stop(t, places):
            late = t > 3.6  # the left leg stands; the right one goes on
            for name, place in places.items():
                if name.startswith("L_"):
                    place[late] = places["L_HJC"][late] + (place - places["L_HJC"])[np.argmax(late)]

        gait, notes = walk(stop)
        assert "without one strike of the other foot left out" in notes
        assert gait.period == pytest.approx(HUMAN.period, rel=0.01)

    def test_of_which_none_is_shared_are_refused(self):
        twice = angles(lambda t: 2 * steady(t) + 0.5)
        with pytest.raises(Unusable, match=r"the other foot strikes at 0\.\d\d, .* of a stride.*no walk"):
            cut(angles(steady)._replace(other=twice))

    def test_that_one_leg_makes_by_chance_are_none(self):
        """It ends as it began; the other one starts from where it stands, and does not."""
        own = angles(steady, 1.0, rate=100.0, apart=0.5)
        share = np.linspace(0.0, 1.0, len(own.t)) ** 2
        late = {j: (1.0 - share) * 12.0 + share * v for j, v in own.other.angles.items()}
        assert cut(own).period == pytest.approx(HUMAN.period, rel=0.02)
        with pytest.raises(Unusable, match="the other leg does not end as it began"):
            cut(own._replace(other=own.other._replace(angles=late)))

    def test_of_another_length_are_left_out(self):
        """As where the subject hesitates: the fourth stride takes half as long again."""
        found = cut(angles(lambda t: 0.3 + np.interp(t, [0, 3.2, 5.0, 9.8], [0, 8 / 3, 11 / 3, 23 / 3]), 7.4))
        assert "of another length left out" in found.notes[-1]
        assert found.period == pytest.approx(1.2, rel=0.02)

    def test_vary_as_is_measured(self):
        apart = np.array([-1.0, 0.0, 1.0])[:, None]
        curves = {"thigh": 20.0 + apart * np.ones(5), "knee": 40.0 + 2.0 * apart * np.ones(5)}
        strides = Strides(np.linspace(0.0, 1.0, 5), curves, 1.2 * np.exp([-0.1, 0.0, 0.1]), ())
        assert strides.variation() == pytest.approx((0.1, np.sqrt((1.0 + 4.0) / 2.0)))

    def test_are_found_where_steps_of_time_vary(self):
        t = np.cumsum(0.012 * np.random.default_rng(3).lognormal(0.0, 0.9, 600).clip(0.05, 3.5))
        rows = np.degrees([j.at(steady(t))[0] for j in (HUMAN.thigh, HUMAN.knee)])
        gait = fo.Gait.from_angles(t, *rows)
        assert misfit(gait) < 0.6
        assert gait.period == pytest.approx(HUMAN.period, rel=0.01)

    def test_standing_before_a_walk_is_left_out_wherever_that_begins(self):
        for phase in np.arange(10) / 10:
            t, places = record(HUMAN, rate=60.0, phase=phase)
            still = {name: np.concatenate([np.repeat(p[:1], 120, axis=0), p]) for name, p in places.items()}
            gait, _ = walked(np.arange(len(t) + 120) / 60, still)
            assert gait.period == pytest.approx(HUMAN.period, rel=0.02)


class TestShortTrials:
    """Phones and small laboratories record 1.3 to 2 s: one stride, which two strikes rarely bound."""

    @given(
        period=st.floats(0.9, 1.3), strides=st.floats(1.12, 1.9), begin=st.floats(0, 1),
        rate=st.sampled_from([60.0, 100.0, 120.0]), seed=st.integers(0, 99),
    )  # fmt: skip
    @settings(max_examples=tries(20))
    def test_any_window_of_more_than_a_stride_gives_it(self, period, strides, begin, rate, seed):
        gait = replace(HUMAN, period=period)
        found, notes = walked(*record(gait, "opensim", strides, rate, 1.0, 1e-3, begin, seed))
        assert found.period == pytest.approx(period, rel=0.05)
        assert misfit(found) < 6.0
        assert "1 stride of" in notes or "its ends differ by" in notes

    @pytest.mark.parametrize("strides", [1.02, 1.04, 1.07, 1.11, 1.15, 1.18])
    def test_of_little_more_than_a_stride_not_all_is_one(self, strides):
        """Its ends may be alike by chance: the part that closes much better is the stride."""
        t = np.arange(round(strides * HUMAN.period * 100)) / 100
        for begin in np.arange(20) / 20:
            rows = np.degrees([j.at(begin + t / HUMAN.period)[0] for j in (HUMAN.thigh, HUMAN.knee)])
            assert cut(recording(np.array([t, *rows]))).period == pytest.approx(HUMAN.period, rel=0.015)

    @pytest.mark.parametrize("rows", [25, 50, 100])
    @pytest.mark.parametrize("last", [True, False])
    def test_a_table_of_one_stride_may_end_before_its_first_row_comes_again(self, rows, last):
        """From 0 to 99 % of a stride, or to 100 %: it takes as long."""
        t = HUMAN.period * np.arange(rows + last) / rows
        rows = np.degrees([j.at(t / HUMAN.period)[0] for j in (HUMAN.thigh, HUMAN.knee)])
        gait = fo.Gait.from_angles(t, *rows)
        assert gait.period == pytest.approx(HUMAN.period)
        assert misfit(gait) < 0.3

    def test_ends_that_differ_by_up_to_15_percent_are_said(self):
        """As those of most children in a published table of 39 strides."""
        t = np.linspace(0.0, 1.2, 60)
        thigh, knee = np.degrees([j.at(t / 1.2)[0] for j in (HUMAN.thigh, HUMAN.knee)])
        drift = t / 1.2 * np.ptp(thigh)
        assert (
            "though they differ by 1" in cut(recording(np.array([t, thigh + 0.12 * drift, knee]))).notes[-1]
        )
        with pytest.raises(Unusable, match=r"its ends differ by 2\d %"):
            cut(recording(np.array([t, thigh + 0.25 * drift, knee])))

    def test_a_coarse_table_that_closes_by_no_more_either_way_says_both_periods(self):
        """As children's, whose strides' ends differ by a tenth, in 20 rows."""
        t = 1.2 * np.arange(20) / 19.5
        thigh, knee = np.degrees([j.at(t / 1.2)[0] for j in (HUMAN.thigh, HUMAN.knee)])
        found = cut(recording(np.array([t, thigh + 0.1 * t / 1.2 * np.ptp(thigh), knee])))
        assert found.period == pytest.approx(t[19])
        assert "it takes 1.169 s, or else 1.231 s" in found.notes[0]

    @pytest.mark.parametrize("side", ["right", "left"])
    def test_both_legs_of_a_coarse_table_take_as_long(self, side, tmp_path):
        """One of them alone, which has a drift, would close better with a row more."""
        t = 1.2 * np.arange(26) / 25
        rows = {}
        for leg, phase in (("r", 0.0), ("l", 0.5)):
            rows[leg] = np.degrees([j.at(phase + t / 1.2)[0] for j in (HUMAN.thigh, HUMAN.knee)])
        rows["l"][0] += 3.0 * t
        names = ["time", "hip_flexion_r", "knee_angle_r", "hip_flexion_l", "knee_angle_l"]
        table = np.stack([t, *rows["r"], *rows["l"]], axis=1)
        text = "\n".join("\t".join(f"{v:.6f}" for v in row) for row in table)
        head = "a\ninDegrees=yes\nendheader\n" + "\t".join(names)
        (tmp_path / "a.mot").write_text(f"{head}\n{text}\n")
        assert fo.Gait.from_file(tmp_path / "a.mot", side=side).period == pytest.approx(1.2)

    @pytest.mark.parametrize("begin", np.arange(8) / 8)
    @pytest.mark.parametrize("strides", [2.0, 2.02, 2.1])
    def test_two_strides_of_which_the_ends_are_cut_are_not_one(self, begin, strides):
        gait, _ = walk(strides=strides, phase=begin, rate=50.0)
        assert gait.period == pytest.approx(HUMAN.period, rel=0.02)

    @pytest.mark.parametrize("begin", [0.0, 0.3, 0.55, 0.8])
    def test_half_a_stride_of_both_legs_is_one_by_symmetry(self, begin):
        gait, notes = walk(strides=0.62, phase=begin)
        assert "half a stride of each leg: 1.2" in notes
        assert " s, some 5 % off if steps differ (gait.period), from" in notes
        assert misfit(gait) < 4.0
        assert gait.period == pytest.approx(HUMAN.period, rel=0.05)

    def test_but_not_where_the_legs_hardly_move_any_more(self):
        t = np.linspace(0.0, 2.0, 101)
        swing, tremble = 30.0 * np.exp(-((t / 0.4) ** 2)), 4.0 * np.cos(8.0 * t)
        legs = [recording(np.array([t, side * (swing + tremble), 20.0 + tremble])) for side in (1.0, -1.0)]
        with pytest.raises(Unusable, match="no stride ends as it began"):
            cut(legs[0]._replace(other=legs[1]))

    def test_both_halves_of_it_meet(self):
        """Though one leg's angles are 2 deg larger, as where its markers sit elsewhere."""
        own = angles(steady, 0.62, apart=0.5)
        higher = {joint: 2.0 + values for joint, values in own.other.angles.items()}
        found = cut(own._replace(other=own.other._replace(angles=higher)))
        assert "half a stride of each leg" in found.notes[-1]
        assert abs(np.diff(found.curves["thigh"][0], 2)).max() < 0.3

    def test_less_is_refused(self):
        refused(
            r"not one whole stride: in 0\.4\d* s no stride ends as it began, and its ends differ by \d+ %",
            strides=0.4,
        )

    @pytest.mark.parametrize("rows", [20, 101])
    @pytest.mark.parametrize("begin", [0.0, 0.4])
    def test_one_whole_stride_is_itself_and_begins_at_the_heel_strike(self, rows, begin):
        phase = np.linspace(0.0, 1.0, rows)
        values = np.degrees([j.at(begin + phase)[0] for j in (HUMAN.thigh, HUMAN.knee)])
        found = cut(recording(np.array([1.2 * phase, *values])))
        assert found.period == pytest.approx(1.2)
        assert found.notes[0].startswith("one stride, from the first row to the last")
        assert (len(found.notes) > 1) == (begin > 0)  # the heel strikes at 60 % of it
        assert misfit(fo.Gait.from_strides(found._replace(source="rows"))) < 0.5

    def test_a_step_after_standing_is_called_so(self):
        with pytest.raises(Unusable, match=r"the leg stands still for \d\d % of .* moves from 2\.4"):
            cut(angles(lambda t: 0.3 + np.maximum(t - 2.4, 0) / 1.5, 3.0))


class TestRows:
    """Of angles over time."""

    @pytest.mark.parametrize(
        ("change", "said"),
        [
            (
                lambda rows: np.delete(rows, slice(100, 130), axis=1),
                r"nothing is recorded from 1\.65 to 2\.16",
            ),
            (lambda rows: np.delete(rows, slice(3, None), axis=1), r"has 3 rows"),
            (lambda rows: rows[:, ::-1], r"the time must increase, and goes from .* after row 1 "),
            (lambda rows: rows + np.eye(4)[:, 2:3] * (np.arange(264) == 100) * 60, r"the knee jumps at 1\.6"),
            (lambda rows: rows * [[1], [1], [-1], [1]], r"the knee goes from -.* beyond -12 to 170 deg"),
            (lambda rows: rows * [[1], [0.017], [0.017], [1]], r"the thigh moves by 0\.\d+ deg only.*=rad"),
            (
                lambda rows: np.add(rows, [[0], [60], [0], [0]]),
                r"the thigh points \d\d deg ahead .*pelvis_tilt",
            ),
            (
                lambda rows: np.where((np.arange(264) == 9) & [[0], [1], [0], [0]], np.nan, rows),
                "row 10 .*thigh",
            ),
        ],
    )
    def test_what_they_cannot_be_is_said_with_the_place(self, change, said):
        rows = four_rows()
        with pytest.raises(Unusable, match=said):
            recording(change(rows))

    @pytest.mark.parametrize("wrong", [300.0, np.nan, 60.0])
    def test_a_foot_that_cannot_be_one_is_left_out(self, wrong):
        rows = four_rows()
        rows[3, 50 if wrong == 60.0 else slice(None)] = wrong
        found = recording(rows)
        assert "foot" not in found.angles
        assert found.notes[0].startswith("no pitch of the foot: ")

    def test_a_last_one_that_is_there_twice_is_left_out(self):
        rows = four_rows()
        found = recording(np.column_stack([rows, rows[:, -1]]))
        assert len(found.t) == 264
        assert found.notes[0].startswith("the last row, again at ")


def four_rows():
    t = np.arange(264) / 60
    return np.array([t, *(np.degrees(j.at(0.3 + t / 1.2)[0]) for j in (HUMAN.thigh, HUMAN.knee, HUMAN.foot))])
