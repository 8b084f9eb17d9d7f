"""Where the walker's foot is wrong for a robot: python benchmarks/other_robots.py [SAND] [WALKS]

The biped with servos of 500 to 20,000 N m/rad, with legs of 5 to 40 % of its mass, and with a free torso that
a controller balances in place of the boom. The default search on the walker (10,000 walks) and one on the
robot (WALKS): how many times better in J_W the robot's foot is on the robot than the walker's; and, of 60
random soles, Kendall's tau between J_W of both, and between the robot and itself at half the time step.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import mujoco
import numpy as np
from scipy.stats import kendalltau

import footopt as fo
from footopt.design import confirm
from footopt.mujoco.model import BIPED

COARSE = fo.Accuracy(dt=2e-3, plates=32)  # of the robot's search, and of random soles
HALVED = fo.Accuracy(dt=1e-3, plates=32)
FINE = fo.Accuracy(dt=5e-4, plates=64)  # of its finalists, and of the feet that are compared
SERVO = 4000.0  # of the biped that comes with footopt, N m/rad
#: Of the balance controller, found by random search: by inclination, its rate and speed (rad, rad/s, m/s) the
#: angle (rad) that is added to the hip that stands, to the one that swings, and to the ankle that stands.
GAINS = ((-0.513, 0.077, 0.0), (-2.41, -0.039, 0.218), (2.60, 0.200, -0.436))
#: Inclination that it aims at, backward, rad; speed of the gait, m/s; and the difference in height of the
#: feet over which the weight goes from one to the other, m.
LEAN, SPEED, SHIFT = -0.14, 0.87, 0.04


def with_servos(stiffness: float) -> fo.mujoco.Robot:
    """The biped with servos of a stiffness, N m/rad, and the same damping ratio."""
    spec, ratio = mujoco.MjSpec.from_file(str(BIPED)), stiffness / SERVO
    for servo in spec.actuators:
        gain, bias = np.array(servo.gainprm), np.array(servo.biasprm)
        gain[0] *= ratio
        bias[1:3] *= ratio, np.sqrt(ratio)
        servo.gainprm, servo.biasprm = gain, bias
    return fo.mujoco.Robot(spec)


def with_legs(share: float) -> fo.mujoco.Robot:
    """The biped with a share of its mass in its legs."""
    spec = mujoco.MjSpec.from_file(str(BIPED))
    geoms = {body.name: body.geoms[0] for body in spec.bodies if body.name != "world"}
    torso = geoms.pop("torso")
    legs = sum(geom.mass for geom in geoms.values())
    whole = torso.mass + legs
    torso.mass = (1.0 - share) * whole
    for geom in geoms.values():
        geom.mass *= share * whole / legs
    return fo.mujoco.Robot(spec)


def without_boom() -> fo.mujoco.Robot:
    """The biped with a free torso: joints are told the gait's angles and what balances it (`GAINS`)."""
    spec, tracker = mujoco.MjSpec.from_file(str(BIPED)), fo.mujoco.Tracker()
    (boom,) = (joint for joint in spec.joints if joint.name == "boom")
    boom.stiffness, boom.damping = np.zeros(3), np.zeros(3)
    names = [joint.name for joint in spec.joints]
    first = [float(tracker.angles(n, np.zeros(1))[0][0]) if n in tracker.joints else 0.0 for n in names]
    spec.add_key(name="start", qpos=first)
    model, times = spec.compile(), FINE.dt * np.arange(1 + round(tracker.duration / FINE.dt))
    told = tracker.commands(model, times)
    feet = [model.body(f"{side}_foot").id for side in ("left", "right")]
    hips, ankles = ([model.actuator(f"{s}_{j}").id for s in ("left", "right")] for j in ("hip", "ankle"))

    def balance(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        left, right = data.xpos[feet, 2]
        stands = min(max(0.5 + (right - left) / SHIFT, 0.0), 1.0)
        walks = SPEED if data.time > tracker.gait.start else 0.0
        state = data.qpos[2] - LEAN, data.qvel[2], data.qvel[0] - walks
        stance, swing, ankle = (float(np.dot(gains, state)) for gains in GAINS)
        data.ctrl[:] = told[min(round(data.time / FINE.dt), len(told) - 1)]
        for hip, joint, share in zip(hips, ankles, (stands, 1.0 - stands), strict=True):
            data.ctrl[hip] += share * stance + (1.0 - share) * swing
            data.ctrl[joint] += share * ankle

    end, after = tracker.duration, tracker.gait.heel_strike
    return fo.mujoco.Robot(spec, controller=balance, key="start", duration=end, after=after)


ROBOTS: dict[str, Callable[[], fo.mujoco.Robot]] = {
    **{f"servos of {k:,} N m/rad": partial(with_servos, k) for k in (500, 1_500, 4_000, 12_000, 20_000)},
    **{f"legs of {100 * share:.0f} % of the mass": partial(with_legs, share) for share in (0.05, 0.2, 0.4)},
    "a free torso": without_boom,
}


def main(name: str, walks: int) -> None:
    """Print a table: a row for each robot."""
    print(
        "| robot | its own foot over the walker's | k of its own | tau | tau with itself | soles that fail |"
    )
    print("| --- | --- | --- | --- | --- | --- |", flush=True)
    soles, scene = fo.Waypoints().random(60, seed=2), fo.Scene(sand=fo.Sand.named(name))
    of_walker = best(fo.search(fo.FootProblem(scene), walks=10_000, seed=1), "fine")
    planar = fo.evaluate(soles, scene, "standard", "efficiency").values[:, 0]
    for title, make in ROBOTS.items():
        robot = replace(make(), sand=scene.sand)
        try:
            own = best(fo.search(fo.FootProblem(robot, accuracy=COARSE), walks=walks, seed=1), FINE)
        except fo.FootoptError as error:
            print(f"| {title} | {error} |", flush=True)
            continue
        there, here = fo.evaluate([own, of_walker], robot, FINE, "efficiency").values[:, 0]
        ranked = [fo.evaluate(soles, robot, a, "efficiency").values[:, 0] for a in (COARSE, HALVED)]
        tau, itself = (
            kendalltau(ranked[0], other, nan_policy="omit").statistic for other in (planar, ranked[1])
        )
        heights, fail = ",".join(map(str, own.k or ())), np.isnan(ranked[0]).sum()
        numbers = f"{there / here:.2f} | {heights} | {tau:.2f} | {itself:.2f} | {fail}"
        print(f"| {title} | {numbers} |", flush=True)


def best(found: fo.SearchResult, accuracy: fo.Accuracy | str) -> fo.Foot:
    """The best of a search's finalists, evaluated again more finely."""
    return fo.Foot.from_waypoints(found.k[confirm(found, accuracy).designs[0]], found.problem.space)


if __name__ == "__main__":
    sand, walks = [*sys.argv[1:], *("hard", "300")[len(sys.argv) - 1 :]]
    main(sand, int(walks))
