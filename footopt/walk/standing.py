"""How deep the walker stands at first: where the sand carries the weight."""

from __future__ import annotations

import numpy as np

from footopt.compiled import inlined
from footopt.effects import base as effects
from footopt.walk.contact import BENT, EDGE
from footopt.walk.state import pose_of


@inlined
def static_height(world, sole, poses):
    """Hip height (m) at which the limit forces of downward motion on both feet carry the weight.

    Vertical balance only: eq. 2 with h = (0, -1) on every plate. Pushes are left out: they depend on the
    speed, and who stands has none. NaN if even at the surface the forces do not carry it.
    """
    low, high = 0.0, -np.inf
    for foot in range(2):
        pose = pose_of(poses, foot)
        for i in range(len(sole.x)):
            high = max(high, -(pose.z + pose.sin * sole.x[i] + pose.cos * sole.z[i]))
    if high <= low or _lift(world, sole, poses, low) < world.mass * world.g:
        return np.nan
    # the Illinois method: a tenth of the evaluations that bisection takes
    weight = world.mass * world.g
    below, above, side = _lift(world, sole, poses, low) - weight, -weight, 0
    for _ in range(200):
        middle = (low * above - high * below) / (above - below)
        missing = _lift(world, sole, poses, middle) - weight
        if abs(missing) <= 1e-13 * weight or not low < middle < high:
            return middle
        if missing > 0.0:
            above *= 0.5 if side > 0 else 1.0  # the other end has stood twice: as if it were nearer
            low, below, side = middle, missing, 1
        else:
            below *= 0.5 if side < 0 else 1.0
            high, above, side = middle, missing, -1
    return low


@inlined
def _lift(world, sole, poses, z):
    """Limit force of downward motion on both feet at the hip height z, N."""
    law, total = world.law, 0.0
    for foot in range(2):
        pose = pose_of(poses, foot)
        cos, sin = pose.cos, pose.sin
        c2p, s2p = cos * cos - sin * sin, 2.0 * sin * cos
        for i in range(len(sole.x)):
            depth = -(z + pose.z + sin * sole.x[i] + cos * sole.z[i])
            if depth > 0.0:
                c = sole.c2[i] * c2p - sole.s2[i] * s2p
                stress = law.A00 + law.B01 + (law.A10 + law.B_sum) * c
                place = pose.x + cos * sole.x[i] - sin * sole.z[i]
                strength = _strength(world.loads, depth, place)
                share = _sinking_share(world.gates, world.rest, sole.tangent, i, cos, sin)
                total += sole.area[i] * strength * stress * share
    return total


@inlined
def _strength(loads, depth, place):
    """Strength integrated over the depth, m."""
    if loads is None:
        return depth
    return effects.load(loads, (depth, 1.0, 0.0), depth, place)[0]


@inlined
def _sinking_share(gates, rest, tangent, i, cos, sin):
    """Share of the stress that plate i feels when it moves straight down, by 1 m/s."""
    if gates is None:
        return 1.0
    vn = cos * tangent.x[i] - sin * tangent.z[i]
    if rest is None:
        return effects.gate(gates, (1.0, 0.0), vn, max(BENT * tangent.turn[i], 1e-9))[0]
    return effects.gate(gates, (1.0, 0.0), vn, EDGE)[0]
