"""The closed outline that a foot is made by: its sole, vertical sides, a flat top and a mounting block."""

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
    """Close a sole with vertical sides and a flat top.

    Parameters
    ----------
    sole : (m, 2), m
        From heel to toe.
    top : float, m
        z_p of the flat top. A sole that reaches higher raises it to its own highest point.

    Returns
    -------
    outline : (p, 2), m
        Counter-clockwise from the heel; the first point is not repeated at the end.

    Raises
    ------
    SettingError
        The top is not finite, or encloses nothing with the sole.
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

    Where a hump of the sole comes nearer to the top than `WALL`, the top is raised to that distance,
    because the body would fall in two there.

    Parameters
    ----------
    sole : (m, 2), m
        From heel to toe.
    top : float, m
        z_p of the flat top.
    ankle_x : float, m
        x_p of the ankle; the block's middle is above it.
    block : (2,), m, optional
        Length and height of a rectangle on the top.

    Returns
    -------
    outline : (p, 2), m
        Counter-clockwise from the heel; the first point is not repeated at the end.

    Raises
    ------
    SettingError
        The block does not fit on the top, the outline crosses itself, or see `closed_contour`.
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
