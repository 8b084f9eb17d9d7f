"""Scenes that once were walked wrongly without a word: now right, or their estimate says how wrong."""

import numpy as np
import pytest
from random_scenes import judge, scale_of

import footopt as fo
from footopt.walk.resolution import BEYOND, resolution

FLAT = fo.Foot.flat()
ROUGH = fo.Waypoints().random(3, seed=8, inside=True)
COMB = fo.Foot.from_waypoints([1, 10] * 100, name="comb") if False else None


def feet(*, n=11, count=3):
    """Random soles."""
    return [fo.Foot.from_waypoints(k) for k in np.random.default_rng(n).integers(1, 11, (count, n))]


def sand(zeta, *effects, **scene):
    """A walk on a sand."""
    return fo.Scene(sand=fo.Sand(zeta), effects=effects, **scene)


STRIPES = fo.Patches(
    tuple(np.arange(100) * 0.02 + 0.1), tuple(np.arange(100) * 0.02 + 0.101), (10.0,) * 100, blur=1e-3
)
SHEETS = fo.Layers(tuple(np.linspace(1e-3, 0.1, 100)), tuple(1.5 ** np.sin(np.arange(100))))

#: Name: feet and scene.
CASES = {
    "a level slab on zeta 200": ([FLAT], sand(200.0)),
    "a hard pan of 1e6 at 30 mm": (feet(), sand(0.2, fo.Layers((0.03,), (1e6,)))),
    "100 patches of 1 mm": (feet(), sand(1.0, STRIPES)),
    "a cliff from 1 to 1,000": (feet(), sand(1.0, fo.Patches((0.5,), (9.0,), (1000.0,), blur=1e-4))),
    "20 us behind the heel strike": (feet(), sand(5.0, t_f=1.10002)),
    "a comb of 200 waypoints": ([fo.Foot.from_waypoints([1, 10] * 100)], sand(5.0)),
    "50 waypoints": (feet(n=50), sand(5.0)),
    "leading edge on hard sand": (feet(), sand(5.0, fo.LeadingEdge())),
    "100 layers and 100 patches": (feet(), sand(1.0, SHEETS, STRIPES)),
}
