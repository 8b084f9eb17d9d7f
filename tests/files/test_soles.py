"""A user's own sole: what a second reader sees in a drawing walks, or a message says what to change."""

import ezdxf
import numpy as np
import pytest
from shapely import LineString, affinity

import footopt as fo
from footopt.errors import FileError
from footopt.files.soles import lines_of, lower_edge

HOLLOW = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4])
#: A closed outline in mm, clockwise, its lower edge from (-120, -10) over (0, -30) to (130, -12).
OUTLINE = [(-120, -10), (-120, 15), (130, 20), (130, -12), (0, -30)]
LOWER = 1e-3 * np.array([(-120, -10), (0, -30), (130, -12)])
LEVEL = 1e-3 * np.array([(-130, 0), (130, 0)])
MM = 'width="400mm" height="400mm" viewBox="-200 -200 400 400"'


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("drawings")


@pytest.fixture
def dxf(folder):
    """A DXF file of what a function draws in model space."""

    def write(draw, units=4):
        document = ezdxf.new("R2010")
        document.units = units
        draw(document.modelspace())
        document.saveas(folder / "a.dxf")
        return folder / "a.dxf"

    return write


@pytest.fixture
def svg(folder):
    def write(shapes, head=MM):
        kind = 'svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd"'
        text = f'<!DOCTYPE {kind}>\n<svg xmlns="http://www.w3.org/2000/svg" {head}>{shapes}</svg>\n'
        (folder / "a.svg").write_text(text)
        return folder / "a.svg"

    return write


def polygon(points, name="a"):
    """An SVG polygon; the y-axis of the file points down."""
    return f'<polygon points="{" ".join(f"{x},{-z}" for x, z in points)}" id="{name}"/>'


def same(found, expected, exact=1e-12):
    np.testing.assert_allclose(found, expected, rtol=0, atol=exact)


def read(path, **settings):
    return fo.read_foot(path, **settings).contour


TRANSFORMS = {
    "rotate(-75 10 20)": lambda of: affinity.rotate(of, -75, origin=(10, 20)),
    "skewX(25)": lambda of: affinity.skew(of, xs=25, origin=(0, 0)),
    "matrix(.9 .2 -.4 1.1 7 -3)": lambda of: affinity.affine_transform(of, [0.9, -0.4, 0.2, 1.1, 7, -3]),
}
#: A path with an arc and a curve, and points of both.
PATH = "M-70 0A70 20 0 0 1 70 0C60 40 10 50-70 0"
ARC, U = np.radians(np.linspace(180, 360, 400)), np.linspace(0, 1, 400)[:, None]
CURVE = (
    (1 - U) ** 3 * [70, 0] + 3 * (1 - U) ** 2 * U * [60, 40] + 3 * (1 - U) * U**2 * [10, 50] + U**3 * [-70, 0]
)
POINTS = np.concatenate([np.stack([70 * np.cos(ARC), 20 * np.sin(ARC)], axis=1), CURVE])


class TestSvg:
    @pytest.mark.parametrize("outer", TRANSFORMS)
    @pytest.mark.parametrize("own", TRANSFORMS)
    def test_a_path_turned_and_in_a_group_is_where_its_transforms_bring_it(self, svg, own, outer):
        path = svg(f'<g transform="{outer}"><path d="{PATH}" transform="{own}"/></g>')
        (line,) = lines_of(path)
        expected = affinity.scale(
            TRANSFORMS[outer](TRANSFORMS[own](LineString(POINTS))), 1e-3, -1e-3, origin=(0, 0)
        )
        assert LineString(line.points).hausdorff_distance(expected) < 4e-5

    def test_what_is_defined_is_drawn_where_it_is_used_and_nowhere_else(self, svg):
        drawing = (
            '<defs><polyline id="sole" points="-50,0 0,30 60,0"/></defs>'
            '<use href="#sole" transform="rotate(180)" y="3"/>'
            '<use xmlns:xlink="http://www.w3.org/1999/xlink" xlink:href="#sole" x="4"/>'
        )
        ends = [line.points[[0, -1]] for line in lines_of(svg(drawing))]
        same(ends, 1e-3 * np.array([[(50, 3), (-60, 3)], [(-46, 0), (64, 0)]]))

    @pytest.mark.parametrize(
        ("head", "unit"),
        [
            (MM, 1e-3),
            ('width="30cm" height="10cm" viewBox="0 0 3000 1000"', 1e-4),
            ('width="720pt" height="9in" viewBox="0 0 254 100"', 1e-3),
            ('width="10in" viewBox="0 0 254 100"', 1e-3),
            ('width="300mm" height="100mm"', 0.0254 / 96),
        ],
    )
    def test_a_drawing_has_units_and_a_y_axis_that_points_down(self, svg, head, unit):
        same(read(svg(polygon(0.001 * np.array(OUTLINE) / unit), head)), LOWER, 1e-9)

    def test_pixels_are_no_length(self, svg):
        path = svg(polygon(OUTLINE), 'width="300px" viewBox="0 0 300 100"')
        with pytest.raises(FileError, match=r"does not say in which unit.*foot\.units"):
            read(path)
        same(read(path, units="mm"), LOWER, 1e-9)


