"""Files as motion laboratories write them, made from a gait by forward kinematics."""

import numpy as np

import footopt as fo
from footopt.files.gaits import cut
from footopt.files.gaits.leg import leg_angles
from footopt.files.gaits.markers import to_markers

HUMAN = fo.Gait.human()
OPENSIM = ("pelvis_tilt", "hip_flexion_r", "knee_angle_r", "ankle_angle_r")
L1, L2 = 0.43, 0.41
WIDTH, DEPTH = 0.24, 0.14  # of the pelvis between its front markers, and from front to back, m
#: Names of (hip, knee, ankle, heel, toe) for the right leg, and how a left name is made of it.
DIALECTS = {
    "opensim": (("R_HJC", "R_KJC", "R_AJC", "R_Heel", "R_MT2"), lambda n: "L" + n[1:]),
    "plug_in_gait": ((None, "RKNE", "RANK", "RHEE", "RTOE"), lambda n: "L" + n[1:]),
    "helen_hayes": ((None, "R.Knee.Lat", "R.Ankle.Lat", "R.Heel", "R.Toe.Tip"), lambda n: "L" + n[1:]),
    "opencap": (("RHJC_study", "r_knee_study", "r_ankle_study", "r_calc_study", "r_toe_study"),
                lambda n: n.replace("r_", "L_").replace("RHJC", "LHJC")),
    "hbm": (("RGTRO", "RLEK", "RLM", "RHEE", "RMT2"), lambda n: "L" + n[1:]),
    "bts": (("RHip", "RKneLat", "RAnkLat", "RHee", "RToe"), lambda n: "L" + n[1:]),
    "ior": (("RGT", "RLE", "RLM", "RCA", "RSM"), lambda n: "L" + n[1:]),
    "rig": (("mixamorig:RightUpLeg", "mixamorig:RightLeg", "mixamorig:RightFoot"),
            lambda n: n.replace("Right", "Left")),
    "words": (("Subject 1:hip_right", "Subject 1:knee_right", "Subject 1:ankle_right"),
              lambda n: n.replace("right", "left")),
}  # fmt: skip
PELVIS = {
    "plug_in_gait": ("RASI", "LASI", "RPSI", "LPSI"),
    "helen_hayes": ("R.ASIS", "L.ASIS", "V.Sacral", None),
}


def record(
    gait, dialect="opensim", strides=5.3, rate=100.0, speed=1.0, noise=0.0, phase=0.37, seed=1, apart=0.5,
    climb=0.0,
):  # fmt: skip
    """Markers of a walk: t (n,) and places by name, each (n, 3) = forward, left, up, m.

    The legs are `apart` by a part of a stride; the hip goes up by `climb`, m/s.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(round(strides * gait.period * rate)) / rate
    right = phase + t / gait.period
    hip = np.stack([speed * t, 0 * t, 0.82 + climb * t + 0.02 * np.cos(4 * np.pi * right)], axis=1)
    names, left_name = DIALECTS[dialect]
    places = {}
    for side, p in ((-1.0, right), (1.0, right + apart)):
        thigh, knee, foot = (series.at(p)[0] for series in (gait.thigh, gait.knee, gait.foot))
        at = hip + np.array([0.0, side * 0.09, 0.0])
        joints = [at]
        for length, angle in ((L1, thigh), (L2, thigh - knee)):
            at = at + length * np.stack([np.sin(angle), 0 * t, -np.cos(angle)], axis=1)
            joints.append(at)
        along = np.stack([np.cos(foot), 0 * t, np.sin(foot)], axis=1)
        down = np.stack([np.sin(foot), 0 * t, -np.cos(foot)], axis=1)
        joints += [at - 0.05 * along + 0.05 * down, at + 0.13 * along + 0.06 * down]
        for name, place in zip(names, joints, strict=False):
            if name is not None:
                places[name if side < 0 else left_name(name)] = place
    if dialect in PELVIS:
        # Harrington's regression backwards: markers whose hip centre is the joint's
        front = hip + np.array([0.24 * DEPTH + 0.0099, 0, 0.30 * WIDTH + 0.0109])
        aside = np.array([0, WIDTH / 2, 0])
        back = front - [DEPTH, 0, 0]
        corners = (front - aside, front + aside, back - aside / 4, back + aside / 4)
        if dialect == "helen_hayes":
            corners = (*corners[:2], back)
        places = dict(zip(PELVIS[dialect], corners, strict=False)) | places
    return t, {name: p + noise * rng.standard_normal(p.shape) for name, p in places.items()}


def walked(t, places, side=None, names=None, max_gap=0.2):
    """The gait and the notes of a walk's markers, by name or as (name, place), without a file between."""
    names_, arrays = zip(*(places.items() if isinstance(places, dict) else places), strict=True)
    markers = to_markers(np.asarray(t), list(names_), np.stack(arrays, axis=1))
    strides = cut(leg_angles(markers, names or {}, side, max_gap))
    return fo.Gait.from_strides(strides._replace(source="markers")), " | ".join(strides.notes)


