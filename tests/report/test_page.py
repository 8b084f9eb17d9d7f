"""report.html in a real browser: what it shows, what moves it, and the files that it hands out."""

import csv
import dataclasses
import io
import json
import random
import re

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
from footopt.files import identity
from footopt.files.outline import closed_contour
from footopt.report import figures, page, summary, terminal
from footopt.report.page.file import packed
from footopt.report.page.file import text as page_text
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
    return result, confirmed, best, flat, entry


@pytest.fixture(scope="module")
def front():
    return searched("pareto", "nsga2")


@pytest.fixture(scope="module")
def single():
    return searched("efficiency", "ga")


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
    assert summary.compare(folder, identity.jobs(folder)) == 1
    (folder / "report.html").rename(folder / "runs.html")
    contents["exact"] = page.search_content(*searched("work", "exhaustive", fo.Waypoints(n=4, K=3)))
    contents["no runs"] = summary.runs_content(folder, [Run(folder / "9")], ["9"], [""], [])
    (folder / "figures").mkdir()
    walk = fo.simulate(fo.Foot.flat(), accuracy="draft")
    figures.save(figures.contour(walk.foot), folder / "figures", "contour", ["png", "svg"])
    figures.save(figures.forces({"flat": walk}), folder / "figures", "wide", ["png", "svg"])
    (folder / "table 1.csv").write_text("")
    page.write_study(folder, "A study", ["What <it> found"], SAYS, [study_table()], STUDY, ["Not <so> good."])
    (folder / "report.html").rename(folder / "study.html")
    written = {name: page.write(folder / f"{name}.html", content) for name, content in contents.items()}
    return written | {"runs": folder / "runs.html", "study": folder / "study.html"}


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


KINDS = ["front", "single", "exact", "walk", "sunk", "runs", "no runs", "study"]


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


@browser_needed
class TestLooks:
    @pytest.mark.parametrize(
        ("kind", "scheme", "width"),
        [("front", "light", 1280), ("study", "dark", 390)],
    )
    def test_axe_finds_nothing(self, kind, scheme, width, pages, browser):
        browser.set_window_size(width, 900)
        shown = Page(browser, pages[kind])
        shown.emulate(prefers_color_scheme=scheme)
        assert shown.judged() == []
        shown.emulate(prefers_color_scheme="light")
        browser.set_window_size(1280, 900)


@browser_needed
class TestBars:
    def test_each_objective_is_a_bar_as_long_as_its_change(self, front, pages, browser):
        _, _, best, flat, _ = front
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


@browser_needed
class TestDownloads:
    def test_dxf_and_csv_hold_the_sole_that_is_shown(self, front, pages, browser, downloads):
        import ezdxf

        foot = front[2].foot
        shown = Page(browser, pages["front"])
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
        (link,) = shown.all("#tables a")
        assert link.get_dom_attribute("href") == "table%201.csv"
        assert link.get_property("href") == (pages["study"].parent / "table 1.csv").as_uri()
        foot = shown.text("#footer")
        assert all(said in foot for said in ("seed: 7", "wall time: 12.3 s", f"footopt {fo.__version__}"))
        assert "far too much" not in pages["study"].read_text()


@browser_needed
def test_a_multirun_shows_every_job_the_failed_ones_too(pages, browser):
    shown = Page(browser, pages["runs"])
    rows = shown.all("#runs tbody tr")
    assert len(rows) == 3
    assert "must be a number > 0" in rows[2].text
    assert [a.get_attribute("href").rsplit("/", 2)[1] for a in shown.all("#runs a")] == ["1"]
    assert "A run's link opens its own page." in shown.text("#runs")  # not every study has a walk
    assert shown.text("#traces .legend").split() == ["1"]  # run 0 has left no walk
    rows[1].find_element("css selector", "button").click()
    assert "The chosen sole: 1" in shown.text("#design-title")


class TestFile:
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
    def test_packed_numbers_come_back(self, pages, browser):
        shown = Page(browser, pages["walk"])
        values = np.random.default_rng(1).normal(size=(4, 3))
        for array in (values, values.astype("f4"), np.array([-5, 1_000_000]), np.array([np.nan, 1.0])):
            found = packed(array, double=array is values)
            back = np.array(shown.js(f"Array.from(unpack({json.dumps(found)}))"), float)
            np.testing.assert_array_equal(back, array.ravel())

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
