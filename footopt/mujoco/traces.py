"""The walk of a robot with its traces, and pictures by MuJoCo's renderer where EGL or OSMesa is there."""

import copy
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from footopt.arrays import Array
from footopt.foot import Foot
from footopt.gait import Pose
from footopt.mujoco.model import with_step
from footopt.mujoco.walking import AXES, Outcome
from footopt.walk import Accuracy, Walk

WIDE, ASIDE = 800, 90.0  # pixels; degrees: along y, with x to the right


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class RobotWalk(Walk):
    """A walk of a robot: traces at the end of every step."""

    joints: Array  # (T, feet, bodies, 2), m: of each leg, its bodies from the root to the foot, in x and z
    turned: Array  # (T, feet), rad: pitch of the feet, positive toe up
    states: Array  # (T, n): MuJoCo's

    def camera(self) -> Any:
        """Pictures by MuJoCo's renderer, where there is GL."""
        return camera(self.scene, self.states)

    @property
    def transition_speed(self) -> float:
        """Infinite: its bristles are the directions themselves."""
        return math.inf

    @property
    def world(self) -> Any:
        """The sand of the walk, its effects, and gravity."""
        return self.scene.planar

    def pose(self, index: ArrayLike) -> Pose:
        """Feet from the centre of mass at some samples."""
        i, place = np.asarray(index), self.joints[:, :, -1] - self.com[:, None]
        along, rate = (np.gradient(of, self.t, axis=0) for of in (place, self.turned))
        x, z, vx, vz = (of[i][..., axis] for of in (place, along) for axis in range(2))
        return Pose(x, z, vx, vz, self.turned[i], rate[i])

    def legs(self, t: ArrayLike) -> Array:
        """Places of the bodies of each leg at times (M,), (M, feet, bodies, 2), m."""
        return self._at(self.joints, t)

    def pitch(self, t: ArrayLike) -> Array:
        """Pitch of the feet at times (M,): (M, feet), rad."""
        return self._at(self.turned, t)

    def _at(self, traced: Array, t: ArrayLike) -> Array:
        """A trace at times, linear between its samples."""
        columns = traced.reshape(len(self.t), -1).T
        each = [np.interp(np.asarray(t, float), self.t, column) for column in columns]
        return np.stack(each, axis=-1).reshape(-1, *traced.shape[1:])


def traced(robot: Any, foot: Foot, accuracy: Accuracy, found: Outcome) -> RobotWalk:
    """The walk of a robot with its traces, from its outcome."""
    end = len(found.t)
    joints, turned = poses(robot, accuracy.dt, found.states[:end])
    return RobotWalk(
        foot=foot,
        scene=robot,
        accuracy=accuracy,
        t=found.t,
        com=found.com[1 : end + 1, AXES],
        velocity=found.velocity[1 : end + 1, AXES],
        force=found.sand[:end, :, AXES],
        power=found.sand[:end, :, 3],
        work=found.sand[:end, :, 4],
        start=found.com[0, AXES],
        bristles=bristles_in_world(found.bristles[:end], turned, foot.plates(accuracy.plates).x.shape[1]),
        reason=found.reason,
        totals={name: found.totals.get(name, math.nan) for name in robot.quantities},
        evaluations=found.evaluations,
        joints=joints,
        turned=turned,
        states=found.states[:end],
    )


def poses(robot: Any, dt: float, states: Array) -> tuple[Array, Array]:
    """Places of the bodies of each leg, and the feet's pitch, after each step."""
    import mujoco

    model, chains = with_step(robot.model, dt), robot.model.chains()
    data, long = mujoco.MjData(model), max(map(len, chains))
    joints = np.empty((len(states), len(chains), long, 2))
    turned = np.empty((len(states), len(chains)))
    rows = np.array([[chain[0]] * (long - len(chain)) + chain for chain in chains])
    feet = rows[:, -1].tolist()
    for n, state in enumerate(states):
        mujoco.mj_setState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        mujoco.mj_kinematics(model, data)
        joints[n] = data.xpos[rows][..., AXES]
        turn = np.einsum("fij,fj->fi", data.xmat[feet].reshape(-1, 3, 3), robot.model.ankles)
        joints[n, :, -1] = (data.xpos[feet] + turn)[:, AXES]
        turned[n] = np.arctan2(data.xmat[rows[:, -1], 6], data.xmat[rows[:, -1], 0])
    return joints, turned


def bristles_in_world(h: Array, turned: Array, plates: int) -> NDArray[np.float32]:
    """Bristles (T, feet, plates, 2) in x and z, means over lines of plates, from those in the feet's axes."""
    x, z = (h[:, :, axis].reshape(*h.shape[:2], h.shape[3] // plates, plates).mean(axis=2) for axis in AXES)
    c, s = np.cos(turned)[..., None], np.sin(turned)[..., None]
    return np.stack([c * x - s * z, s * x + c * z], axis=-1).astype(np.float32)


class Camera(NamedTuple):
    """Pictures of a robot without its background and its feet, in whose place soles are drawn."""

    picture: Callable[..., Any]  # from a sample, and left, right, low and high of a view, m, to an image
    top: float  # of the robot at the start, m


@contextmanager
def camera(robot: Any, states: Any) -> Iterator[Camera | None]:
    """A `Camera` for the states of a robot's walk; None without GL."""
    import mujoco

    gl: Any = None
    for name in ("egl", "osmesa"):
        with suppress(Exception):  # of PyOpenGL, in many forms, where a library is missing
            gl = gl or import_module(f"mujoco.{name}").GLContext(WIDE, WIDE)
    if gl is None:
        yield None
        return
    model, option, eye = copy.copy(robot.model.compiled), mujoco.MjvOption(), mujoco.MjvCamera()
    bare = [i for i in range(model.ngeom) if model.body(model.geom_bodyid[i]).name in ("world", *robot.feet)]
    model.geom_rgba[bare, 3], model.geom_matid[bare] = 0.0, -1
    model.vis.headlight.ambient[:], model.vis.headlight.diffuse[:] = 0.4, 0.6
    model.vis.global_.offwidth = model.vis.global_.offheight = WIDE
    eye.orthographic, eye.azimuth, eye.elevation, eye.distance = 1, ASIDE, 0.0, 2.0 * model.stat.extent
    data, scene = mujoco.MjData(model), mujoco.MjvScene(model, maxgeom=10_000)
    gl.make_current()
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)

    def place(sample: int) -> None:
        mujoco.mj_setState(model, data, states[sample], mujoco.mjtState.mjSTATE_FULLPHYSICS)
        mujoco.mj_forward(model, data)

    def picture(sample: int, left: float, right: float, low: float, high: float) -> Any:
        place(sample)
        tall = min(round(WIDE * (high - low) / (right - left)), WIDE)
        colours, depth = np.empty((tall, WIDE, 3), np.uint8), np.empty((tall, WIDE), np.float32)
        model.vis.global_.fovy, eye.lookat[:] = high - low, (0.5 * (left + right), 0.0, 0.5 * (low + high))
        mujoco.mjv_updateScene(model, data, option, None, eye, mujoco.mjtCatBit.mjCAT_ALL, scene)
        view = mujoco.MjrRect(0, 0, WIDE, tall)
        mujoco.mjr_render(view, scene, context)
        mujoco.mjr_readPixels(colours, depth, view, context)
        return np.dstack([colours, 255 * (depth < 1.0).astype(np.uint8)])[::-1]

    try:
        place(0)
        top = np.delete(data.geom_xpos[:, 2] + model.geom_rbound, bare).max(initial=0.0)
        yield Camera(picture, float(top))
    finally:
        context.free()
        gl.free()
