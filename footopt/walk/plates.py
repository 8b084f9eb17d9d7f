"""Every plate's place, motion and force, by the compiled law of the walk: what figures and studies ask."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from footopt.arrays import Array
from footopt.foot import Plates
from footopt.gait import Pose
from footopt.walk.contact import TURN, bristles_between, plate_force
from footopt.walk.discretize import sole_of
from footopt.walk.own_code import compiled_for
from footopt.walk.state import Motion, World, ankle_of, in_world, plates_between, write


@dataclass(frozen=True, eq=False)
class PlateStates:
    """Plates of both feet at M samples; vectors are (M, 2 feet, N, 2), in x, z."""

    position: Array  # m
    velocity: Array  # m/s
    force: Array  # N
    normal: Array  # outward, into the sand
    area: Array  # (N,), m^2
    transition_speed: Array  # (M, 2 feet), m/s: the speed over which directions are smoothed

    @property
    def depth(self) -> Array:
        """Below the sand's surface, (M, 2 feet, N), m; 0 above."""
        return np.maximum(-self.position[..., 1], 0.0)

    @property
    def power(self) -> Array:
        """f.v of every plate, (M, 2 feet, N), W: the paper's eq. 7."""
        return np.asarray(np.sum(self.force * self.velocity, axis=-1))


def plate_states(
    plates: Plates,
    pose: Pose,
    com: Array,
    velocity: Array,
    world: World,
    transition_speed: float,
    bristles: Array | None = None,
) -> PlateStates:
    """The plates of one foot shape under a walker in some states, on the sand of a world.

    The plates are of one design; the pose is that of both feet at M times, and place and velocity
    of the hip are (M, 2), m and m/s. The law's jump at rest is smoothed over the transition speed, m/s, or
    `bristles` (M, 2, N, 2) are turned by motion over that speed; infinity leaves them as they are.
    """
    sole, count = sole_of(plates), plates.x.shape[1]
    e0, hip, out = None, np.column_stack([com, velocity]), np.zeros((*pose.x.shape, sole.plates.shape[1], 8))
    if bristles is not None:
        e0 = np.zeros((pose.x.size, 2, sole.plates.shape[1]))
        e0[..., :count] = np.moveaxis(bristles, 3, 2).reshape(-1, 2, count)
    compiled_for(each_plate, world.effects.all)(world, sole, pose.table(), hip, transition_speed, e0, out)
    place, moves, force, normal = (out[:, :, :count, i : i + 2] for i in range(0, 8, 2))
    transition = np.hypot(transition_speed, TURN * float(sole.span) * pose.rate)
    return PlateStates(place, moves, force, normal, plates.area[0], transition)


def each_plate(
    world: Any, sole: Any, poses: Array, hip: Array, transition_speed: float, e0: Any, out: Array
) -> None:
    """Compiled: fill `out` (M, feet, plates, 8) with place, velocity, force and normal of every plate.

    poses: (M, feet, 7). hip: (M, 4), its place and velocity. e0: bristles (M times feet, 2, plates), or None.
    """
    law, acting, part = world.law, world.effects, plates_between(sole, True, 0, sole.plates.shape[1])
    for m in range(len(hip)):
        moving = Motion(hip[m, 0], hip[m, 1], hip[m, 2], hip[m, 3])
        for foot in range(poses.shape[1]):
            ankle = in_world(ankle_of(poses[m], foot), moving)
            bristles = bristles_between(e0, m * poses.shape[1] + foot, 0, len(part.x))
            for i in range(len(part.x)):
                x, z, at, nx, nz = plate_force(law, acting, part, i, ankle, transition_speed, None, bristles)
                write(out[m, foot, i], (at.x, at.z, at.vx, at.vz, x, z, nx, nz))
