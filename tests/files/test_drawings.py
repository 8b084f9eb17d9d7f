"""Drawings of other people: what a second reader sees is what is read."""

import ezdxf
import numpy as np
import pytest
from ezdxf import path as curves
from shapely import LinearRing, LineString, MultiLineString
from svgpathtools import parse_path

import footopt as fo
from footopt.errors import FileError
from footopt.files import soles
from footopt.files.soles import lines_of

MM = 'width="400mm" height="400mm" viewBox="-200 -200 400 400"'


def svg(path, shapes, head=MM):
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{shapes}</svg>')
    return path


def drawn(path, draw, units=4):
    document = ezdxf.new("R2010")
    document.units = units
    draw(document.modelspace())
    document.saveas(path)
    return path


def matrix(a, b, c, d, e, f):
    return np.array([[a, c, e], [b, d, f]])


def rotation(deg, scale=1.0):
    c, s = scale * np.cos(np.radians(deg)), scale * np.sin(np.radians(deg))
    return matrix(c, s, -s, c, 0, 0)


TRANSFORMS = {
    "rotate(30)": rotation(30),
    "rotate(-75 10 20)": None,
    "scale(-1 1)": matrix(-1, 0, 0, 1, 0, 0),
    "skewX(25)": matrix(1, 0, np.tan(np.radians(25)), 1, 0, 0),
    "skewY(-15)": matrix(1, np.tan(np.radians(-15)), 0, 1, 0, 0),
    "matrix(.9 .2 -.4 1.1 7 -3)": matrix(0.9, 0.2, -0.4, 1.1, 7, -3),
    "matrix(-.5 .8 .7 .6 0 12)": matrix(-0.5, 0.8, 0.7, 0.6, 0, 12),
}
around = rotation(-75)
TRANSFORMS["rotate(-75 10 20)"] = np.column_stack(
    [around[:, :2], np.array([10, 20]) - around[:, :2] @ np.array([10, 20])]
)
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
}  # fmt: skip


def apart(found, expected):
    """The largest distance of two lines from each other (m)."""
    return found.hausdorff_distance(expected)


class TestSvg:
    @pytest.mark.parametrize("grouped", [False, True])
    @pytest.mark.parametrize("transform", TRANSFORMS)
    @pytest.mark.parametrize("shape", SHAPES)
    def test_every_transform_of_every_shape_is_what_another_reader_sees(
        self, tmp_path, shape, transform, grouped
    ):
        change = TRANSFORMS[transform]
        if grouped:
            drawing = f'<g transform="translate(3 -4)"><g transform="{transform}">{shape}</g></g>'
            change = change + np.array([[0, 0, 3], [0, 0, -4]])
        else:
            drawing = shape.replace("/>", f' transform="{transform}"/>')
        (line,) = lines_of(svg(tmp_path / "a.svg", drawing))
        other = parse_path(SHAPES[shape])
        places = np.array([part.point(t) for part in other for t in np.linspace(0, 1, 400)])
        expected = np.stack([places.real, places.imag], axis=1) @ change[:, :2].T + change[:, 2]
        expected = 1e-3 * expected * [1.0, -1.0]
        line = LinearRing(line.points) if line.closed else LineString(line.points)
        assert line.is_closed == (SHAPES[shape].lower()[-1] == "z")
        assert apart(line, LineString(expected)) < 4e-5

    @pytest.mark.parametrize("by", ["defs", "symbol", "mask", "marker"])
    def test_what_is_drawn_elsewhere_is_drawn_there_and_nowhere_else(self, tmp_path, by):
        drawing = (
            f'<{by} id="all"><polyline id="sole" points="-50,0 0,30 60,0"/></{by}>'
            '<use href="#sole" transform="rotate(180)" y="3"/>'
            '<use xmlns:xlink="http://www.w3.org/1999/xlink" xlink:href="#sole" x="4"/>'
        )
        found = lines_of(svg(tmp_path / "a.svg", drawing))
        if by in ("mask", "marker"):
            assert found == []  # nothing of them is drawn but by what they are for
            return
        ends = [line.points[[0, -1]] for line in found]
        np.testing.assert_allclose(
            ends, 1e-3 * np.array([[(50, 3), (-60, 3)], [(-46, 0), (64, 0)]]), atol=1e-12
        )

    def test_a_drawing_without_names_offers_none(self, tmp_path):
        two = '<rect x="-60" y="0" width="120" height="9"/><rect x="-60" y="20" width="120" height="9"/>'
        with pytest.raises(FileError, match=r"it holds 2: .*mm\. Delete what is not the sole"):
            soles.read(svg(tmp_path / "a.svg", two))

    def test_damaged_xml_is_said_with_its_place(self, tmp_path):
        path = svg(tmp_path / "a.svg", '<rect width="3" height="4"/>')
        path.write_text(path.read_text()[:-9])
        with pytest.raises(
            FileError, match=r"cannot be read as SVG \(its XML breaks off .* in line 1, column"
        ):
            soles.read(path)