def turned(places, heading=0.0, up="z"):
    """Laboratory axes: walking at `heading` (deg) in the floor's plane, with y or z up."""
    c, s = np.cos(np.radians(heading)), np.sin(np.radians(heading))
    found = {name: p @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) for name, p in places.items()}
    return (
        found if up == "z" else {name: np.stack([p[:, 0], p[:, 2], -p[:, 1]], 1) for name, p in found.items()}
    )


def write_trc(path, t, places, unit=1000.0, units="mm", blank=True, empty=""):
    """TRC as OpenSim's documentation has it; NaN is an empty cell (or `empty`)."""
    rate, n = 1 / np.median(np.diff(t)), len(t)
    lines = [
        f"PathFileType\t4\t(X/Y/Z)\t{path.name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{rate:.2f}\t{rate:.2f}\t{n}\t{len(places)}\t{units}\t{rate:.2f}\t1\t{n}",
        "Frame#\tTime\t" + "\t\t\t".join(places) + "\t\t",
        "\t\t" + "\t".join(f"{axis}{i + 1}" for i in range(len(places)) for axis in "XYZ"),
        *([""] if blank else []),
    ]
    for i, now in enumerate(t):
        cells = [empty if np.isnan(v) else f"{unit * v:.5f}" for p in places.values() for v in p[i]]
        lines.append("\t".join([str(i + 1), f"{now:.5f}", *cells]))
    path.write_text("\r\n".join(lines) + "\r\n")
    return path


def write_mot(
    path, gait, names, knee_sign=1.0, degrees=True, said=True, strides=4.3, rate=100.0, tilt=5.0, other=None,
    t=None, phase=None,
):  # fmt: skip
    """Angles as OpenSim's inverse kinematics writes them, for the right leg; `other` is the phase by which
    the left one is ahead of it, in strides.
    """
    t = np.arange(round(strides * gait.period * rate)) / rate if t is None else t
    p = phase(t) if phase else 0.2 + t / gait.period
    thigh, knee, foot = (np.degrees(s.at(p)[0]) for s in (gait.thigh, gait.knee, gait.foot))
    columns = [np.full_like(t, tilt), thigh - tilt, knee_sign * knee, foot - thigh + knee]
    if other is not None:
        left, bent = (np.degrees(s.at(p + other)[0]) for s in (gait.thigh, gait.knee))
        columns += [left - tilt, knee_sign * bent]
        names = (*names, *(name.replace("_r", "_l") for name in names[1:3]))
    rows = np.stack([t, *(c if degrees else np.radians(c) for c in columns)], axis=1)
    head = ["Coordinates", "version=1", f"nRows={len(t)}", f"nColumns={len(columns) + 1}"]
    if said:
        head.append(f"inDegrees={'yes' if degrees else 'no'}")
    table = ["\t".join(f"{v:.8f}" for v in row) for row in rows]
    path.write_text("\n".join([*head, "endheader", "\t".join(["time", *names]), *table]) + "\n")
    return path


