"""What a foot or a walk is judged by beside the compiled objectives: geometry, and the walk's validity."""

from __future__ import annotations

from functools import lru_cache

from footopt.foot import Foot
from footopt.walk import validity
from footopt.walk.objectives import measure
from footopt.walk.results import Walk
from footopt.walk.validity import Diagnostic, diagnose


@measure("foot", "$h$", "m", maximise=False, worst=1e3, least=0.0)
def hollow(foot: Foot) -> float:
    """Largest gap between the sole and its lower convex hull, m."""
    return foot.hollow


@measure("foot", "$d_{\\min}$", "m", maximise=True, worst=-1e3)
def thickness(foot: Foot) -> float:
    """Smallest height of the foot's top above its sole, m."""
    return float(foot.top - foot.contour[:, 1].max())


@lru_cache(maxsize=1)  # three measures of one walk
def _validity(walk: Walk) -> dict[str, Diagnostic]:
    return {d.name: d for d in diagnose(walk)}


@measure("walk", r"$z_{\mathrm{ankle}}$", "m", maximise=False, worst=1e3)
def ankle_depth(walk: Walk) -> float:
    """Largest depth of the ankle below the surface, m: only the sole feels the sand, not the leg."""
    return validity.ankle_depth(walk)


@measure("walk", r"$\bar v$", "m/s", maximise=False, worst=1e3, least=0.0)
def plate_speed(walk: Walk) -> float:
    """Speed of the plates, weighted by their force, m/s: RFT is tested for slow motion."""
    return _validity(walk)["force-weighted plate speed"].value


@measure("walk", r"$s_{\mathrm{inertia}}$", "", maximise=False, worst=1e3, least=0.0)
def inertial_share(walk: Walk) -> float:
    """Share of the force that the grains' inertia has, or would have."""
    return _validity(walk)["inertial share of the force"].value


@measure("walk", r"$s_{\mathrm{trailing}}$", "", maximise=False, worst=1e3, least=0.0)
def trailing_share(walk: Walk) -> float:
    """Share of |W| on faces that trail."""
    return _validity(walk)["share of |W| on trailing faces"].value
