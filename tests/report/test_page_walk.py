"""The page's own walk, in JavaScript, agrees with the compiled one, or the page says why it cannot."""

from dataclasses import replace

import numpy as np
import pytest
from browsers import Page, browser_needed

import footopt as fo
from footopt.files.io import plain
from footopt.report import page
from footopt.report.page.physics import physics, spline
from footopt.report.page.study import NOTHING
from footopt.walk import OBJECTIVES
from footopt.walk.accuracy import resolve
from footopt.walk.objectives import offered

NAMES = tuple(name for name in offered(fo.Scene()) if name in OBJECTIVES)
#: Walks with each of these heights, and gives why they failed and what they are judged by.
WALK = """
const walked = FEET.map((k) => {
  const steps = P.accuracy.plates * P.accuracy.parts, points = k ? arcPoints(k, steps) : unpack(P.points);
  const walk = simulate(points, { zeta: P.sand.zeta, mass: P.walker.mass });
  return [walk.reason, NAMES.map((name) => walk.objectives[name] ?? null)];
});
"""


def in_browser(browser, folder, scene, accuracy, space, feet):
    """What the page's scripts make of soles, on a page of the scene."""
    content = {
        "title": "A walk",
        "columns": [],
        "physics": physics(scene, accuracy, space),
        "space": spline(space),
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


def drawn(rng):
    """A scene, an accuracy and a space as users could have them.

    Three kernels walk them all, which other tests have compiled.
    """
    kernel = int(rng.integers(3))
    effects = [
        fo.Slope(rng.uniform(-10, 10)),
        fo.Layers((0.02, 0.05), tuple(rng.uniform(0.3, 3, 2))),
        fo.Patches((0.2, 1.0), (0.7, 1.4), tuple(rng.uniform(0.3, 3, 2)), rng.uniform(0.02, 0.2)),
        fo.Inertia(rho=rng.uniform(500, 2500)),
        fo.LeadingEdge(),
    ]
    gait = replace(
        fo.Gait.human(rng.uniform(0.9, 1.8), int(rng.integers(1, 7)), ("shank", "measured")[rng.integers(2)]),
        start=(0.5, 0.0, rng.uniform(0.1, 1.0))[rng.integers(3)],
    )
    walker = fo.Walker(
        rng.uniform(20, 120), rng.uniform(0.3, 0.6), rng.uniform(0.3, 0.6), rng.uniform(1.6, 9.81)
    )
    sand = fo.Sand(zeta=10 ** rng.uniform(-0.5, 1))
    accuracy = fo.Accuracy(
        dt=rng.uniform(3e-3, 1e-2),
        plates=int(rng.integers(24, 80)),
        creep=10 ** rng.uniform(-5, -3),
        rule=("arc", "chord")[rng.integers(2)],
        control=None if kernel == 1 else 10 ** rng.uniform(-4, -2.5),
    )
    n = int(rng.integers(4, 16))
    space = fo.Waypoints(n, int(rng.integers(2, 30)), rng.uniform(0.08, 0.18), rng.uniform(0.01, 0.05),
                         ankle=(rng.uniform(-0.05, 0.05), rng.uniform(0, 0.05)))  # fmt: skip
    some = (effects, effects[:1], effects[:1] + effects[4:])[kernel]
    return fo.Scene(sand, gait, walker, effects=tuple(some)), accuracy, space


@browser_needed
def test_soles_walk_as_in_python_in_a_browser(browser, tmp_path):
    scene, accuracy, space = fo.Scene(fo.Sand.named("hard")), resolve("standard"), fo.Waypoints()
    feet = space.random(100, seed=17)
    walked = in_browser(browser, tmp_path, scene, accuracy, space, feet)
    assert differences(walked, scene, accuracy, space, feet).max() < 1e-9


@browser_needed
@pytest.mark.parametrize("seed", [20, 21, 24])
def test_so_do_soles_in_any_scene_or_the_page_says_what_rounding_does(seed, browser, tmp_path):
    # a few walks hang on their last digits: a plate turns round, or a step is halved, or not
    scene, accuracy, space = drawn(np.random.default_rng(seed))
    feet = space.random(5, seed=seed)
    off = differences(
        in_browser(browser, tmp_path, scene, accuracy, space, feet), scene, accuracy, space, feet
    )
    apart = off >= 1e-9
    said = browser.execute_script(
        "return arguments[0].map((k) => rounding(arcPoints(k, P.accuracy.plates * P.accuracy.parts),"
        "{ zeta: P.sand.zeta, mass: P.walker.mass })?.[1] ?? 0)", feet[apart].tolist()
    )  # fmt: skip
    assert (off[apart] < 10.0 * np.array(said, float)).all()