class TestDxf:
    def test_without_a_header_it_has_no_unit(self, tmp_path):
        text = "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n-100\n20\n0\n11\n100\n21\n0\n0\nENDSEC\n0\nEOF\n"
        (tmp_path / "a.dxf").write_text(text)
        with pytest.raises(FileError, match=r"does not say in which unit it is\. Set foot\.units"):
            soles.read(tmp_path / "a.dxf")
        assert np.ptp(soles.read(tmp_path / "a.dxf", units="mm").points[:, 0]) == pytest.approx(0.2)

    def test_lines_of_old_programs_with_both_x_before_both_y(self, tmp_path):
        line = "0\nLINE\n8\n1\n10\n{}\n11\n{}\n20\n{}\n21\n{}\n30\n0.0\n31\n0.0\n"
        lines = line.format(-100.0, 0.0, 0.0, -20.0) + line.format(0.0, 100.0, -20.0, 0.0)
        text = f"0\nSECTION\n2\nENTITIES\n{lines}0\nENDSEC\n0\nEOF\n"
        (tmp_path / "a.dxf").write_text(text)
        sole = soles.read(tmp_path / "a.dxf", units="mm").points
        np.testing.assert_allclose(sole, [(-0.1, 0), (0, -0.02), (0.1, 0)])

    @pytest.mark.parametrize("zscale", [0.0, 1.0])
    def test_blocks_that_are_turned_scaled_mirrored_and_flat(self, tmp_path, zscale):
        def draw(space):
            block = space.doc.blocks.new("FOOT")
            block.add_lwpolyline([(-50, 0, 0.3), (0, -10, 0), (50, 0, 0)], "xyb")
            block.add_ellipse((0, 10), (50, 10), 0.4, 0.0, 2.0)
            space.add_blockref(
                "FOOT", (3, 4), dxfattribs={"xscale": -2, "yscale": 1.5, "zscale": zscale, "rotation": 20}
            )

        path = drawn(tmp_path / "a.dxf", draw)
        found = lines_of(path)
        document = ezdxf.readfile(path)
        (insert,) = document.modelspace()
        insert.dxf.zscale = 1.0
        expected = [
            1e-3 * np.array([(v.x, v.y) for v in curves.make_path(entity).flattening(1e-3, 64)])
            for entity in insert.virtual_entities()
        ]
        assert apart(MultiLineString([line.points for line in found]), MultiLineString(expected)) < 5e-5

    def test_holes_are_left_out_and_listed(self, tmp_path):
        def draw(space):
            space.add_circle((20, 0), 4)
            space.add_lwpolyline([(-100, -20), (100, -20), (100, 20), (-100, 20)], close=True)
            space.add_circle((-60, 0), 6)

        foot = fo.Foot.from_file(drawn(tmp_path / "a.dxf", draw))
        np.testing.assert_allclose(foot.contour, [(-0.1, -0.02), (0.1, -0.02)])
        (note,) = foot.notes
        assert "not its holes: a closed outline of 11.9" in note
        assert note.count("a closed outline of") == 3

    @pytest.mark.parametrize("inner", ["sole", "open"])
    def test_a_frame_round_a_sole_is_no_outline(self, tmp_path, inner):
        def draw(space):
            space.add_lwpolyline([(-150, -90), (150, -90), (150, 90), (-150, 90)], close=True)
            space.add_lwpolyline([(-100, 0), (0, -20), (100, 0)], close=inner == "sole")

        with pytest.raises(FileError, match="it holds 2"):
            soles.read(drawn(tmp_path / "a.dxf", draw))

    def test_a_body_beside_the_outline_is_left_alone(self, tmp_path):
        def draw(space):
            space.add_lwpolyline([(-100, 0), (0, -20), (100, 0)])
            mesh = space.add_polymesh((3, 3))
            for i in range(3):
                for j in range(3):
                    mesh.set_mesh_vertex((i, j), (i, j, 1))
            ezdxf.render.MeshBuilder.from_mesh  # noqa: B018
            box = ezdxf.render.forms.cube()
            box.render_polyface(space)

        path = drawn(tmp_path / "a.dxf", draw)
        np.testing.assert_allclose(soles.read(path).points, [(-0.1, 0), (0, -0.02), (0.1, 0)])

    def test_what_is_damaged_is_said_in_plain_words(self, tmp_path):
        path = drawn(tmp_path / "a.dxf", lambda space: space.add_line((-100, 0), (100, 0)))
        path.write_text(path.read_text().replace("ENTITIES", "ENTITIE\nS"))
        with pytest.raises(FileError, match=r"cannot be read as DXF: it is damaged, or something else"):
            soles.read(path)
