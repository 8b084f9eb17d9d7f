"""A sole drawn on the page: the walk follows the pointer, the keys and the sliders, and what comes of it."""

import json
import re
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
RUN = {"folder": "outputs/optimize/one", "words": "sand=hard solver=ga"}


@pytest.fixture(scope="module")
def found():
    """A small search, its problem, and its page's content."""
    problem = fo.FootProblem(fo.Scene(sand=fo.Sand.named("soft")), objective="pareto", accuracy="draft")
    result = fo.search(problem, "nsga2", pop_size=16, n_gen=2, seed=1)
    confirmed = confirm(result, "draft", 2)
    best = fo.Foot.from_waypoints(result.k[confirmed.designs[0]], problem.space)
    walk, flat = (fo.simulate(foot, problem.scene, "draft") for foot in (best, fo.Foot.flat()))
    entry = {"flat": flat.objectives, "accuracy": {"name": "draft"}, "scene": {"effects": {}}}
    return result, confirmed, page.search_content(result, confirmed, walk, flat, [], entry) | RUN


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

    def test_a_finger_drags_a_waypoint(self, found, shown):
        before, holder = heights(shown), "#design figure .plot"
        low = before.index(min(before))
        grip, drawing = (shown[place].rect for place in (f"[data-waypoint='{low}']", holder))
        across, down = (
            (grip[at] + 0.5 * grip[side] - drawing[at]) / drawing[side]
            for at, side in (("x", "width"), ("y", "height"))
        )
        shown.touch(holder, (across, down), (across, down + 30 / drawing["height"]))
        settled(shown)
        after = heights(shown)
        assert after[low] > before[low] + 1
        assert [k for p, k in enumerate(after) if p != low] == [k for p, k in enumerate(before) if p != low]
        assert not shown.errors()

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

    def test_where_the_flat_foot_sinks_nothing_is_compared_with_it(self, shown):
        from selenium.webdriver.common.keys import Keys

        shown["#zeta"].send_keys(Keys.HOME)
        shown["#mass"].send_keys(Keys.END)
        settled(shown)
        assert "the flat foot, whose walk failed: sunk" in shown.text("#design-words")
        assert shown.js("Object.values(entry.flat).some(Number.isFinite)") is False
        assert not shown.all("#bars")
        shown["#back"].click()
        assert shown.all("#bars")
        assert shown.errors() == []

    def test_a_sole_that_leaves_its_box_is_said_to(self, shown):
        shown.js(
            "kOf.set([10, 10, 1, 10, 10, 10, 10, 10, 1, 10, 10], DRAWN * 11) ?? rewalk() ?? choose(DRAWN)"
        )
        box = 1e3 * fo.Waypoints().box_violation([[10, 10, 1, 10, 10, 10, 10, 10, 1, 10, 10]])[0]
        assert f"leaves its box by {box:.1f} mm" in shown.text("#design-words")

    def test_is_saved_as_files_and_as_commands(self, shown, downloads):
        drag(shown, 5, 8)
        k = heights(shown)
        contour = fo.Foot.from_waypoints(k).contour
        for ending in ("csv", "dxf", "stl"):
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

    def test_any_design_walks_when_it_is_chosen_brushed_or_under_the_pointer(self, found, shown):
        result = found[0]
        for i in np.flatnonzero(result.feasible)[:8].tolist():
            shown.js(f"choose({i})")
            assert shown["#walk svg"].is_displayed()
            work = shown.js(f"simulated({i}).objectives.work")
            assert work == pytest.approx(result.column("work")[i], rel=1e-9)
        shown.js("choose(data.best)")
        at, width = shown.js("data.best"), shown["#parallel svg"].size["width"]
        far, near = shown.js("[Math.max, Math.min].map((f) => f(...[...front].map(columnOf('distance').of)))")
        upper = shown.js(f"columnOf('distance').of({at})") > 0.5 * (near + far)  # the other half is brushed
        begin, end = (0.6, 0.98) if upper else (0.05, 0.45)
        shown.drag("#parallel svg", (70 / width, begin), (70 / width, end))
        low, most = shown.limits("distance")
        chosen = int(re.search(r"design (\d+)", shown.text("#design-title"))[1])
        assert low <= result.column("distance")[chosen] <= most

        def glance():
            return shown.text("#glance h3")

        shown["#clear"].click()
        before, step = glance(), shown["#glimpse svg"].get_attribute("innerHTML")
        places = ((x, y) for x in (0.2, 0.35, 0.5) for y in np.linspace(0.25, 0.9, 40))
        while glance() == before:
            shown._pointer("#parallel svg", next(places)).perform()
        assert shown["#glimpse svg"].get_attribute("innerHTML") != step
        assert f"design {chosen}" in shown.text("#design-title")  # which is chosen by a click only

    def test_a_walk_that_hangs_on_its_last_digits_is_said_to(self, shown):
        drag(shown, 4, 8)
        assert shown.text("#unwalked") == ""
        shown.driver.execute_script(
            "const before = simulate;"
            "simulate = (arc, world) => { const walk = before(arc, world);"
            "walk.objectives.work *= 1 + 1e15 * "
            "(world.mass - sketch.mass) / sketch.mass; return walk; }; choose(DRAWN)"
        )
        assert re.match(
            r"This walk hangs on its last digits: rounding alone changes its work by \d+ %\.",
            shown.text("#unwalked"),
        )

    def test_is_refused_with_the_effect_that_the_page_does_not_have(self, browser, tmp_path):
        scene = fo.Scene(effects=(fo.Rest(),))
        entry = {"accuracy": {"name": "draft"}, "scene": {"effects": {"rest": {}}}}
        content = page.walk_content(fo.simulate(fo.Foot.flat(), scene, "draft"), entry)
        shown = Page(browser, page.write(tmp_path / "report.html", content))
        assert "effects=rest of this run" in shown.text("#no-drawing")
        assert not shown.all("[role=slider][data-waypoint]")
