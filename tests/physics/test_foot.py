"""The foot: a spline through waypoints, the paper's five shapes, and the plates they are cut into."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

import footopt as fo
from footopt.errors import SettingError
from footopt.foot import SHAPES, Soles, as_feet, as_plates
from footopt.foot.plates import RULES
from footopt.studies.simulate import flattened

SPACE = fo.Waypoints()
HEIGHTS = st.lists(st.integers(1, SPACE.K), min_size=SPACE.n, max_size=SPACE.n)
SMOOTH = [
    [2, 4, 6, 8, 9, 10, 9, 8, 6, 4, 2],
    [1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 8],
    [1, 3, 5, 6, 7, 8, 8, 8, 7, 6, 5],
    [10] * 11,
]


def reference_spline(space, k):
    """The same sole from scipy: z_p(x_p)."""
    x = np.linspace(-space.L, space.L, space.n)
    return CubicSpline(x, -np.asarray(k) * space.H / space.K, bc_type="not-a-knot")


def chords(points):
    return np.hypot(*np.diff(points, axis=0).T)


def scanned(seed, sides):
    """A line of so many sides with noise."""
    random = np.random.default_rng(seed)
    x = np.linspace(-0.1, 0.1, sides + 1)
    return np.stack([x, -0.02 + 10.0 ** random.uniform(-6, -3) * random.standard_normal(sides + 1)], axis=1)


class TestWaypoints:
    @pytest.mark.parametrize("n", [4, 5, 11, 30])
    def test_span_the_box(self, n):
        """The paper's printed x_i do not; the erratum is x_i = -L + 2 L (i-1)/(n-1)."""
        space = fo.Waypoints(n=n, L=0.1)
        np.testing.assert_allclose(space.x, np.linspace(-0.1, 0.1, n), rtol=0, atol=1e-15)

    @given(HEIGHTS)
    def test_the_sole_is_the_not_a_knot_cubic_spline(self, k):
        x, z = SPACE.contour(k)[0].T
        np.testing.assert_allclose(z, reference_spline(SPACE, k)(x), rtol=0, atol=1e-15)

    def test_points_lie_on_the_sole_from_heel_to_toe(self):
        k = [5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4]
        points = SPACE.points(k, 77)[0]
        assert points.shape == (78, 2)
        np.testing.assert_allclose(points[:, 1], reference_spline(SPACE, k)(points[:, 0]), rtol=0, atol=1e-15)
        assert (np.diff(points[:, 0]) > 0).all()
        np.testing.assert_allclose(points[[0, -1], 0], [-SPACE.L, SPACE.L], rtol=0, atol=1e-16)


class TestBox:
    @given(HEIGHTS)
    def test_violation_is_how_far_the_spline_leaves_the_box(self, k):
        z = reference_spline(SPACE, k)(np.linspace(-SPACE.L, SPACE.L, 20_001))
        outside = max(z.max(), -SPACE.H - z.min(), 0.0)
        assert SPACE.box_violation(k)[0] == pytest.approx(outside, abs=1e-3 * SPACE.H)

    def test_most_random_soles_leave_the_box(self):
        """Two thirds do, which is why the violation is a constraint of the problem."""
        violation = SPACE.box_violation(SPACE.random(2000, seed=0))
        assert np.mean(violation > 1e-9) == pytest.approx(2 / 3, abs=0.05)

    @pytest.mark.parametrize("tolerance", [0.0, 0.05, 0.2])
    def test_random_designs_inside_respect_it(self, tolerance):
        space = fo.Waypoints(box_tolerance=tolerance)
        k = space.random(200, seed=3, inside=True)
        assert k.shape == (200, space.n)
        assert (space.box_violation(k) <= tolerance * space.H).all()

    def test_a_box_that_no_random_sole_respects_is_an_error_that_says_so(self, monkeypatch):
        monkeypatch.setattr(fo.Waypoints, "box_violation", lambda self, k: np.full(len(k), 1.0))
        with pytest.raises(SettingError, match=r"foot\.box_tolerance = 0\.05.*foot\.n=11 and foot\.K=10"):
            SPACE.random(10, seed=0, inside=True)


