"""Bipeds drawn at random walk within their tolerance: python benchmarks/random_robots.py FIRST LAST

By the number of each: the biped scaled by 0.25 to 1.4, half to twice as dense, with legs of 0.4 to 2 times
the share, servos 0.4 to 3.3 times as stiff, on the Earth or the Moon, with a gait 0.8 to 1.5 times as slow,
another integrator, sand and effect. Four random soles each, against an eighth of the step and more plates.
"""

from __future__ import annotations

import sys
from dataclasses import replace

import mujoco
import numpy as np

import footopt as fo
from footopt.errors import SettingError
from footopt.mujoco.model import BIPED
from footopt.walk.ladder import numerics

TOLERANCE = fo.Tolerance(0.05)
EFFECTS = ((), (fo.LeadingEdge(),), (fo.Inertia(),), (fo.Shadowing(),))


def draw(number: int) -> tuple[fo.mujoco.Robot, fo.Waypoints, np.ndarray]:
    """A robot, a space of soles of its size, and heights of four."""
    rng = np.random.default_rng([37, number])
    s, dense = np.exp(rng.uniform(np.log(0.25), np.log(1.4))), np.exp(rng.uniform(-0.7, 0.7))
    stiff, heavy = np.exp(rng.uniform(-1.0, 1.2)), np.exp(rng.uniform(-1.0, 0.7))
    spec, mass = mujoco.MjSpec.from_file(str(BIPED)), s**3 * dense
    spec.option.timestep = float(rng.choice([1e-3, 2e-3]) * np.sqrt(s))
    kind = rng.choice(["implicitfast", "euler", "implicit"])
    spec.option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{kind.upper()}")
    g = 9.81 if rng.random() < 0.7 else 1.62
    spec.option.gravity = [0.0, 0.0, -g]
    moment, slow = mass * s * g / 9.81, np.sqrt(s * 9.81 / g)
    for body in spec.bodies:
        body.pos = np.array(body.pos) * s
        for geom in body.geoms:
            geom.mass *= mass * (1.0 if body.name == "torso" else heavy)
            geom.size, geom.pos = np.array(geom.size) * s, np.array(geom.pos) * s
            if np.isfinite(geom.fromto).all():
                geom.fromto = np.array(geom.fromto) * s
        for joint in body.joints:
            joint.armature *= mass * s * s
            if joint.name == "boom":
                joint.stiffness = np.asarray(joint.stiffness) * moment
                joint.damping = np.asarray(joint.damping) * moment * slow
    for servo in spec.actuators:
        gain, bias = np.array(servo.gainprm), np.array(servo.biasprm)
        gain[0] *= stiff * moment
        bias[1:3] *= stiff * moment * np.array([1.0, slow])
        servo.gainprm, servo.biasprm = gain, bias
    period = 1.2 * slow * rng.uniform(0.8, 1.5)
    tracker = fo.mujoco.Tracker(replace(fo.Gait.human(), period=period, start=0.5 * period))
    sand = fo.Sand(10 ** rng.uniform(-0.7, 1.7) * dense * s)
    robot = fo.mujoco.Robot(spec, controller=tracker, sand=sand, effects=EFFECTS[rng.integers(4)])
    n = int(rng.choice([5, 11]))
    return robot, fo.Waypoints(n, 10, 0.13 * s, 0.03 * s, 0.1 * s), rng.integers(1, 11, (4, n))


def main(first: int, last: int) -> None:
    """Print a line for each, and what they come to."""
    errors, refused, other = [], 0, 0
    for number in range(first, last):
        robot, space, k = draw(number)
        try:
            robot.check_comparable()
        except SettingError as error:
            refused += 1
            print(f"{number}: {error}", flush=True)
            continue
        numbers = numerics(TOLERANCE, robot, space)
        table = fo.evaluate(k, robot, numbers, space=space)
        alone = fo.evaluate(k[::-1], robot, numbers, space=space, threads=1)
        assert np.array_equal(table.values, alone.values[::-1], equal_nan=True)
        finest = fo.Accuracy(dt=numbers.dt / 8, plates=max(192, 2 * numbers.plates))
        truth = fo.evaluate(k, robot, finest, space=space)
        walked, other = table.feasible & truth.feasible, other + np.sum(table.reasons != truth.reasons)
        error = np.abs(table.values - truth.values) / np.maximum(np.abs(truth.values), 1e-3)
        errors += error[walked].max(axis=1).tolist()
        print(f"{number}: {robot.title}, {1e3 * numbers.dt:.3g} ms, {numbers.plates} plates: "
              f"{[*table.reasons]}, errors {error.max(axis=1).round(3).tolist()}", flush=True)  # fmt: skip
    within, worst = np.mean(np.array(errors) <= TOLERANCE.error), max(errors)
    print(f"{last - first} robots, {refused} refused; {len(errors)} feet walk, {100 * within:.1f} % of them")
    print(f"within {100 * TOLERANCE.error:g} %, at worst {100 * worst:.2g} %; {other} end otherwise")


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
