"""One sole as the drawing programs of others write it: it is read to 0.03 mm, whatever the dialect."""

import io

import ezdxf
import numpy as np
import pytest
from ezdxf.math import BSpline
from shapely import LineString, Point

import footopt as fo
from footopt.errors import FileError

TOE = 80.0 * np.sqrt(0.5)
#: A closed outline, mm: a heel of 20 mm radius, a flat sole, an eighth of a circle of 80 mm to the toe.
PATH = (
    f"M-120 10L-120-10A20 20 0 0 1-100-30L40-30A80 80 0 0 1{40 + TOE:.6f} {50 - TOE:.6f}L{40 + TOE:.6f} 10Z"
)
BULGES = [(-120, 10, 0), (-120, -10, np.tan(np.pi / 8)), (-100, -30, 0), (40, -30, np.tan(np.pi / 16)),
          (40 + TOE, 50 - TOE, 0), (40 + TOE, 10, 0)]  # fmt: skip


def sole():
    """Its lower edge from heel to toe, m, its box's middle in the origin."""
    heel, toe = np.radians(np.linspace(180, 270, 500)), np.radians(np.linspace(270, 315, 500))
    behind = (-100 + 20 * np.cos(heel), -10 + 20 * np.sin(heel))
    edge = np.concatenate([behind, (40 + 80 * np.cos(toe), 50 + 80 * np.sin(toe))], axis=1).T
    return 1e-3 * (edge - [0.5 * (TOE - 80.0), -10.0])


def inkscape():
    return (
        '<?xml version="1.0" encoding="UTF-8" standalone="no"?>\n'
        '<svg xmlns="http://www.w3.org/2000/svg" width="210mm" height="297mm" viewBox="0 0 210 297" '
        'version="1.1" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" '
        'xmlns:sodipodi="http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd">'
        '<sodipodi:namedview id="v" inkscape:document-units="mm"><sodipodi:guide position="1,2"/>'
        "</sodipodi:namedview>"
        '<defs id="d"><clipPath id="c"><rect width="9" height="9"/></clipPath></defs>'
        '<g inkscape:label="Hidden" inkscape:groupmode="layer" id="l1" style="display:none">'
        '<rect x="1" y="2" width="80" height="90"/></g>'
        '<g inkscape:label="Layer 1" inkscape:groupmode="layer" id="l2" transform="translate(105.3,-12.1)">'
        f'<path style="fill:none;stroke:#000000" transform="matrix(1,0,0,-1,0,99)" d="{PATH}" '
        'sodipodi:nodetypes="cccccc" id="path9"/></g></svg>'
    )


def document(version="R2010", units=4):
    made = ezdxf.new(version)
    made.units = units
    return made, made.modelspace()


def text_of(made):
    out = io.StringIO()
    made.write(out)
    return out.getvalue()


def pieces(space, size=1.0, **attributes):
    """Lines and arcs, in no order."""
    at = size * np.array([(x, y) for x, y, _ in BULGES])
    for i in (4, 0, 2, 5):
        space.add_line(at[i], at[(i + 1) % 6], dxfattribs=attributes)
    space.add_arc((40 * size, 50 * size), 80 * size, 270, 315, dxfattribs=attributes)
    space.add_arc((-100 * size, -10 * size), 20 * size, 180, 270, dxfattribs=attributes)


def autocad():
    made, space = document("R2018")
    space.add_lwpolyline(BULGES, "xyb", close=True)
    space.add_circle((-60, -5), 4)
    space.add_text("SOLE 42")
    space.add_linear_dim((0, 60), (-120, 10), (90, 10)).render()
    made.layout().add_line((0, 0), (210, 297))
    return text_of(made)


