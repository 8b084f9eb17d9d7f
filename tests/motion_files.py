"""Files of a leg's angles as laboratories write them, made from a gait."""

import numpy as np

import footopt as fo

HUMAN = fo.Gait.human()
OPENSIM = ("pelvis_tilt", "hip_flexion_r", "knee_angle_r", "ankle_angle_r")


def degrees(gait, phase):
    """Thigh, knee and, if it has one, foot at phases, deg."""
    series = {"thigh": gait.thigh, "knee": gait.knee, "foot": gait.foot}
    return {joint: np.degrees(s.at(phase)[0]) for joint, s in series.items() if s is not None}


def write_mot(path, gait, names=OPENSIM, knee_sign=1.0, unit="deg", said=True, strides=4.3, tilt=5.0):
    """Angles as OpenSim's inverse kinematics writes them, for the right leg."""
    t = np.arange(round(100 * strides * gait.period)) / 100
    thigh, knee, foot = degrees(gait, 0.2 + t / gait.period).values()
    columns = [np.full_like(t, tilt), thigh - tilt, knee_sign * knee, foot - thigh + knee]
    rows = np.stack([t, *(c if unit == "deg" else np.radians(c) for c in columns)], axis=1)
    head = ["Coordinates", "version=1", f"nRows={len(t)}", f"nColumns={len(columns) + 1}"]
    if said:
        head.append(f"inDegrees={'yes' if unit == 'deg' else 'no'}")
    table = ["\t".join(f"{v:.8f}" for v in row) for row in rows]
    path.write_text("\n".join([*head, "endheader", "\t".join(["time", *names]), *table]) + "\n")
    return path


def write_table(path, gait, strides, rate=60.0, columns=("time", "thigh", "knee", "foot")):
    """Angles over some strides as CSV; of a single one, from heel strike to heel strike, the last row is the
    first.
    """
    t = np.arange(round(strides * gait.period * rate) + (strides == 1.0)) / rate
    phase = t / gait.period + (0.3 if strides > 1 else 0.0)
    values = {"time": t} | degrees(gait, phase)
    rows = zip(*(values.get(column, phase) for column in columns), strict=True)
    path.write_text(
        "\n".join([",".join(columns), *(",".join(f"{v:.9f}" for v in row) for row in rows)]) + "\n"
    )
    return path


def misfit(gait, true=HUMAN, joints=("thigh", "knee")):
    """Largest difference of a gait's angles from true ones, deg, at the shift of phase that fits best: which
    instant of the heel strike is phase 0 is a convention.
    """
    phase, shift = np.arange(100) / 100, np.linspace(-0.1, 0.1, 401)[:, None]
    found, expected = (degrees(gait, phase), degrees(true, phase + shift))
    return np.max([abs(found[j] - expected[j]).max(axis=1) for j in joints], axis=0).min()
