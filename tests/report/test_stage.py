"""The stage: prints as deep as soles were, arrows as long as forces; the page draws what figures draw."""

import numpy as np
import pytest
from browsers import Page, browser_needed

import footopt as fo
from footopt.report import page
from footopt.report.page.walks import ARROWS
from footopt.report.stage import Stage, View
from footopt.report.style import new_figure

WORLD = (fo.Slope(5), fo.Patches((0.4,), (0.9,), (2.5,)), fo.Layers((0.03,), (0.3,)))


def walked(effects=()):
    foot = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4])
    return fo.simulate(foot, fo.Scene(effects=effects), "draft")


def lines(axes, name):
    """The points of a part of the picture."""
    return [found.get_xydata() for found in axes.lines if found.get_label() == f"_{name}"]


@browser_needed
def test_the_page_draws_what_figures_and_films_draw(browser, tmp_path):
    walk = walked(WORLD)
    content = page.walk_content(walk, {"accuracy": {"name": "draft"}, "scene": {"effects": {}}})
    shown = Page(browser, page.write(tmp_path / "page.html", content))
    times = walk.t[np.searchsorted(walk.t, np.subtract(shown.js("Array.from(open(0).when)"), 1e-6))[40::60]]
    here = Stage(walk, times, ARROWS)
    for i, t in enumerate(times):
        hip = here.body.hip[i, 0]
        for view in (View(-0.5, 3.0, -0.2, 1.2, 0.03, 4e-4, 500.0),
                     View(hip - 0.4, hip + 0.4, -0.2, 0.2, 0.007, 8e-4, 50.0, True)):  # fmt: skip
            axes = new_figure(7.0, 3.0).subplots()
            here.draw_ground(axes, view)
            here.draw_feet(axes, i, view)
            code = (
                f"(() => {{ const walk = open(0), view = {page.file.json.dumps(view._asdict())}, "
                f"ground = groundPicture(view), "
                f"body = bodyPicture(instant(walk, {t}), view, [], []); "
                "return [[...ground.shapes, ...body.shapes], [...ground.words, ...body.words]]; })()"
            )  # fmt: skip
            shapes, words = shown.js(code)
            found = {name.removesuffix(" dots"): np.array(points, float) for name, points, *_ in shapes}
            for name in ("left-leg", "right-sole", "force", "key", "gravity"):
                (drawn,) = lines(axes, name)
                assert np.shape(found[name])[1] == 2
                if name == "right-sole":  # the page has fewer points of it
                    assert found[name][[0, -1]] == pytest.approx(drawn[[0, -1]], abs=2e-3)
                else:
                    assert found[name] == pytest.approx(drawn, abs=2e-3, nan_ok=True)
            texts = {text.get_text(): text.get_position() for text in axes.texts}
            assert {word[2] for word in words} == set(texts)
