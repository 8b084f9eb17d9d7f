"""A user's own sole: what is drawn is what walks, or a message says what to change."""

import ezdxf
import numpy as np
import pytest

import footopt as fo
from footopt.errors import FileError, SettingError
from footopt.files.soles import lower_edge, read

HOLLOW = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4])
#: A closed outline in mm, clockwise, its lower edge from (-120, -10) over (0, -30) to (130, -12).
OUTLINE = [(-120, -10), (-120, 15), (130, 20), (130, -12), (0, -30)]
LOWER = 1e-3 * np.array([(-120, -10), (0, -30), (130, -12)])


def drawing(path, draw, units=4):
    """A DXF file of what `draw` draws in model space."""
    document = ezdxf.new("R2010")
    document.units = units
    draw(document.modelspace())
    document.saveas(path)
    return path


def svg(path, shapes, head='width="300mm" height="100mm" viewBox="-150 -50 300 100"'):
    path.write_text(f'<?xml version="1.0"?>\n<svg xmlns="http://www.w3.org/2000/svg" {head}>{shapes}</svg>\n')
    return path


def polygon(points, **attributes):
    """An SVG polygon; the y-axis of the file points down."""
    given = " ".join(f'{name}="{value}"' for name, value in attributes.items())
    return f'<polygon points="{" ".join(f"{x},{-z}" for x, z in points)}" {given}/>'


class TestFootoptsOwnFiles:
    @pytest.mark.parametrize("ending", ["csv", "dxf", "svg"])
    def test_give_the_foot_back(self, tmp_path, ending):
        path = HOLLOW.to_file(tmp_path / f"sole.{ending}")
        foot = fo.Foot.from_file(path, width=0.08, ankle=(0.01, 0.05))
        np.testing.assert_allclose(foot.contour, HOLLOW.contour, rtol=0, atol=1e-9)
        assert (foot.name, foot.width, foot.ankle) == ("sole", 0.08, (0.01, 0.05))

    @pytest.mark.parametrize("ending", ["dxf", "svg"])
    def test_the_lower_edge_of_their_outline_is_the_sole(self, tmp_path, ending):
        path = HOLLOW.to_file(tmp_path / f"sole.{ending}")
        found = read(path, layer="OUTLINE")
        np.testing.assert_allclose(found, HOLLOW.contour, rtol=0, atol=1e-9)

    def test_walk_as_the_foot_itself(self, tmp_path):
        foot = fo.Foot.from_file(HOLLOW.to_file(tmp_path / "sole.dxf"))
        one = fo.Foot(HOLLOW.contour)
        tables = [fo.evaluate([f], fo.Scene(), "draft").values for f in (foot, one)]
        np.testing.assert_allclose(*tables, rtol=1e-6)


class TestDxf:
    @pytest.mark.parametrize("turn", [1, -1])
    @pytest.mark.parametrize("shift", range(5))
    def test_the_lower_edge_of_a_closed_outline(self, tmp_path, turn, shift):
        points = np.roll(OUTLINE, shift, axis=0)[::turn].tolist()
        path = drawing(tmp_path / "a.dxf", lambda space: space.add_lwpolyline(points, close=True))
        np.testing.assert_allclose(read(path), LOWER, atol=1e-12)

    @pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 2, 0)])
    def test_pieces_are_joined_whichever_way_they_were_drawn(self, tmp_path, order):
        ends = [((-0.1, 0), (0, -0.02)), ((0.05, -0.02), (0, -0.02)), ((0.05, -0.02), (0.1, 0.01))]
        path = drawing(tmp_path / "a.dxf", lambda s: [s.add_line(*ends[i]) for i in order], units=6)
        np.testing.assert_allclose(
            read(path), [(-0.1, 0), (0, -0.02), (0.05, -0.02), (0.1, 0.01)], atol=1e-12
        )

    def test_bulges_of_a_polyline_are_arcs(self, tmp_path):
        half = [(-100, 0, 1.0), (100, 0, 0.0)]  # a bulge of 1 is half a circle, here below its chord
        path = drawing(tmp_path / "a.dxf", lambda space: space.add_lwpolyline(half, "xyb", close=True))
        sole = read(path)
        np.testing.assert_allclose(np.hypot(*sole.T), 0.1, atol=1e-9)
        assert sole[:, 1].min() == pytest.approx(-0.1, abs=2e-5)

    def test_arcs_and_splines_are_flattened_on_themselves(self, tmp_path):
        def draw(space):
            space.add_arc((0, 0), 100, 180, 270)
            space.add_spline([(0, -100), (50, -90), (100, -40)])

        sole = read(drawing(tmp_path / "a.dxf", draw))
        arc = sole[sole[:, 0] <= 0]
        middle = 0.5 * (arc[1:] + arc[:-1])
        np.testing.assert_allclose(np.hypot(*arc.T), 0.1, atol=1e-9)
        assert 0.1 - np.hypot(*middle.T).min() < 2.1e-5
        np.testing.assert_allclose(sole[[0, -1]], [(-0.1, 0), (0.1, -0.04)], atol=1e-9)

    @pytest.mark.parametrize(("units", "unit"), [(1, 0.0254), (4, 1e-3), (5, 1e-2), (6, 1.0)])
    def test_units_are_the_files_own(self, tmp_path, units, unit):
        line = [(-0.1 / unit, 0), (0.1 / unit, 0)]
        path = drawing(tmp_path / "a.dxf", lambda space: space.add_line(*line), units)
        np.testing.assert_allclose(read(path), [(-0.1, 0), (0.1, 0)], atol=1e-12)

    def test_lines_in_blocks_count(self, tmp_path):
        document = ezdxf.new("R2010")
        document.units = 4
        document.blocks.new("FOOT").add_lwpolyline([(-50, 0), (0, -10), (50, 0)])
        document.modelspace().add_blockref("FOOT", (0, 0), dxfattribs={"xscale": 2, "yscale": 2})
        document.saveas(tmp_path / "a.dxf")
        np.testing.assert_allclose(read(tmp_path / "a.dxf"), [(-0.1, 0), (0, -0.02), (0.1, 0)], atol=1e-12)


