"""A small biped in MuJoCo walks ten seconds on sand: python biped.py [--sand hard] [--film walk.gif]

Torso, thighs, shanks and feet have masses, joints are servos that track footopt's gait, and a boom keeps the
torso upright, as the booms of planar biped robots do. Nothing else is prescribed: the torso's place, the
joints' errors and the ankles' give follow from the forces.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import mujoco
import numpy as np
from PIL import Image, ImageDraw

import footopt as fo
from footopt.files.feet import body_outline

#: kg; of a person of 60 kg (Winter, Biomechanics and Motor Control of Human Movement, 2009, table 4.1).
MASS = {"torso": 40.7, "thigh": 6.0, "shank": 2.8, "foot": 0.87}
STIFF, DAMPED = 4000.0, 120.0  # of the servos, N m/rad and N m s/rad
FEET = ("left_foot", "right_foot")
SHOWN = ("distance", "mean_height", "work", "peak_power", "speed_loss")

MODEL = """
<mujoco model="biped">
  <option timestep="{dt}" integrator="implicitfast"><flag contact="disable"/></option>
  <visual><global offwidth="960" offheight="540"/><headlight ambient=".5 .5 .5"/></visual>
  <asset>
    <texture name="g" type="2d" builtin="checker" rgb1=".86 .77 .58" rgb2=".8 .7 .5" width="99" height="99"/>
    <texture name="sky" type="skybox" builtin="flat" rgb1="1 1 1" rgb2="1 1 1" width="8" height="8"/>
    <material name="sand" texture="g" texrepeat="60 1" rgba="1 1 1 .6"/>{mesh}
  </asset>
  <worldbody>
    <light pos="2 -3 4" dir="-.3 .5 -1" directional="true" castshadow="false"/>
    <geom type="box" size="12 1.2 .25" pos="5 0 -.25" material="sand" contype="0" conaffinity="0"/>
    <body name="torso">
      <joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/>
      <joint name="boom" axis="0 -1 0" stiffness="20000" damping="1000"/>
      <geom type="capsule" fromto="0 0 .08 0 0 .5" size=".09" mass="{torso}" rgba=".35 .4 .5 1"/>
      {legs}
    </body>
  </worldbody>
  <actuator>{servos}</actuator>
</mujoco>
"""
LEG = """
<body name="{side}_thigh" pos="0 {y} 0">
  <joint name="{side}_hip" axis="0 -1 0" armature=".1"/>
  <geom type="capsule" fromto="0 0 0 0 0 -{l1}" size=".05" mass="{thigh}" rgba="{color}"/>
  <body name="{side}_shank" pos="0 0 -{l1}">
    <joint name="{side}_knee" axis="0 -1 0" armature=".1"/>
    <geom type="capsule" fromto="0 0 0 0 0 -{l2}" size=".035" mass="{shank}" rgba="{color}"/>
    <body name="{side}_foot" pos="0 0 -{l2}">
      <joint name="{side}_ankle" axis="0 -1 0" armature=".05"/>
      <geom type="mesh" mesh="foot" mass="{foot}" rgba="{color}"/>
    </body>
  </body>
</body>
"""
SERVO = '<general joint="{joint}" biastype="affine" gainprm="{kp}" biasprm="0 -{kp} -{kv}"/>'


def model_of(foot: fo.Foot, walker: fo.Walker, dt: float) -> mujoco.MjModel:
    """The biped with this foot."""
    vertices = "  ".join(" ".join(f"{v:.6f}" for v in vertex) for vertex in prism(foot))
    legs = "".join(
        LEG.format(side=side, y=y, l1=walker.l1, l2=walker.l2, color=color, **MASS)
        for side, y, color in (("left", 0.1, ".2 .45 .7 1"), ("right", -0.1, ".8 .45 .2 1"))
    )
    joints = (f"{side}_{joint}" for side in ("left", "right") for joint in ("hip", "knee", "ankle"))
    # a servo answers the error of the angle and of its rate: the control is both, in rad
    servos = "".join(SERVO.format(joint=joint, kp=STIFF, kv=DAMPED) for joint in joints)
    mesh = f'<mesh name="foot" vertex="{vertices}"/>'
    return mujoco.MjModel.from_xml_string(
        MODEL.format(dt=dt, mesh=mesh, legs=legs, servos=servos, torso=MASS["torso"])
    )


def prism(foot: fo.Foot) -> np.ndarray:
    """Corners of the foot's body for pictures, (p, 3), m, from the ankle: MuJoCo takes their hull."""
    outline = body_outline(replace(foot, top=0.03)) - foot.ankle
    half = foot.width / 2
    return np.concatenate([np.insert(outline, 1, y, axis=1) for y in (-half, half)])


