"""One picture of the scene: the page, which walks by itself, draws the parts that figures and films draw."""

from functools import cache

import numpy as np
import pytest
from browsers import Page, browser_needed
from matplotlib.colors import same_color

import footopt as fo
from footopt.report import page, picture
from footopt.report.parts import LOOKS, View, shapes
from footopt.report.picture import Picture
from footopt.report.style import PALETTE, new_figure

WORLDS = {
    "plain": (),
    "slope, patch and layer": (fo.Slope(5), fo.Patches((0.4,), (0.9,), (2.5,)), fo.Layers((0.03,), (0.3,))),
    "footprints": (fo.Footprints(),),
}


@cache
def walked(name):
    foot = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4])
    return fo.simulate(foot, fo.Scene(effects=WORLDS[name]), "draft")


def views(hip):
    """From afar and close."""
    return View(-0.5, 3.0, -0.2, 1.2, 0.03, 4e-4, 500.0), View(
        hip - 0.4, hip + 0.4, -0.2, 0.2, 0.007, 8e-4, 50.0, True
    )


def away(points, others):
    """How far points are at most from a line through others, m; gaps are left out."""
    points, others = (np.array(p, float) for p in (points, others))
    if len(others) == 1:
        return np.linalg.norm(points - others, axis=1).max()
    begin, along = others[:-1], np.diff(others, axis=0)
    known = np.isfinite(along).all(axis=1)
    begin, along = begin[known], along[known]
    apart = points[np.isfinite(points).all(axis=1), None] - begin
    part = np.clip((apart * along).sum(-1) / np.maximum((along**2).sum(-1), 1e-30), 0.0, 1.0)
    return np.linalg.norm(apart - part[..., None] * along, axis=-1).min(axis=1).max(initial=0.0)


@browser_needed
@pytest.mark.parametrize("world", WORLDS)
def test_the_page_draws_what_figures_and_films_draw(world, browser, tmp_path):
    walk = walked(world)
    content = page.walk_content(walk, {"accuracy": {"name": "draft"}, "scene": {"effects": {}}})
    shown = Page(browser, page.write(tmp_path / "page.html", content))
    times = walk.t[np.searchsorted(walk.t, np.subtract(shown.js("Array.from(open(0).when)"), 1e-6))[40::60]]
    here = Picture(walk, times, page.walks.ARROWS)
    for i, t in enumerate(times):
        for view in views(here.body.hip[i, 0]):
            mine, words = here.shapes(i, view)
            found = shown.js(
                f"(() => {{ const walk = open(0), view = {page.file.json.dumps(view._asdict())}, "
                f"top = (walk.surface ?? printed(walk))({t}); "
                f"return picture(things(walk, instant(walk, {t}), top, view), view); }})()"
            )
            assert [part["name"] for part, *_ in found["shapes"]] == [shape.part for shape in mine]
            for (drawn, points, *_), shape in zip(found["shapes"], mine, strict=True):
                part = drawn["name"]
                points = np.array([[np.nan if v is None else v for v in p] for p in points]).reshape(-1, 2)
                # two cells of a drawn print, which is steep at its ends
                off = 8e-3 if part in ("print", "rim", "surface") else 2e-3
                assert away(points, shape.points) < off, (part, t)
                assert away(shape.points, points) < off, (part, t)
            assert [word[2] for word in found["words"]] == [label.text for label in words]
            np.testing.assert_allclose(
                [w[:2] for w in found["words"]], [label[:2] for label in words], atol=1e-3
            )


@browser_needed
def test_the_page_has_the_looks_of_figures(browser, tmp_path):
    content = page.walk_content(walked("plain"), {"accuracy": {"name": "draft"}, "scene": {"effects": {}}})
    shown = Page(browser, page.write(tmp_path / "page.html", content))
    drawn = {p.get_attribute("class"): p for p in shown.all("#walk .wide svg path")}
    assert set(drawn) == set(LOOKS) - {"layer", "patch", "ghost", "edge", "paint", "gravity"}
    for part, element in drawn.items():
        look = LOOKS[part]
        for name, role in (("fill", look.fill), ("stroke", look.stroke)):
            value = element.value_of_css_property(name)
            numbers = (
                [int(v) / 255 for v in value.removeprefix("rgb(").removesuffix(")").split(",")]
                if role
                else None
            )
            assert same_color(numbers, PALETTE[role]) if role else value == "none"
        if look.stroke:
            wide = float(element.value_of_css_property("stroke-width").removesuffix("px"))
            assert wide == pytest.approx(look.width * 96 / 72, rel=1e-3)
        assert float(element.value_of_css_property("opacity")) == pytest.approx(look.opacity)


@pytest.mark.slow  # of compiling
def test_figures_draw_every_part_as_it_looks():
    axes = new_figure(7.0, 3.0).subplots()
    here = Picture(walked("slope, patch and layer"), [1.2])
    shapes, labels = here.shapes(0, views(here.body.hip[0, 0])[1])
    picture.draw(axes, shapes, labels)
    lines = [line for line in axes.lines if line.get_label().startswith("_")]
    assert [line.get_label()[1:] for line in lines] == [s.part for s in shapes if LOOKS[s.part].stroke]
    for line in lines:
        look = LOOKS[line.get_label()[1:]]
        assert same_color(line.get_color(), PALETTE[look.stroke])
        assert (line.get_markersize() if look.dots else line.get_linewidth()) == look.width
    orders = [line.get_zorder() for line in lines if line.get_label() not in ("_force", "_gravity")]
    assert orders == sorted(orders)
    assert {label.text for label in labels} <= {text.get_text() for text in axes.texts}


def test_a_drawn_print_is_as_deep_as_soles_were():
    walk = walked("plain")
    _, z = picture.printed(walk, np.array([0.1, 1.5, walk.t[-1]]))
    assert np.all(np.diff(z, axis=0) <= 0.0)  # it never fills
    low = Picture(walk, np.linspace(walk.t[0], walk.t[-1], 400)).body.sole[..., 1].min()
    assert z[-1].min() == pytest.approx(low, abs=1e-3)
    turns = np.diff(np.sign(np.diff(z[-1][z[-1] < 0.0])))
    assert (turns != 0).sum() < 30  # no teeth: a few in each print


def test_an_arrow_is_as_long_as_its_force():
    rows = [(0.0, 0.0, 300.0, 400.0), (1.0, 2.0, 0.0, 1e-7), (5.0, 5.0, 0.0, 200.0)]
    force = [dict(zip(("x", "z", "fx", "fz"), row, strict=True)) for row in rows]
    view = View(-9.0, 9.0, -9.0, 9.0, unit=0.1, metres=0.01)
    [[_, line, _]], _ = shapes({"force": force}, view)
    assert len(line) == 2 * 7  # one is too short to be seen
    assert line[:2].tolist() == [[0.0, 0.0], [3.0, 4.0]]
    assert np.isnan(line[2]).all()
    [[_, tips, _]], _ = shapes({"force": force}, view._replace(close=True))
    assert tips[:2].tolist() == [[-3.0, -4.0], [0.0, 0.0]]
    heads = np.linalg.norm(tips[[3, 5]] - tips[4], axis=1)
    assert heads == pytest.approx(1.3 * 0.1 * np.sqrt(1.16))