class TestSvg:
    def test_millimetres_and_a_y_axis_that_points_down(self, tmp_path):
        np.testing.assert_allclose(read(svg(tmp_path / "a.svg", polygon(OUTLINE))), LOWER, atol=1e-9)

    @pytest.mark.parametrize(
        ("head", "unit"),
        [
            ('width="30cm" height="10cm" viewBox="0 0 3000 1000"', 1e-4),
            ('width="10in" viewBox="0 0 254 100"', 1e-3),
            ('width="300mm" height="100mm"', 0.0254 / 96),
        ],
    )
    def test_units_of_a_drawing(self, tmp_path, head, unit):
        path = svg(tmp_path / "a.svg", polygon(0.001 * np.array(OUTLINE) / unit), head)
        np.testing.assert_allclose(read(path), LOWER, atol=1e-9)

    def test_transforms_curves_and_groups(self, tmp_path):
        shapes = (
            '<g id="feet" transform="translate(10 0) scale(2 1)"><g id="sole">'
            '<path d="M -50 0 C -50 30 40 30 40 0"/></g><g id="note"><rect width="9" height="9"/></g></g>'
        )
        sole = read(svg(tmp_path / "a.svg", shapes), layer="sole")
        t = np.linspace(0, 1, 4001)[:, None]
        ends = 1e-3 * np.array([(-90, 0), (-90, -30), (90, -30), (90, 0)])
        exact = (
            (1 - t) ** 3 * ends[0]
            + 3 * t * (1 - t) ** 2 * ends[1]
            + 3 * t**2 * (1 - t) * ends[2]
            + t**3 * ends[3]
        )
        near = np.linalg.norm(sole[:, None] - exact, axis=-1).min(axis=1)
        assert near.max() < 5e-5
        np.testing.assert_allclose(sole[[0, -1]], ends[[0, -1]], atol=1e-9)

    def test_pixels_are_no_length(self, tmp_path):
        path = svg(tmp_path / "a.svg", polygon(OUTLINE), 'width="300px" viewBox="0 0 300 100"')
        with pytest.raises(FileError, match=r"does not say in which unit.*foot\.units"):
            read(path)
        np.testing.assert_allclose(read(path, units="mm"), LOWER, atol=1e-9)


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
    def test_dialects(self, tmp_path, text):
        (tmp_path / "a.csv").write_text(text, encoding="utf-8")
        np.testing.assert_allclose(
            read(tmp_path / "a.csv"), [(-0.1, -1e-3), (0, -0.0205), (0.1, 0)], atol=1e-12
        )

    def test_no_header_needs_units(self, tmp_path):
        (tmp_path / "a.csv").write_text("-100 -1\n0 -20\n100 0\n")
        with pytest.raises(FileError, match=r"does not say in which unit"):
            read(tmp_path / "a.csv")
        assert len(read(tmp_path / "a.csv", units="mm")) == 3

    def test_a_closed_table_is_an_outline(self, tmp_path):
        rows = "\n".join(f"{x},{z}" for x, z in [*OUTLINE, OUTLINE[0]])
        (tmp_path / "a.csv").write_text(f"x_mm,z_mm\n{rows}\n")
        np.testing.assert_allclose(read(tmp_path / "a.csv"), LOWER, atol=1e-12)

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("x_mm,depth\n1,2\n", "lacks x or z; it holds x_mm, depth"),
            ("x_mm,z_mm\n1,2\n3,four\n", "row 2 of the table is not numbers: '3,four'"),
            ("x_mm,z_mm\n1,2\n3\n", "row 2 of the table"),
            ("x_mm,z_mm\n1,2\n3,nan\n", "row 2 of the table"),
            ("x_furlong,z_furlong\n1,2\n", "says 'furlong'"),
            ("x_mm,z_mm\n", "holds no line"),
        ],
    )
    def test_what_is_wrong_is_named(self, tmp_path, text, message):
        (tmp_path / "a.csv").write_text(text)
        with pytest.raises(FileError, match=message):
            read(tmp_path / "a.csv")


