"""Scenes that once were walked wrongly without a word: now right, or their estimate says how wrong."""

import numpy as np
import pytest
from random_scenes import judge

import footopt as fo


def soles(n=11, count=2):
    """Random ones, flat at first."""
    heights = np.random.default_rng(n).integers(1, 11, (count, n))
    return [fo.Foot.from_waypoints([10] * n), *map(fo.Foot.from_waypoints, heights)]


def walk_on(zeta, *effects, **scene):
    """A walk on a sand."""
    return fo.Scene(sand=fo.Sand(zeta), effects=effects, **scene)


BEGINS = 0.1 + 0.02 * np.arange(100)
STRIPES = fo.Patches(tuple(BEGINS), tuple(BEGINS + 1e-3), (10.0,) * 100, blur=1e-3)
SHEETS = fo.Layers(tuple(np.linspace(1e-3, 0.1, 100)), tuple(1.5 ** np.sin(np.arange(100))))
CLIFF = fo.Patches((0.5,), (9.0,), (1000.0,), blur=1e-4)
SPIKES = [fo.Foot.from_waypoints([1, 10] * 100)]

#: Feet, scene, and the relative error that `standard` may have there: beyond its promise it has to say so.
CASES = {
    "a level slab on zeta 200": (soles(), walk_on(200.0), 0.005),
    "a hard pan of 1e6 at 30 mm": (soles(), walk_on(0.2, fo.Layers((0.03,), (1e6,))), 0.005),
    "100 patches of 1 mm": (soles(), walk_on(1.0, STRIPES), 0.005),
    "a cliff from 1 to 1,000": (soles(), walk_on(1.0, CLIFF), 0.005),
    "20 us behind the heel strike": (soles(), walk_on(5.0, t_f=1.10002), 0.005),
    "a comb of 200 waypoints": (SPIKES, walk_on(5.0), 0.005),
    "50 waypoints": (soles(50), walk_on(5.0), 0.005),
    "leading edge on hard sand": (soles(), walk_on(5.0, fo.LeadingEdge()), 0.005),
    "100 layers and 100 patches": (soles(), walk_on(1.0, SHEETS, STRIPES), 0.005),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_the_estimate_holds_the_error_which_is_within_the_promise(name):
    feet, scene, allowed = CASES[name]
    for one in judge(feet, scene):
        assert one.reason == one.truth == ""
        assert one.error.max() <= one.estimate.max()
        assert one.error.max() <= allowed
