"""report.html in a real browser: what it shows, what moves it, and the files that it hands out."""

import csv
import io
import json
import re

import numpy as np
import pytest
from browsers import Page, arrived, needs
from study_pages import leave_job

import footopt as fo
from footopt.design import confirm
from footopt.files import identity
from footopt.report import figures, page, summary, terminal
from footopt.walk import FIVE

pytestmark = [pytest.mark.slow, needs]
LIMIT = 5e6  # bytes of a page


@pytest.fixture(scope="module")
def front():
    """A small search, and its best walk."""
    problem = fo.FootProblem(fo.Scene(sand=fo.Sand.named("soft")), "pareto", accuracy="draft")
    result = fo.search(problem, "nsga2", pop_size=24, n_gen=6, seed=1)
    confirmed = confirm(result, "draft", 5)
    foot = fo.Foot.from_waypoints(result.k[confirmed.designs[0]], problem.space)
    return result, confirmed, fo.simulate(foot, problem.scene, "draft")


@pytest.fixture(scope="module")
def pages(front, tmp_path_factory):
    """A page of each kind, as files by name."""
    folder = tmp_path_factory.mktemp("pages")
    result, confirmed, best = front
    flat = fo.simulate(fo.Foot.flat(), best.scene, "draft")
    entry = {"flat": flat.objectives, "error_estimate": best.objectives, "warnings": ["it is deep"],
             "remarks": ["it is few"], "accuracy": {"name": "draft"}, "scene": {"effects": {}}}  # fmt: skip
    sinking = fo.simulate(fo.Foot.flat(), fo.Scene(sand=fo.Sand(zeta=0.001)), "draft")
    contents = {
        "front": page.search_content(result, confirmed, best, flat, entry),
        "walk": page.walk_content(best, entry),
        "sunk": page.walk_content(sinking, entry),
    }
    for i, zeta in enumerate([1.0, 5.0]):
        leave_job(folder / str(i), fo.simulate(fo.Foot.flat(), fo.Scene(sand=fo.Sand(zeta=zeta)), "draft"))
    assert summary.compare(folder, identity.jobs(folder)) == 0
    (folder / "report.html").rename(folder / "runs.html")
    (folder / "figures").mkdir()
    figures.save(figures.contour(best.foot), folder / "figures", "contour", ["svg"])
    shown = terminal.table(("name", "a number"), words=("name",), title="What came out")
    shown.add_row("[bold]", "1.25 %")
    says = {"contour": 'A sole, and a "quoted" <word>.'}
    page.write_study(folder, "A study", ["What <it> found"], says, [shown], {"study": "effects"})
    (folder / "report.html").rename(folder / "study.html")
    written = {name: page.write(folder / f"{name}.html", content) for name, content in contents.items()}
    return written | {name: folder / f"{name}.html" for name in ("runs", "study")}


@pytest.mark.parametrize("kind", ["front", "walk", "sunk", "runs", "study"])
def test_a_page_loads_alone_names_all_that_one_operates_and_fits_any_window(kind, pages, browser):
    """Without an error, and with nothing from outside."""
    assert pages[kind].stat().st_size < LIMIT
    shown = Page(browser, pages[kind])
    assert not shown.errors()
    assert shown.js("performance.getEntriesByType('resource').length") == 0
    assert shown.text("h1")
    for width in (390, 1280):
        browser.set_window_size(width, 900)
        assert shown.js("document.documentElement.scrollWidth <= document.documentElement.clientWidth")
    browser.execute_script("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    nameless = shown.js(
        "[...document.querySelectorAll('button, select, input, a')].filter((e) => e.checkVisibility() && "
        "!(e.ariaLabel || e.labels?.length || (e.tagName !== 'SELECT' && e.textContent.trim())))"
        ".map((e) => e.outerHTML)"
    )
    assert nameless == []
    if kind == "study":
        (image,) = shown.all("img")
        assert image.get_attribute("alt") == 'A sole, and a "quoted" <word>.'
        cells = [cell.text for cell in shown.all("#tables th, #tables td")]
        assert cells == ["name", "a number", "[bold]", "1.25 %"]
    if kind == "front":
        assert "it is few" in shown.text("#warnings")
        assert shown.judged() == []  # by axe


