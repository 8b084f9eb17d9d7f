"""A sole drawn on the page: the walk follows the pointer, the keys and the sliders, and what comes of it."""

import json
import shlex
import time

import numpy as np
import pytest
from browsers import Page, arrived, browser_needed

import footopt as fo
from footopt.design import confirm
from footopt.report import page
from footopt.walk import FIVE

pytestmark = [pytest.mark.slow]
RUN = {"folder": "outputs/optimize/one", "overrides": "sand=hard solver=ga"}


@pytest.fixture(scope="module")
def found():
    """A small search, its problem, and its page's content."""
    problem = fo.FootProblem(fo.Scene(sand=fo.Sand.named("soft")), objective="pareto", accuracy="draft")
    result = fo.search(problem, "nsga2", pop_size=16, n_gen=2, seed=1)
    confirmed = confirm(result, "draft", 2)
    best = fo.Foot.from_waypoints(result.k[confirmed.designs[0]], problem.space)
    walk, flat = (fo.simulate(foot, problem.scene, "draft") for foot in (best, fo.Foot.flat()))
    entry = {"flat": flat.objectives, "accuracy": {"name": "draft"}, "scene": {"effects": {}}}
    return result, confirmed, page.search_content(result, confirmed, walk, flat, entry) | RUN


@pytest.fixture
def shown(found, browser, tmp_path):
    return Page(browser, page.write(tmp_path / "report.html", found[2]))


def heights(shown):
    """k of the chosen sole, as the page says it."""
    return json.loads(shown.text("#design-words").partition("k = ")[2].partition(";")[0])


def told(shown):
    """The objectives of the chosen sole on the page."""
    return dict(zip(FIVE, shown.js("data.columns.slice(0, 5).map((_, c) => valueOf(DRAWN, c))"), strict=True))


def drag(shown, waypoint, down):
    """Drag a waypoint by pixels."""
    from selenium.webdriver.common.action_chains import ActionChains

    grip = shown[f'[role=slider][data-waypoint="{waypoint}"]']
    pointer = ActionChains(shown.driver, duration=20).move_to_element(grip).click_and_hold()
    for _ in range(4):
        pointer = pointer.move_by_offset(0, down // 4)
    pointer.release().perform()
    settled(shown)


def settled(shown):
    """Wait until all of the page shows what is drawn."""
    for _ in range(100):
        if shown.text("#walk-title") == "The walk: drawn here" and shown.js("walked.has(DRAWN)"):
            time.sleep(0.2)
            return
        time.sleep(0.05)
    raise AssertionError("the walk does not follow")


@browser_needed
class TestDrawing:
    def test_a_dragged_waypoint_moves_the_sole_its_walk_and_its_objectives(self, found, shown):
        before, drawing = heights(shown), shown["#design figure svg"].get_attribute("innerHTML")
        low = before.index(min(before))
        drag(shown, low, 24)
        after = heights(shown)
        assert after[low] > before[low]
        assert [k for p, k in enumerate(after) if p != low] == [k for p, k in enumerate(before) if p != low]
        assert shown["#design figure svg"].get_attribute("innerHTML") != drawing
        walk = fo.simulate(fo.Foot.from_waypoints(after), found[0].problem.scene, "draft")
        for name, value in told(shown).items():
            assert value == pytest.approx(walk.objectives[name], rel=1e-9)
        force = shown.js("Array.from(walkOf(DRAWN).force)")
        assert np.array(force).reshape(-1, 2, 2) == pytest.approx(walk.force, rel=1e-6, abs=1e-6)
        assert shown.errors() == []

    def test_keys_move_the_waypoint_that_has_the_focus_and_undo_brings_it_back(self, shown):
        from selenium.webdriver.common.keys import Keys

        before = heights(shown)
        high = before.index(max(before))
        shown[f'[role=slider][data-waypoint="{high}"]'].send_keys(Keys.ARROW_UP)
        settled(shown)
        assert heights(shown)[high] == before[high] - 1
        assert shown.js("document.activeElement.dataset.waypoint") == str(high)
        shown["body"].send_keys(Keys.CONTROL + "z")
        assert heights(shown) == before
        assert "drawn" not in shown.text("#design-title")
        assert not shown["#undo"].is_enabled()

    def test_sliders_change_sand_and_mass_for_this_sole_and_the_flat_one(self, found, shown):
        from selenium.webdriver.common.keys import Keys

        k, scene = heights(shown), found[0].problem.scene
        shown["#zeta"].send_keys(*[Keys.ARROW_RIGHT] * 20)
        shown["#mass"].send_keys(*[Keys.ARROW_LEFT] * 10)
        settled(shown)
        zeta, mass = shown.js("[sketch.zeta, sketch.mass]")
        assert zeta > scene.sand.zeta
        assert mass < scene.walker.mass
        there = fo.Scene(sand=fo.Sand(zeta=zeta), walker=fo.Walker(mass=mass))
        table = fo.evaluate([k, [10] * 11], there, "draft", FIVE)
        assert list(told(shown).values()) == pytest.approx(table.values[0], rel=1e-9)
        assert [shown.js(f"entry.flat.{name}") for name in FIVE] == pytest.approx(table.values[1], rel=1e-9)
        shown["#back"].click()
        assert shown.js("entry.flat.work") == pytest.approx(found[2]["entry"]["flat"]["work"])

    def test_is_saved_as_files_and_as_commands(self, shown, downloads):
        drag(shown, 5, 8)
        k = heights(shown)
        contour = fo.Foot.from_waypoints(k).contour
        for ending in ("csv", "dxf"):
            shown[f"#download-{ending}"].click()
            text = arrived(downloads, ending)
            if ending == "csv":
                rows = np.array([line.split(",") for line in text.split()[1:]], float)
                assert rows == pytest.approx(1e3 * contour, abs=1e-2)
            else:
                assert len(text) > 1000
        shown["#draw summary"].click()
        shown["#commands"]
        walk, search = map(shlex.split, shown.text("#commands").splitlines())
        sole = f"[{','.join(map(str, k))}]"
        assert walk == ["footopt", "study=simulate", "run=outputs/optimize/one", f"foot.k={sole}"]
        assert search == ["footopt", "sand=hard", "solver=ga", f"study.start={sole}"]

    def test_any_design_walks_when_it_is_chosen(self, found, shown):
        result = found[0]
        for i in np.flatnonzero(result.feasible)[:8].tolist():
            shown.js(f"choose({i})")
            assert shown["#walk svg"].is_displayed()
            work = shown.js(f"simulated({i}).objectives.work")
            assert work == pytest.approx(result.column("work")[i], rel=1e-9)
