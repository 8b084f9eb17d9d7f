"""A block of 60 kg on one foot in MuJoCo: what tests of the sand under robots share."""

import mujoco
import numpy as np
from numba import njit

import footopt as fo
from footopt.mujoco import attach
from footopt.mujoco.faces import COLUMNS, forces
from footopt.mujoco.implicit import OPEN

HARD = fo.Sand.named("hard")
BLOCK = """
<mujoco>
  <option timestep="{dt}" integrator="{integrator}"/>
  <worldbody>
    <body name="foot" pos="0 0 {height}">
      <freejoint/><geom type="box" size=".13 .05 .01" mass="60"/>
    </body>
  </worldbody>
</mujoco>
"""


def block_model(height=0.05, dt=1e-3, integrator="Euler"):
    """The model."""
    return mujoco.MjModel.from_xml_string(BLOCK.format(dt=dt, integrator=integrator, height=height))


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


@njit(error_model="numpy")
def _forces(acting, open, faces, law, up, surface, forward, twist, c, turn, h0):
    """`footopt.mujoco.faces.forces`, compiled."""
    return forces(acting, open, faces, law, up, surface, forward, twist, c, turn, h0)


def feel(contact, up, twist, height, c=0.0, turn=1e9, bristles=None):
    """Wrench of the sand on the only body in its own axes, (6,), and its derivative by the twist, (6, 6)."""
    body, twist = contact._bodies[0], np.asarray(twist, float)
    faces = contact._space.faces[0].reshape(COLUMNS, -1)
    h0 = np.zeros_like(faces[:3]) if bristles is None else bristles.reshape(3, -1)
    way, acting = c * twist, contact.acting
    surface = float(height + up @ way[:3]), tuple((up - np.cross(way[3:], up)).tolist())
    open = OPEN * contact._space.step["bypass"][0]
    forward, up = (0.0, (1.0, 0.0, 0.0)), tuple(np.asarray(up, float).tolist())
    total, rows = _forces(acting, open, faces, body["law"], up, surface, forward, twist, c, turn, h0)
    return np.array(total), np.array(rows)
