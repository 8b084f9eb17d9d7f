"""Bristles: the elastic displacement that the sand under each plate remembers.

A plate's direction of motion h is the force of a bristle: a spring and a damper side by side (Kelvin-Voigt),
which its motion bends over the length delta, and which slides where |h| = 1. e is what the spring carries::

    e' = (v - slip) / delta,   h = e + tau e',   |h| <= 1,   slip along h, and 0 where |h| < 1

Over a time c, from e_0 at its beginning, that is a return map, as in plasticity::

    u = e_0 + (c + tau) v / delta,   h = u / max(1, |u|),   e = e_0 + (h - e_0) c / (c + tau)

Sliding turns e and h into v / |v|, as the plain law has it; at rest both are what balance needs, and nothing
moves. Without the damper a walker vibrates on its bristles at sqrt(g / delta), 500 Hz, by 3 mm/s, which long
steps damp and short ones do not: tau = 2 sqrt(delta / g) is about critical, and vanishes with delta.
"""

from functools import partial
from typing import Any, NamedTuple

import numpy as np

from footopt.compiled import FAST, inlined, unless_none
from footopt.walk.contact import bristles_between, direction, kinematics, rsqrt, submerged
from footopt.walk.state import ankle_of, in_world, plates_between


class Bristles(NamedTuple):
    """e of every plate, (2 feet, 2 components, padded plates) each; 0 in the air. None without bristles."""

    e_n: Any  # at the step's beginning
    e_stage: Any  # where its second stage begins
    e_next: Any  # at its end


@inlined
def transition_speed_of(length, world, c):
    """The speed over which a plate's direction turns, m/s; with bristles, after a time c, s."""
    if length is None:
        return world.creep
    return length / (c + world.retardation)


@unless_none
def bent_down(length, size, plates):
    """Bristles (2 feet, 2, plates), all (0, -size): 1 is bent straight down, 0 upright."""
    e = np.zeros((2, 2, plates))
    for i in range(plates):
        e[0, 1, i] = e[1, 1, i] = -size
    return e


@inlined
def next_step(bristles):
    """Make the end of a step the beginning of the next one."""
    return Bristles(bristles.e_next, bristles.e_stage, bristles.e_n)


@unless_none
def record(trace, row, e):
    """Write bristles into a row of a trace."""
    for foot in range(2):  # loops: numba takes 20 s to compile an assignment of arrays
        for i in range(e.shape[2]):
            trace[row, foot, 0, i], trace[row, foot, 1, i] = e[foot, 0, i], e[foot, 1, i]


@partial(unless_none, fastmath=FAST)
def bend(before, after, part, world, sole, poses, hip, c):
    """Bend the bristles of both feet over a stage of a time c, s, from those before it to those after it.

    part: how much of the stage `after` belongs to; 1 is its end. hip: its `Motion` at the end of the stage.
    """
    transition = transition_speed_of(world.bristle_length, world, c)
    share = part * c / (c + world.retardation)
    for foot in range(2):
        ankle = in_world(ankle_of(poses, foot), hip)
        first, last = submerged(sole, ankle)
        for i in range(first):
            after[foot, 0, i] = after[foot, 1, i] = 0.0
        for i in range(last, sole.plates.shape[1]):
            after[foot, 0, i] = after[foot, 1, i] = 0.0
        plates = plates_between(sole, None, first, last)
        e0 = bristles_between(before, foot, first, last)
        ex, ez = bristles_between(after, foot, first, last)
        for i in range(len(plates.x)):
            motion = kinematics(ankle, plates.x[i], plates.z[i])
            h = direction(motion, transition, 0.0, e0, i)
            in_sand = 1.0 if motion.z < 0.0 else 0.0
            x, z = e0[0][i] + share * (h.x - e0[0][i]), e0[1][i] + share * (h.z - e0[1][i])
            in_sand *= rsqrt(max(x * x + z * z, 1.0))  # beyond its stage a slope may lead out of the disc
            ex[i], ez[i] = in_sand * x, in_sand * z