class TestPlates:
    @pytest.mark.parametrize("k", SMOOTH)
    @pytest.mark.parametrize("plates", [50, 100, 400])
    def test_of_a_smooth_sole_have_equal_lengths(self, k, plates):
        length = chords(SPACE.points(k, plates)[0])
        assert np.ptp(length) < 1e-3 * length.mean()

    @pytest.mark.parametrize("rule", sorted(RULES))
    @given(k=HEIGHTS)
    def test_areas_sum_to_width_times_arc_length(self, rule, k):
        """Chords are shorter than the arc, by a share that falls with the square of their number."""
        spline = reference_spline(SPACE, k)
        pieces = zip(SPACE.x[:-1], SPACE.x[1:], strict=True)
        arc = sum(quad(lambda x: math.hypot(1.0, spline(x, 1)), a, b)[0] for a, b in pieces)
        short = [
            1.0 - as_plates(Soles(k, SPACE), n, rule).area.sum() / (SPACE.width * arc)
            for n in (100, 200, 400)
        ]
        assert -1e-9 < short[2] < 1e-4
        if short[2] > 1e-6:
            assert 3.5 < short[0] / short[1] < 4.5
            assert 3.5 < short[1] / short[2] < 4.5

    def test_of_the_paper_hold_the_chords_middle_from_the_ankle_and_its_doubled_angle(self):
        foot = fo.Foot.from_waypoints(SMOOTH[1], ankle=(0.02, 0.05), width=0.08)
        points = foot.points(64)
        plates = foot.plates(64, "chord")
        middle, chord = (points[1:] + points[:-1]) / 2, np.diff(points, axis=0)
        angle = np.arctan2(chord[:, 1], chord[:, 0])
        np.testing.assert_allclose(plates.x[0], middle[:, 0] - 0.02, rtol=0, atol=1e-15)
        np.testing.assert_allclose(plates.z[0], middle[:, 1] - 0.05, rtol=0, atol=1e-15)
        np.testing.assert_allclose(plates.c2[0], np.cos(2 * angle), rtol=0, atol=1e-14)
        np.testing.assert_allclose(plates.s2[0], np.sin(2 * angle), rtol=0, atol=1e-14)
        np.testing.assert_allclose(plates.area[0], 0.08 * chords(points), rtol=1e-14)

    @given(HEIGHTS)
    def test_averaged_over_their_arc_keep_the_soles_area_and_first_moments(self, k):
        """An averaged plate stands for its chords: sums over the sole do not notice."""
        chord, arc = as_plates(Soles(k, SPACE), 256, "chord"), as_plates(Soles(k, SPACE), 64, "arc")
        for name in ("x", "z", "c2", "s2"):
            fine = np.sum(chord.area * getattr(chord, name))
            assert np.sum(arc.area * getattr(arc, name)) == pytest.approx(fine, abs=1e-14)
        assert arc.area.sum() == pytest.approx(chord.area.sum(), rel=1e-12)

    @given(st.integers(0, 2**32 - 1), st.integers(2, 3000), st.sampled_from([8, 24, 100]))
    def test_of_a_drawing_keep_the_area_and_first_moments_of_all_its_sides(self, seed, sides, plates):
        """However many are within a plate: a scan's noise is often finer."""
        line = scanned(seed, sides)
        (dx, dz), length = np.diff(line, axis=0).T, chords(line)
        middle = (line[1:] + line[:-1]) / 2
        cut = fo.Foot(line, width=1.0).plates(plates)
        assert cut.area.sum() == pytest.approx(length.sum(), rel=1e-9)
        of_sides = {"x": middle[:, 0], "z": middle[:, 1]}
        of_sides |= {"c2": (dx**2 - dz**2) / length**2, "s2": 2 * dx * dz / length**2}
        for name, values in of_sides.items():
            whole = np.sum(length * values)
            assert np.sum(cut.area * getattr(cut, name)) == pytest.approx(whole, abs=1e-8 * length.sum())

    @pytest.mark.parametrize("bend", [0.01, 0.5, 2.0])
    def test_turn_by_as_much_as_their_piece_of_an_arc(self, bend):
        angle = np.linspace(-0.5, 0.5, 3001) * bend
        arc = 0.1 / bend * np.stack([np.sin(angle), 1.0 - np.cos(angle)], axis=1)
        np.testing.assert_allclose(fo.Foot(arc).plates(8).turn, bend / 8, rtol=0.01)
        k = np.full(11, 10) - np.rint(20 * np.linspace(-0.5, 0.5, 11) ** 2).astype(int)
        sole = fo.Foot.from_waypoints(k)
        drawing = fo.Foot(sole.contour)
        np.testing.assert_allclose(sole.plates(48).turn, drawing.plates(48).turn, rtol=0.1, atol=2e-3)

    def test_turn_by_the_spread_of_the_sides_within_not_by_their_sum(self):
        """The sides of a saw turn forth and back: no further, however many they are."""
        for teeth in (80, 400, 2000):
            x = np.linspace(-0.1, 0.1, 2 * teeth + 1)
            saw = np.stack([x, 0.1 * (x[1] - x[0]) * (np.arange(len(x)) % 2)], axis=1)
            turn = fo.Foot(saw).plates(8).turn
            np.testing.assert_allclose(turn, math.sqrt(12.0) * math.sin(math.atan(0.1)), rtol=0.02)

    @given(st.lists(st.integers(2, 300), min_size=1, max_size=5), st.data())
    def test_a_drawing_does_not_depend_on_its_batch(self, sides, data):
        feet = [fo.Foot(scanned(seed, count)) for seed, count in enumerate(sides)]
        i = data.draw(st.integers(0, len(feet) - 1))
        shaded = {"fill": fo.Shadowing().reshape}
        together, alone = (as_plates(batch, 24, "arc", **shaded) for batch in (feet, [feet[i]]))
        for all_, one in zip(together, alone, strict=True):
            np.testing.assert_array_equal(all_[i], one[0])

    @given(st.lists(HEIGHTS, min_size=1, max_size=12), st.data())
    def test_a_design_does_not_depend_on_its_batch(self, batch, data):
        """Bit for bit: stores and engines rest on it."""
        i = data.draw(st.integers(0, len(batch) - 1))
        shaded = {"fill": fo.Shadowing().reshape}
        together, alone = (as_plates(as_feet(k, SPACE), 64, "arc", **shaded) for k in (batch, batch[i]))
        for all_, one in zip(together, alone, strict=True):
            np.testing.assert_array_equal(all_[i], one[0])
        np.testing.assert_array_equal(SPACE.contour(batch)[i], SPACE.contour(batch[i])[0])
        assert SPACE.box_violation(batch)[i] == SPACE.box_violation(batch[i])[0]


