"""The closed outline by which a foot is made: its sole, vertical sides, a flat top, a mounting block."""

from collections.abc import Sequence

import numpy as np

from footopt.arrays import Array
from footopt.errors import check
from footopt.foot import Foot

MM = 1e3  # millimetres in a metre
SAME_POINT = 1e-9  # m; points nearer than this are one: twins upset a CAD program
MIN_WALL = 2e-3  # least material above a sole's hump, m: a body must not fall in two


def closed_contour(sole: Array, top: float) -> Array:
    """Close a sole (m, 2), m, with vertical sides and a flat top at z_p = `top`, m.

    The outline runs counter-clockwise from the heel and does not repeat its first point. A sole that reaches
    higher than the top raises it. Raises `SettingError` if sole and top enclose nothing.
    """
    from shapely import LinearRing, Polygon

    level = max(top, float(sole[:, 1].max()))
    outline: Array = np.array([*sole, (sole[-1, 0], level), (sole[0, 0], level)])
    outline = outline[np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1) > SAME_POINT]
    encloses = len(outline) > 2 and Polygon(outline).area > SAME_POINT and LinearRing(outline).is_ccw
    hint = f"The sole's highest point is at {sole[:, 1].max():g} m."
    check(encloses, "foot.top", top, "above the sole, so that the outline encloses an area", hint)
    return outline


def body_outline(foot: Foot, block: Sequence[float] | None = None) -> Array:
    """The closed outline that a workshop makes, in one piece.

    Where a hump of the sole comes nearer to the top than `MIN_WALL`, the top is raised to that distance,
    because the body would fall in two there.

    A block of some length and height, m, may stand on the top, its middle above the ankle. The outline
    (p, 2), m, runs counter-clockwise and does not repeat its first point. Raises `SettingError` if the block
    does not fit on the top, or if the outline crosses itself or encloses nothing.
    """
    from shapely import Polygon, box, get_coordinates, is_valid_reason
    from shapely.geometry.polygon import orient

    sole, top = foot.contour, foot.top
    heel, toe, hump = sole[0], sole[-1], sole[1:-1, 1].max(initial=-np.inf)
    if hump > max(heel[1], toe[1]) - SAME_POINT:
        top = max(top, hump + MIN_WALL)
    outline = closed_contour(sole, top)
    body = Polygon(outline)
    allowed = "such that the sole, two vertical sides and the top do not cross"
    where = f"The sole overhangs, or crosses itself: {is_valid_reason(body)}, in m."
    check(body.is_valid, "foot.top", foot.top, allowed, where)
    if block is None:
        return outline
    sizes = len(block) == 2 and all(0 < size < np.inf for size in block)
    check(sizes, "foot.block", list(block), "a length and a height > 0, in m, or null")
    (length, height), middle, level = block, foot.ankle[0], outline[:, 1].max()
    on_top = f"on the top, which reaches from {MM * heel[0]:g} to {MM * toe[0]:g} mm"
    fits = heel[0] - SAME_POINT <= middle - length / 2 and middle + length / 2 <= toe[0] + SAME_POINT
    hint = f"Its middle is above the ankle, at {MM * middle:g} mm; length and height are in m."
    check(fits, "foot.block", list(block), on_top, hint)
    body = body.union(box(middle - length / 2, level, middle + length / 2, level + height))
    around: Array = get_coordinates(orient(body).exterior)[:-1]
    return around
