"""Names that a user chooses stay names: in drawings, pages, figures and on the terminal."""

import csv
import io
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from xml.etree import ElementTree

import numpy as np
import pytest
from rich.console import Console

import footopt as fo
from footopt.files import identity
from footopt.files import soles as outline
from footopt.files.io import write_walk
from footopt.foot.export import write_all
from footopt.report import figures, page, summary, terminal
from footopt.report.page.file import SCRIPTS, resources
from footopt.studies.base import foot_entry, scene_entry
from footopt.walk import OBJECTIVES

NAMES = (
    "<script>alert(1)</script>", "</script><script>alert(1)</script>", "<img src=x onerror=alert(1)>", "<!--", "-->", "]]>",
    "\"' onload='alert(1)", "a&b;&lt;&#60;", "a\nb\r\nc\td", "\x1b[31mred\x07\x00", "$x$", "$\\frac{", "\\$", "[/red]",
    "[bold]b", "_hidden", "grün ∞", "\u202egnp.exe", "\u2028", "%s {0} {name}", "'); DROP TABLE design;--", "n" * 300,
    "<!--DATA-->", "<!--SCRIPT-->", "",
)  # fmt: skip


class Elements(HTMLParser):
    """What a browser would find in a page: tags, handlers, the text of scripts and headings."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.handlers, self.texts = [], [], {}
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.handlers += [name for name, _ in attributes if name.startswith("on")]

    def handle_data(self, text):
        if self.tags:
            self.texts.setdefault(self.tags[-1], []).append(text)


@pytest.fixture(scope="module")
def walk(ramp_foot):
    return fo.simulate(ramp_foot, fo.Scene(), "draft")


def named(walk, name):
    """The same walk, with everything called by a name."""
    scene = replace(
        walk.scene,
        sand=replace(walk.scene.sand, name=name),
        gait=replace(walk.scene.gait, name=name, source=name),
    )
    return replace(walk, foot=replace(walk.foot, name=name), scene=scene)


def written(walk, path, note=""):
    """The page of a walk."""
    entry = {
        "study": "simulate", "design": foot_entry(walk.foot), "reason": note,
        **scene_entry(walk.scene, walk.accuracy, tuple(OBJECTIVES)), "warnings": [note], "versions": {"footopt": note},
        "settings": {"sand": {"name": note}, "foot": {"path": note}},
    }  # fmt: skip
    return page.write(path, page.walk_content(walk, entry)).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def plain(walk, tmp_path_factory):
    """The page of the walk with names that mean nothing to a browser."""
    return Elements(written(named(walk, "plain"), tmp_path_factory.mktemp("plain") / "report.html", "plain"))


@pytest.mark.parametrize("name", NAMES)
def test_no_name_adds_an_element_to_a_page(name, walk, plain, tmp_path):
    changed = Elements(written(named(walk, name), tmp_path / "report.html", name))
    assert changed.tags == plain.tags
    assert changed.tags.count("script") == 2
    assert not changed.handlers
    data = json.loads(changed.texts["script"][0])
    assert data["entry"]["scene"]["sand"]["name"] == named(walk, name).scene.sand.name
    assert data["entry"]["settings"]["sand"]["name"] == name
    assert changed.texts["title"][0] == f"footopt: {data['title']}"


def test_the_pages_own_scripts_write_no_markup():
    """Names reach the page as JSON; from there only as text."""
    parts = resources("footopt.report.page")
    for name in SCRIPTS:
        source = (parts / name).read_text(encoding="utf-8")
        assert not re.search(
            r"innerHTML|outerHTML|insertAdjacent|document\.write|eval\(|new Function", source
        )


@pytest.mark.parametrize("name", NAMES)
def test_drawings_and_bodies_do_not_hold_a_name(name, ramp_foot, tmp_path):
    foot = replace(ramp_foot, name=name)
    write_all(foot, tmp_path)
    tags = [element.tag.rpartition("}")[2] for element in ElementTree.parse(tmp_path / "contour.svg").iter()]
    assert tags == ["svg", "g", "path", "g", "path"]
    for ending in ("dxf", "svg", "csv"):
        np.testing.assert_allclose(
            outline.read(tmp_path / f"contour.{ending}").points, foot.contour, rtol=0, atol=1e-9
        )
    for path in tmp_path.iterdir():
        assert len(name) < 5 or name.encode() not in path.read_bytes()


def test_a_name_is_a_label_of_a_figure(walk, ramp_foot):
    feet = {
        name: ramp_foot for name in NAMES if name.isascii() and name.isprintable() and 0 < len(name) < 100
    }
    drawn = figures.contours(feet)
    drawn.draw_without_rendering()  # mathtext is only looked at then
    shown = [text.get_text().replace("\\$", "$").strip() for text in drawn.legends[0].get_texts()]
    assert shown == list(feet)
    figures.com({"$\\frac{": walk, "_hidden": walk}).draw_without_rendering()


@pytest.mark.parametrize("name", NAMES)
def test_on_the_terminal_a_name_is_one_line_without_control(name, walk, monkeypatch):
    changed, stream = named(walk, name), io.StringIO()
    out = terminal.console()
    monkeypatch.setattr(out, "file", stream)
    out.print(f"{terminal.describe_scene(changed.scene)}; {terminal.describe_foot(changed.foot)}")
    terminal.warn(out, changed.foot.name)
    lines = stream.getvalue().splitlines()
    assert len(lines) == 2
    assert all(line.isprintable() for line in lines)
    assert changed.scene.sand.name in lines[0]
    assert isinstance(out, Console)


def test_the_table_over_jobs_has_a_long_setting_whole_and_a_value_of_zero(walk, tmp_path, capsys):
    setting = f"foot.path='{' '.join(['drawings of soles'] * 8)}/sole.dxf'"
    (tmp_path / "0").mkdir()
    write_all(walk.foot, tmp_path / "0")
    identity.write(tmp_path / "0", {}, [setting, "sand=soft"])
    result = {
        "study": "simulate", "design": foot_entry(walk.foot), "objectives": {"speed_loss": 0.0, "work": None},
        "settings": {"foot": {"top": 0.0, "width": 0.1}}, "versions": {},
    }  # fmt: skip
    (tmp_path / "0" / "result.json").write_text(json.dumps(result))
    assert summary.of_multirun(tmp_path) == 0
    with open(tmp_path / "summary.csv", newline="") as file:
        (row,) = csv.DictReader(file)
    assert row["overrides"] == f"{setting} sand=soft"
    assert (row["speed_loss"], row["work"]) == ("0.0", "")
    assert re.search(r" 0 +- +\d", capsys.readouterr().out)


def test_the_page_over_jobs_keeps_their_names_as_text(walk, tmp_path, capsys):
    """A job for each name, and one that failed; beside them the same jobs with names that mean nothing."""
    tags = []
    for names in (["plain"] * len(NAMES), NAMES):
        top = tmp_path / f"sweep{len(tags)}"
        for i, name in enumerate((*names, names[0])):
            job = top / str(i)
            job.mkdir(parents=True)
            identity.write(job, {}, [f"sand.name={name}{i}"])
            if i == len(names):
                (job / "error.txt").write_text(f"footopt: {name}", encoding="utf-8")
                continue
            changed = named(walk, name)
            changed.foot.to_file(job / "contour.csv")
            write_walk(job / "walk.nc", changed.variables, {"reason": changed.reason})
            result = {
                "study": "simulate", "design": foot_entry(changed.foot), "objectives": changed.objectives,
                "reason": name, "settings": {"foot": {"top": 0.0, "width": 0.1}}, "versions": {},
                "wall_time_s": 1.0, "seed": 1,
            }  # fmt: skip
            (job / "result.json").write_text(json.dumps(result), encoding="utf-8")
        assert summary.of_multirun(top) == sum(map(bool, names)) + 1  # walks with a reason failed, too
        found = Elements((top / "report.html").read_text(encoding="utf-8"))
        tags.append(found.tags)
        assert not found.handlers
    assert tags[0] == tags[1]
    assert capsys.readouterr().out
