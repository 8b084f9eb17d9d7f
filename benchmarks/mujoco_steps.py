"""Steps per second of a robot in MuJoCo on sand, and on a rigid plane: python benchmarks/mujoco_steps.py

A free torso on two legs with three joints each, held by servos, stands on two soles of 64 plates, and then
marches in place: its feet leave the ground in turn. One core, processor time, the best of some rounds.
"""

from __future__ import annotations

import argparse
import time

import mujoco
import numpy as np

import footopt as fo

ROUNDS, STEPS = 7, 4000
FEET = ("left_foot", "right_foot")

MODEL = """
<mujoco>
  <option timestep="0.001" integrator="implicitfast"/>
  <default><geom contype="0" conaffinity="0"/><joint axis="0 -1 0" armature=".1" damping="2"/></default>
  <worldbody>
    <geom type="plane" size="9 9 1" contype="{plane}" pos="0 0 -.001"/>
    <body name="torso" pos="0 0 .95"><freejoint/><geom type="box" size=".1 .15 .2" mass="41" pos="0 0 .2"/>
      {legs}
    </body>
  </worldbody>
  <actuator>{servos}</actuator>
</mujoco>
"""
LEG = """
<body pos="0 {y} 0"><joint name="{side}_hip"/>
  <geom type="capsule" fromto="0 0 0 0 0 -.45" size=".04" mass="6"/>
  <body pos="0 0 -.47"><joint name="{side}_knee"/>
    <geom type="capsule" fromto="0 0 0 0 0 -.43" size=".03" mass="3"/>
    <body name="{side}_foot" pos="0 0 -.45"><joint name="{side}_ankle"/>
      <geom type="box" size=".13 .05 .01" pos="0 0 -.02" mass="1" conaffinity="1"/>
    </body>
  </body>
</body>
"""


def model_of(plane: bool) -> mujoco.MjModel:
    """The robot, on a rigid plane or over nothing."""
    legs = "".join(LEG.format(side=side, y=y) for side, y in (("left", 0.1), ("right", -0.1)))
    joints = [f"{side}_{joint}" for side in ("left", "right") for joint in ("hip", "knee", "ankle")]
    servos = "".join(f'<position joint="{joint}" kp="3000" kv="60"/>' for joint in joints)
    return mujoco.MjModel.from_xml_string(MODEL.format(plane=int(plane), legs=legs, servos=servos))


def rates(sand: fo.Sand | None, marching: bool, rounds: int, steps: int) -> list[float]:
    """Steps per second of every round; on a rigid plane where there is no sand."""
    model = model_of(sand is None)
    data = mujoco.MjData(model)
    contact = sand and fo.mujoco.attach(model, data, dict.fromkeys(FEET, fo.Foot.flat()), sand, plates=64)
    found = []
    for _ in range(rounds):
        mujoco.mj_resetData(model, data)
        mujoco.mj_step(model, data, nstep=200)
        began = time.process_time()
        for n in range(steps // 50):
            if marching:
                lift = 0.5 * np.maximum(np.sin(2 * np.pi * (n / 20 + np.array([0.0, 0.5]))), 0.0)
                data.ctrl = np.stack([lift, -2 * lift, lift], axis=1).ravel()
            mujoco.mj_step(model, data, nstep=50)
        found.append(steps / (time.process_time() - began))
    if contact:
        contact.detach()
    return found


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="once and short: does it run?")
    size = (1, 100) if parser.parse_args().quick else (ROUNDS, STEPS)
    print("| | rigid plane (steps/s) | sand (steps/s) | sand / plane |")
    print("| --- | --- | --- | --- |")
    for name, marching in (("standing", False), ("marching", True)):
        for zeta in (1.0, 5.0):
            plane, sand = max(rates(None, marching, *size)), max(rates(fo.Sand(zeta), marching, *size))
            print(f"| {name}, zeta {zeta:g} | {plane:,.0f} | {sand:,.0f} | {sand / plane:.2f} |", flush=True)
