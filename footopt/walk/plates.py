"""Every plate's place, motion and force, by the law in its readable form: what figures and tests ask."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from footopt.effects import base as effects
from footopt.foot import Plates
from footopt.gait.gait import Pose
from footopt.sand.law import by_angles, by_direction, smoothed
from footopt.walk.contact import BENT, EDGE, SEEN, TURN
from footopt.walk.scene import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PlateStates:
    """Plates of both feet at M samples; vectors are (M, 2 feet, N, 2), in x, z."""

    position: Array  # m
    velocity: Array  # m/s
    force: Array  # N
    normal: Array  # outward, into the sand
    area: Array  # (N,), m^2
    depth: Array  # (M, 2 feet, N), m: below the sand's surface, 0 above
    slip: Array  # (M, 2 feet), m/s: the speed over which directions are smoothed

    @property
    def total(self) -> Array:
        """F = sum of f over the plates of a foot, (M, 2 feet, 2), N: the paper's eq. 2."""
        return np.asarray(self.force.sum(axis=2))

    @property
    def power(self) -> Array:
        """f.v of every plate, (M, 2 feet, N), W: the paper's eq. 7."""
        return np.asarray(np.sum(self.force * self.velocity, axis=-1))


def plate_states(
    plates: Plates,
    pose: Pose,
    com: Array,
    velocity: Array,
    scene: Scene,
    creep: float,
    angles: bool = False,
    bristles: Array | None = None,
) -> PlateStates:
    """The plates of one foot shape under a walker in some states, with the effects of a scene.

    The paper's eq. 4 gives places and velocities, eq. 1 the forces; `PlateStates.total` is eq. 2.

    Parameters
    ----------
    plates : Plates
        Of one design, directed.
    pose : Pose
        Of both feet at M times.
    com, velocity : (M, 2), m and m/s
        Of the hip, in x and z.
    scene : Scene
        Its sand and effects count.
    creep : float, m/s
        Speed over which the law's jump at rest is smoothed.
    angles : bool
        Whether the law is computed from angles, as published; only for flat plates (rule "chord").
    bristles : (M, 2, N, 2), optional
        Directions h that the sand's bristles hold (`bristles.Bristles`), in place of the smoothed velocity's.
    """
    assert plates.tx is not None, "plates must be directed"
    assert plates.tz is not None, "plates must be directed"
    x, z, tx, tz = plates.x[0], plates.z[0], plates.tx[0], plates.tz[0]
    cos, sin, rate = np.cos(pose.pitch)[..., None], np.sin(pose.pitch)[..., None], pose.rate[..., None]
    rx, rz = cos * x - sin * z, sin * x + cos * z
    position = np.stack(
        [(com[:, 0, None] + pose.x)[..., None] + rx, (com[:, 1, None] + pose.z)[..., None] + rz], axis=-1
    )
    v = np.stack(
        [
            (velocity[:, 0, None] + pose.vx)[..., None] - rate * rz,
            (velocity[:, 1, None] + pose.vz)[..., None] + rate * rx,
        ],
        axis=-1,
    )
    normal = np.stack([sin * tx + cos * tz, sin * tz - cos * tx], axis=-1)
    span = 0.0 if plates.span is None else plates.span[0]
    slip = np.hypot(creep, TURN * span * rate)
    h = smoothed(v, slip[..., None]) if bristles is None else bristles
    if angles:
        beta = np.arctan2(tz, tx) + pose.pitch[..., None]
        stress = by_angles(beta, v, slip, scene.sand.stress_map)
    else:
        c2p, s2p = np.cos(2.0 * pose.pitch)[..., None], np.sin(2.0 * pose.pitch)[..., None]
        c, s = plates.c2[0] * c2p - plates.s2[0] * s2p, plates.s2[0] * c2p + plates.c2[0] * s2p
        stress = by_direction(c, s, h, scene.sand.stress_map)
    edge: float | Array = EDGE
    if bristles is None:
        bent = 0.0 if plates.turn is None else plates.turn[0]
        speed = np.linalg.norm(v, axis=-1)
        edge = np.sqrt(creep**2 + (SEEN * span * rate) ** 2 + (BENT * bent * speed) ** 2)
    force = forces(stress, position, v, normal, plates.area[0], scene, edge, bristles)
    return PlateStates(position, v, force, normal, plates.area[0], depth_of(position), slip[..., 0])


def depth_of(position: Array) -> Array:
    """Depth below the sand's surface, m, 0 above; positions are (..., 2), m."""
    return np.maximum(-position[..., 1], 0.0)


def forces(
    stress: Array,
    position: Array,
    velocity: Array,
    normal: Array,
    area: Array,
    scene: Scene,
    edge: float | Array,
    bristles: Array | None = None,
) -> Array:
    """zeta load share stress dA - pressure n dA: the force on plates with a scene's effects, (*S, 2), N.

    Parameters
    ----------
    stress : (*S, 2), N/m^3
        Per depth, for zeta = 1.
    position, velocity, normal : (*S, 2), m, m/s and 1
        Of the plates, in x and z.
    area : broadcast to S, m^2
        Of the plates.
    scene : Scene
        Its sand and effects count.
    edge : float or broadcast to S
        The speed over which a gate opens, m/s; with bristles `contact.EDGE`.
    bristles : (*S, 2), optional
        Which way a plate faces, in place of its velocity.
    """
    depth = depth_of(position)
    vn = np.sum(normal * velocity, axis=-1)
    leads = vn if bristles is None else np.sum(normal * bristles, axis=-1)
    load, share, push = effects.readable(scene.effects, depth, position[..., 0], vn, leads, edge)
    pull = scene.zeta * load * share * area
    return np.asarray(pull[..., None] * stress - (push * area)[..., None] * normal)
