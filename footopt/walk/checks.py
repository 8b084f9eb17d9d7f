"""Checks of a walk: is it inside what resistive force theory has been tested for, and do its balances hold?

RFT's growth of stress with depth is tested to about one plate width, its rate independence for slow
motion, and, as in the paper, faces that trail (n.v < 0) are counted like those that lead, unless the
scene names the leading edge.
"""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from footopt.arrays import Ints
from footopt.effects import EFFECTS, laws
from footopt.effects import base as effects
from footopt.foot import Foot
from footopt.sand import StressMap
from footopt.sand.law import power_taken
from footopt.walk.objectives import floors, measure, shortest
from footopt.walk.results import Walk

SAMPLES = 600  # instants of the walk that are looked at
NOISE = 3e-5  # of a walk's largest power; 1.3e-5 is the most in hard cases, as a foot leaves the sand

#: Names of the diagnostics, and why a value above the limit is doubtful.
WHY = {
    "depth of the sole": "the law's growth with depth is tested to about one plate width",
    "depth of the ankle": "only the sole feels the sand, not the leg; a higher foot.ankle raises it",
    "force-weighted plate speed": "the law is tested for slow motion; effects=inertia may matter",
    "inertial share of the force": "the sand's inertia is left out; effects=inertia counts it",
    "share of |W| on trailing faces":
        "faces that trail are counted as in the paper; effects=leading_edge leaves them out",
    "sinking while standing": "the smoothed law lets a walker that stands sink; effects=rest holds it",
    "power that the sand gives":
        "such a sand pushes plates along, and a walk's end may hang on the accuracy; see sand.coefficients",
    "length of the sole over the body's height": "lengths are in m, and foot.L is half of the sole's",
    "height of the body over the sole's length": "lengths are in m, those of legs, too",
    "pitch of the more level foot at the start":
        "z of a foot's body is up where its sole is level; put a body with such axes into it, and name that",
    "floor of J_W over what is below it":
        "J_W counts no less than 1 J, 1 W and 0.001 m/s of a human on the Earth; "
        "a later scene.t_f may be fairer",
}  # fmt: skip
RARE = tuple(WHY)[5:]  # reported only where they are beyond their limit


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
    """Indices of the instants of a walk at which plates are evaluated."""
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
    force, v = states.force, states.velocity
    size, speed = lasts * np.sqrt(np.vecdot(force, force)), np.sqrt(np.vecdot(v, v))
    vn = np.vecdot(states.normal, v)
    power = lasts * np.abs(states.power)
    counted = [effect for effect in walk.scene.effects if effect.is_inertia]
    pushes = laws(counted or [kind() for kind in EFFECTS.values() if kind.is_inertia]).pushes
    inertia = lasts * effects.push(pushes, vn, depth) * states.area
    slender = float(np.ptp(walk.foot.contour[:, 0]) / walk.start[1])
    least = floors(walk.scene).items()
    floored = max(floor / max(walk.totals.get(name, floor), 1e-300) for name, floor in least)
    total_force, total_power = max(size.sum(), 1e-300), max(power.sum(), 1e-300)
    trailing = power[vn < 0].sum()
    stood = 0.0 if walk.scene.holds else float(min(walk.scene.gait.start, walk.t[-1]))
    sinks = 1.5 * sinking_speed(walk, stood) * stood if stood > 0.0 else 0.0  # integral of the speed
    # a walker that stands does no work to speak of, but may creep
    moves = len(walk.scene.strikes) > 0 if walk.scene.gait else np.ptp(walk.com[:, 0]) > shortest(walk.scene)
    rows = (  # the value, its unit, and its limit
        (walk.totals.get("maximum_sinkage", float(depth.max())), "m", walk.foot.width),
        (ankle_depth(walk), "m", 0.0),
        (float((size * speed).sum() / total_force), "m/s", 0.5),
        (float(inertia.sum() / total_force), "", math.inf if counted else 0.05),
        (float(trailing / total_power) if moves else 0.0, "", 0.2),
        (sinks, "m", shortest(walk.scene)),
        (-walk.scene.sand.stress_map.dissipation(), "N/cm^3", 0.0),  # no error bound holds beyond it
        (slender, "", 0.8),  # from 0.1 to 0.5 of animals and robots
        (1.0 / slender, "", 20.0),
        (float(np.degrees(np.abs(walk.pitch(walk.t[:1])).min())), "deg", 10.0),
        (floored if walk.feasible and moves else 0.0, "", 1.0),
    )
    found = [Diagnostic(name, *row, why) for (name, why), row in zip(WHY.items(), rows, strict=True)]
    return [d for d in found if d.outside or d.name not in RARE]


