"""A block of 60 kg on one foot in MuJoCo: what tests of the sand under robots share."""

import mujoco

import footopt as fo
from footopt.mujoco import attach

HARD = fo.Sand.named("hard")
BLOCK = """
<mujoco>
  <option timestep="{dt}" integrator="{integrator}"/>
  <worldbody>
    {more}
    <body name="foot" pos="0 0 {height}">
      <freejoint/><geom type="box" size=".13 .05 .01" mass="60"/>
    </body>
  </worldbody>
</mujoco>
"""


def block_model(height=0.05, dt=1e-3, integrator="Euler", more=""):
    """The model; more: other bodies of its world."""
    return mujoco.MjModel.from_xml_string(
        BLOCK.format(dt=dt, integrator=integrator, height=height, more=more)
    )


def put_on_sand(request, sand=HARD, effects=(), foot=None, plates=64, **options):
    """Model, data and contact of a block, until the test is over."""
    model = block_model(**options)
    data = mujoco.MjData(model)
    contact = attach(model, data, {"foot": foot or fo.Foot.flat()}, sand, effects, plates)
    request.addfinalizer(contact.detach)
    return model, data, contact


def settle(model, data, seconds):
    """Let it go on for some time, s."""
    mujoco.mj_step(model, data, nstep=round(seconds / model.opt.timestep))
