"""The paper's algorithm as a numpy programmer would write it: the baseline of the benchmarks.

Explicit Euler, the law in its angle form, one array operation at a time over all plates of both
feet of all designs; peak power and lost speed are read at the ends of the steps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import footopt as fo
from footopt.sand.law import PER_CM3

Array = NDArray[np.float64]

DT, PLATES, CREEP = 1e-4, 100, 1e-4  # the paper's step (s) and plates; the smoothing, m/s


class Chords(NamedTuple):
    """Chord plates, each (designs, 1, plates): middles from the ankle (m), angle (rad), area (m^2)."""

    x: Array
    z: Array
    beta: Array
    area: Array


def chords(k: Array, space: fo.Waypoints, plates: int = PLATES) -> Chords:
    """The plates of waypoint feet."""
    points = space.points(k, plates)
    middle = 0.5 * (points[:, 1:] + points[:, :-1]) - np.asarray(space.ankle)
    dx, dz = np.moveaxis(np.diff(points, axis=1), -1, 0)
    columns = middle[..., 0], middle[..., 1], np.arctan2(dz, dx), space.width * np.hypot(dx, dz)
    return Chords(*(column[:, None, :] for column in columns))


def walk(sole: Chords, scene: fo.Scene, dt: float = DT, creep: float = CREEP) -> tuple[Array, Array]:
    """Walk with a batch of feet.

    Returns
    -------
    values : (designs, 5), distance, mean height, work, peak power, speed loss
    trace : (designs, steps + 1, 4), hip x, z (m), v_x, v_z (m/s)
    """
    law, walker = scene.sand.stress_map, scene.walker
    t_f, steps = scene.duration, round(scene.duration / dt)
    t = t_f * np.arange(steps + 1) / steps
    h, strike = t_f / steps, scene.gait.heel_strike - 1e-9
    pose = scene.gait.pose(t, walker.l1, walker.l2)
    cos, sin = np.cos(pose.pitch)[..., None], np.sin(pose.pitch)[..., None]
    place_z, speed_x, speed_z = pose.z[..., None], pose.vx[..., None], pose.vz[..., None]
    rate, turn = pose.rate[..., None], 2.0 * pose.pitch[..., None]
    twice, stiffness = 2.0 * sole.beta, scene.zeta * PER_CM3 * sole.area

    def forces(n: int, z: Array, vx: Array, vz: Array) -> tuple[Array, Array, Array]:
        """f_x, f_z and power of both feet at step n, each (designs, 2)."""
        rx, rz = cos[n] * sole.x - sin[n] * sole.z, sin[n] * sole.x + cos[n] * sole.z
        pull = stiffness * np.maximum(-(z[:, None, None] + place_z[n] + rz), 0.0)
        ux = vx[:, None, None] + speed_x[n] - rate[n] * rz
        uz = vz[:, None, None] + speed_z[n] + rate[n] * rx
        square = ux * ux + uz * uz
        share = np.sqrt(square / (square + creep * creep))  # |h| of the smoothed direction
        b, g = twice + turn[n], np.arctan2(-uz, ux)
        alpha_z = (
            law.A00
            + law.A10 * np.cos(b)
            + share * (law.B11 * np.sin(b + g) + law.B01 * np.sin(g) + law.Bm11 * np.sin(g - b))
        )
        alpha_x = law.D10 * np.sin(b) + share * (
            law.C11 * np.cos(b + g) + law.C01 * np.cos(g) + law.Cm11 * np.cos(g - b)
        )
        fx, fz = -pull * alpha_x, pull * alpha_z
        return fx.sum(-1), fz.sum(-1), (fx * ux + fz * uz).sum(-1)

    z = static_height(sole, scene, pose.z[0], pose.pitch[0])
    x, vx, vz = np.zeros_like(z), np.zeros_like(z), np.zeros_like(z)
    trace, power = np.empty((len(z), steps + 1, 4)), np.empty((len(z), steps + 1, 2))
    for n in range(steps + 1):
        fx, fz, power[:, n] = forces(n, z, vx, vz)
        trace[:, n] = np.stack([x, z, vx, vz], axis=1)
        x, z = x + h * vx, z + h * vz
        vx, vz = vx + h * fx.sum(-1) / walker.mass, vz + h * (fz.sum(-1) / walker.mass - walker.g)
    speed, late = trace[:, t > strike, 2], np.abs(power[:, t > strike])
    values = np.stack(
        [
            trace[:, -1, 0],
            trace[:, :-1, 1].mean(axis=1),
            np.abs(h * power[:, :-1].sum(axis=(1, 2))),
            late.max(axis=(1, 2), initial=0.0),
            (np.maximum.accumulate(speed, axis=1) - speed).max(axis=1, initial=0.0),
        ],
        axis=1,
    )
    return values, trace


def static_height(sole: Chords, scene: fo.Scene, ankle: Array, pitch: Array) -> Array:
    """Hip height at which both feet, moving down, carry the weight, (designs,), by bisection."""
    law = scene.sand.stress_map
    cos, sin = np.cos(pitch)[:, None], np.sin(pitch)[:, None]
    level = ankle[:, None] + sin * sole.x + cos * sole.z
    stress = law.A00 + law.B01 + (law.A10 + law.B11 + law.Bm11) * np.cos(2.0 * (sole.beta + pitch[:, None]))
    low, high = np.zeros(len(level)), -level.min(axis=(1, 2))
    for _ in range(60):
        middle = 0.5 * (low + high)
        depth = np.maximum(-(middle[:, None, None] + level), 0.0)
        carried = (scene.zeta * PER_CM3 * sole.area * depth * stress).sum(axis=(1, 2)) >= scene.walker.weight
        low, high = np.where(carried, middle, low), np.where(carried, high, middle)
    return low
