"""report.html in a real browser: what it shows, what moves it, and the files that it hands out."""

import csv
import dataclasses
import io
import json
import random
import re
import time
from collections import Counter

import numpy as np
import pytest
from browsers import Page, arrived, browser_needed
from rich.text import Text
from running import tries
from shapely import Polygon
from study_pages import leave_job

import footopt as fo
from footopt.design import confirm
from footopt.design.result import SHOWN
from footopt.errors import FileError
from footopt.foot.outline import closed_contour
from footopt.report import figures, page, summary, terminal
from footopt.report.numbers import number, title
from footopt.report.page import walks
from footopt.report.page.file import packed
from footopt.report.page.file import text as page_text
from footopt.report.stage import ground
from footopt.report.summary import Run
from footopt.studies.base import foot_entry, scene_entry
from footopt.walk import FIVE, OBJECTIVES
from footopt.walk.objectives import lookup

LIMIT = 5e6  # bytes of a page
MARKUP = (
    "<script>", "</script>", "alert(1)", "window.ran=1", "<svg/onload=window.ran=1>", "<!--", "-->", "]]>",
    "<img/src=x/onerror=window.ran=1>", "<a/href=javascript:window.ran=1>", "${window.ran=1}", "</title>",
    "</style>", "'", '"', "`", "*/", "&lt;", "\\u003c", "{{", "\u2028",
)  # fmt: skip


def searched(objective, solver, space=None):
    """A small search, and what its page is made of."""
    problem = fo.FootProblem(objective=objective, space=space, accuracy="draft")
    result = fo.search(problem, solver, pop_size=24, n_gen=6, seed=1)
    confirmed = confirm(result, "standard", 5)
    best = fo.simulate(fo.Foot.from_waypoints(result.k[confirmed.designs[0]], problem.space), problem.scene)
    flat = fo.simulate(fo.Foot.flat(), problem.scene)
    entry = {
        "seed": 1,
        "flat": flat.objectives,
        "error_estimate": best.objectives,
        "accuracy": {"name": "standard"},
        "search_accuracy": {"name": "draft"},
        "scene": {"effects": {}},
        "ranks": {
            "laws": [
                {"law": "shadowing", "change": dict.fromkeys(FIVE, -0.1)},
                {"law": "leading edge", "change": dict.fromkeys(FIVE, 0.2)},
            ]
        },
        "warnings": ["it is deep"],
        "wall_time_s": 1.0,
        "versions": {"footopt": fo.__version__},
    }
    chosen = page.walked_designs(result, confirmed)
    feet = [fo.Foot.from_waypoints(result.k[i], problem.space) for i in chosen]
    others = [(i, fo.simulate(foot, problem.scene, "draft")) for i, foot in zip(chosen, feet, strict=True)]
    return result, confirmed, best, flat, others, entry


@pytest.fixture(scope="module")
def front():
    return searched("pareto", "nsga2")


@pytest.fixture(scope="module")
def single():
    return searched("efficiency", "ga")


@pytest.fixture(scope="module")
def ten_thousand(front, tmp_path_factory):
    """A page of as many designs, spread about those of a search."""
    result, confirmed, best, flat, _, entry = front
    some = np.resize(np.flatnonzero(result.feasible), 10_000)
    many = dataclasses.replace(
        result,
        **{
            name: getattr(result, name)[some] for name in ("k", "values", "feasible", "reasons", "generation")
        },
        front=np.arange(3000),
    )
    many.values[:] *= np.random.default_rng(1).normal(1.0, 0.05, many.values.shape)
    content = page.search_content(many, confirmed, best, flat, [], entry)
    return page.write(tmp_path_factory.mktemp("many") / "report.html", content)


@pytest.fixture(scope="module")
def pages(front, single, tmp_path_factory):
    """A page of each kind, as files by name."""
    folder = tmp_path_factory.mktemp("pages")
    walk_entry = {"accuracy": {"name": "draft"}, "scene": {"effects": {"layers": {"depths": [0.03]}}}}
    sinking = fo.Scene(sand=fo.Sand(zeta=0.001))
    contents = {
        "front": page.search_content(*front),
        "single": page.search_content(*single),
        "walk": page.walk_content(fo.simulate(fo.Foot.shape("reversed_l"), accuracy="draft"), walk_entry),
        "sunk": page.walk_content(
            fo.simulate(dataclasses.replace(fo.Foot.flat(), name="a_long_name" * 12), sinking, "draft"),
            walk_entry,
        ),
    }
    for i, zeta in enumerate([1.0, 5.0]):
        leave_job(folder / str(i), fo.simulate(fo.Foot.flat(), fo.Scene(sand=fo.Sand(zeta=zeta)), "draft"))
    (folder / "0" / "walk.nc").unlink()  # a study of many scenarios leaves neither walk nor page
    (folder / "1" / "report.html").touch()
    (folder / "2").mkdir()
    (folder / "2" / "error.txt").write_text("sand.zeta = 0: must be a number > 0\n")
    assert summary.of_multirun(folder) == 1
    (folder / "report.html").rename(folder / "jobs.html")
    contents["exact"] = page.search_content(*searched("work", "exhaustive", fo.Waypoints(n=4, K=3)))
    dead = Run("job 9", "9", folder / "9", note="no result", failed=True)
    contents["no jobs"] = page.jobs_content(folder, [dead], [])
    (folder / "figures").mkdir()
    walk = fo.simulate(fo.Foot.flat(), accuracy="draft")
    figures.save(figures.contour(walk.foot), folder / "figures", "contour", svg=True)
    figures.save(figures.forces({"flat": walk}), folder / "figures", "wide", svg=True)
    (folder / "table 1.csv").write_text("")
    page.write_study(folder, "A study", ["What <it> found"], SAYS, [study_table()], STUDY, ["Not <so> good."])
    (folder / "report.html").rename(folder / "study.html")
    written = {name: page.write(folder / f"{name}.html", content) for name, content in contents.items()}
    return written | {"jobs": folder / "jobs.html", "study": folder / "study.html"}


