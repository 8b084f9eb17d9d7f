"""A user's own sole: what is drawn is what walks, or a message says what to change."""

import ezdxf
import numpy as np
import pytest

import footopt as fo
from footopt.errors import FileError, SettingError
from footopt.files import soles
from footopt.files.soles import lower_edge

HOLLOW = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4])
#: A closed outline in mm, clockwise, its lower edge from (-120, -10) over (0, -30) to (130, -12).
OUTLINE = [(-120, -10), (-120, 15), (130, 20), (130, -12), (0, -30)]
LOWER = 1e-3 * np.array([(-120, -10), (0, -30), (130, -12)])
LEVEL = 1e-3 * np.array([(-130, 0), (130, 0)])
MM = 'width="300mm" height="100mm" viewBox="-150 -50 300 100"'


@pytest.fixture
def dxf(tmp_path):
    """A DXF file of what a function draws in model space."""

    def write(draw, units=4):
        document = ezdxf.new("R2010")
        document.units = units
        draw(document.modelspace())
        document.saveas(tmp_path / "a.dxf")
        return tmp_path / "a.dxf"

    return write


@pytest.fixture
def svg(tmp_path):
    def write(shapes, head=MM):
        text = f'<?xml version="1.0"?>\n<svg xmlns="http://www.w3.org/2000/svg" {head}>{shapes}</svg>\n'
        (tmp_path / "a.svg").write_text(text)
        return tmp_path / "a.svg"

    return write


@pytest.fixture
def table(tmp_path):
    def write(text):
        (tmp_path / "a.csv").write_text(text, encoding="utf-8")
        return tmp_path / "a.csv"

    return write


def polygon(points, name="a"):
    """An SVG polygon; the y-axis of the file points down."""
    return f'<polygon points="{" ".join(f"{x},{-z}" for x, z in points)}" id="{name}"/>'


def same(found, expected, exact=1e-12):
    np.testing.assert_allclose(found, expected, rtol=0, atol=exact)


def read(path, **settings):
    return soles.read(path, **settings).points


class TestFootoptsOwnFiles:
    @pytest.mark.parametrize("ending", ["csv", "dxf", "svg"])
    def test_give_the_foot_back(self, tmp_path, ending):
        path = HOLLOW.to_file(tmp_path / f"sole.{ending}")
        foot = fo.Foot.from_file(path, width=0.08, ankle=(0.01, 0.05))
        same(foot.contour, HOLLOW.contour, 1e-9)
        assert (foot.name, foot.width, foot.ankle) == ("sole", 0.08, (0.01, 0.05))
        if ending != "csv":
            same(read(path, layer="OUTLINE"), HOLLOW.contour, 1e-9)


class TestDxf:
    @pytest.mark.parametrize("turn", [1, -1])
    @pytest.mark.parametrize("shift", range(5))
    def test_the_lower_edge_of_a_closed_outline(self, dxf, turn, shift):
        points = np.roll(OUTLINE, shift, axis=0)[::turn].tolist()
        same(read(dxf(lambda space: space.add_lwpolyline(points, close=True))), LOWER)

    @pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 2, 0)])
    def test_pieces_are_joined_whichever_way_they_were_drawn(self, dxf, order):
        ends = [((-0.1, 0), (0, -0.02)), ((0.05, -0.02), (0, -0.02)), ((0.05, -0.02), (0.1, 0.01))]
        path = dxf(lambda space: [space.add_line(*ends[i]) for i in order], units=6)
        same(read(path), [(-0.1, 0), (0, -0.02), (0.05, -0.02), (0.1, 0.01)])

    def test_bulges_of_a_polyline_are_arcs(self, dxf):
        half = [(-100, 0, 1.0), (100, 0, 0.0)]  # a bulge of 1 is half a circle, here below its chord
        sole = read(dxf(lambda space: space.add_lwpolyline(half, "xyb", close=True)))
        same(np.hypot(*sole.T), 0.1, 1e-9)
        assert sole[:, 1].min() == pytest.approx(-0.1, abs=2e-5)

    def test_arcs_and_splines_are_flattened_on_themselves(self, dxf):
        def draw(space):
            space.add_arc((0, 0), 100, 180, 270)
            space.add_spline([(0, -100), (50, -90), (100, -40)])

        sole = read(dxf(draw))
        arc = sole[sole[:, 0] <= 0]
        same(np.hypot(*arc.T), 0.1, 1e-9)
        assert 0.1 - np.hypot(*(0.5 * (arc[1:] + arc[:-1])).T).min() < 2.1e-5
        same(sole[[0, -1]], [(-0.1, 0), (0.1, -0.04)], 1e-9)

    @pytest.mark.parametrize(("units", "unit"), [(1, 0.0254), (4, 1e-3), (5, 1e-2), (6, 1.0)])
    def test_units_are_the_files_own(self, dxf, units, unit):
        same(read(dxf(lambda space: space.add_line(*(LEVEL / unit).tolist()), units)), LEVEL)

    def test_lines_in_blocks_count(self, dxf):
        def draw(space):
            space.doc.blocks.new("FOOT").add_lwpolyline([(-50, 0), (0, -10), (50, 0)])
            space.add_blockref("FOOT", (0, 0), dxfattribs={"xscale": 2, "yscale": 2})

        same(read(dxf(draw)), [(-0.1, 0), (0, -0.02), (0.1, 0)])


