"""Balances of a sound walk: its energy adds up, the sand gives none beyond what smoothing allows."""

import math
from functools import cache

import numpy as np

from footopt.sand import StressMap
from footopt.sand.law import power_taken
from footopt.walk.results import Walk

NOISE = 1e-5  # of a walk's largest power; 5e-6 is the most in 120 marches that set feet down at 2 to 4 m/s


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
            found = max(found, float(np.max(power[largest] / (sizes * plates.slip[:, foot]))))
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


def creep_while_standing(walk: Walk) -> float:
    """How far smoothing lets the walker sink before the gait starts, m: `sinking_speed` summed up."""
    t = float(min(walk.scene.gait.start, walk.t[-1]))
    return 1.5 * sinking_speed(walk, t) * t if t > 0.0 else 0.0