#: The figures of a page of a study, its table, and what result.json says.
SAYS = {"contour": 'A flat sole, and a "quoted" <word>.', "wide": "Forces of a walk."}
STUDY = {
    "study": "effects",
    "seed": 7,
    "wall_time_s": 12.3,
    "settings": {"solver": {"seed": 7}, "sand": {"zeta": 5.0}},
    "versions": {"footopt": fo.__version__},
    "error_estimate": {"ellipse": {"distance": 0.001}},
    "far too much": list(range(1000)),
}


def study_table():
    shown = terminal.table(("name", "a number"), words=("name",), title="What came out")
    shown.add_row("[bold]", Text("1.25 %", style="bold red"))
    shown.add_row("k = [1, 2, 3]", "-")
    shown.add_row("table 1.csv", "2")
    return shown


KINDS = ["front", "single", "exact", "walk", "sunk", "jobs", "no jobs", "study"]


@browser_needed
@pytest.mark.parametrize("kind", KINDS)
def test_a_page_loads_alone_names_all_that_one_operates_and_fits_any_window(kind, pages, browser):
    """Without an error, and with nothing from outside."""
    shown = Page(browser, pages[kind])
    assert not shown.errors()
    assert shown.js("performance.getEntriesByType('resource').length") == 0
    assert shown.text("h1")
    for width in (390, 800, 1280):
        browser.set_window_size(width, 900)
        assert shown.js("document.documentElement.scrollWidth <= document.documentElement.clientWidth")
    browser.execute_script("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    # what depends on the width has been drawn again
    browser.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")
    nameless = shown.js(
        "[...document.querySelectorAll('button, select, input, a')].filter((e) => e.checkVisibility() && "
        "!(e.ariaLabel || e.labels?.length || (e.tagName !== 'SELECT' && e.textContent.trim())))"
        ".map((e) => e.outerHTML)"
    )
    assert nameless == []
    assert shown.js(
        "[...document.querySelectorAll('svg[role=img]')].every((e) => e.getAttribute('aria-label'))"
    )


@browser_needed
class TestExplorer:
    def test_a_drag_along_an_axis_filters_both_figures(self, front, pages, browser):
        result = front[0]
        shown = Page(browser, pages["front"])
        assert shown.counts() == (len(result.front), len(result.front))
        before = shown.js("document.querySelector('#scatter canvas').toDataURL()")
        left = 70 / shown["#parallel"].size["width"]  # the first axis: distance
        shown.drag("#parallel svg", (left, 0.15), (left, 0.5))
        low, high = shown.limits("distance")
        values = result.column("distance")[result.front]
        assert np.isinf(high)
        assert min(values) < low < max(values)
        assert shown.counts()[0] == np.sum(values >= low)
        assert 0 < shown.counts()[0] < len(result.front)
        assert shown.js("document.querySelector('#scatter canvas').toDataURL()") != before
        shown["#clear"].click()
        assert shown.counts()[0] == len(result.front)
        assert shown.js("document.querySelector('#scatter canvas').toDataURL()") == before

    def test_a_drag_across_the_scatter_sets_limits_of_the_values_that_were_picked(
        self, front, pages, browser
    ):
        result = front[0]
        shown = Page(browser, pages["front"])
        shown['#scatter-x option[value="work"]'].click()
        shown['#scatter-y option[value="generation"]'].click()
        before = shown.js("document.querySelector('#parallel canvas').toDataURL()")
        shown.drag("#scatter svg", (0.2, 0.2), (0.6, 0.8))
        (low, high), (first, last) = shown.limits("work"), shown.limits("generation")
        work, generation = result.column("work")[result.front], result.generation[result.front]
        inside = (low <= work) & (work <= high) & (first <= generation) & (generation <= last)
        assert shown.counts()[0] == inside.sum() < len(inside)
        assert shown.js("document.querySelector('#parallel canvas').toDataURL()") != before

    def test_a_click_on_a_point_shows_that_design_and_its_walk(self, front, pages, browser):
        result = front[0]
        shown = Page(browser, pages["front"])
        best = shown.text("#design-title")
        walk = shown.js("document.querySelector('#walk figure path').getAttribute('d')")
        other = int(result.front[-1])
        place = shown.js(
            "(() => { const x = columnOf('distance'), y = columnOf('mean_height');"
            "const all = [...[...front].map((i) => [x.of(i), y.of(i)]), [x.flat, y.flat]], i = "
            + str(other)
            + ";"
            "const part = (v, vs) => { const [a, b] = range(vs); return (v - a) / (b - a); };"
            "return [part(x.of(i), all.map((p) => p[0])), part(y.of(i), all.map((p) => p[1]))]; })()"
        )
        width, height = (shown["#scatter svg"].size[side] for side in ("width", "height"))
        across = (72 + place[0] * (width - 26 - 72)) / width
        down = (height - 40 + place[1] * (22 - (height - 40))) / height
        shown.click("#scatter svg", (across, down))
        title = shown.text("#design-title")
        assert title != best
        chosen = int(re.search(r"design (\d+)", title)[1])
        near = result.values[chosen, :2] - result.values[other, :2]
        assert np.all(np.abs(near) < 0.05 * np.ptp(result.values[result.front][:, :2], axis=0))
        assert f"k = [{','.join(map(str, result.k[chosen]))}]" in shown.text("#design-words")
        rows = [row.find_elements("css selector", "td") for row in shown.all("#glance tbody tr")]
        numbers = [float(cells[1].text.replace("−", "-")) for cells in rows]
        np.testing.assert_allclose(numbers, result.values[chosen], rtol=1e-3)
        assert shown.text("#walk-title") == f"The walk: design {chosen}"
        assert shown.js("document.querySelector('#walk figure path').getAttribute('d')") != walk

    def test_numbers_are_written_as_on_the_terminal(self, pages, browser):
        values = [2.1344, 2.1, 278.46, 12345.6, -0.00025268, 1.5e6, -5.0, 3e-15]
        shown = Page(browser, pages["front"]).js(f"{values}.map(number)")
        assert [text.replace("−", "-") for text in shown] == [number(value) for value in values]

    def test_works_from_the_keyboard_alone(self, front, pages, browser):
        from selenium.webdriver.common.keys import Keys

        result = front[0]
        shown = Page(browser, pages["front"])
        shown["#limits summary"].send_keys(Keys.ENTER)
        powers = np.sort(result.column("peak_power")[result.front])
        middle = float(powers[len(powers) // 2 - 1 :][:2].mean())  # between two: the page rounds
        shown['input[aria-label^="largest peak power"]'].send_keys(f"{middle}{Keys.TAB}")
        assert shown.counts()[0] == np.sum(result.column("peak_power")[result.front] <= middle)
        shown["#explore > details:last-of-type summary"].send_keys(Keys.ENTER)
        shown["#explore table button"].send_keys(Keys.ENTER)
        kept = [i for i in result.front if result.column("peak_power")[i] <= middle]
        first = max(kept, key=lambda i: result.column("distance")[i])
        assert f"design {first}" in shown.text("#design-title")
        shown["#which"].send_keys("all")
        shown["#clear"].send_keys(Keys.ENTER)
        assert shown.counts() == (result.feasible.sum(),) * 2

    def test_a_design_without_a_walk_says_how_to_walk_it(self, front, browser, tmp_path):
        result, confirmed, best, flat, _, entry = front
        rest = dataclasses.replace(
            result.problem.scene, effects=(fo.Rest(),)
        )  # which the page cannot walk with
        problem = fo.FootProblem(rest, objective="pareto", accuracy="draft")
        there = dataclasses.replace(result, problem=problem)
        others = page.walked_designs(there, confirmed)
        assert set(others) < set(result.shown.tolist())
        content = page.search_content(there, confirmed, best, flat, [(i, best) for i in others], entry)
        shown = Page(browser, page.write(tmp_path / "report.html", content))
        shown['#which option[value="all"]'].click()
        shown["#explore > details:last-of-type summary"].click()
        assert shown["#explore table button"]
        listed = {int(button.text): button for button in shown.all("#explore table button")}
        beside = next(i for i in listed if i not in result.front)
        listed[beside].click()
        assert f"foot.k=[{','.join(map(str, result.k[beside]))}]" in shown.text("#unwalked")
        assert not shown["#walk svg"].is_displayed()  # which would be that of another design
        assert shown.text("#walk-title") == f"The walk: design {beside}"


@browser_needed
def test_the_answer_comes_first_then_walk_and_search(front, pages, browser):
    _, _, best, flat, _, _ = front
    shown = Page(browser, pages["front"])
    browser.set_window_size(1280, 800)
    assert shown.text("h1") == walks.verdict(best, flat)
    for part in ("#design figure svg", "#bars", "#step svg", "#warnings"):
        box = shown[part].rect
        assert box["y"] + box["height"] < 720, part
    tops = [shown[f"#{name}"].rect["y"] for name in ("design", "walk", "parallel", "search")]
    assert tops == sorted(tops)


@browser_needed
class TestAxes:
    def shown(self, page):
        return [axis.get_attribute("data-axis") for axis in page.all("#parallel line[data-axis]")]

    def test_waypoints_and_hollow_are_axes_that_filter(self, front, pages, browser):
        result = front[0]
        shown = Page(browser, pages["front"])
        shown["#axes summary"].click()
        for name in ("hollow", "k3"):
            shown[f'#axes input[data-axis="{name}"]'].click()
        assert self.shown(shown)[-2:] == ["hollow", "k3"]
        middle = float(np.median(result.k[result.front, 2]))
        shown["#limits summary"].click()
        shown['input[aria-label="largest k3"]'].send_keys(f"{middle}\t")
        assert shown.counts()[0] == (result.k[result.front, 2] <= middle).sum()
        depth = [1e3 * fo.Foot.from_waypoints(result.k[i]).hollow for i in result.front[:5]]
        told = shown.js("[...front].slice(0, 5).map(columnOf('hollow').of)")
        np.testing.assert_allclose(told, depth, atol=0.02)
        told = shown.js("[...front].map((i) => [numbers[i], generation[i], ...heights(i)])")
        of_each = [result.front, result.generation[result.front], *result.k[result.front].T]
        np.testing.assert_array_equal(told, np.transpose(of_each))

    def test_are_moved_from_the_keyboard_and_by_their_names(self, pages, browser):
        shown = Page(browser, pages["front"])
        first, second, *rest = self.shown(shown)
        shown["#axes summary"].click()
        shown[f'#axes button[aria-label="{first.replace("_", " ")} to the right"]'].send_keys("\n")
        assert self.shown(shown) == [second, first, *rest]
        width = shown["#parallel"].size["width"]
        apart = (width - 140) / len([first, *rest])
        shown.drag("#parallel svg", ((70 + apart) / width, 0.03), (20 / width, 0.03))
        assert self.shown(shown) == [first, second, *rest]

    def test_have_ticks_and_the_flat_foot(self, front, pages, browser):
        flat = front[3].objectives
        shown = Page(browser, pages["front"])
        assert len(shown.all("#parallel text.halo")) > 3 * len(self.shown(shown))
        assert "flat" in {text.text for text in shown.all("#parallel text")}
        assert shown.js("columnOf('work').flat") == pytest.approx(flat["work"])
        assert shown.js("columnOf('efficiency').flat") == 1.0

    def test_designs_are_coloured_by_any_value(self, pages, browser):
        shown = Page(browser, pages["front"])
        pixels = "document.querySelector('#scatter canvas').toDataURL()"
        before = shown.js(pixels)
        shown['#shade option[value="generation"]'].click()
        assert shown.js(pixels) != before
        assert shown[".scale .gradient"].is_displayed()

    def test_a_finger_sets_limits_on_both_figures(self, pages, browser):
        shown = Page(browser, pages["front"])
        left = 70 / shown["#parallel"].size["width"]
        shown.touch("#parallel svg", (left, 0.15), (left, 0.5))
        low, high = shown.limits("distance")
        assert np.isfinite(low)
        assert np.isinf(high)
        shown["#clear"].click()
        shown.touch("#scatter svg", (0.3, 0.3), (0.7, 0.8))
        assert shown.counts()[0] < shown.counts()[1]

    def test_the_pointer_reads_values_off_every_plot(self, pages, browser):
        shown = Page(browser, pages["single"])
        place = shown.js(
            "(() => { const b = document.querySelector('#scatter circle').getBoundingClientRect(),"
            "a = document.querySelector('#scatter svg').getBoundingClientRect();"
            "return [(b.x + b.width / 2 - a.x) / a.width, (b.y + b.height / 2 - a.y) / a.height]; })()"
        )
        assert re.match(r"design \d+.*\ndistance [\d.]+ m\n", shown.hover("#scatter svg", place))
        assert re.match(r"[\d.]+ s: left [\d.]+, right [\d.]+; flat: left",
                        shown.hover("#walk .plots figure:nth-child(3) svg", (0.6, 0.5)))  # fmt: skip
        assert re.match(r"\d+ evaluations: [\d.]+, median", shown.hover("#search .plot svg", (0.9, 0.5)))


@browser_needed
class TestStage:
    def test_the_step_loops_until_it_is_paused(self, pages, browser):
        shown = Page(browser, pages["front"])
        paths = "document.querySelectorAll('#design figure:last-of-type path')"
        legs = f"Array.from({paths}, (p) => p.getAttribute('d')).join()"
        before = shown.js(legs)
        for _ in range(100):
            if shown.js(legs) != before:
                break
            time.sleep(0.05)
        assert shown.js(legs) != before
        shown["#design .loop"].click()
        stands = shown.js(legs)
        time.sleep(0.2)
        assert shown.js(legs) == stands

    def test_the_compared_walk_is_a_ghost_in_step(self, pages, browser):
        shown = Page(browser, pages["front"])
        assert len(shown.all("#walk .ghost")) == 6  # soles and legs, and soles close
        shown["#keep"].click()
        assert shown["#walk-compare option:checked"].text == shown.text("#walk-title").removeprefix(
            "The walk: "
        )
        assert not shown.all("#walk .ghost")  # a walk is not its own ghost
        browser.execute_script("choose([...front].find((i) => i !== data.best))")
        assert len(shown.all("#walk .ghost")) == 6  # soles and legs, and soles close

    def test_soles_are_coloured_by_stress_and_by_power(self, front, pages, browser):
        best = front[2]
        shown = Page(browser, pages["front"])
        for name in ("stress", "power"):
            shown[f'#paint option[value="{name}"]'].click()
            colours = {p.value_of_css_property("stroke") for p in shown.all("#walk .paint")}
            assert len(colours) > 4
        t = best.t[best.force[:, 1, 1].argmax()]
        parts = shown.js(f"PAINTS.stress.of(open(0), instant(open(0), {t}), 1)")
        force = np.linalg.norm([f["f"] for f in shown.js(f"instant(open(0), {t}).feet[1].forces")], axis=1)
        area = best.foot.width * np.linalg.norm(np.diff(best.foot.contour, axis=0), axis=1).sum()
        assert (1e3 * np.array(parts) * area / len(parts)).sum() == pytest.approx(force.sum(), rel=0.02)
        assert max(shown.js(f"PAINTS.power.of(open(0), instant(open(0), {t}), 1, {t})")) > 0

    def test_layers_patches_and_gravity_are_shown_close_and_far(self, front, tmp_path, browser):
        walk = front[3]
        effects = (fo.Slope(8), fo.Patches((0.4,), (0.9,), (2.5,)), fo.Layers((0.03,), (0.3,)))
        content = page.walk_content(walk, {"accuracy": {"name": "draft"}, "scene": {"effects": {}}})
        content["ground"] = ground(dataclasses.replace(walk.scene, effects=effects))
        shown = Page(browser, page.write(tmp_path / "page.html", content))
        for figure in shown.all("#design figure:last-of-type, #walk .wide figure"):
            assert figure.find_elements("css selector", ".gravity")
            words = {"g = 9.81 m/s²", "8° uphill", "layer × 0.3", "patch × 2.5"}
            assert words <= set(figure.text.split("\n"))
        behind = shown.js(
            "[...document.querySelectorAll('svg .surface')].filter((print) => "
            "[...print.ownerSVGElement.querySelectorAll('text')].some((name) => "
            "!(print.compareDocumentPosition(name) & 4))).length"
        )
        assert behind == 0  # a print hides no name
        shown.emulate(prefers_color_scheme="dark")  # white arrows on white sand would not be seen
        strip = shown.js("getComputedStyle(document.querySelector('.layer')).filter")
        shown.emulate(prefers_color_scheme="light")
        assert strip == "brightness(0.32)"

    def test_one_walk_has_the_flat_foot_beside_it(self, front, browser, tmp_path):
        best, flat = front[2:4]
        entry = {"flat": flat.objectives, "accuracy": {"name": "standard"}, "scene": {"effects": {}}}
        shown = Page(browser, page.write(tmp_path / "page.html", page.walk_content(best, entry, flat)))
        times = best.objectives["efficiency"] / flat.objectives["efficiency"]
        assert shown.text("#gain strong") == f"J_W x {times:.2f} of flat"
        assert shown.all("#design svg .ghost")
        again = fo.simulate(fo.Foot.flat(), flat.scene, "draft")  # other values of the same sole are no gain
        content = page.walk_content(again, entry, flat)
        shown = Page(browser, page.write(tmp_path / "page.html", content))
        assert "this is the flat foot" in shown.text("#design-words")
        assert not shown.all("#bars, #gain, #design svg .ghost")
        assert not shown.errors()

    def test_the_step_on_a_patch_is_the_one_that_is_shown(self, browser, tmp_path):
        scene = fo.Scene(effects=(fo.Patches((0.9,), (1.5,), (0.2,)),))
        content = page.walk_content(fo.simulate(fo.Foot.flat(), scene, "draft"), {"scene": {"effects": {}}})
        shown = Page(browser, page.write(tmp_path / "page.html", content))
        assert shown["#step svg"].get_attribute("aria-label").startswith("One step of the left foot")
        assert "patch × 0.2" in shown.text("#step")

    def test_a_sole_of_many_waypoints_is_as_smooth_on_the_stage(self, browser, tmp_path):
        space = fo.Waypoints(n=50, K=20)
        foot = fo.Foot.from_waypoints(space.random(1, seed=1)[0], space)
        content = page.walk_content(fo.simulate(foot, accuracy="draft"), {"scene": {"effects": {}}})
        shown = Page(browser, page.write(tmp_path / "page.html", content))
        drawn = np.array(shown.js("open(0).light"))
        off = foot.contour[:, 1] - np.interp(foot.contour[:, 0], *drawn.T)
        assert abs(off).max() < 0.0015  # a pixel

    def test_a_drawn_print_has_no_teeth(self, pages, browser):
        shown = Page(browser, pages["walk"])
        z = np.array(shown.js("printed(open(0))(open(0).t.at(-1)).map(({ z }) => z)"))
        turns = np.diff(np.sign(np.diff(z[z < 0])))
        assert z.min() < -0.01
        assert (turns != 0).sum() < 20  # one in a print or two, of four steps

    def test_a_print_that_is_no_result_says_that_it_is_drawn(self, pages, browser):
        shown = Page(browser, pages["front"])
        assert "print drawn, not computed" in shown.text("#walk")


@browser_needed
class TestLooks:
    @pytest.mark.parametrize(
        ("kind", "scheme", "width"),
        [("front", "light", 1280), ("jobs", "dark", 390), ("study", "dark", 390), ("walk", "dark", 1280)],
    )
    def test_axe_finds_nothing(self, kind, scheme, width, pages, browser):
        browser.set_window_size(width, 900)
        shown = Page(browser, pages[kind])
        shown.emulate(prefers_color_scheme=scheme)
        assert shown.judged() == []
        shown.emulate(prefers_color_scheme="light")

    def test_follows_a_dark_theme_and_forced_colours(self, pages, browser):
        shown = Page(browser, pages["front"])
        paper = "getComputedStyle(document.body).backgroundColor"
        line = "getComputedStyle(document.querySelector('#walk .left-leg')).stroke"
        assert shown.js(paper) == "rgb(255, 255, 255)"
        shown.emulate(prefers_color_scheme="dark")
        assert shown.js(paper) == "rgb(21, 24, 27)"
        shown.emulate(forced_colors="active")
        assert shown.js("matchMedia('(forced-colors: active)').matches")
        assert shown.js("ink('--left')") == "LinkText"
        assert not shown.errors()
        shown.emulate(prefers_color_scheme="light")
        assert shown.js(line)

    def test_motion_stands_still_for_those_who_want_none(self, pages, browser):
        shown = Page(browser, pages["front"])
        shown.emulate(prefers_reduced_motion="reduce")
        browser.refresh()
        assert shown.text("#design .loop") == "Play"
        shown.emulate(prefers_reduced_motion="no-preference")

    def test_warnings_are_on_paper_what_is_drawn_with_is_not(self, pages, browser):
        shown = Page(browser, pages["front"])
        browser.execute_cdp_cmd("Page.printToPDF", {})
        assert shown["#warnings p"].is_displayed()
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        hidden = shown.js("getComputedStyle(document.querySelector('#draw')).display")
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
        assert hidden == "none"

    @pytest.mark.parametrize("kind", ["front", "study"])
    def test_is_printed_on_few_sheets(self, kind, pages, browser):
        import base64

        Page(browser, pages[kind])
        sheets = base64.b64decode(browser.execute_cdp_cmd("Page.printToPDF", {})["data"])
        assert 1 <= len(re.findall(rb"/Type\s*/Page\b", sheets)) <= 8


@browser_needed
class TestBars:
    def test_each_objective_is_a_bar_as_long_as_its_change(self, front, pages, browser):
        _, _, best, flat, _, _ = front
        shown = Page(browser, pages["front"])
        marks = {bar.get_attribute("data-name"): bar for bar in shown.all("#bars .bar-of-change")}
        assert set(marks) == set(FIVE)
        change = {name: best.objectives[name] / flat.objectives[name] - 1.0 for name in FIVE}
        long = {name: float(bar.get_attribute("width")) for name, bar in marks.items()}
        scale = max(long.values()) / max(
            map(abs, change.values())
        )  # pixels; a bar is never less than one long
        assert long == pytest.approx({name: max(scale * abs(c), 1.0) for name, c in change.items()}, rel=1e-3)
        for name, bar in marks.items():
            assert f"{100 * change[name]:+.1f} %".replace("-", "−") in shown.text("#bars")
            better = change[name] * (1 if lookup((name,))[0].maximise else -1) > 0
            assert (bar.get_attribute("stroke-dasharray") is None) == better

    def test_has_the_error_of_the_numbers_and_what_other_laws_say(self, front, pages, browser):
        shown = Page(browser, pages["front"])
        assert len(shown.all("#bars .error")) == 5
        said = [title.get_attribute("textContent") for title in shown.all("#bars circle title")]
        assert said[:2] == ["shadowing: −10.0 %", "leading edge: +20.0 %"]

    def test_j_w_is_told_as_a_multiple_with_the_values_behind(self, front, pages, browser):
        _, _, best, flat, _, _ = front
        raw = [walk.objectives["efficiency"] for walk in (best, flat)]
        shown = Page(browser, pages["front"])
        times = raw[0] / raw[1]
        said = f"x {times:.2f} of flat"
        assert shown.text("#gain strong") == f"J_W {said}"
        assert number(raw[0]).replace("-", "−", 1) in shown.text("#gain")


@browser_needed
class TestWalk:
    def test_the_scrubber_moves_the_picture_the_numbers_and_the_plots_together(self, front, pages, browser):
        from selenium.webdriver.common.keys import Keys

        best = front[2]
        shown = Page(browser, pages["front"])
        cursors = [c.get_attribute("x1") for c in shown.all("#walk .cursor")]
        assert len(set(cursors)) == 1
        for _ in range(20):
            shown["#time"].send_keys(Keys.ARROW_RIGHT)
        t = float(shown["#time"].get_property("value"))
        assert f"t = {t:.2f} s" in shown.text("#walk output")
        moved = [c.get_attribute("x1") for c in shown.all("#walk .cursor")]
        assert len(set(moved)) == 1
        assert moved != cursors
        row = [cell.text.replace("−", "-") for cell in shown.all("#walk .scroll tr:nth-child(1) td")]
        now = [np.interp(t, best.t, trace) for trace in (*best.com.T, *best.velocity.T)]
        np.testing.assert_allclose([float(text) for text in row[1:5]], now, rtol=0, atol=2e-3)

    def test_play_walks_and_pause_stands(self, pages, browser):
        shown = Page(browser, pages["single"])
        shown["#speed option:last-child"].click()
        start = float(shown["#time"].get_property("value"))
        shown["#play"].click()
        assert shown.text("#play") == "Pause"
        while (value := float(shown["#time"].get_property("value"))) == start:
            time.sleep(0.05)
        assert value > start
        shown["#play"].click()
        assert shown.text("#play") == "Play"
        stands = shown["#time"].get_property("value")
        time.sleep(0.1)
        assert shown["#time"].get_property("value") == stands

    def test_the_whole_walker_has_the_force_on_its_foot(self, front, pages, browser):
        shown, walk = Page(browser, pages["front"]), front[2]
        now = float(shown["#time"].get_property("value"))
        line = shown["#walk figure .force"].get_attribute("d")
        ends = np.array(re.findall(r"[\d.]+", line)[:4], float).reshape(2, 2)  # down is positive
        x, z = np.diff(ends, axis=0)[0] * (1, -1)
        fx, fz = walk.force[np.searchsorted(walk.t, now), 1]
        assert z > 10  # pixels
        assert np.arctan2(x, z) == pytest.approx(np.arctan2(fx, fz), abs=0.1)

    def test_arrows_in_the_close_up_are_seen_whole(self, pages, browser):
        shown = Page(browser, pages["front"])
        low, high = shown.js(
            "(() => { const close = document.querySelector('#walk .wide figure:last-child svg'), ends = [];"
            "for (let t = 0; t < open(0).t.at(-1); t += 0.02) { const time = document.querySelector('#time');"
            "time.value = t; time.dispatchEvent(new Event('input'));"
            "for (const p of close.querySelectorAll('path.force'))"
            "{ const box = p.getBBox(); ends.push(box.y + box.height); } }"
            "return [Math.max(...ends), +close.getAttribute('height')]; })()"
        )
        assert 0.5 * high < low <= high

    def test_heel_strikes_are_seen(self, pages, front, browser):
        shown = Page(browser, pages["front"])
        strikes = front[2].scene.gait.heel_strikes(front[2].scene.duration)
        marks = shown.all("#walk .plots figure:first-child .strike")
        assert len(marks) == len(strikes)
        style = [marks[0].value_of_css_property(name) for name in ("stroke", "stroke-opacity", "opacity")]
        assert style == ["rgb(95, 95, 95)", "1", "1"]

    def test_a_click_in_a_plot_goes_to_that_instant(self, pages, browser):
        shown = Page(browser, pages["walk"])
        shown.click("#walk .plots figure:nth-child(4) svg", (0.9, 0.5))
        assert 2.4 < float(shown["#time"].get_property("value")) < 2.9

    def test_the_soles_stand_in_the_sand_where_the_walk_has_them(self, pages, front, browser):
        best = front[2]
        shown = Page(browser, pages["front"])
        t = best.t[len(best.t) // 2]
        feet = shown.js(f"instant(open(0), {t}).feet.map((foot) => foot.sole)")
        pose = best.scene.gait.pose(np.array([t]), 0.47, 0.45)
        com = best.com[len(best.t) // 2]
        for foot in (0, 1):
            c, s = np.cos(pose.pitch[0, foot]), np.sin(pose.pitch[0, foot])
            heel = best.foot.contour[0] - best.foot.ankle
            expected = com + [pose.x[0, foot], pose.z[0, foot]] + np.array([[c, -s], [s, c]]) @ heel
            np.testing.assert_allclose(feet[foot][0], expected, atol=1e-3)
            forces = shown.js(f"instant(open(0), {t}).feet[{foot}].forces")
            total = np.sum([force["f"] for force in forces], axis=0)
            np.testing.assert_allclose(total, best.force[len(best.t) // 2, foot], rtol=0.02, atol=10.0)
            away = np.array([force["at"] for force in forces])[:, None] - np.array(feet[foot])
            assert np.linalg.norm(away, axis=-1).min(axis=1).max() < 0.02  # the arrows end on the sole

    def test_a_walk_that_sank_says_so(self, pages, browser):
        assert "sunk" in Page(browser, pages["sunk"]).text("#walk")

    def test_a_legend_names_the_lines(self, pages, browser):
        shown = Page(browser, pages["front"])
        assert [name.text for name in shown.all("#walk .legend span")] == ["left foot", "right foot", "flat"]

    def test_rounding_is_no_motion_and_has_no_error(self, pages, browser):
        shown = Page(browser, pages["front"])
        assert shown.js("column({ t: [0, 1], v: [1e-22, -3e-13] }, 'v', 1, 0)") == [0, 0]
        assert shown.js("[percent(3.4, 1e-22), percent(1e-14), percent(0.0123)]") == ["–", "0 %", "1.2 %"]


@browser_needed
class TestSearch:
    def test_the_lineage_shows_each_sole_that_was_the_best(self, single, pages, browser):
        result = single[0]
        shown = Page(browser, pages["single"])
        buttons = shown.all(".lineage button")
        assert len(buttons) == len(walks.successive_bests(result))
        assert re.fullmatch(r"generation 1\nx \d\.\d\d of flat", buttons[0].text)
        buttons[0].click()
        i = walks.successive_bests(result)[0]
        assert ",".join(map(str, result.k[i])) in shown.text("#design-words")
        assert shown.text("#walk-title") == f"The walk: design {i}"

    def test_a_search_of_one_generation_is_a_point(self, single, browser, tmp_path):
        content = page.search_content(*single)
        shown = Page(
            browser, page.write(tmp_path / "page.html", content | {"history": content["history"][:1]})
        )
        assert len(shown.all("#search svg[role=img] circle")) == 1


@browser_needed
class TestDownloads:
    @pytest.mark.parametrize("kind", ["front", "walk"])
    def test_dxf_csv_and_stl_hold_the_sole_that_is_shown(self, kind, front, pages, browser, downloads):
        import ezdxf

        foot = front[2].foot if kind == "front" else fo.Foot.shape("reversed_l")
        shown = Page(browser, pages[kind])
        area = Polygon(1e3 * closed_contour(foot.contour, foot.top)).area

        shown["#download-csv"].click()
        rows = list(csv.reader(io.StringIO(arrived(downloads, "csv"))))
        assert rows[0] == ["x_mm", "z_mm"]
        np.testing.assert_allclose(np.array(rows[1:], float), 1e3 * foot.contour, rtol=0, atol=2e-4)

        shown["#download-dxf"].click()
        document = ezdxf.read(io.StringIO(arrived(downloads, "dxf")))
        assert not document.audit().errors
        (drawn,) = document.modelspace().query('POLYLINE[layer=="OUTLINE"]')
        assert drawn.is_closed
        points = np.array([v.dxf.location.vec2 for v in drawn.vertices])
        assert Polygon(points).area == pytest.approx(area, rel=1e-5)

        shown["#download-stl"].click()
        vertices = re.findall(r"vertex (\S+) (\S+) (\S+)", arrived(downloads, "stl"))
        facets = np.array(vertices, float).reshape(-1, 3, 3)
        volume = np.einsum("ij,ij->", facets[:, 0], np.cross(facets[:, 1], facets[:, 2])) / 6
        assert volume == pytest.approx(area * 1e3 * foot.width, rel=1e-5)  # outward normals: positive
        edges = Counter((tuple(f[i]), tuple(f[(i + 1) % 3])) for f in facets.tolist() for i in range(3))
        assert all(edges[b, a] == n == 1 for (a, b), n in edges.items())  # watertight


@browser_needed
class TestAStudysPage:
    def test_has_its_figures_and_tables_as_they_are(self, pages, browser):
        shown = Page(browser, pages["study"])
        images = shown.all("img")
        assert [image.get_attribute("alt") for image in images] == list(SAYS.values())
        assert all(image.get_attribute("src").startswith("data:image/svg+xml") for image in images)
        wide = [image.size["width"] for image in images]  # letters of one size: a column, and a page
        assert wide[1] > 1.9 * wide[0] > 600
        cells = [cell.text for cell in shown.all("#tables th, #tables td")]
        assert cells == ["name", "a number", "[bold]", "1.25 %", "k = [1, 2, 3]", "-",
                         "table 1.csv", "2"]  # fmt: skip
        assert "What <it> found" in shown.text("#header")

    def test_marks_what_is_bold_on_the_terminal_and_what_is_wrong(self, pages, browser):
        shown = Page(browser, pages["study"])
        assert [cell.text for cell in shown.all("#tables strong")] == ["1.25 %"]
        assert shown.text("#warnings summary") == "1 warning"
        assert not shown["#warnings p"].is_displayed()
        shown["#warnings summary"].click()
        assert shown.text("#warnings p") == "Not <so> good."

    def test_links_the_files_beside_it_that_its_tables_name(self, pages, browser):
        shown = Page(browser, pages["study"])
        (link,) = shown.all("#tables a")
        assert link.get_dom_attribute("href") == "table%201.csv"
        assert link.get_property("href") == (pages["study"].parent / "table 1.csv").as_uri()

    def test_says_at_its_foot_how_it_was_made(self, pages, browser):
        shown = Page(browser, pages["study"])
        foot = shown.text("#footer")
        assert "seed: 7" in foot
        assert "wall time: 12.3 s" in foot
        assert f"footopt {fo.__version__}" in foot
        assert {"Settings", "Error estimates"} <= {s.text for s in shown.all("summary")}
        assert pages["study"].stat().st_size < 8e6
        assert "far too much" not in pages["study"].read_text()


@browser_needed
def test_a_multirun_shows_every_job_the_failed_ones_too(pages, browser):
    shown = Page(browser, pages["jobs"])
    rows = shown.all("#jobs tbody tr")
    assert len(rows) == 3
    assert "must be a number > 0" in rows[2].text
    assert [a.get_attribute("href").rsplit("/", 2)[1] for a in shown.all("#jobs a")] == ["1"]
    assert "A job's link opens its own page." in shown.text("#jobs")  # not every study has a walk
    assert "job 1" in shown.text("#traces")
    assert "job 0" not in shown.text("#traces")
    rows[1].find_element("css selector", "button").click()
    assert "job 1" in shown.text("#design-title")


class TestVerdict:
    def test_names_the_largest_gain_and_the_largest_loss(self, front):
        best, flat = front[2], front[3]
        said = walks.verdict(best, flat)
        changes = {
            name: o.sign * (best.objectives[name] / flat.objectives[name] - 1.0)
            for name, o in zip(FIVE, lookup(FIVE), strict=True)
        }
        gain, loss = min(changes, key=changes.get), max(changes, key=changes.get)
        assert title(gain) in said
        assert title(loss) in said
        assert said.endswith("than a flat one")

    def test_leads_with_the_largest_gain_in_what_was_sought(self, front):
        best, flat = front[2], front[3]
        assert title("distance") in walks.verdict(best, flat, ["distance"]).split(",")[0]

    def test_of_the_flat_foot_itself_nothing_is_claimed(self, front):
        flat = front[3]
        assert walks.verdict(flat, flat) == "A foot without a hollow for hard sand"


class TestFile:
    def test_successive_bests_get_better_and_end_with_the_best(self, single):
        result = single[0]
        line = walks.successive_bests(result)
        values = result.column("efficiency")[line]
        assert np.all(np.diff(values) < 0)
        assert np.all(np.diff(result.generation[line]) > 0)
        assert line[-1] == result.best
        assert [g.best for g in result.history][-1] == values[-1]

    def test_the_largest_page_stays_small(self, front, monkeypatch):
        """As many of a front and beside it as there are at most; numbers at random, as none repeat."""
        result, draw, count = front[0], np.random.default_rng(1), 3 * SHOWN
        many = dataclasses.replace(
            result,
            k=draw.integers(1, 11, (count, result.problem.space.n)),
            values=draw.normal(size=(count, result.values.shape[1])),
            feasible=np.ones(count, bool),
            reasons=np.full(count, ""),
            generation=draw.integers(5000, size=count),
            front=np.arange(SHOWN),
        )
        content = page.search_content(many, *front[1:])
        assert content["front"]["shape"] == (SHOWN,)
        assert SHOWN <= content["designs"]["rows"]["shape"][0] <= SHOWN + 1
        assert len(page_text(content)) < LIMIT

    @browser_needed
    def test_lines_of_ten_thousand_designs_are_neither_a_solid_block_nor_nothing(self, ten_thousand, browser):
        Page(browser, ten_thousand)
        ink = browser.execute_script(
            "const canvas = document.querySelector('#parallel canvas'), { width, height } = canvas;"
            "const all = canvas.getContext('2d').getImageData(0, 0, width, height).data;"
            "return Array.from({ length: all.length / 4 }, (_, i) => all[4 * i + 3]);"
        )
        shade = np.array(ink) / 255
        assert (shade > 0.05).mean() > 0.1
        assert (shade > 0.95).mean() < 0.1

    def test_of_very_many_designs_the_front_and_an_even_selection_are_shown(self, front, monkeypatch):
        result = front[0]
        monkeypatch.setattr(walks, "SHOWN", len(result.front) + 10)
        content = page.search_content(*front)
        (count,) = content["designs"]["rows"]["shape"]
        assert len(result.front) <= count <= len(result.front) + 10 < result.designs
        assert content["front"]["shape"] == (len(result.front),)
        assert f"{count} of the designs are on this page" in content["headline"]

    @pytest.mark.parametrize("exact", [True, False])
    def test_packed_numbers_come_back(self, exact):
        import base64

        values = np.random.default_rng(1).normal(size=(40, 3)) * 1e3
        found = packed(values, exact)
        raw = np.frombuffer(base64.b64decode(found["data"]), "<f4" if exact else "<u2").astype(float)
        back = raw if exact else found["low"] + found["step"] * raw
        error = 1e-7 * np.abs(values).max() if exact else np.ptp(values) / 65535
        np.testing.assert_allclose(back.reshape(found["shape"]), values, rtol=0, atol=error)
        for last, kind in ((250, "u1"), (251, "<u2")):
            whole = packed(np.arange(-5, last + 1))
            kept = np.frombuffer(base64.b64decode(whole["data"]), kind)
            assert (whole["low"], whole["step"], kept.tolist()) == (-5, 1, list(range(last + 6)))
        large = packed(np.array([1, 70_000, 99_999, 1_000_000]))  # heights of foot.K = 1e6
        kept = np.frombuffer(base64.b64decode(large["data"]), "<f4")
        assert (large["step"], kept.tolist()) == (0.0, [1, 70_000, 99_999, 1_000_000])

    @browser_needed
    def test_a_browser_runs_nothing_of_a_name(self, browser, tmp_path):
        """Mixtures of markup and scripts, drawn; a dialog would end the test, too."""
        walk = fo.simulate(fo.Foot.flat(), accuracy="draft")
        for seed in range(tries(3)):
            draw = random.Random(seed)
            name = "".join(draw.choices(MARKUP, k=draw.randint(1, 8)))
            sand, gait = (dataclasses.replace(part, name=name) for part in (walk.scene.sand, walk.scene.gait))
            scene = dataclasses.replace(walk.scene, sand=sand, gait=gait)
            named = dataclasses.replace(walk, foot=dataclasses.replace(walk.foot, name=name), scene=scene)
            entry = {
                "study": "simulate",
                "design": foot_entry(named.foot),
                **scene_entry(scene, walk.accuracy, tuple(OBJECTIVES)),
                **{"reason": name, "warnings": [name], "versions": {name: name}, "settings": {name: name}},
            }
            browser.get(page.write(tmp_path / "page.html", page.walk_content(named, entry)).as_uri())
            assert browser.execute_script("return window.ran") is None, name
            assert len(browser.find_elements("css selector", "script")) == 2
            assert not browser.find_elements("css selector", "[src=x]")

    def test_a_multirun_of_a_study_without_one_best_foot_has_a_page_too(self, tmp_path):
        results = {"effects": {}, "stability": {}}
        for i, (name, more) in enumerate(results.items()):
            (tmp_path / str(i)).mkdir()
            (tmp_path / str(i) / "result.json").write_text(json.dumps({"study": name, **more}))
        assert summary.of_multirun(tmp_path) == 0
        text = (tmp_path / "report.html").read_text()
        assert all(f"study={name}: see its own folder" in text for name in results)

    def test_a_folder_that_cannot_be_written_is_named(self, tmp_path):
        with pytest.raises(FileError, match="nowhere"):
            page.write(tmp_path / "nowhere" / "report.html", {"title": ""})
