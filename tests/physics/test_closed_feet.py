"""Feet whose contour is closed: the plates of sides and top, and what they do in the sand."""

from dataclasses import replace

import numpy as np
import pytest
from shapely import Polygon

import footopt as fo
from footopt.files.feet import closed_contour
from footopt.foot import as_feet, as_plates

K = (5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4)
SHADES = fo.Shadowing()


def test_the_plates_run_once_around():
    foot = fo.Foot.from_waypoints(K, closed=True, top=0.02)
    plates = foot.plates(64)
    outline = closed_contour(foot.contour, foot.top)
    loop = np.linalg.norm(np.diff(outline, axis=0, append=outline[:1]), axis=1).sum()
    assert plates.area.sum() == pytest.approx(loop * foot.width, rel=1e-3)
    # the divergence theorem: the sum of normals is zero, and x n_x is the area
    normal = np.stack([plates.tz[0], -plates.tx[0]])
    assert (normal * plates.area).sum(axis=1) == pytest.approx([0.0, 0.0], abs=1e-5)
    enclosed = (plates.x * normal[0] * plates.area).sum() / foot.width
    assert enclosed == pytest.approx(Polygon(outline).area, rel=5e-3)


def test_the_sole_comes_first_and_is_the_open_one():
    open_, closed = (fo.Foot.from_waypoints(K, closed=c).plates(40) for c in (False, True))
    np.testing.assert_array_equal(closed.x[:, :40], open_.x)
    assert closed.x.shape[1] == 40 + 5 + 20 + 5


def test_a_side_of_no_length_has_no_area_and_is_finite():
    plates = fo.Foot.shape("circle", closed=True).plates(40, fill=SHADES.reshape)
    assert all(np.isfinite(column).all() for column in plates)
    assert plates.area.min() == pytest.approx(0.0, abs=1e-20)


def test_a_population_and_a_foot_have_the_same_plates():
    space = fo.Waypoints(closed=True, top=0.01)
    alone = fo.Foot.from_waypoints(K, space).plates(48, fill=SHADES.reshape)
    for a, b in zip(as_plates(as_feet([K, K], space), 48, "arc", fill=SHADES.reshape), alone, strict=True):
        np.testing.assert_array_equal(a[1], b[0])


def test_sides_and_top_carry_where_they_are_in_the_sand(flat_foot):
    """On soft sand the whole foot is, and the top holds it down when it is lifted."""
    scene = fo.Scene(sand=fo.Sand.named("soft"), effects=(fo.LeadingEdge(),))
    open_, closed = (fo.simulate(replace(flat_foot, closed=c), scene, "draft") for c in (False, True))
    assert open_.force[:, :, 1].min() > -10.0  # steep parts of the sole alone
    assert closed.force[:, :, 1].min() < -30.0
    assert closed.objectives["work"] > open_.objectives["work"]