def energy_gap(walk: Walk) -> float:
    """The gap in a walk's energy balance, over the work of the sand.

    |d(kinetic + potential) - work of the sand - net work of the joints| / |work of the sand|, where both
    works are the stepper's own quadrature.
    """
    walker = walk.scene.walker
    kinetic = 0.5 * walker.mass * float(np.sum(walk.velocity[-1] ** 2))
    tilt, g = walk.scene.gravity
    x, z = (walk.com[-1] - walk.start).tolist()
    potential = float(walker.mass * (g * z - tilt * x))
    sand = float(walk.work[-1].sum())
    gap = abs(kinetic + potential - sand - walk.totals["net_joint_work"])
    return float(gap / max(abs(sand), 1e-300))


def power_from_sand(walk: Walk, samples: int = 64) -> float:
    """Largest power that a foot gets from the sand, over its plates' forces times the speed of smoothing.

    Less than `NOISE` of the largest power of the walk is none: forces are known to the square of Newton's
    last step, and at an instant of rest that is more than smoothing gives.
    """
    found, noise = 0.0, NOISE * float(np.abs(walk.power).max(initial=0.0))
    for foot in range(2):
        power = walk.power[:, foot]
        largest = np.argsort(power)[-samples:]
        largest = largest[power[largest] > noise]
        if len(largest):
            plates = walk.plates(largest)
            sizes = np.linalg.norm(plates.force[:, foot], axis=-1).sum(axis=-1)
            found = max(found, float(np.max(power[largest] / (sizes * plates.transition_speed[:, foot]))))
    return found


@cache
def smoothing_power(stress_map: StressMap) -> float:
    """Bound of `power_from_sand` that smoothing allows: 1.1 for the generic stress map.

    A plate that moves at s along e feels a - q M e with q = s / sqrt(s^2 + eps^2), and gets power only
    while q < q0 = (a.e) / (e.M e): at speeds below eps q0 / sqrt(1 - q0^2). q0 < 1 wherever the law
    dissipates; elsewhere there is no bound (inf).
    """
    beta, gamma = np.meshgrid(np.linspace(-np.pi / 2, np.pi / 2, 361), np.linspace(-np.pi, np.pi, 721))
    there, back = (power_taken(beta, gamma + turn, stress_map) for turn in (0.0, np.pi))
    q0 = float(np.max((back - there) / (back + there)))
    return q0 / math.sqrt(1.0 - q0 * q0) if q0 < 1.0 else math.inf


def sinking_speed(walk: Walk, t: float) -> float:
    """Speed at which smoothing lets a flat sole sink at a time t (s) of standing, m/s.

    The sand carries the weight at the depth d_0 with h = 1, and a little deeper, by a share s, with
    3/8 + 5/8 h = 1 / (1 + s): a speed eps (5 / 16 s)^(1/2) that falls as ds/dt = v / d_0 goes on, to
    eps (5 d_0 / (24 eps t))^(1/3). Where that is below eps, eps.
    """
    eps, depth = walk.accuracy.creep, walk.totals["maximum_sinkage"]
    return float(eps * max(1.0, (5.0 * depth / (24.0 * eps * t)) ** (1.0 / 3.0)))
