"""A foot and a gait for each other, as a problem of pymoo.

`python examples/codesign.py` searches the best foot for the built-in gait, then foot and gait together, with
as many evaluations again, beginning with that foot. Four numbers of the gait join the heights of the
waypoints as whole numbers from 1 to K: the first and the last level are the ends of a range, the middle one
is the gait as it is given. No walk may be slower than that of the first foot: without that, a search slows
down, as speed is what costs. `python examples/codesign.py soft 100` takes soft sand and 100 generations.

The ranges are assumed for an adult, not measured. Danion et al. (Gait & Posture 18, 2003) had people walk
with stride times from 0.79 to 1.25 s and steps 22 % longer and shorter; an ankle bends from 20 deg down to
10 deg up (Perry, Gait Analysis, table 4.1). The search does not know what a gait costs the muscles.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.core.problem import Problem
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.operators.repair.rounding import RoundingRepair
from pymoo.optimize import minimize

import footopt as fo
from footopt.gait import Fourier

#: Lowest, own and highest value: stride time in s, the thigh's swing and the knee's bend as factors, the
#: foot's pitch in deg (+ toe up).
RANGES = {
    "stride_time": (0.98, 1.2, 1.38),
    "step": (0.9, 1.0, 1.1),
    "lift": (0.8, 1.0, 1.2),
    "pitch": (-20.0, 0.0, 10.0),
}
SLACK = 2e-3  # of the distance that is asked for: the error of a walk at accuracy standard

Ints = NDArray[np.int64]


def genes(levels: Ints, K: int) -> dict[str, float]:
    """Values of the gait's numbers for their levels, 1 to K."""
    at = (1, (K + 1) // 2, K)
    return {
        name: float(np.interp(k, at, ends)) for (name, ends), k in zip(RANGES.items(), levels, strict=True)
    }


def varied(gait: fo.Gait, values: dict[str, float]) -> fo.Gait:
    """The gait with other values; with its own it is the same to rounding."""
    bend = float(np.degrees(gait.knee.at(np.arange(200) / 200)[0]).min())  # of the knee, its least
    thigh = scaled(gait.thigh, values["step"], gait.thigh.a0)
    knee = scaled(gait.knee, values["lift"], bend)
    shank = Fourier(  # the foot's pitch in the paper
        thigh.a0 - knee.a0,
        tuple(np.subtract(thigh.a, knee.a).tolist()),
        tuple(np.subtract(thigh.b, knee.b).tolist()),
    )
    foot = shank._replace(a0=shank.a0 + values["pitch"])
    return replace(gait, thigh=thigh, knee=knee, foot=foot, pitch="measured", period=values["stride_time"])


def scaled(angle: Fourier, factor: float, about: float) -> Fourier:
    """An angle's distance from a value times a factor, deg."""
    a, b = (tuple((factor * np.array(c)).tolist()) for c in (angle.a, angle.b))
    return Fourier(about + factor * (angle.a0 - about), a, b)


class FootAndGait(Problem):  # type: ignore[misc]  # pymoo has no types
    """Heights of a sole's waypoints, then a level for each of RANGES: J_W, at a distance or more."""

    def __init__(self, scene: fo.Scene, space: fo.Waypoints, accuracy: str, distance: float) -> None:
        super().__init__(n_var=space.n + 4, n_obj=1, n_ieq_constr=3, xl=1, xu=space.K, vtype=int)
        # all walks last as long, whatever the stride's time
        self.scene, self.space = replace(scene, t_f=scene.duration), space
        self.accuracy, self.distance = accuracy, distance

    def _evaluate(self, x: Ints, out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
        levels, inverse = np.unique(x[:, self.space.n :], axis=0, return_inverse=True)
        values = np.empty((len(x), 2))
        for number, one in enumerate(levels):  # the soles of one gait together
            rows = np.flatnonzero(inverse.ravel() == number)
            scene = replace(self.scene, gait=varied(self.scene.gait, genes(one, self.space.K)))
            soles, names = x[rows, : self.space.n], ("efficiency", "distance")
            values[rows] = fo.evaluate(soles, scene, self.accuracy, names, self.space).values
        outside = self.space.box_violation(x[:, : self.space.n]) / self.space.H - self.space.box_tolerance
        failed = np.isnan(values).any(axis=1)
        f, distance = np.where(failed[:, None], [0.0, 0.0], values).T
        out["F"], out["G"] = f, np.stack([outside, np.where(failed, 1.0, -1.0), self.distance - distance], 1)


def together(problem: FootAndGait, foot: Ints, generations: int, seed: int = 1) -> Any:
    """Search foot and gait, beginning with a foot (n,) and the gait as it is given; pymoo's result."""
    space, rng = problem.space, np.random.default_rng(seed)
    first = rng.integers(1, space.K + 1, (100, problem.n_var))
    first[:50, : space.n] = foot
    first[0, space.n :] = (space.K + 1) // 2
    repair = RoundingRepair()
    algorithm = GA(100, sampling=first, crossover=SBX(repair=repair), mutation=PM(repair=repair))
    return minimize(problem, algorithm, ("n_gen", generations), seed=seed)


if __name__ == "__main__":
    sand = sys.argv[1] if len(sys.argv) > 1 else "hard"
    generations = int(sys.argv[2]) if len(sys.argv) > 2 else 40
    scene = fo.Scene(sand=fo.Sand.named(sand))
    alone = fo.search(fo.FootProblem(scene), walks=100 * generations)
    before, reached = alone.column("efficiency")[alone.best], alone.column("distance")[alone.best]
    problem = FootAndGait(scene, fo.Waypoints(), "standard", (1.0 - SLACK) * reached)
    found = together(problem, alone.k[alone.best], generations)
    k, after = found.X[:11].tolist(), float(found.F[0])
    print(f"{sand} sand, J_W: the foot alone {before:.3g}, together {after:.3g} (x {after / before:.2f})")
    print(f"k = {k}", *(f"{n} {v:.3g}" for n, v in genes(found.X[11:], 10).items()), sep=", ")
    if generations < 40:
        print(f"Only {100 * generations} evaluations of each search: more generations may change the answer.")
