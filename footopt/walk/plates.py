"""Every plate's place, motion and force, by the compiled law of the walk: what figures and studies ask."""

from dataclasses import dataclass

import numpy as np

from footopt.arrays import Array
from footopt.compiled import inlined, inlined_fast
from footopt.effects.dual import value
from footopt.foot import Plates
from footopt.gait import Pose
from footopt.walk.contact import TURN, bristles_between, outward_normal, plate_force
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
        return np.asarray(np.vecdot(self.force, self.velocity))


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
    directed = None if world.effects.gates is None and world.effects.pushes is None else True
    compiled_for(each_plate, world.effects.all)(
        world, sole, directed, pose.table(), hip, transition_speed, e0, out
    )
    place, moves, force, normal = (out[:, :, :count, i : i + 2] for i in range(0, 8, 2))
    transition = np.hypot(transition_speed, TURN * float(sole.span) * pose.rate)
    return PlateStates(place, moves, force, normal, plates.area[0], transition)


def each_plate(world, sole, directed, poses, hip, transition, e0, out):
    """Compiled: fill `out` (M, feet, plates, 8) with place, velocity, force and normal of every plate.

    directed: True, or None where no effect needs the plates' directions. poses: (M, feet, 7). hip: (M, 4),
    its place and velocity. e0: bristles of all feet, (M feet, 2, plates), or None.
    """
    feet = poses.shape[1]
    for m in range(len(hip)):
        for foot in range(feet):
            at, held = out[m, foot], m * feet + foot
            _fill_foot(at, world, sole, directed, poses[m], foot, hip[m], transition, e0, held)


# numba compiles a function once for each set of options of its callers: these two have those of the walk's


@inlined
def _fill_foot(out, world, sole, directed, poses, foot, hip, transition, e0, held):
    count = sole.plates.shape[1]
    part, tangent = plates_between(sole, directed, 0, count), plates_between(sole, True, 0, count).tangent
    ankle = in_world(ankle_of(poses, foot), Motion(hip[0], hip[1], hip[2], hip[3]))
    _fill(out, world, part, tangent, ankle, transition, bristles_between(e0, held, 0, count))


@inlined_fast
def _fill(out, world, part, tangent, ankle, transition, e0):
    for i in range(len(part.x)):
        x, z, at, _, _ = plate_force(world.law, world.effects, part, i, ankle, transition, world.given, e0)
        nx, nz = outward_normal(tangent, i, ankle)
        write(out[i], (at.x, at.z, at.vx, at.vz, value(x), value(z), nx, nz))
