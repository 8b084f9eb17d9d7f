"""`CoDesign`: a foot and four numbers of the gait, searched together as whole numbers."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from footopt.design.problem import Array, FootProblem, Ints, Words
from footopt.errors import check
from footopt.foot import Foot, Waypoints
from footopt.gait.genes import GENES, values_of, varied
from footopt.walk.scene import Scene
from footopt.walk.simulate import at_once, evaluate


@dataclass(frozen=True)
class FootAndGait(Waypoints):
    """A space of soles and gaits: n whole numbers from 1 to K, of which the last four are `GENES`.

    Parameters are those of `Waypoints`; n has the genes, too.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        check(self.K >= 3, "foot.K", self.K, "3 or more, for a gait's own value between its limits")

    @classmethod
    def of(cls, space: Waypoints) -> FootAndGait:
        """Of the soles of a space."""
        return cls(**_settings(space) | {"n": space.n + len(GENES)})

    @property
    def feet(self) -> Waypoints:
        """The space of soles alone."""
        return Waypoints(**_settings(self) | {"n": self.n - len(GENES)})

    @property
    def own(self) -> tuple[int, ...]:
        """The genes of a gait as it is given."""
        return ((self.K + 1) // 2,) * len(GENES)

    @property
    def x(self) -> Array:
        """The waypoints' x_p, m."""
        return self.feet.x

    def heights(self, k: ArrayLike) -> Array:
        """z_p of the waypoints, m."""
        return self.feet.heights(self.check(k)[:, : -len(GENES)])

    def contour(self, k: ArrayLike) -> Array:
        """The soles as dense polylines, m."""
        return self.feet.contour(self.check(k)[:, : -len(GENES)])

    def points(self, k: ArrayLike, steps: int) -> Array:
        """Points on the splines at equal steps along their arcs, m."""
        return self.feet.points(self.check(k)[:, : -len(GENES)], steps)


def _settings(space: Waypoints) -> dict[str, Any]:
    return {field.name: getattr(space, field.name) for field in fields(Waypoints)}


class CoDesign(FootProblem):
    """Find a foot and a gait together: heights of waypoints, and levels of `footopt.gait.genes.GENES`.

    All walks last as long as that with the gait as it is given, so that a slower stride has no fewer seconds
    to lose. A speed is asked for by a limit of distance.

    Parameters
    ----------
    scene : Scene
        With the gait that is varied.
    space : Waypoints
        Of the soles; the problem's own space is `FootAndGait` of it.
    **asked
        objective, accuracy, threads, limits and choose of `FootProblem`.
    """

    space: FootAndGait

    def __init__(self, scene: Scene | None = None, space: Waypoints | None = None, **asked: Any) -> None:
        scene = Scene() if scene is None else scene
        lasting, both = replace(scene, t_f=scene.duration), FootAndGait.of(space or Waypoints())
        super().__init__(lasting, space=both, **asked)

    def scene_of(self, k: Ints) -> Scene:
        """The scene with the gait of a design (n,)."""
        levels = tuple(int(level) for level in k[-len(GENES) :])
        values = values_of(self.scene.gait, levels, self.space.K)
        return replace(self.scene, gait=varied(self.scene.gait, values))

    def foot_of(self, k: Ints) -> Foot:
        """The foot of a design (n,)."""
        return Foot.from_waypoints(k[: -len(GENES)].tolist(), self.space.feet)

    def walk(self, k: Ints) -> tuple[Array, Words]:
        """Walk with designs (designs, n), those of one gait together."""
        feet = self.space.feet
        _, first, gaits = np.unique(k[:, -len(GENES) :], axis=0, return_index=True, return_inverse=True)
        values = np.empty((len(k), len(self.record)))
        reasons = np.empty(len(k), dtype=object)

        def of_gait(number: int) -> None:
            rows = np.flatnonzero(gaits.ravel() == number)
            scene, soles = self.scene_of(k[first[number]]), k[rows, : -len(GENES)]
            table = evaluate(soles, scene, self.accuracy, self.record, feet, threads=1)
            values[rows], reasons[rows] = table.values, table.reasons

        with ThreadPoolExecutor(at_once(self.threads)) as pool:
            list(pool.map(of_gait, range(len(first))))
        return values, reasons.astype(np.str_)


def speed(distance: float, scene: Scene) -> float:
    """Mean forward speed from the start of the gait to the end of the walk, m/s."""
    return distance / (scene.duration - scene.gait.start)


def shares(alone: float, foot: float, gait: float, both: float) -> tuple[float, float]:
    """What the foot and what the gait did of a gain, ln(both / alone): they sum to it.

    Each is the mean of what the change is worth before and after the other (the value of Shapley 1953).

    Parameters
    ----------
    alone, foot, gait, both : float
        Of an objective of one sign: before, with the other foot, with the other gait, with both.
    """
    if not all(math.isfinite(v) and v * alone > 0.0 for v in (alone, foot, gait, both)):
        return math.nan, math.nan
    by_foot = 0.5 * (math.log(foot / alone) + math.log(both / gait))
    return by_foot, math.log(both / alone) - by_foot
