"""Pictures of a robot by MuJoCo's renderer, where EGL or OSMesa makes a context for it."""

import copy
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

WIDE, ASIDE = 800, 90.0  # pixels; degrees: along y, with x to the right


class Camera(NamedTuple):
    """Pictures of a robot: nothing is behind it, nor its feet, in whose place soles are drawn."""

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