class TestSvg:
    @pytest.mark.parametrize(
        ("head", "unit"),
        [
            (MM, 1e-3),
            ('width="30cm" height="10cm" viewBox="0 0 3000 1000"', 1e-4),
            ('width="10in" viewBox="0 0 254 100"', 1e-3),
            ('width="300mm" height="100mm"', 0.0254 / 96),
        ],
    )
    def test_a_drawing_has_units_and_a_y_axis_that_points_down(self, svg, head, unit):
        same(read(svg(polygon(0.001 * np.array(OUTLINE) / unit), head)), LOWER, 1e-9)

    def test_transforms_curves_and_groups(self, svg):
        path = svg(
            '<g id="feet" transform="translate(10 0) scale(2 1)"><g id="sole">'
            '<path d="M -50 0 C -50 30 40 30 40 0"/></g><g id="note"><rect width="9" height="9"/></g></g>'
        )
        sole, t = read(path, layer="sole"), np.linspace(0, 1, 4001)[:, None]
        ends = 1e-3 * np.array([(-90, 0), (-90, -30), (90, -30), (90, 0)])
        weights = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3)
        exact = sum(weight * end for weight, end in zip(weights, ends, strict=True))
        assert np.linalg.norm(sole[:, None] - exact, axis=-1).min(axis=1).max() < 5e-5
        same(sole[[0, -1]], ends[[0, -1]], 1e-9)

    def test_pixels_are_no_length(self, svg):
        path = svg(polygon(OUTLINE), 'width="300px" viewBox="0 0 300 100"')
        with pytest.raises(FileError, match=r"does not say in which unit.*foot\.units"):
            read(path)
        same(read(path, units="mm"), LOWER, 1e-9)


class TestCsv:
    @pytest.mark.parametrize(
        "text",
        [
            "x_mm,z_mm\n-100,-1\n0,-20.5\n100,0\n",
            "z (mm), x (mm)\n-1,-100\n-20.5,0\n0,100\n",
            "X_cm;Y_cm\n-10;-,1\n0;-2,05\n10;0\n",
            "# measured by hand\nx_m\tz_m\n\n-.1\t-.001\n0\t-.0205\n.1\t0\n",
            "\ufeffname,x_mm,z_mm\n1,100,0\n2,0,-20.5\n3,-100,-1\n",
        ],
    )
    def test_dialects(self, table, text):
        same(read(table(text)), [(-0.1, -1e-3), (0, -0.0205), (0.1, 0)])

    def test_no_header_needs_units(self, table):
        path = table("-100 -1\n0 -20\n100 0\n")
        with pytest.raises(FileError, match=r"does not say in which unit"):
            read(path)
        assert len(read(path, units="mm")) == 3

    def test_a_closed_table_is_an_outline(self, table):
        rows = "\n".join(f"{x},{z}" for x, z in [*OUTLINE, OUTLINE[0]])
        same(read(table(f"x_mm,z_mm\n{rows}\n")), LOWER)

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("x_mm,depth\n1,2\n", "lacks x or z; it holds x_mm, depth"),
            ("x_mm,z_mm\n1,2\n3,four\n", "row 2 of the table is not numbers: '3,four'"),
            ("x_mm,z_mm\n1,2\n3\n", "row 2 of the table"),
            ("x_mm,z_mm\n1,2\n3,nan\n", "row 2 of the table"),
            ("x_furlong,z_furlong\n1,2\n", "says 'furlong'"),
            ("x_mm,z_mm\n", "holds no line"),
            ("x_mm,z_mm\n-100,0\n0,-10\n.5,20\n1,-10\n100,0\n", r"a spike at \(0\.50, 20\.00\) mm"),
        ],
    )
    def test_what_is_wrong_is_named(self, table, text, message):
        with pytest.raises(FileError, match=message):
            read(table(text))


