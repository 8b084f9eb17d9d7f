"""footopt's planar walker as a MuJoCo model: a mass on two massless legs whose joints are prescribed."""

import mujoco
import numpy as np

from footopt.mujoco import attach

MODEL = """
<mujoco>
  <compiler angle="radian" boundmass="1e-9" boundinertia="1e-9"/>
  <option timestep="{dt}" integrator="{integrator}" gravity="0 0 -{g}"><flag contact="disable"/></option>
  <worldbody>
    <body name="hip">
      <joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/>
      <geom type="sphere" size=".05" mass="{mass}"/>
      {legs}
    </body>
  </worldbody>
</mujoco>
"""
LEG = """
<body name="{side}_thigh">
  <joint name="{side}_thigh" axis="0 -1 0" armature="1e9"/>
  <geom type="sphere" size=".01" mass="1e-9"/>
  <body name="{side}_shank" pos="0 0 -{l1}">
    <joint name="{side}_knee" axis="0 -1 0" armature="1e9"/>
    <geom type="sphere" size=".01" mass="1e-9"/>
    <body name="{side}_foot" pos="0 0 -{l2}"><geom type="sphere" size=".01" mass="1e-9"/></body>
  </body>
</body>
"""


def model_of(walker, dt, integrator="RK4"):
    """The model of a `Walker`; its feet turn with the shanks."""
    legs = "".join(LEG.format(side=side, l1=walker.l1, l2=walker.l2) for side in ("left", "right"))
    return mujoco.MjModel.from_xml_string(
        MODEL.format(dt=dt, integrator=integrator, g=walker.g, mass=walker.mass, legs=legs)
    )


def walk(foot, scene, walked, dt=2e-4, plates=256):
    """The five objectives of a walk in MuJoCo, which begins as `walked`, a `Walk` of the same scene."""
    model = model_of(scene.walker, dt)
    data = mujoco.MjData(model)
    steps = round(scene.duration / dt)
    t = dt * np.arange(steps + 1)
    (thigh, thigh_rate), (shank, shank_rate), _ = scene.gait.angles(t)
    angles = np.stack([thigh, shank - thigh], axis=-1).reshape(len(t), 4)
    rates = np.stack([thigh_rate, shank_rate - thigh_rate], axis=-1).reshape(len(t), 4)
    data.qpos[:2] = walked.com[0]
    contact = attach(
        model, data, {"left_foot": foot, "right_foot": foot}, scene.sand, effects=scene.effects, plates=plates
    )
    path, power = np.empty((steps, 4)), np.empty((steps, 2))
    try:
        for n in range(steps):
            data.qpos[2:], data.qvel[2:] = angles[n], rates[n]
            mujoco.mj_step(model, data)
            path[n] = *data.qpos[:2], *data.qvel[:2]
            power[n] = tuple(contact.power.values())
        work, counts = sum(contact.work.values()), contact.counts
    finally:
        contact.detach()
    late = t[1:] > scene.gait.heel_strike
    speed = path[late, 2]
    return {
        "distance": path[-1, 0],
        "mean_height": float(np.mean(path[:, 1])),
        "work": abs(work),
        "peak_power": np.abs(power[late]).max(),
        "speed_loss": float((np.maximum.accumulate(speed) - speed).max()),
    }, counts
