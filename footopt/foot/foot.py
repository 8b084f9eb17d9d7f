"""`Foot`, one sole, and how soles become plates."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from footopt.arrays import Array, Ints
from footopt.effects.base import Reshape
from footopt.effects.hull import filled
from footopt.errors import check, check_whole
from footopt.foot.plates import RULES, Plates, along_arc, numbered
from footopt.foot.shapes import SHAPES
from footopt.foot.waypoints import Waypoints, as_space, check_dimensions, check_length, heights_text


@dataclass(frozen=True, eq=False, repr=False)
class Foot:
    """A sole in the foot frame: origin at the centre of the foot's box, x_p to the toe, z_p up.

    Make one with `from_waypoints` or `shape`, or read one with `footopt.read_foot`.

    Parameters
    ----------
    contour : (m, 2), m
        A dense polyline from heel to toe, with the sand below it.
    width : float, m
        Of the sole.
    ankle : (2,), m
        Place of the ankle in the foot frame.
    name : str
        For legends.
    k : (n,), optional
        The waypoints' heights, if that is where the sole comes from.
    space : Waypoints, optional
        Their design space.
    closed : bool
        Whether the sides and the top feel the sand too, or only the sole.
    top : float, m
        z_p of the flat top.
    notes : tuple of str
        Parts of its file that were left out.

    Raises
    ------
    SettingError
        The contour has fewer than two points, or a value is not finite or out of range.
    """

    contour: Array
    width: float = 0.10
    ankle: tuple[float, float] = (0.0, 0.0)
    name: str = "foot"
    k: tuple[int, ...] | None = None
    space: Waypoints | None = None
    closed: bool = False
    top: float = 0.0
    notes: tuple[str, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        contour = np.array(self.contour, float, order="C")  # the caller's own may change later
        contour.flags.writeable = False
        points = contour.ndim == 2 and contour.shape[1] == 2 and len(contour) >= 2
        allowed = "at least two points (x_p, z_p) from -10 to 10, in m"
        given = np.array2string(contour, threshold=6, separator=", ")
        check(points and (np.abs(contour) <= 10.0).all(), "foot.contour", given, allowed)
        ahead = contour[0, 0] <= contour[-1, 0] + 1e-9 and (contour != contour[0]).any()
        check(ahead, "foot.contour", given, "a line from heel to toe: its last x_p is not the smaller one")
        check_dimensions(self.width, self.ankle, self.top, self.closed)
        object.__setattr__(self, "ankle", tuple(self.ankle))
        object.__setattr__(self, "contour", contour)
        if self.space is not None and self.k is not None:  # of a foot that `replace` has changed, too
            object.__setattr__(self, "k", tuple(self.space.check(self.k)[0].tolist()))
            own = {name: getattr(self, name) for name in ("width", "ankle", "closed", "top")}
            space, drawn = replace(self.space, **own), self.space.contour(self.k)[0]
            there = contour.shape == drawn.shape and np.allclose(contour, drawn, rtol=0, atol=1e-9)
            for name, value in {"k": self.k, "space": space}.items():
                object.__setattr__(self, name, value if there else None)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Foot) and self._geometry() == other._geometry()

    def __hash__(self) -> int:
        return hash(self._geometry())

    def _geometry(self) -> tuple[Any, ...]:
        """All that a walk depends on, so that a foot that is read again equals the one that was written."""
        return self.contour.tobytes(), self.width, self.ankle, self.k, self.space, self.closed, self.top

    def __repr__(self) -> str:
        long, high = 1e3 * np.ptp(self.contour, axis=0)
        return f"<Foot {self.name}: {long:.1f} x {high:.1f} mm, hollow {1e3 * self.hollow:.1f} mm>"

    @classmethod
    def from_waypoints(
        cls, k: Sequence[int] | Array, space: Waypoints | None = None, **parameters: Any
    ) -> Self:
        """Make a sole through waypoints.

        Parameters
        ----------
        k : (n,)
            The waypoints' heights, whole numbers from 1 (high) to K (low).
        space : Waypoints, optional
            The design space; by default the paper's, with n = len(k).
        **parameters
            Other values of the space: K, L, H, width, ankle, box_tolerance, closed or top.

        Raises
        ------
        SettingError
            A height is not in the space.
        """
        check(np.ndim(k) == 1, "foot.k", k, "one design: a list of whole numbers")
        space = replace(as_space(space, np.size(k)), **parameters)
        heights = tuple(int(v) for v in space.check(k)[0])
        contour, name = space.contour(heights)[0], f"k={heights_text(heights)}"
        return cls(contour, space.width, space.ankle, name, heights, space, space.closed, space.top)

    @classmethod
    def flat(cls, space: Waypoints | None = None) -> Self:
        """Make the flat sole at the bottom of the box (k = K everywhere), with which feet are compared."""
        space = as_space(space)
        return replace(cls.from_waypoints([space.K] * space.n, space), name="flat")

    @classmethod
    def shape(cls, name: str, length: float = 0.26, **parameters: Any) -> Self:
        """Make one of the paper's five shapes (Fig. 3).

        Parameters
        ----------
        name : {"ellipse", "rectangle", "circle", "reversed_l", "reversed_triangle"}
            The shape.
        length : float, m
            Of the contact line.
        **parameters
            ``width``, ``ankle``, ``closed`` and ``top`` as of every `Foot`; ``upright`` of an L and ``apex``
            of a triangle (see `footopt.foot.shapes`).

        Raises
        ------
        SettingError
            There is no such shape, or a value is out of range.
        """
        check(name in SHAPES, "foot.shape", name, f"one of {', '.join(SHAPES)}")
        check_length("foot.length", length)
        options = {word: parameters.pop(word) for word in ("upright", "apex") if word in parameters}
        return cls(SHAPES[name](length, **options), name=name, **parameters)

    def points(self, steps: int) -> Array:
        """Points at equal steps along the sole's arc, (steps + 1, 2), m; a step ends at each corner.

        Those of a sole through waypoints are on its spline.
        """
        check_whole("steps", steps, 1, 10**6)
        return self._pieces(steps, 1)[0]

    def _pieces(self, plates: int, parts: int) -> tuple[Array, Ints]:
        """Points (m, 2), m, and the numbers of those where plates end, as `along_arc` gives them."""
        if self.space is not None and self.k is not None:
            return self.space.points(self.k, plates * parts)[0], np.arange(plates + 1) * parts
        return along_arc(self.contour, plates, parts)

    def plates(self, plates: int, rule: str = "arc", fill: Reshape | None = None) -> Plates:
        """Cut the sole into plates, (1, plates); see `as_plates`."""
        check(rule in RULES, "rule", rule, f"one of {', '.join(RULES)}")
        return as_plates([self], plates, rule, fill)

    @property
    def hollow(self) -> float:
        """Largest gap, along z_p, between the sole and its lower convex hull, m: 0 for a convex sole."""
        hull, i = lower_hull(self.contour)
        return float(self.contour[i, 1] - hull[i, 1])

    @property
    def box_violation(self) -> float | None:
        """How far a waypoint sole leaves its box, m; None for any other sole."""
        if self.space is None or self.k is None:
            return None
        return float(self.space.box_violation(self.k)[0])


def lower_hull(contour: Array) -> tuple[Array, int]:
    """A sole (m, 2), m, filled up to its lower convex hull, and its point that is farthest above that."""
    hull = filled(contour[None].copy(), 0.0)[0]  # compiled for arrays that can be written to
    return hull, int(np.argmax(contour[:, 1] - hull[:, 1]))


@dataclass(frozen=True, eq=False)
class Soles(Sequence[Foot]):
    """Soles through waypoints; an index makes one of them a `Foot`."""

    k: Array | Ints  # (designs, n), their heights
    space: Waypoints

    def __len__(self) -> int:
        return len(self.k)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return Soles(self.k[index], self.space)
        return Foot.from_waypoints(self.k[index], self.space)


def as_feet(feet: Any, space: Waypoints | None = None) -> Sequence[Foot]:
    """Feet as they are, one foot as a list of one, and heights of waypoints (designs, n) as `Soles`."""
    if isinstance(feet, Soles):
        return feet
    feet = [feet] if isinstance(feet, Foot) else feet
    if isinstance(feet, Sequence) and any(isinstance(foot, Foot) for foot in feet):
        check(all(isinstance(foot, Foot) for foot in feet), "feet", feet, "all Foot, or all waypoint heights")
        own = space is None or all(foot.space in (None, space) for foot in feet)
        check(own, "space", space, "that of the Foot objects, or None: each has its own")
        return feet
    try:
        heights = np.atleast_2d(np.asarray(feet))
    except ValueError:  # of different lengths
        heights = np.empty(0, object)
    allowed = "Foot, a list of these, or heights of waypoints (designs, n)"
    check(heights.ndim == 2 and heights.dtype.kind in "iuf", "feet", feet, allowed)
    return Soles(heights, as_space(space, heights.shape[1])) if heights.size else []


def as_plates(feet: Sequence[Foot], plates: int, rule: str, fill: Reshape | None = None) -> Plates:
    """The plates of feet.

    `fill` changes the soles before they are cut, as an effect does (`footopt.effects.reshaping`); the rest is
    as of `Plates.from_points`. Raises `SettingError` if there are open and closed ones among the feet.
    """
    bodies: Sequence[Foot | Waypoints] = feet
    if isinstance(feet, Soles):
        parts = RULES[rule]
        bodies, points = [feet.space], feet.space.points(feet.k, plates * parts)
        ends = parts * numbered(len(points), plates + 1)
    else:
        same = len({foot.closed for foot in feet}) == 1
        check(same, "foot.closed", "both in one batch", "the same for all feet of a batch")
        pieces = [foot._pieces(plates, RULES[rule]) for foot in feet]
        most, ends = max(len(line) for line, _ in pieces), np.stack([numbers for _, numbers in pieces])
        # a toe that is repeated has no area
        points = np.stack([np.pad(line, ((0, most - len(line)), (0, 0)), "edge") for line, _ in pieces])
    ankle, width, top = (np.array([getattr(b, n) for b in bodies], float) for n in ("ankle", "width", "top"))
    points = points if fill is None else fill(points)
    return Plates.from_points(points, ends, ankle, width, rule, top if bodies[0].closed else None)