SHAPE_OPTIONS = [
    ("ellipse", {}),
    ("rectangle", {}),
    ("circle", {}),
    ("reversed_l", {}),
    ("reversed_l", {"upright": "heel"}),
    ("reversed_triangle", {}),
    ("reversed_triangle", {"apex": "toe"}),
]


class TestShapes:
    @pytest.mark.parametrize(("name", "options"), SHAPE_OPTIONS)
    @pytest.mark.parametrize("length", [0.26, 0.1])
    def test_all_have_the_same_contact_length(self, name, options, length):
        contour = fo.Foot.shape(name, length, **options).contour
        assert chords(contour).sum() == pytest.approx(length, rel=1e-3)

    @pytest.mark.parametrize(("name", "options"), SHAPE_OPTIONS)
    def test_run_from_heel_to_toe_with_the_sand_below(self, name, options):
        """Seen from above, n = (sin b, -cos b) points out of a convex sole: it turns left only."""
        contour = fo.Foot.shape(name, **options).contour
        (ax, az), (bx, bz) = np.diff(contour, axis=0)[:-1].T, np.diff(contour, axis=0)[1:].T
        assert (ax * bz - az * bx >= 0).all()
        assert contour[0, 0] < contour[-1, 0] or name == "reversed_l"
        assert (np.diff(contour[:, 0]) >= 0).all()

    @pytest.mark.parametrize(("name", "options"), SHAPE_OPTIONS)
    def test_the_whole_shape_is_centred_with_axes_two_to_one(self, name, options):
        """The contact line is the lower part of a shape whose box is [-a/2, a/2] x [-b/2, b/2]."""
        contour = fo.Foot.shape(name, **options).contour
        half = contour[:, 0].max()
        assert contour[:, 0].min() == pytest.approx(-half)
        depth = -contour[:, 1].min()
        assert depth == pytest.approx(half if name == "circle" else half / 2)
        top = {"ellipse": 0.0, "circle": 0.0, "rectangle": -depth}.get(name, depth)
        assert contour[:, 1].max() == pytest.approx(top, abs=1e-15)

    def test_the_upright_and_the_apex_are_where_they_are_told(self):
        toe = fo.Foot.shape("reversed_l").contour
        heel = fo.Foot.shape("reversed_l", upright="heel").contour
        assert toe[-1, 1] > toe[0, 1]
        np.testing.assert_array_equal(heel, toe[::-1] * [-1, 1])
        middle = fo.Foot.shape("reversed_triangle").contour
        under_toe = fo.Foot.shape("reversed_triangle", apex="toe").contour
        assert middle[1, 0] == 0.0
        assert under_toe[1, 0] == under_toe[2, 0] == under_toe[:, 0].max()

    @pytest.mark.parametrize("name", sorted(SHAPES))
    def test_are_cut_into_plates_of_equal_arc(self, name):
        points = fo.Foot.shape(name).points(100)
        assert points.shape == (101, 2)
        length = chords(points)
        inside = length > 0.95 * length.max()  # plates end at corners
        assert (~inside).sum() <= 1
        assert 100 * length[inside].mean() == pytest.approx(0.26, rel=1e-3)


