"""A user's own sole: what a second reader sees in a drawing walks, or a message says what to change."""

from functools import reduce

import ezdxf
import numpy as np
import pytest
from ezdxf import path as curves
from ezdxf.disassemble import recursive_decompose
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from running import tries
from shapely import LinearRing, LineString, MultiLineString
from svgpathtools import parse_path

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


def matrix(a, b, c, d, e=0.0, f=0.0):
    return np.array([[a, c, e], [b, d, f], [0, 0, 1]])


def rotation(deg):
    c, s = np.cos(np.radians(deg)), np.sin(np.radians(deg))
    return matrix(c, s, -s, c)


TRANSFORMS = {
    "translate(3 -4)": matrix(1, 0, 0, 1, 3, -4),
    "rotate(30)": rotation(30),
    "rotate(-75 10 20)": matrix(1, 0, 0, 1, 10, 20) @ rotation(-75) @ matrix(1, 0, 0, 1, -10, -20),
    "scale(-1 1)": matrix(-1, 0, 0, 1),
    "skewX(25)": matrix(1, 0, np.tan(np.radians(25)), 1),
    "skewY(-15)": matrix(1, np.tan(np.radians(-15)), 0, 1),
    "matrix(.9 .2 -.4 1.1 7 -3)": matrix(0.9, 0.2, -0.4, 1.1, 7, -3),
    "matrix(-.5 .8 .7 .6 0 12)": matrix(-0.5, 0.8, 0.7, 0.6, 0, 12),
}
#: Shapes and the paths that SVG's own text says they are.
SHAPES = {
    '<rect x="-60" y="-10" width="120" height="30"/>': "M-60-10h120v30h-120z",
    '<rect x="-60" y="-10" width="120" height="30" rx="9" ry="6"/>': (
        "M-51-10H51A9 6 0 0 1 60-4V14A9 6 0 0 1 51 20H-51A9 6 0 0 1-60 14V-4A9 6 0 0 1-51-10z"
    ),
    '<circle cx="5" cy="3" r="50"/>': "M55 3A50 50 0 0 1-45 3A50 50 0 0 1 55 3z",
    '<ellipse cx="-4" cy="2" rx="70" ry="20"/>': "M66 2A70 20 0 0 1-74 2A70 20 0 0 1 66 2z",
    '<path d="M-70 0A80 30 20 0 1 70 10L0 40Z"/>': "M-70 0A80 30 20 0 1 70 10L0 40Z",
    '<path d="M-70 0C-60 40 10-50 70 0S80 90 0 60Q-90 90-70 0Z"/>': (
        "M-70 0C-60 40 10-50 70 0S80 90 0 60Q-90 90-70 0Z"
    ),
    '<polygon points="-50,0 0,-30 60,20 5,9"/>': "M-50 0L0-30L60 20L5 9Z",
    '<polyline points="-50,0 0,-30 60,20"/>': "M-50 0L0-30L60 20",
    '<line x1="-50" y1="3" x2="60" y2="-8"/>': "M-50 3L60-8",
}


class TestSvg:
    @given(
        shape=st.sampled_from(list(SHAPES)),
        own=st.sampled_from(list(TRANSFORMS)),
        outer=st.lists(st.sampled_from(list(TRANSFORMS)), max_size=2),
    )
    @settings(max_examples=tries(60))
    def test_every_shape_turned_and_in_groups_is_what_another_reader_sees(self, folder, shape, own, outer):
        drawing = shape.replace("/>", f' transform="{own}"/>')
        for transform in reversed(outer):
            drawing = f'<g transform="{transform}">{drawing}</g>'
        path = folder / "b.svg"
        path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {MM}>{drawing}</svg>')
        (line,) = lines_of(path)
        places = np.array(
            [part.point(t) for part in parse_path(SHAPES[shape]) for t in np.linspace(0, 1, 400)]
        )
        change = reduce(np.matmul, [TRANSFORMS[name] for name in (*outer, own)])
        expected = change @ [places.real, places.imag, np.ones(len(places))]
        found = LinearRing(line.points) if line.closed else LineString(line.points)
        assert line.closed == (SHAPES[shape].lower()[-1] == "z")
        assert found.hausdorff_distance(LineString(1e-3 * expected[:2].T * [1.0, -1.0])) < 4e-5

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


UNITS = [(1, 0.0254), (2, 0.3048), (4, 1e-3), (5, 1e-2), (6, 1.0)]
SCALES = st.floats(0.3, 1.1)  # the other reader has arcs as cubics, 0.03 % off


class TestDxf:
    @given(
        x=SCALES, y=SCALES, mirrored=st.booleans(), turn=st.floats(-180, 180),
        bulge=st.sampled_from([-0.8, 0.0, 0.3]), units=st.sampled_from(UNITS),
    )  # fmt: skip
    @settings(max_examples=tries(20), phases=[Phase.generate])
    def test_curves_in_blocks_of_blocks_are_what_another_reader_sees(
        self, folder, x, y, mirrored, turn, bulge, units
    ):
        """Some programs flatten blocks with a scale of 0 along z."""
        document = ezdxf.new("R2010")
        document.units, unit = units
        block, outer, size = document.blocks.new("FOOT"), document.blocks.new("PAIR"), 1e-3 / unit
        block.add_lwpolyline([(-50 * size, 0, bulge), (0, -10 * size, 0), (50 * size, 0, 0)], "xyb")
        block.add_ellipse((0, 10 * size), (50 * size, 10 * size), 0.4, 0.0, 2.0)
        block.add_arc((0, 0), 100 * size, 180, 270)
        block.add_spline([(0, -100 * size), (50 * size, -90 * size), (100 * size, -40 * size)])
        outer.add_blockref("FOOT", (size, 2 * size))
        scales = {"xscale": -x if mirrored else x, "yscale": y, "zscale": 7.0, "rotation": turn}
        insert = document.modelspace().add_blockref("PAIR", (3 * size, 4 * size), dxfattribs=scales)
        document.saveas(folder / "b.dxf")
        (folder / "b.dxf").write_text((folder / "b.dxf").read_text().replace("43\n7.0", "43\n0.0"))
        insert.dxf.zscale = 1.0
        expected = MultiLineString(
            [
                unit * np.array([(v.x, v.y) for v in curves.make_path(entity).flattening(1e-3 * size, 64)])
                for entity in recursive_decompose(document.modelspace())
            ]
        )
        found = MultiLineString([line.points for line in lines_of(folder / "b.dxf")])
        assert found.hausdorff_distance(expected) < 6e-5

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