class TestDxf:
    def test_arcs_are_flattened_on_themselves(self, dxf):
        half = [(-100, 0, 1.0), (100, 0, 0.0)]  # a bulge of 1 is half a circle, here below its chord
        sole = read(dxf(lambda space: space.add_lwpolyline(half, "xyb", close=True)))
        same(np.hypot(*sole.T), 0.1, 1e-9)
        assert 0.1 - np.hypot(*(0.5 * (sole[1:] + sole[:-1])).T).min() < 2.1e-5

    def test_holes_are_left_out_and_listed(self, dxf):
        def draw(space):
            space.add_circle((20, 0), 4)
            space.add_lwpolyline([(-100, -20), (100, -20), (100, 20), (-100, 20)], close=True)
            space.add_circle((-60, 0), 6)

        foot = fo.read_foot(dxf(draw))
        same(foot.contour, [(-0.1, -0.02), (0.1, -0.02)])
        (note,) = foot.notes
        assert "not its holes: a closed outline of 11.9" in note
        assert note.count("a closed outline of") == 3


class TestTheLine:
    @pytest.mark.parametrize("turn", [1, -1])
    @pytest.mark.parametrize("shift", range(6))
    def test_of_an_outline_is_the_lower_edge_and_of_vertical_sides_the_lowest_ends(self, turn, shift):
        same(1e-3 * lower_edge(np.roll(OUTLINE, shift, axis=0)[::turn]), LOWER)
        box = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, 0.0)])
        same(lower_edge(np.roll(box, shift, axis=0)[::turn]), [(-1, -1), (1, -1)])

    @pytest.mark.parametrize("ending", ["csv", "dxf", "svg"])
    def test_of_footopt_s_own_files_is_the_foot(self, tmp_path, ending):
        path = fo.write_foot(HOLLOW, tmp_path / f"sole.{ending}")
        foot = fo.read_foot(path, width=0.08, ankle=(0.01, 0.05))
        same(foot.contour, HOLLOW.contour, 1e-9)
        assert (foot.name, foot.width, foot.ankle) == ("sole", 0.08, (0.01, 0.05))
        if ending != "csv":
            same(read(path, layer="OUTLINE"), HOLLOW.contour, 1e-9)

    def test_in_two_units_or_stretched_is_refused(self, svg, tmp_path):
        table = tmp_path / "two.csv"
        table.write_text("x_mm,z_m\n-130,0\n0,-0.03\n130,0\n")
        with pytest.raises(FileError, match="two units"):
            fo.read_foot(table, units="mm")
        head = 'width="600mm" height="100mm" viewBox="0 0 300 100" preserveAspectRatio="none"'
        with pytest.raises(FileError, match="stretched or cut"):
            read(svg(polygon(OUTLINE), head))
        same(read(svg(polygon(OUTLINE), head.replace("none", "xMidYMid"))), LOWER, 1e-9)

    def test_follows_scale_toe_and_origin(self, svg):
        path = svg(polygon(OUTLINE))
        same(read(path, scale=2.0), 2 * LOWER, 1e-9)
        same(read(path, toe="left"), LOWER[::-1] * [-1, 1], 1e-9)
        same(read(path, origin="centre"), LOWER - [5e-3, -5e-3], 1e-9)

    def test_is_one_of_several_by_its_layer(self, svg):
        shapes = f'<g id="a">{polygon(OUTLINE)}</g><g id="screw"><circle cx="20" cy="45" r="4"/></g>'
        with pytest.raises(FileError, match=r"holds 2: .*'screw'"):
            read(svg(shapes))
        same(read(svg(shapes), layer="a"), LOWER, 1e-9)

    @pytest.mark.parametrize(
        ("ends", "units", "mended", "named"),
        [
            ([((-130, 0), (130, 0))], 6, {"units": "mm"}, r"foot\.units"),
            ([((500, 300), (760, 300))], 4, {"origin": "centre"}, r"foot\.origin=centre"),
            ([((-100, 0), (0, -9)), ((0.5, -9), (100, 0))], 4, None, "gaps above 0"),
            ([((0, 0), (0, -20)), ((0, -20), (90, -9)), ((90, -9), (0, 5))], 4, None, "the heel"),
        ],
        ids=["units", "origin", "gap", "ends"],
    )
    def test_that_is_no_sole_is_refused_with_what_to_change(self, dxf, ends, units, mended, named):
        path = dxf(lambda space: [space.add_line(*end) for end in ends], units)
        with pytest.raises(FileError, match=named):
            read(path, **({} if mended else {"origin": "centre"}))
        if mended:
            same(read(path, **mended), LEVEL)
