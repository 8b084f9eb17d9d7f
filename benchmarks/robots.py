"""What a walk of the biped in MuJoCo costs: python benchmarks/robots.py [WALKS]

Processor time of a walk on hard sand at the model's own time step, against the same robot with the same
commands on a rigid plane of MuJoCo's; and how much faster two threads and two processes are than one.
"""

from __future__ import annotations

import sys
import time
from functools import partial

import mujoco
import numpy as np
from mujoco import rollout

import footopt as fo
from footopt.design.executor import Workers, make_executor
from footopt.mujoco.model import BIPED

ROUNDS = 5


def on_a_plane(robot: fo.mujoco.Robot) -> float:
    """Processor time of a walk on a rigid plane, s."""
    spec = mujoco.MjSpec.from_file(str(BIPED))
    plane = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 1.0])
    plane.contype = plane.conaffinity = 1
    for name in robot.feet:
        for geom in spec.body(name).geoms:
            geom.contype = geom.conaffinity = 1
    model = spec.compile()
    data = mujoco.MjData(model)
    for name in robot.controller.joints:
        data.qpos[model.joint(name).qposadr[0]] = robot.controller.angles(name, np.zeros(1))[0][0]
    data.qpos[1] = 0.95
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    state = np.empty(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, data, state, kind)
    times = model.opt.timestep * np.arange(round(robot.duration / model.opt.timestep))
    told = robot.controller.commands(model, times)
    began = time.process_time()
    rollout.rollout(model, data, state[None], told[None])
    return time.process_time() - began


def main(walks: int) -> None:
    """Print the table."""
    robot = fo.mujoco.Robot()
    accuracy = fo.Accuracy(dt=robot.model.compiled.opt.timestep, plates=32)
    feet = fo.Waypoints().random(walks, seed=1)
    fo.evaluate(feet[:2], robot, accuracy)  # compiles
    rows = []
    with make_executor("processes", 2) as pool:
        processes = Workers(fo.FootProblem(robot, accuracy=accuracy), pool)
        ways = [partial(fo.evaluate, feet, robot, accuracy, threads=threads) for threads in (1, 2)]
        processes(feet)
        for _ in range(ROUNDS):
            began = time.process_time()
            ways[0]()
            sand = (time.process_time() - began) / walks
            plane = float(np.median([on_a_plane(robot) for _ in range(5)]))
            clock = []
            for way in (*ways, partial(processes, feet)):
                began = time.perf_counter()
                way()
                clock.append(time.perf_counter() - began)
            rows.append((1e3 * sand, 1.0 / sand, sand / plane, clock[0] / clock[1], clock[0] / clock[2]))
    middle = np.median(rows, axis=0)
    print("| ms a walk | walks a second and core | times a rigid plane's | two threads | two processes |")
    print("| --- | --- | --- | --- | --- |")
    print(f"| {middle[0]:.1f} | {middle[1]:.0f} | {middle[2]:.1f} | {middle[3]:.2f} | {middle[4]:.2f} |")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 40)