def test_a_drag_along_an_axis_filters_both_figures_and_a_row_is_chosen(front, pages, browser):
    result, shown = front[0], Page(browser, pages["front"])
    assert shown.counts() == (len(result.front), len(result.front))
    before = shown.js("document.querySelector('#scatter canvas').toDataURL()")
    left = 70 / shown["#parallel"].size["width"]  # the first axis: distance
    shown.drag("#parallel svg", (left, 0.15), (left, 0.5))
    low, _ = shown.limits("distance")
    values = result.column("distance")[result.front]
    assert min(values) < low < max(values)
    assert shown.counts()[0] == np.sum(values >= low) > 0
    assert shown.js("document.querySelector('#scatter canvas').toDataURL()") != before
    shown["#clear"].click()
    assert shown.counts()[0] == len(result.front)
    shown["#explore > details:last-of-type summary"].click()
    shown["#explore tbody button"].click()  # in the order of the run's choice
    chosen = int(re.search(r"design (\d+)", shown.text("#design-title"))[1])
    assert chosen == result.best
    shown["[data-sort=distance]"].click()
    shown["#explore tbody button"].click()
    chosen = int(re.search(r"design (\d+)", shown.text("#design-title"))[1])
    assert chosen == max(result.front, key=lambda i: result.column("distance")[i])
    s = "quantileScale([9, 1, NaN, 2, 100, 3], 4)"
    assert shown.js(f"[{s}.to(3), {s}.from(0.5), {s}.from(1), {s}.to(-7)]") == [0.5, 3, 100, 0]
    link = shown.js("location.href")
    browser.get("about:blank")
    browser.get(link)  # opens the page as it was left
    assert f"design {chosen}" in shown.text("#design-title")
    work = shown.js(f"simulated({chosen}).objectives.work")
    assert work == pytest.approx(result.column("work")[chosen], rel=1e-9)


def test_a_sole_is_drawn_walks_as_in_python_and_is_handed_out(front, pages, browser, downloads):
    """By the pointer; and on other sand under another walker by the sliders."""
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    def heights():
        return json.loads(shown.text("#design-words").partition("k = ")[2].partition(";")[0])

    def check(scene):
        walk = fo.simulate(fo.Foot.from_waypoints(heights()), scene, front[0].problem.accuracy)
        told = shown.js("data.columns.slice(0, 5).map((_, c) => valueOf(DRAWN, c))")
        assert told == pytest.approx([walk.objectives[name] for name in FIVE], rel=1e-9)

    scene, shown = front[0].problem.scene, Page(browser, pages["front"])
    before = heights()
    low = before.index(min(before))
    browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", shown["#design svg"])
    pointer = ActionChains(browser, duration=20)
    pointer.move_to_element(shown[f'[role=slider][data-waypoint="{low}"]']).click_and_hold()
    pointer.move_by_offset(0, 12).move_by_offset(0, 12).release().perform()
    shown.settled()
    assert heights()[low] > before[low]
    check(scene)
    shown["#zeta"].send_keys(*[Keys.ARROW_RIGHT] * 20)
    shown["#mass"].send_keys(*[Keys.ARROW_LEFT] * 10)
    shown.settled()
    zeta, mass = shown.js("[sketch.zeta, sketch.mass]")
    assert zeta > scene.sand.zeta
    assert mass < scene.walker.mass
    check(fo.Scene(sand=fo.Sand(zeta=zeta), walker=fo.Walker(mass=mass)))
    assert "leading edge" in shown.text("#design")  # another law, which the page walks by itself
    shown["#download-csv"].click()
    rows = list(csv.reader(io.StringIO(arrived(downloads, "csv"))))
    contour = fo.Foot.from_waypoints(heights()).contour
    np.testing.assert_allclose(np.array(rows[1:], float), 1e3 * contour, rtol=0, atol=2e-4)
    assert shown.errors() == []