def write_nexus(path, t, places, before="", after=""):
    """CSV as Vicon Nexus exports it: sections, names with the subject before a colon, mm."""
    rate = round(1 / np.median(np.diff(t)))
    lines = [
        "Trajectories",
        f"{rate}",
        ",," + ",".join(f"Sandra:{name},," for name in places),
        "Frame,Sub Frame," + ",".join("X,Y,Z" for _ in places),
        ",," + ",".join("mm,mm,mm" for _ in places),
    ]
    for i in range(len(t)):
        cells = ["" if np.isnan(v) else f"{1e3 * v:.6g}" for p in places.values() for v in p[i]]
        lines.append(",".join([str(i + 101), "0", *cells]))
    path.write_text(before + "\r\n".join([*lines, "", after]))
    return path


def write_motive(path, t, places, unit=("Meters", 1.0)):
    """CSV as OptiTrack Motive exports it, with a solved rigid body before the measured markers."""
    body, n = 7 * [""], len(places)
    names = [name for name in places for _ in range(3)]
    lines = [
        f"Format Version,1.23,Take Name,walk,Capture Frame Rate,100.000000,Length Units,{unit[0]},"
        "Coordinate Space,Global",
        "",
        ",".join(["", "", *(7 * ["Rigid Body"]), *(3 * ["Rigid Body Marker"]), *(3 * n * ["Marker"])]),
        ",".join(["", "", *(7 * ["Pelvis"]), *(3 * ["Pelvis:Marker1"]), *(f'"{name}"' for name in names)]),
        ",".join(["", "", *(7 * ["A1"]), *(3 * ["B2"]), *(f"C{i}" for i in range(3 * n))]),
        ",".join(["", "", *(4 * ["Rotation"]), *((3 + 3 + 3 * n) * ["Position"])]),
        ",".join(["Frame", "Time (Seconds)", *"XYZW", *((2 + n) * list("XYZ"))]),
    ]
    for i, now in enumerate(t):
        cells = ["" if np.isnan(v) else f"{unit[1] * v:.6f}" for p in places.values() for v in p[i]]
        lines.append(",".join([str(i), f"{now:.6f}", *body, "9", "9", "9", *cells]))
    path.write_text("\n".join(lines) + "\n")
    return path


def write_c3d(path, t, places):
    """C3D as ezc3d writes it, in mm; NaN is a negative residual."""
    import ezc3d

    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [float(round(1 / (t[1] - t[0])))]
    file["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    file["parameters"]["POINT"]["LABELS"]["value"] = list(places)
    points = np.ones((4, len(places), len(t)))
    points[:3] = 1e3 * np.stack(list(places.values())).transpose(2, 0, 1)
    file["data"]["points"] = points
    file.write(str(path))
    return path


def write_table(path, gait, strides, rate=60.0, columns=("time", "thigh", "knee", "foot"), phase=None):
    """Angles over some strides as CSV; of a single one the last row is the first.

    `phase` of time says how far the stride is; a single one begins at the heel strike.
    """
    t = np.arange(round(strides * gait.period * rate) + (strides == 1.0)) / rate
    p = phase(t) if phase else t / gait.period + (0.3 if strides > 1 else 0.0)
    values = {"time": t} | {j: np.degrees(getattr(gait, j).at(p)[0]) for j in ("thigh", "knee", "foot")}
    rows = zip(*(values.get(column, p) for column in columns), strict=True)
    path.write_text(
        "\n".join([",".join(columns), *(",".join(f"{v:.9f}" for v in row) for row in rows)]) + "\n"
    )
    return path


def misfit(gait, joints=("thigh", "knee"), true=HUMAN):
    """Largest difference of a gait's angles from true ones, deg, at the shift of phase that fits best.

    A heel strike is where the ankle is farthest ahead, a few hundredths of a stride before the sole is
    set down: the shift says which instant is phase 0, and changes no walk.
    """
    phase, shift = np.arange(100) / 100, np.linspace(-0.1, 0.1, 1001)[:, None]
    differences = []
    for joint in joints:
        found, _ = getattr(gait, joint).at(phase)
        expected, _ = getattr(true, joint).at(phase + shift)
        differences.append(np.degrees(abs(found - expected)))
    return np.max(differences, axis=(0, 2)).min()
