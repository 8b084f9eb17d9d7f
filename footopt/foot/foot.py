"""`Foot`: one sole, whatever it was made from."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from footopt.errors import check
from footopt.foot.plates import RULES, Plates, along_arc, hollow
from footopt.foot.shapes import shape
from footopt.foot.waypoints import Waypoints, check_ankle

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Foot:
    """A sole in the foot frame (origin at the centre of the foot's box, x_p to the toe, z_p up).

    Make one with `from_waypoints` or `shape`.

    Parameters
    ----------
    contour : (m, 2), m, a dense polyline from heel to toe with the sand below it.
    width : m. ankle : place of the ankle in the foot frame, m. name : for legends.
    k, space : the waypoint heights and their space, if that is where the sole comes from.
    """

    contour: Array
    width: float = 0.10
    ankle: tuple[float, float] = (0.0, 0.0)
    name: str = "foot"
    k: tuple[int, ...] | None = None
    space: Waypoints | None = None

    def __post_init__(self) -> None:
        contour = np.asarray(self.contour, float)
        check(
            contour.ndim == 2 and contour.shape[1] == 2 and len(contour) >= 2 and np.isfinite(contour).all(),
            "foot.contour",
            contour.shape,
            "at least two points (x_p, z_p), finite, in m",
        )
        check(0 < self.width < math.inf, "foot.width", self.width, "a length > 0, in m")
        check_ankle(self.ankle)
        object.__setattr__(self, "contour", contour)

    @classmethod
    def from_waypoints(
        cls, k: Sequence[int] | Array, space: Waypoints | None = None, **parameters: object
    ) -> Foot:
        """A sole through waypoints at the heights k.

        Parameters
        ----------
        k : (n,), whole numbers from 1 (high) to K (low)
        space : the design space; by default the paper's, with n = len(k) and `parameters`
            (K, L, H, width, ankle, box_tolerance).
        """
        check(np.ndim(k) == 1, "foot.k", k, "one design: a list of whole numbers")
        space = replace(space or Waypoints(n=len(k)), **parameters)  # type: ignore[arg-type]
        heights = tuple(int(v) for v in space.check(k)[0])
        name = "k " + "-".join(map(str, heights))
        return cls(space.contour(heights)[0], space.width, space.ankle, name, heights, space)

    @classmethod
    def flat(cls, space: Waypoints | None = None) -> Foot:
        """The flat sole at the bottom of the box (k = K everywhere): what a gain is measured from."""
        space = space or Waypoints()
        return replace(cls.from_waypoints([space.K] * space.n, space), name="flat")

    @classmethod
    def shape(
        cls,
        name: str,
        length: float = 0.26,
        width: float = 0.10,
        ankle: tuple[float, float] = (0.0, 0.0),
        **options: str,
    ) -> Foot:
        """One of the paper's five shapes by name (`footopt.foot.shapes`), with a contact length in m."""
        return cls(shape(name, length, **options), width, tuple(ankle), name)  # type: ignore[arg-type]

    def points(self, steps: int) -> Array:
        """Points at equal steps along the arc, (steps + 1, 2), m."""
        if self.space is not None and self.k is not None:
            points: Array = self.space.points(self.k, steps)[0]
            return points
        return along_arc(self.contour, steps)

    def plates(self, plates: int, rule: str = "arc", directed: bool = False) -> Plates:
        """The foot's plates, (1, plates); see `Plates.from_points`."""
        return stack_plates([self], plates, rule, directed)

    @property
    def hollow(self) -> float:
        """Largest gap between the sole and its lower convex hull, m (see `plates.hollow`)."""
        return hollow(self.contour)

    @property
    def box_violation(self) -> float | None:
        """How far a waypoint sole leaves its box, m; None for any other sole."""
        return None if self.space is None else float(self.space.box_violation(self.k)[0])  # type: ignore[arg-type]


def stack_plates(feet: Sequence[Foot], plates: int, rule: str = "arc", directed: bool = False) -> Plates:
    """The plates of many feet at once, (feet, plates)."""
    return Plates.from_points(
        np.stack([foot.points(plates * RULES[rule]) for foot in feet]),
        np.array([foot.ankle for foot in feet], float),
        np.array([foot.width for foot in feet], float),
        rule,
        directed,
    )


def as_plates(
    feet: Sequence[Foot] | Plates | ArrayLike,
    plates: int,
    rule: str,
    space: Waypoints | None,
    directed: bool = False,
) -> Plates:
    """Plates of feet, of plates (as they are), or of waypoint heights (designs, n) in `space`."""
    if isinstance(feet, Plates):
        return feet
    if isinstance(feet, Sequence) and any(isinstance(foot, Foot) for foot in feet):
        return stack_plates([foot for foot in feet if isinstance(foot, Foot)], plates, rule, directed)
    heights = np.atleast_2d(np.asarray(feet))
    return (space or Waypoints(n=heights.shape[-1])).plates(heights, plates, rule, directed)
