"""The closed outline by which a foot is made: its sole, vertical sides, a flat top, a mounting block."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from footopt.errors import SettingError, check
from footopt.files.drawings import MM
from footopt.files.soles.lines import SAME, crossing
from footopt.foot import Foot

Array = NDArray[np.float64]

WALL = 2e-3  # least material above a sole's hump, m: a body must not fall in two


def closed_contour(sole: Array, top: float) -> Array:
    """Close a sole (m, 2), m, with vertical sides and a flat top at z_p = `top`, m.

    The outline runs counter-clockwise from the heel and does not repeat its first point. A sole that reaches
    higher than the top raises it. Raises `SettingError` if sole and top enclose nothing.
    """
    from shapely import LinearRing, Polygon

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


def body_outline(foot: Foot, block: Sequence[float] | None = None) -> Array:
    """The closed outline that a workshop makes, in one piece.

    Where a hump of the sole comes nearer to the top than `WALL`, the top is raised to that distance, because
    the body would fall in two there.

    Parameters
    ----------
    foot : Foot
        Its sole, top and ankle.
    block : (2,), m, optional
        Length and height of a mounting block on the top, its middle above the ankle.

    Returns
    -------
    outline : (p, 2), m
        Counter-clockwise from the heel; the first point is not repeated at the end.

    Raises
    ------
    SettingError
        The block does not fit on the top, or the outline crosses itself or encloses nothing.
    """
    sole, top = foot.contour, foot.top
    hump = sole[1:-1, 1].max(initial=-np.inf)
    if hump > max(sole[0, 1], sole[-1, 1]) - SAME:
        top = max(top, hump + WALL)
    outline = closed_contour(sole, top)
    if block is not None:
        level = outline[:, 1].max()
        corners = _block(sole[0, 0], sole[-1, 0], level, foot.ankle[0], block)
        outline = np.concatenate([sole, [(sole[-1, 0], level)], corners, [(sole[0, 0], level)]])
        # a corner of the block may be one of the top, and the top the sole's own end
        outline = outline[np.linalg.norm(outline - np.roll(outline, 1, axis=0), axis=1) > SAME]
    place = crossing(outline, closed=True)
    if place is not None:
        x, z = MM * place
        raise SettingError(
            "foot.top",
            foot.top,
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
