"""Is the walk inside what resistive force theory has been tested for? Numbers, limits, measures.

RFT's growth of stress with depth is tested to about one plate width, its rate independence for slow
motion, and, as in the paper, faces that trail (n.v < 0) are counted like those that lead, unless the
scene names the leading edge.
"""

import math
from dataclasses import dataclass

import numpy as np

from footopt.arrays import Ints
from footopt.effects import EFFECTS, laws
from footopt.effects import base as effects
from footopt.foot import Foot
from footopt.walk.balances import creep_while_standing
from footopt.walk.objectives import measure
from footopt.walk.results import Walk

SAMPLES = 600  # instants of the walk that are looked at

#: Names of the diagnostics, and why a value above the limit is doubtful.
WHY = {
    "depth of the sole": "RFT's growth with depth is tested to about one plate width",
    "depth of the ankle": "only the sole feels the sand, not the leg",
    "force-weighted plate speed": "RFT is tested for slow motion",
    "inertial share of the force": "the sand's inertia is left out; effects=inertia counts it",
    "share of |W| on trailing faces":
        "faces that trail are counted as in the paper; effects=leading_edge leaves them out",
    "sinking while standing": "the smoothed law lets a walker that stands sink; effects=rest holds it",
    "power that the sand gives":
        "such a sand pushes plates along, and a walk's end may hang on the accuracy; see sand.coefficients",
    "length of the sole over the leg's": "lengths are in m, and foot.L is half of the sole's",
    "length of the leg over the sole's": "lengths are in m, those of thigh and shank, too",
}  # fmt: skip
RARE = tuple(WHY)[5:]  # told only where they are beyond their limit


@dataclass(frozen=True)
class Diagnostic:
    """One number about a walk's validity, and where it leaves the tested range (above `limit`)."""

    name: str
    value: float
    unit: str
    limit: float
    why: str

    @property
    def outside(self) -> bool:
        """Whether the value is beyond its limit."""
        return self.value > self.limit


def samples(walk: Walk) -> Ints:
    """The instants of a walk that are looked at."""
    return np.unique(np.linspace(0, len(walk.t) - 1, SAMPLES).astype(np.int64))


@measure("foot", "$h$", "m", maximise=False, worst=1e3, least=0.0)
def hollow(foot: Foot) -> float:
    """Largest gap between the sole and its lower convex hull, m."""
    return foot.hollow


@measure("foot", "$d_{\\min}$", "m", maximise=True, worst=-1e3)
def thickness(foot: Foot) -> float:
    """Smallest height of the foot's top above its sole, m."""
    return float(foot.top - foot.contour[:, 1].max())


@measure("walk", r"$z_{\mathrm{ankle}}$", "m", maximise=False, worst=1e3)
def ankle_depth(walk: Walk) -> float:
    """Largest depth of the ankle below the surface, m: only the sole feels the sand, not the leg."""
    index = samples(walk)
    return float(max(-(walk.com[index, 1, None] + walk.pose(index).z).min(), 0.0))


def diagnose(walk: Walk) -> list[Diagnostic]:
    """The validity of a walk; an empty list for one without a single step.

    Computed from the plates at up to `SAMPLES` instants.
    """
    if len(walk.t) == 0:
        return []
    index = samples(walk)
    states = walk.plates(index)
    depth = states.depth
    lasts = np.diff(walk.t[index], prepend=0.0)[:, None, None]  # s, of the time that a sample stands for
    size = lasts * np.linalg.norm(states.force, axis=-1)
    speed = np.linalg.norm(states.velocity, axis=-1)
    vn = np.sum(states.normal * states.velocity, axis=-1)
    power = lasts * np.abs(states.power)
    counted = [effect for effect in walk.scene.effects if effect.is_inertia]
    pushes = laws(counted or [kind() for kind in EFFECTS.values() if kind.is_inertia]).pushes
    inertia = lasts * effects.push(pushes, vn, depth) * states.area
    walker = getattr(walk.scene, "walker", None)  # of a robot no leg is known
    slender = float(np.ptp(walk.foot.contour[:, 0])) / (walker.l1 + walker.l2) if walker else math.nan
    total_force, total_power = max(size.sum(), 1e-300), max(power.sum(), 1e-300)
    trailing, sinks = power[vn < 0].sum(), 0.0 if walk.scene.holds else creep_while_standing(walk)
    rows = (  # the value, its unit, and its limit
        (float(depth.max()), "m", walk.foot.width),
        (ankle_depth(walk), "m", 0.0),
        (float((size * speed).sum() / total_force), "m/s", 0.5),
        (float(inertia.sum() / total_force), "", math.inf if counted else 0.05),
        (float(trailing / total_power), "", 0.2),
        (sinks, "m", 1e-3),
        (-walk.scene.sand.stress_map.dissipation(), "N/cm^3", 0.0),  # no error bound holds beyond it
        (slender, "", 0.8),  # from 0.1 to 0.5 of animals and robots
        (1.0 / slender, "", 20.0),
    )
    found = [Diagnostic(name, *row, why) for (name, why), row in zip(WHY.items(), rows, strict=True)]
    return [d for d in found if d.outside or d.name not in RARE]
