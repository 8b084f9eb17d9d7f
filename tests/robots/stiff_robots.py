"""Stiff robots, drawn at random: a torso on two legs with servos, 3 to 100 kg, a foot 0.2 to 5 % of it."""

import mujoco
import numpy as np

import footopt as fo

MODEL = """
<mujoco>
  <option timestep="{dt}" integrator="{integrator}"/>
  <default><geom contype="0" conaffinity="0"/>
    <joint axis="0 -1 0" armature="{armature}" damping="{damping}"/></default>
  <worldbody>
    <body name="torso" pos="0 0 .53"><freejoint/>
      <geom type="box" size=".1 .15 .2" mass="{torso}" pos="0 0 .2"/>
      {legs}
    </body>
  </worldbody>
  <actuator>{servos}</actuator>
</mujoco>
"""
LEG = """
<body pos="0 {y} 0"><joint name="{side}_hip"/>
  <geom type="capsule" fromto="0 0 0 0 0 -.25" size=".04" mass="{leg}"/>
  <body pos="0 0 -.25"><joint name="{side}_knee"/>
    <geom type="capsule" fromto="0 0 0 0 0 -.23" size=".03" mass="{leg}"/>
    <body name="{side}_foot" pos="0 0 -.25"><joint name="{side}_ankle"/>
      <geom type="box" size=".13 .05 .01" pos="0 0 -.02" mass="{foot}"/>
    </body>
  </body>
</body>
"""


def draw(rng, integrators=("RK4", "implicit", "implicitfast")):
    """A model on sand whose servos are stable in the air: model and contact arguments."""
    while True:
        mass = np.exp(rng.uniform(*np.log([3, 100])))
        foot = mass * np.exp(rng.uniform(*np.log([0.002, 0.05])))
        kp = mass * 9.81 * 0.5 * np.exp(rng.uniform(*np.log([5, 300])))
        kv, in_joint = kp * np.exp(rng.uniform(*np.log([0.004, 0.05]))), rng.integers(2)
        legs = "".join(
            LEG.format(side=s, y=y, leg=0.08 * mass, foot=foot) for s, y in (("a", 0.1), ("b", -0.1))
        )
        joints = [f"{side}_{joint}" for side in "ab" for joint in ("hip", "knee", "ankle")]
        servo = '<position joint="{}" kp="{}" kv="{}"/>'
        servos = "".join(servo.format(joint, kp, 0 if in_joint else kv) for joint in joints)
        model = mujoco.MjModel.from_xml_string(MODEL.format(
            dt=rng.choice([5e-4, 1e-3, 2e-3, 4e-3]), integrator=rng.choice(integrators), legs=legs,
            armature=rng.choice([0, 0.01, 0.1]), damping=kv * in_joint, torso=0.68 * mass - 2 * foot,
            servos=servos))  # fmt: skip
        sole = fo.Foot.from_waypoints(fo.Waypoints().random(1, seed=int(rng.integers(1e6)))[0])
        sand = fo.Sand(float(np.exp(rng.uniform(*np.log([0.2, 50])))))
        if stable_in_the_air(model):
            return model, fo.Foot.flat() if rng.integers(2) else sole, sand


def stable_in_the_air(model):
    """Whether the servos' swing dies within a second without gravity."""
    data, gravity = mujoco.MjData(model), model.opt.gravity.copy()
    model.opt.gravity[:] = 0.0
    data.qvel[6:] = 0.1
    mujoco.mj_step(model, data, nstep=round(1.0 / model.opt.timestep))
    model.opt.gravity[:] = gravity
    return abs(data.qvel[6:]).max() < 0.05 and not sum(w.number for w in data.warning)
