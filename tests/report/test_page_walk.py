"""The page's own walk, in JavaScript, agrees with the compiled one, or the page says why it cannot."""

import numpy as np
import pytest
from browsers import Page, browser_needed
from every_effect import LAYERS, PATCHES

import footopt as fo
from footopt.files.io import plain
from footopt.report import page
from footopt.report.page.file import NOTHING
from footopt.report.page.walks import physics, spline
from footopt.walk import OBJECTIVES
from footopt.walk.accuracy import resolve
from footopt.walk.objectives import offered

NAMES = tuple(name for name in offered(fo.Scene()) if name in OBJECTIVES)
#: Walks with each of these heights, and gives why they failed and what they are judged by.
WALK = """
const walked = FEET.map((k) => {
  const walk = simulate(plates(k), { zeta: P.sand.zeta, mass: P.walker.mass });
  return [walk.reason, NAMES.map((name) => walk.objectives[name] ?? null)];
});
"""


def in_browser(browser, folder, scene, accuracy, space, feet):
    """What the page's scripts make of soles, on a page of the scene."""
    content = {
        "title": "A walk",
        "columns": [],
        "physics": physics(scene, accuracy, space),
        "space": spline(space) if isinstance(space, fo.Waypoints) else None,
        "designs": NOTHING,
    }
    Page(browser, page.write(folder / "report.html", content))
    return browser.execute_script(f"const [FEET, NAMES] = arguments;{WALK}return walked", plain(feet), NAMES)


def differences(walked, scene, accuracy, space, feet):
    """The largest relative difference of any objective of each walk from the compiled walk's."""
    known = fo.evaluate(feet, scene, accuracy, NAMES, space)
    assert [reason for reason, _ in walked] == known.reasons.tolist()
    values = np.array([values for _, values in walked], float)
    assert np.array_equal(np.isnan(values), np.isnan(known.values))
    return np.nan_to_num(abs(values / known.values - 1.0)).max(axis=1)


SCENES = {
    "hard sand": fo.Scene(fo.Sand.named("hard")),
    "every effect": fo.Scene(
        gait=fo.Gait.human(period=1.4, pitch="measured"),
        walker=fo.Walker(45.0, 0.4, 0.35, 3.7),
        effects=(fo.Slope(-6.0), LAYERS, PATCHES, fo.Inertia(), fo.LeadingEdge()),
    ),
}


@browser_needed
@pytest.mark.parametrize("name", SCENES)
def test_soles_walk_as_in_python_in_a_browser_or_the_page_says_what_rounding_does(name, browser, tmp_path):
    """A few walks hang on their last digits: a plate turns round, or a step is halved, or not."""
    scene, accuracy, space = SCENES[name], resolve("standard"), fo.Waypoints(ankle=(0.02, 0.03))
    feet = space.random(50, seed=17)
    walked = in_browser(browser, tmp_path, scene, accuracy, space, feet)
    off = differences(walked, scene, accuracy, space, feet)
    apart = off >= 1e-9
    said = browser.execute_script(
        "return arguments[0].map((k) => rounding(plates(k),"
        "{ zeta: P.sand.zeta, mass: P.walker.mass })?.[1] ?? 0)", feet[apart].tolist()
    )  # fmt: skip
    assert (off[apart] < 10.0 * np.array(said, float)).all()
    assert apart.mean() < 0.1


@browser_needed
def test_a_drawing_walks_as_in_python(browser, tmp_path):
    x = np.linspace(-0.12, 0.12, 500)
    z = -0.02 + 1e-4 * np.random.default_rng(4).standard_normal(500)
    foot = fo.Foot(np.stack([x, z], axis=1), ankle=(0.02, 0.03))
    scene, accuracy = SCENES["every effect"], fo.Accuracy(plates=56)
    walked = in_browser(browser, tmp_path, scene, accuracy, foot, [None])
    assert differences(walked, scene, accuracy, None, [foot]).max() < 1e-9
