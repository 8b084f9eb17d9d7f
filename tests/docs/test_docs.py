"""The pages keep their word: commands compose, those of the first pages run, linked files are there."""

import os
import re
import runpy
import shlex
from pathlib import Path

import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
from running import composed, footopt

import footopt as fo
from footopt.cli.compose import CONF, hydra_overrides
from footopt.effects import EFFECTS
from footopt.studies.settings import known

ROOT = Path(__file__).parents[2]
PAGES = sorted(
    path
    for pattern in ("*.md", "docs/**/*.md", "examples/**/*.md", "outputs/*.md", "outputs/reference/**/*.md")
    for path in ROOT.glob(pattern)
)
TEXTS = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in PAGES}
CHANGES = "CHANGELOG.md"  # it tells of what went
#: Settings of a small search.
SMALL = {"solver.pop_size": "8", "solver.n_gen": "2", "study.finalists": "2", "accuracy": "draft",
         "study.confirm": "null"}  # fmt: skip


def blocks(text):
    """Fenced blocks of a page: (language, content)."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", text, flags=re.M | re.S)


def prose(text):
    """A page without its fenced blocks."""
    return re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)


def spans(text):
    """Code in the running text."""
    return [" ".join(found.split()) for found in re.findall(r"`([^`]+)`", prose(text))]


def commands_of(text):
    """The arguments of a page's commands of footopt: in its `sh` blocks, and whole ones in running text."""
    shell = [content.replace("\\\n", " ") for language, content in blocks(text) if language == "sh"]
    lines = [command for content in shell for line in content.splitlines() for command in line.split("&&")]
    for line in [*lines, *(span for span in spans(text) if re.match(r"footopt( |$)", span))]:
        words = shlex.split(os.path.expandvars(line), comments=True)
        if words[:1] == ["sbatch"]:
            words = shlex.split(words[-1])
        if words[:3] == ["python", "-m", "footopt"]:
            words = words[2:]
        if words[:1] == ["footopt"]:
            yield tuple(words[1:])


FOOTOPT = {words: page for page, text in TEXTS.items() if page != CHANGES for words in commands_of(text)}
for line in re.findall(r"^ {8}footopt((?: [^ \n]+)*)(?:  .*)?$", (CONF / "config.yaml").read_text(), re.M):
    FOOTOPT[tuple(shlex.split(line))] = "footopt --help"
FIRST = [words for words, page in FOOTOPT.items() if page in ("README.md", "docs/getting-started.md")]


def overrides(arguments):
    """The settings of a command, as Hydra reads them: not the run that another begins from."""
    words = [word for word in arguments if "=" in word and not word.startswith(("-", "run=", "resume="))]
    return OverridesParser.create().parse_overrides(hydra_overrides(words))


# --- commands and Python -------------------------------------------------------------------------


@pytest.mark.slow
def test_every_command_composes():
    """With one value of those of a sweep, and without what `examples` and the reader's own files add."""
    assert len(FOOTOPT) > 30
    for arguments, page in FOOTOPT.items():
        if {"--config-dir", "--help", "--version"} & set(arguments) or "plugins=" in " ".join(arguments):
            continue
        words = []
        for word in overrides(arguments):
            if not word.key_or_group.startswith("hydra") and not word.is_interval_sweep():
                one = next(word.sweep_string_iterator()) if word.is_sweep_override() else None
                words.append(f"{word.key_or_group}={one}" if one else word.input_line)
        try:
            composed(*words)
        except HydraException as error:
            raise AssertionError(f"{page}: footopt {' '.join(arguments)}") from error


@pytest.mark.slow
@pytest.mark.parametrize("arguments", FIRST, ids=" ".join)
def test_the_first_commands_run(arguments, place):
    """As they stand, but for how long they search."""
    words = ["run=earlier" if word.startswith("run=") else word for word in arguments]
    words = ["resume=earlier" if word.startswith("resume=") else word for word in words]
    given = {word.partition("=")[0]: word for word in words}
    searches = not {"study", "run", "resume", "--help", "--version"} & set(given)
    more = [f"{key}={value}" for key, value in SMALL.items() if searches and key not in given]
    before = {*place.rglob("result.json")}
    done = footopt(*words, *more, cwd=place)
    assert done.returncode == 0, done.stderr
    left = {*place.rglob("result.json")} - before
    assert all((path.parent / "report.html").is_file() for path in left)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with an earlier run."""
    folder = tmp_path_factory.mktemp("docs")
    words = [f"{key}={value}" for key, value in SMALL.items() if key != "study.confirm"]
    assert footopt(*words, "hydra.run.dir=earlier", cwd=folder).returncode == 0
    return folder


@pytest.mark.slow
def test_the_python_of_the_first_page_runs(tmp_path, monkeypatch):
    (code,) = [content for language, content in blocks(TEXTS["README.md"]) if language == "python"]
    assert '("n_gen", 50)' in code
    monkeypatch.chdir(tmp_path)
    found = {}
    exec(code.replace('("n_gen", 50)', '("n_gen", 2)'), found)
    assert len(found["table"].values) == 1000
    assert len(found["res"].F) > 1
    assert (tmp_path / "front.png").exists()


def test_the_reference_of_python_has_every_public_name():
    """Those of the module `fo.mujoco`, and of `fo.stress`, by where they are."""
    listed = re.findall(r"^\.\. auto\w+:: (?:footopt\.)?(\S+)$", (ROOT / "docs/api.rst").read_text(), re.M)
    assert {*fo.__all__} - {*listed} == {"__version__", "mujoco", "stress"}
    assert {"mujoco.Robot", "mujoco.attach", "sand.law.alpha"} < {*listed}


@pytest.mark.parametrize("page", TEXTS)
def test_files_that_are_linked_are_there(page):
    """Sphinx looks for the anchors in them."""
    for target in re.findall(r"\]\(([^)\s#]+)[^)\s]*\)", prose(TEXTS[page])):
        assert re.match(r"\w+:", target) or ((ROOT / page).parent / target).exists(), f"{page}: {target}"


@pytest.mark.parametrize("page", sorted({*TEXTS} - {CHANGES}))
def test_python_is_python_and_its_public_names_exist(page):
    code = [content for language, content in blocks(TEXTS[page]) if language == "python"]
    for text in code:
        compile(text, page, "exec")
    for name in re.findall(r"\bfo\.([a-zA-Z_]+)", "\n".join([*code, *spans(TEXTS[page])])):
        assert hasattr(fo, name), f"{page}: fo.{name}"


def test_the_reference_is_that_of_the_program_and_every_setting_has_a_meaning():
    """But effects without parameters."""
    page, bare = runpy.run_path(str(ROOT / "docs/reference.py"))["page"](), {f"effects.{n}" for n in EFFECTS}
    assert TEXTS["docs/reference.md"] == page, "write it again: python docs/reference.py > docs/reference.md"
    assert [s.name for s in known().values() if not s.described[1] and s.name not in bare] == []
    assert all(f"`{name}`" in page for name in {*known()} - bare)
