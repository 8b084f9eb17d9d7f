"""The paper's five shapes (its Fig. 3), all with the same contact length.

Each function takes the contact length (m) and returns the contact line as a polyline from heel to toe,
(m, 2), m, in the foot frame: the origin is the centre of the *whole* shape's bounding box. The paper's
drawings are not available; a choice that it leaves open is a parameter here.
"""

from collections.abc import Callable

import numpy as np

from footopt.arrays import Array
from footopt.errors import check

ARC = 2000  # chords of a curved contact line


def ellipse(length: float) -> Array:
    """Lower half of an ellipse with axes 2:1, the long one along the foot."""
    from scipy.special import ellipe

    a = length / (2.0 * float(ellipe(0.75)))  # half perimeter = 2 a E(m), m = 1 - (b/a)^2
    return _half_oval(a, a / 2.0)


def circle(length: float) -> Array:
    """Lower half of a circle."""
    return _half_oval(length / np.pi, length / np.pi)


def rectangle(length: float) -> Array:
    """Bottom side a of a rectangle with sides a:b = 2:1: the flat foot."""
    a, b = length, length / 2.0
    return np.array([[-a / 2, -b / 2], [a / 2, -b / 2]])


def reversed_l(length: float, upright: str = "toe") -> Array:
    """Bottom and upright side of an L with sides a:b = 2:1; the upright is at the toe or the heel."""
    check(upright in ("toe", "heel"), "foot.upright", upright, "one of toe, heel")
    a, b = length * 2.0 / 3.0, length / 3.0
    toe = np.array([[-a / 2, -b / 2], [a / 2, -b / 2], [a / 2, b / 2]])
    return toe if upright == "toe" else toe[::-1] * [-1.0, 1.0]


def reversed_triangle(length: float, apex: str = "middle") -> Array:
    """The two lower sides of a triangle on its apex, base a to height b = 2:1.

    The apex is under the middle of the base (both lower sides equal), or under the toe.
    """
    check(apex in ("middle", "toe"), "foot.apex", apex, "one of middle, toe")
    if apex == "middle":
        b = length / (2.0 * np.sqrt(2.0))
        return np.array([[-b, b / 2], [0.0, -b / 2], [b, b / 2]])
    b = length / (np.sqrt(5.0) + 1.0)
    return np.array([[-b, b / 2], [b, -b / 2], [b, b / 2]])


_ALL: tuple[Callable[..., Array], ...] = (ellipse, rectangle, circle, reversed_l, reversed_triangle)
SHAPES = {shape.__name__: shape for shape in _ALL}


def _half_oval(a: float, b: float) -> Array:
    """Lower half of an oval with half axes a, b, from heel to toe."""
    angle = np.linspace(np.pi, 2.0 * np.pi, ARC + 1)
    line = np.stack([a * np.cos(angle), b * np.sin(angle)], axis=1)
    line[0], line[-1] = (-a, 0.0), (a, 0.0)
    return line
