"""A sole's hull, and the closed outline that it is made by: vertical sides, a flat top, a mounting block."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from footopt.errors import SettingError, check
from footopt.files.drawings import MM
from footopt.files.soles.lines import SAME, crossing
from footopt.foot.waypoints import check_top

Array = NDArray[np.float64]

WALL = 2e-3  # least material above a sole's hump, m: a body must not fall in two


def closed_contour(sole: Array, top: float) -> Array:
    """Close a sole (m, 2), m, with vertical sides and a flat top at z_p = `top`, m.

    The outline runs counter-clockwise from the heel and does not repeat its first point. A sole that reaches
    higher than the top raises it. Raises `SettingError` if sole and top enclose nothing.
    """
    from shapely import LinearRing, Polygon

    check_top(top)
    level = max(top, float(sole[:, 1].max()))
    corners = np.array([[sole[-1, 0], level], [sole[0, 0], level]])
    # an end that is already at the top has no side above it; twin points upset a CAD program
    keep = [level - sole[end, 1] > SAME for end in (-1, 0)]
    outline = np.concatenate([sole, corners[keep]])
    check(
        len(outline) > 2 and Polygon(outline).area > SAME and LinearRing(outline).is_ccw,
        "foot.top",
        top,
        "above the sole, so that the outline encloses an area",
        f"The sole's highest point is at {sole[:, 1].max():g} m.",
    )
    return outline


def body_outline(sole: Array, top: float, ankle_x: float, block: Sequence[float] | None = None) -> Array:
    """The outline of the body that is made: a closed contour in one piece, with a mounting block.

    `block` is the length and height (m) of a rectangle on the top, its middle above `ankle_x`, m. Where a
    hump of the sole comes nearer to the top than `WALL`, the top is raised to that distance, because the
    body would fall in two there. Raises `SettingError` if the block does not fit on the top, or the outline
    crosses itself.
    """
    given, hump = top, sole[1:-1, 1].max(initial=-np.inf)
    if hump > max(sole[0, 1], sole[-1, 1]) - SAME:
        top = max(top, hump + WALL)
    outline = closed_contour(sole, top)
    if block is not None:
        level = outline[:, 1].max()
        corners = _block(sole[0, 0], sole[-1, 0], level, ankle_x, block)
        outline = np.concatenate([sole, [(sole[-1, 0], level)], corners, [(sole[0, 0], level)]])
        # a corner of the block may be one of the top, and the top the sole's own end
        outline = outline[np.linalg.norm(outline - np.roll(outline, 1, axis=0), axis=1) > SAME]
    place = crossing(outline, closed=True)
    if place is not None:
        x, z = MM * place
        raise SettingError(
            "foot.top",
            given,
            "such that the sole, two vertical sides and the top do not cross",
            f"They meet at x {x:.2f}, z {z:.2f} mm: the sole overhangs, or crosses itself there.",
        )
    return outline


def _block(heel: float, toe: float, level: float, middle: float, block: Sequence[float]) -> Array:
    """The corners of a block on a top at `level` (m) from toe to heel, (4, 2), m."""
    check(
        len(block) == 2 and all(0 < size < np.inf for size in block),
        "foot.block",
        list(block),
        "a length and a height > 0, in m, or null",
    )
    length, height = block
    check(
        heel - SAME <= middle - length / 2 and middle + length / 2 <= toe + SAME,
        "foot.block",
        list(block),
        f"on the top, which reaches from {MM * heel:g} to {MM * toe:g} mm",
        f"Its middle is above the ankle, at {MM * middle:g} mm; length and height are in m.",
    )
    ahead, behind, high = middle + length / 2, middle - length / 2, level + height
    return np.array([(ahead, level), (ahead, high), (behind, high), (behind, level)])


def lower_hull(contour: Array) -> tuple[Array, float, float, float]:
    """Lower convex hull of a sole (m, 2), m, and where the sole is farthest above it.

    Returns the hull from heel to toe, x where the gap is largest, and the heights of hull and sole there.
    """
    hull: list[Array] = []
    for p in contour[np.lexsort((contour[:, 1], contour[:, 0]))]:  # Andrew's monotone chain
        while len(hull) >= 2:
            (ax, az), (bx, bz) = hull[-1] - hull[-2], p - hull[-2]
            if ax * bz - az * bx > 0.0:
                break
            hull.pop()
        hull.append(p)
    corners = np.array(hull)
    left, right = corners[0, 0], corners[-1, 0]
    margin = 1e-9 * (right - left)
    inner = contour[(contour[:, 0] > left + margin) & (contour[:, 0] < right - margin)]
    # a vertical side at an end is part of the chain, but has no inside
    flat = corners[np.concatenate([[True], np.diff(corners[:, 0]) > 0.0])]
    if len(inner) == 0:  # nothing between the ends but the straight hull itself
        inner = flat.mean(axis=0, keepdims=True)
    floor = np.interp(inner[:, 0], flat[:, 0], flat[:, 1])
    i = int(np.argmax(inner[:, 1] - floor))
    return flat, float(inner[i, 0]), float(floor[i]), float(inner[i, 1])


def hollow(contour: Array) -> float:
    """Largest gap, along z_p, between a sole (m, 2), m, and its lower convex hull, m.

    0 for a convex sole; the depth of the hollow for one that touches ground at heel and toe only. Points on
    the contour's vertical sides do not count.
    """
    _, _, low, high = lower_hull(contour)
    return max(high - low, 0.0)