class TestSettings:
    def test_scale_toe_and_origin(self, svg):
        path = svg(polygon(OUTLINE))
        same(read(path, scale=2.0), 2 * LOWER, 1e-9)
        same(read(path, toe="left"), LOWER[::-1] * [-1, 1], 1e-9)
        same(read(path, origin="centre"), LOWER - [5e-3, -5e-3], 1e-9)

    @pytest.mark.parametrize(
        "given", [{"units": "feet"}, {"scale": 0.0}, {"toe": "up"}, {"origin": "heel"}, {"layer": "top"}]
    )
    def test_what_cannot_be_used_is_refused(self, svg, given):
        (setting,) = given
        with pytest.raises(SettingError, match=rf"foot\.{setting} = .*must be"):
            read(svg(polygon(OUTLINE)), **given)


class TestWhatIsNoSole:
    def test_several_outlines_are_listed(self, svg):
        path = svg(polygon(OUTLINE) + '<g id="screw"><circle cx="20" cy="45" r="4"/></g>')
        with pytest.raises(
            FileError, match=r"holds 2: a closed outline of 250 x 50 mm; .* 8 x 8 mm on 'screw"
        ):
            read(path)

    @pytest.mark.parametrize(
        ("ends", "units", "mended", "message"),
        [
            ([((-130, 0), (130, 0))], 6, {"units": "mm"}, r"would be 260 m long\. Set foot\.units"),
            ([((-130, 0), (130, 0))], 0, {"units": "mm"}, r"not say in which unit it is\. Set foot\.units"),
            ([((500, 300), (760, 300))], 4, {"origin": "centre"}, r"x 500 and 760 mm.*foot\.origin=centre"),
            (
                [((-100, 0), (0, -9)), ((0.5, -9), (100, 0))],
                4,
                None,
                r"2: an open .*gaps wider than 0\.01 mm",
            ),
            (
                [((0, 0), (0, -20)), ((0, -20), (90, -9)), ((90, -9), (0, 5))],
                4,
                None,
                "which end is the heel",
            ),
        ],
        ids=["units", "no units", "origin", "gap", "ends"],
    )
    def test_a_line_that_is_none_is_refused_with_what_to_change(self, dxf, ends, units, mended, message):
        path = dxf(lambda space: [space.add_line(*end) for end in ends], units)
        with pytest.raises(FileError, match=message):
            read(path, **({} if mended else {"origin": "centre"}))
        if mended:
            same(read(path, **mended), LEVEL)

    def test_a_line_that_crosses_itself_is_refused_with_the_place(self, svg):
        with pytest.raises(FileError, match=r"crosses itself at \(0\.00, 0\.00\) mm"):
            read(svg(polygon([(-100, -10), (100, 10), (100, -10), (-100, 10)])))

    @pytest.mark.parametrize("ending", ["dxf", "svg", "csv"])
    def test_a_file_that_is_not_there_or_something_else(self, tmp_path, ending):
        path = tmp_path / f"a.{ending}"
        with pytest.raises(FileError, match=rf"a\.{ending}.*cannot be read .No such file"):
            read(path)
        path.write_bytes(b"\x00\xff\xfe not a drawing")
        with pytest.raises(FileError, match=rf"a\.{ending}"):
            read(path)

    def test_a_drawing_of_nothing(self, svg):
        with pytest.raises(FileError, match="holds no line"):
            read(svg("<text>sole</text>"))


def test_of_vertical_sides_the_lowest_ends_count():
    box = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, 0.0)])
    for shift in range(len(box)):
        np.testing.assert_array_equal(lower_edge(np.roll(box, shift, axis=0)), [(-1, -1), (1, -1)])