def autocad_mirrored():
    """Mirrored by hand: extrusion along -z, angles and centres in its own coordinates."""
    made, space = document("R2000")
    back = {"extrusion": (0, 0, -1)}
    at = [(-x, y) for x, y, _ in BULGES]
    space.add_lwpolyline([(-x, y, -b) for x, y, b in BULGES[:3]], "xyb", dxfattribs=back)
    space.add_arc((-40, 50), 80, 225, 270, dxfattribs=back)
    space.add_lwpolyline([at[2], at[3]], dxfattribs=back)
    space.add_lwpolyline([at[4], at[5], at[0]], dxfattribs=back)
    return text_of(made)


def autocad_12():
    made = ezdxf.new("R12")
    made.modelspace().add_polyline2d(BULGES, format="xyb", close=True)
    return text_of(made)


def librecad():
    """Blocks are flattened with a scale of 0 along z."""
    made, space = document("R2007")
    block = made.blocks.new("foot")
    pieces(block, 1.0, layer="0")
    made.layers.add("Sohle").off()
    space.add_blockref("foot", (3, 4), {"layer": "Kontur", "xscale": -1, "yscale": -1, "rotation": 180})
    return text_of(made).replace("41\n-1.0", "43\n0.0\n 41\n-1.0")


def rhino():
    """One rational spline of second degree, which is a circle exactly, and lines as polylines, in inches."""
    made, space = document("R2010", units=1)
    by = 1 / 25.4
    for centre, radius, begin, end in (((40, 50), 80, 270, 315), ((-100, -10), 20, 180, 270)):
        half = np.radians(0.5 * (end - begin))
        angles = np.radians([begin, 0.5 * (begin + end), end])
        radii = radius / np.array([1.0, np.cos(half), 1.0])
        points = by * (np.array(centre) + radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1))
        curve = BSpline(points, order=3, weights=[1.0, np.cos(half), 1.0])
        space.add_spline().apply_construction_tool(curve)
    at = by * np.array([(x, y) for x, y, _ in BULGES])
    space.add_lwpolyline(at[[4, 5, 0, 1]])
    space.add_polyline3d([(*at[2], 0.0), (*at[3], 0.0)])
    return text_of(made)


def openscad():
    """Lines of six digits, neither a header nor tables."""
    edge = 1e3 * sole()
    points = np.concatenate([edge, [(edge[-1, 0], 20.0), (edge[0, 0], 20.0)]])
    text = "  0\nSECTION\n  2\nBLOCKS\n  0\nENDSEC\n  0\nSECTION\n  2\nENTITIES\n"
    for (x, z), (u, w) in zip(points, np.roll(points, -1, axis=0), strict=True):
        text += f"  0\nLINE\n  8\n0\n 10\n{x:.6g}\n 20\n{z:.6g}\n 11\n{u:.6g}\n 21\n{w:.6g}\n"
    return text + "  0\nENDSEC\n  0\nEOF\n"


PROGRAMS = (inkscape, autocad, autocad_mirrored, autocad_12, librecad, rhino, openscad)
UNITS = {autocad_12: "mm", openscad: "mm"}  # of files that say none


def test_a_sole_that_is_drawn_in_another_plane_is_not_read_as_flat(tmp_path):
    made, space = document("R2010", units=4)
    space.add_polyline3d([(-100, 0, 5), (0, 0, -5), (100, 0, 5)])
    made.saveas(tmp_path / "xz.dxf")
    with pytest.raises(FileError, match="leaves the xy plane"):
        fo.read_foot(tmp_path / "xz.dxf")


@pytest.mark.parametrize("program", PROGRAMS)
def test_one_sole_of_every_program_is_the_same(program, tmp_path):
    path = tmp_path / ("a.svg" if program == inkscape else "a.dxf")
    path.write_text(program())
    if program in UNITS:
        with pytest.raises(FileError, match=r"does not say in which unit it is"):
            fo.read_foot(path, origin="centre")
    found = fo.read_foot(path, units=UNITS.get(program), origin="centre").contour
    true = sole()
    assert max(LineString(true).distance(Point(place)) for place in found) < 3e-5
    assert found[[0, -1], 0] == pytest.approx(true[[0, -1], 0], abs=1.1e-5)  # a steep heel is a vertical side
    assert len(found) > 30