def hollow_by_pairs(contour):
    """The gap below every point to the lowest chord that spans it, by trying all chords."""
    x, z = contour.T
    worst = 0.0
    for p in range(1, len(x) - 1):
        i, j = np.meshgrid(np.arange(p), np.arange(p + 1, len(x)), indexing="ij")
        bridge = z[i] + (z[j] - z[i]) * (x[p] - x[i]) / (x[j] - x[i])
        worst = max(worst, z[p] - bridge.min())
    return worst


class TestHollow:
    @pytest.mark.parametrize(("name", "options"), SHAPE_OPTIONS)
    def test_the_five_shapes_have_none(self, name, options):
        """All are convex; the L and the triangle end in a vertical side, which does not count."""
        assert fo.Foot.shape(name, **options).hollow == pytest.approx(0.0, abs=1e-15)

    @given(st.floats(0.05, 1.5))
    def test_of_an_arch_is_its_sagitta(self, half_angle):
        angle = np.linspace(-half_angle, half_angle, 2001)
        arch = 0.1 * np.stack([np.sin(angle), np.cos(angle)], axis=1)
        assert fo.Foot(arch).hollow == pytest.approx(0.1 * (1 - math.cos(half_angle)), rel=1e-9)

    @given(HEIGHTS)
    def test_agrees_with_a_search_over_all_chords(self, k):
        contour = SPACE.contour(k)[0][::8]
        assert fo.Foot(contour).hollow == pytest.approx(hollow_by_pairs(contour), abs=1e-15)


class TestFoot:
    def test_remembers_where_it_comes_from(self):
        foot = fo.Foot.from_waypoints([1, 2, 3, 4, 5], K=5, L=0.1, H=0.02, width=0.07, ankle=(0.0, 0.04))
        assert foot.k == (1, 2, 3, 4, 5)
        assert foot.space == fo.Waypoints(5, 5, 0.1, 0.02, 0.07, (0.0, 0.04))
        assert (foot.width, foot.ankle) == (0.07, (0.0, 0.04))
        assert foot.contour[0, 0] == -0.1
        assert foot.contour[-1].tolist() == pytest.approx([0.1, -0.02])

    def test_replaced_it_is_what_it_says(self):
        foot = fo.Foot.from_waypoints([1, 2, 3, 4, 5], K=5)
        assert replace(foot, closed=True).space.closed
        turned = fo.Foot(foot.contour[::-1] * [-1.0, 1.0], name=foot.name)
        assert replace(foot, contour=turned.contour) == turned

    def test_made_again_is_the_same_foot_but_for_its_name(self):
        """So that the numbers of an accuracy are found once for a sole that is read again."""
        contour = SPACE.contour(SMOOTH[1])[0]
        foot = fo.Foot(contour)
        assert {foot, fo.Foot(contour.copy(), name="again")} == {foot}
        assert len({foot, fo.Foot(contour, width=0.08), fo.Foot(1.01 * contour)}) == 3


def test_feet_are_of_their_own_space_and_keep_their_own_contour():
    foot, line = fo.Foot.flat(), np.array([[-0.1, -0.03], [0.1, -0.03]])
    assert fo.evaluate([foot], space=foot.space).feasible.all()
    with pytest.raises(ValueError, match="space"):
        fo.evaluate([foot], space=fo.Waypoints(n=5))
    own = fo.Foot(line)
    line += 0.01
    assert own.contour[0, 1] == -0.03
    with pytest.raises(ValueError, match="read-only"):
        own.contour[0, 1] = 0.0
    with pytest.raises(ValueError, match="heel to toe"):
        fo.Foot(line[::-1])


@pytest.mark.parametrize("shape", SHAPES)
def test_a_shape_is_compared_with_a_flat_sole_of_its_own_length(shape):
    foot = fo.Foot.shape(shape, 0.05, width=0.04)
    level = flattened(foot)
    assert (level.hollow, level.width) == (0.0, 0.04)
    assert np.ptp(level.contour, axis=0) == pytest.approx([np.ptp(foot.contour[:, 0]), 0.0])
    assert level.contour[:, 1].min() == foot.contour[:, 1].min()