class TestSettings:
    def test_scale_toe_and_origin(self, tmp_path):
        path = svg(tmp_path / "a.svg", polygon(OUTLINE))
        np.testing.assert_allclose(read(path, scale=2.0), 2 * LOWER, atol=1e-9)
        np.testing.assert_allclose(read(path, toe="left"), LOWER[::-1] * [-1, 1], atol=1e-9)
        np.testing.assert_allclose(read(path, origin="centre"), LOWER - [5e-3, -5e-3], atol=1e-9)

    @pytest.mark.parametrize(
        "given", [{"units": "feet"}, {"scale": 0.0}, {"toe": "up"}, {"origin": "heel"}, {"layer": "top"}]
    )
    def test_what_cannot_be_used_is_refused(self, tmp_path, given):
        (setting,) = given
        with pytest.raises(SettingError, match=rf"foot\.{setting} = .*must be"):
            read(svg(tmp_path / "a.svg", polygon(OUTLINE)), **given)


class TestWhatIsNoSole:
    def test_several_outlines_are_listed(self, tmp_path):
        both = polygon(OUTLINE, id="a") + '<g id="screw"><circle cx="20" cy="5" r="4"/></g>'
        path = svg(tmp_path / "a.svg", both)
        with pytest.raises(
            FileError, match=r"holds 2: a closed outline of 250 x 50 mm; .* 8 x 8 mm on 'screw'"
        ):
            read(path)

    def test_a_gap_is_two_lines(self, tmp_path):
        def draw(space):
            space.add_line((-100, 0), (0, -10))
            space.add_line((0.5, -10), (100, 0))

        with pytest.raises(FileError, match=r"holds 2: an open line .*close gaps wider than 0\.01 mm"):
            read(drawing(tmp_path / "a.dxf", draw))

    def test_wrong_units_show_in_the_length(self, tmp_path):
        path = drawing(tmp_path / "a.dxf", lambda space: space.add_line((-130, 0), (130, 0)), units=6)
        with pytest.raises(FileError, match=r"the sole would be 260 m long\. Set foot\.units"):
            read(path)

    def test_a_drawing_without_units(self, tmp_path):
        path = drawing(tmp_path / "a.dxf", lambda space: space.add_line((-130, 0), (130, 0)), units=0)
        with pytest.raises(FileError, match=r"does not say in which unit it is\. Set foot\.units"):
            read(path)
        np.testing.assert_allclose(read(path, units="mm"), [(-0.13, 0), (0.13, 0)])

    def test_an_origin_beside_the_foot(self, tmp_path):
        path = drawing(tmp_path / "a.dxf", lambda space: space.add_line((500, 300), (760, 300)))
        with pytest.raises(FileError, match=r"between x 500 and 760 mm.*foot\.origin=centre"):
            read(path)
        np.testing.assert_allclose(read(path, origin="centre"), [(-0.13, 0), (0.13, 0)], atol=1e-12)

    def test_a_line_that_crosses_itself(self, tmp_path):
        eight = [(-100, -10), (100, 10), (100, -10), (-100, 10)]
        with pytest.raises(FileError, match=r"crosses itself at \(0\.00, 0\.00\) mm"):
            read(svg(tmp_path / "a.svg", polygon(eight)))

    @pytest.mark.parametrize("ending", ["dxf", "svg", "csv"])
    def test_a_file_that_is_not_there_or_something_else(self, tmp_path, ending):
        path = tmp_path / f"a.{ending}"
        with pytest.raises(FileError, match=rf"a\.{ending}.*cannot be read .No such file"):
            read(path)
        path.write_bytes(b"\x00\xff\xfe not a drawing")
        with pytest.raises(FileError, match=rf"a\.{ending}"):
            read(path)

    def test_a_drawing_of_nothing(self, tmp_path):
        with pytest.raises(FileError, match="holds no line"):
            read(svg(tmp_path / "a.svg", "<text>sole</text>"))


def test_of_vertical_sides_the_lowest_ends_count():
    box = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, 0.0)])
    for shift in range(len(box)):
        np.testing.assert_array_equal(lower_edge(np.roll(box, shift, axis=0)), [(-1, -1), (1, -1)])