def walk(
    foot: fo.Foot, sand: fo.Sand, seconds: float = 10.0, dt: float = 1e-3, watch=None
) -> dict[str, float]:
    """Walk, and say how, in m, J, W, m/s and deg; work and power are of the sand."""
    walker, gait = fo.Walker(), fo.Gait.human()
    model = model_of(foot, walker, dt)
    data = mujoco.MjData(model)
    t = dt * np.arange(round(seconds / dt))
    (thigh, thigh_rate), (shank, shank_rate), (pitch, pitch_rate) = gait.angles(t)
    angles = np.stack([thigh, shank - thigh, pitch - shank], axis=-1).reshape(len(t), 6)
    rates = np.stack([thigh_rate, shank_rate - thigh_rate, pitch_rate - shank_rate], axis=-1).reshape(
        len(t), 6
    )
    data.qpos[1] = fo.simulate(foot, fo.Scene(sand=sand, gait=gait), "draft").com[0, 1]
    data.qpos[3:] = angles[0]
    contact = fo.mujoco.attach(model, data, dict.fromkeys(FEET, foot), sand)
    path, power, depth = (np.empty((len(t), 2)) for _ in range(3))
    joint = 0.0
    for n in range(len(t)):
        data.ctrl = angles[n] + DAMPED / STIFF * rates[n]
        mujoco.mj_step(model, data)
        joint += dt * np.maximum(data.actuator_force * data.qvel[3:], 0.0).sum()
        path[n] = data.qpos[1], data.qvel[0]
        power[n], depth[n] = tuple(contact.power.values()), tuple(contact.depth.values())
        if watch is not None:
            watch(model, data)
    work, failures = sum(contact.work.values()), contact.counts["failures"]
    contact.detach()
    late = t > gait.heel_strike
    speed = path[late, 1]
    return {
        "distance": float(data.qpos[0]),
        "mean_height": float(path[:, 0].mean()),
        "work": abs(work),
        "peak_power": float(np.abs(power[late]).max()),
        "speed_loss": float((np.maximum.accumulate(speed) - speed).max()),
        "sinkage": float(depth.max()),
        "joint_work": float(joint),
        "tracking": float(np.degrees(np.abs(data.qpos[3:] - angles[-1]).max())),
        "failures": failures,
    }


def five() -> list[fo.Foot]:
    """The flat foot, the best soles on hard and on regular sand, a circle and an ellipse."""
    hard, regular = [2, 6, 6, 2, 1, 1, 1, 1, 3, 4, 1], [1, 2, 3, 4, 5, 7, 9, 10, 10, 9, 7]
    feet = [fo.Foot.flat()]
    for name, k in (("best, hard", hard), ("best, regular", regular)):
        feet.append(replace(fo.Foot.from_waypoints(k), name=name))
    return [*feet, fo.Foot.shape("circle"), fo.Foot.shape("ellipse")]


def film(path: str, feet: list[fo.Foot], sand: fo.Sand, seconds: float = 10.0, every: int = 100) -> None:
    """The walks with some feet, one above the other, as a GIF of real time."""
    rows: list[list[np.ndarray]] = []
    for foot in feet:
        frames: list[np.ndarray] = []
        camera = mujoco.MjvCamera()
        camera.azimuth, camera.elevation, camera.distance = 90.0, -3.0, 1.95
        renderer: list[mujoco.Renderer] = []

        def watch(model, data, name=foot.name, frames=frames, camera=camera, renderer=renderer):
            if not renderer:
                renderer.append(mujoco.Renderer(model, 240, 360))
            if round(data.time / model.opt.timestep) % every == 0:
                camera.lookat[:] = data.qpos[0] + 0.1, 0.0, 0.7
                renderer[0].update_scene(data, camera)
                picture = Image.fromarray(renderer[0].render())
                ImageDraw.Draw(picture).text((8, 6), f"{name} foot, {data.time:.1f} s", "black", font_size=14)
                frames.append(np.array(picture))

        walk(foot, sand, seconds, watch=watch)
        renderer[0].close()
        rows.append(frames)
    pictures = [Image.fromarray(np.concatenate(both)) for both in zip(*rows, strict=True)]
    palette = pictures[0].quantize(24)
    flat = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    flat[0].save(path, save_all=True, append_images=flat[1:], duration=every, loop=0, optimize=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sand", default="hard", help="soft, regular, hard, ...")
    parser.add_argument("--seconds", type=float, default=10.0, help="how long each walk is")
    parser.add_argument("--five", action="store_true", help="five feet in place of two")
    parser.add_argument("--film", help="a .gif of the walks; without a display, set MUJOCO_GL=egl")
    options = parser.parse_args()
    if options.seconds <= fo.Gait.human().heel_strike:
        parser.error(f"--seconds is {options.seconds:g}; give more than {fo.Gait.human().heel_strike:g}")
    sand = fo.Sand.named(options.sand)
    for foot in five() if options.five else five()[:2]:
        print(foot.name, {k: round(v, 4) for k, v in walk(foot, sand, options.seconds).items()}, flush=True)
        if options.five:  # the walker whose mass is all at the hip
            hip = fo.simulate(foot, fo.Scene(sand=sand, t_f=options.seconds)).objectives
            print("    by fo.simulate", {k: round(v, 4) for k, v in hip.items() if k in SHOWN})
    if options.film:
        film(options.film, five()[:2], sand, options.seconds)
