"""One effect of each kind, as tests of several files use them."""

from feet_in_sand import pose_of

import footopt as fo

#: Interfaces and patches are two each everywhere: another number is compiled again.
LAYERS = fo.Layers((0.02, 0.05), (0.6, 1.5))
PATCHES = fo.Patches((0.35, 1.2), (0.95, 1.6), (0.7, 1.5))
ONE = {"layers": LAYERS, "patches": PATCHES, "leading_edge": fo.LeadingEdge(), "inertia": fo.Inertia()}
ALL = (*ONE.values(), fo.Slope(3.0), fo.Shadowing())

DOWN = pose_of(0.0, 0.0, 0.0)  # the ankle at the hip, level


def difference(function, d=1e-7):
    """Central difference at 0."""
    return (function(d) - function(-d)) / (2.0 * d)
