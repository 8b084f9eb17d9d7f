"""The page's stage draws what figures and films draw."""

import json

import numpy as np
import pytest
from browsers import Page, browser_needed
from every_effect import ALL

import footopt as fo
from footopt.report import page
from footopt.report.stage import Stage, draw_ground, draw_key
from footopt.report.style import new_figure


def lines(axes, name):
    """The points of a part of the picture."""
    return [found.get_xydata() for found in axes.lines if found.get_label() == f"_{name}"]


@browser_needed
def test_the_page_draws_what_figures_and_films_draw(browser, tmp_path):
    foot = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4])
    walk = fo.simulate(foot, fo.Scene(effects=ALL[:-1]), "draft")
    content = page.walk_content(walk, {"accuracy": {"name": "draft"}, "scene": {"effects": {}}})
    shown = Page(browser, page.write(tmp_path / "page.html", content))
    times = walk.t[np.searchsorted(walk.t, np.subtract(shown.js("Array.from(open(0).when)"), 1e-6))[40::60]]
    here = Stage(walk, times)
    for i, t in enumerate(times):
        hip = here.body.hip[i, 0]
        for left, right, low, high, close in (
            (-0.5, 3.0, -0.2, 1.2, False),
            (hip - 0.4, hip + 0.4, -0.2, 0.2, True),
        ):
            axes = new_figure(7.0, 3.0).subplots()
            axes.set(xlim=(left, right), ylim=(low, high))
            draw_ground(axes, here.ground)
            arrows = here.draw_feet(axes, i, 2000.0, close=close)
            draw_key(axes, arrows, 500.0)
            view = {"left": left, "right": right, "low": low, "high": high, "close": close,
                    "unit": 1e-9, "metres": 1 / 2000.0, "newtons": 500.0}  # fmt: skip
            code = (
                f"(() => {{ const walk = open(0), view = {json.dumps(view)}, "
                f"ground = groundPicture(view), body = bodyPicture(instant(walk, {t}), view, []); "
                "return [[...ground.shapes, ...body.shapes], [...ground.words, ...body.words]]; })()"
            )
            shapes, words = shown.js(code)
            found = {name.removesuffix(" dots"): np.array(points, float) for name, points, *_ in shapes}
            (leg,), (sole,) = lines(axes, "left-leg"), lines(axes, "right-sole")
            assert found["left-leg"] == pytest.approx(leg, abs=2e-3)
            assert found["right-sole"][[0, -1]] == pytest.approx(
                sole[[0, -1]], abs=2e-3
            )  # the page has fewer
            begin, end = found["force"][0::7], found["force"][1::7]
            drawn = np.column_stack([end if close else begin, end - begin])
            along = np.stack([arrows.U, arrows.V], axis=1) / arrows.scale
            here_drawn = np.column_stack([arrows.get_offsets(), along])
            long = (each[np.linalg.norm(each[:, 2:], axis=1) > 1e-3] for each in (drawn, here_drawn))
            assert next(long) == pytest.approx(next(long), abs=2e-3)
            texts = {line for text in axes.texts for line in text.get_text().split("\n")}
            assert texts <= {word[2] for word in words}
