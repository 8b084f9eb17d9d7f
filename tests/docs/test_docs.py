"""The pages keep their word: commands compose, those of the first pages run, and links resolve."""

import os
import re
import shlex
from pathlib import Path

import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
from running import composed, footopt

import footopt as fo
from footopt.cli.compose import CONF, groups, hydra_overrides
from footopt.studies.settings import known

ROOT = Path(__file__).parents[2]
PAGES = sorted(
    path
    for pattern in ("*.md", "docs/**/*.md", "examples/**/*.md", "outputs/*.md", "outputs/reference/**/*.md")
    for path in ROOT.glob(pattern)
)
TEXTS = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in PAGES}
CHANGES = "CHANGELOG.md"  # it tells of what went
#: Programs of other people: .ci/run and other tests run what is behind them.
OTHERS = {"python", "make", "pip", "pytest", "sphinx-build", "pre-commit", "sbatch", "dask", "cd"}
#: Settings of a small search.
SMALL = {"solver.pop_size": "8", "solver.n_gen": "2", "study.finalists": "2", "accuracy": "draft",
         "study.confirm": "null"}  # fmt: skip
GROUPS = groups()
KEYS = {key[:end] for key in known() for end in (*(i for i, c in enumerate(key) if c == "."), len(key))}

OWN = {
    "cohesion",
    "floor",
    "ripple",
    "shaking",
    "hill_climbing",
    "distance",
    "unit",
}  # of the plugins in docs


def blocks(text):
    """Fenced blocks of a page: (language, content, text before)."""
    fence = re.compile(r"^```(\w*)\n(.*?)^```$", flags=re.M | re.S)
    return [(found[1], found[2], text[: found.start()]) for found in fence.finditer(text)]


def prose(text):
    """A page without its fenced blocks."""
    return re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)


def spans(text):
    """Code in the running text."""
    return [" ".join(found.split()) for found in re.findall(r"`([^`]+)`", prose(text))]


def commands_of(text):
    """Commands of a page, one each, without comments: of its `sh` blocks, and whole ones in running text."""
    shell = [content.replace("\\\n", " ") for language, content, _ in blocks(text) if language == "sh"]
    lines = [line for content in shell for line in content.splitlines()]
    whole = re.compile(r"(footopt|python|pip|pytest|sbatch|dask|sphinx-build|pre-commit) +\S.*|footopt")
    for line in [*lines, *(span for span in spans(text) if whole.fullmatch(span))]:
        words = shlex.split(os.path.expandvars(line), comments=True)
        while "&&" in words:
            yield tuple(words[: words.index("&&")])
            words = words[words.index("&&") + 1 :]
        if words:
            yield tuple(words)


COMMANDS = {words: page for page, text in TEXTS.items() if page != CHANGES for words in commands_of(text)}
for line in re.findall(r"^ {8}(footopt(?: [^ \n]+)*)(?:  .*)?$", (CONF / "config.yaml").read_text(), re.M):
    COMMANDS[tuple(shlex.split(line))] = "footopt --help"


def footopt_words(words):
    """The arguments if the command is footopt, also as a module or as what sbatch runs; else None."""
    if words[0] == "sbatch":
        return footopt_words(tuple(shlex.split(words[-1])))
    if words[:3] == ("python", "-m", "footopt"):
        return words[3:]
    return words[1:] if words[0] == "footopt" else None


FOOTOPT = {found: page for words, page in COMMANDS.items() if (found := footopt_words(words)) is not None}
FIRST = [words for words, page in FOOTOPT.items() if page in ("README.md", "docs/getting-started.md")]


def overrides(arguments):
    """The settings of a command, as Hydra reads them: not the run that another begins from."""
    words = [word for word in arguments if "=" in word and not word.startswith(("-", "run=", "resume="))]
    return OverridesParser.create().parse_overrides(hydra_overrides(words))


# --- settings and commands ------------------------------------------------------------------------


@pytest.mark.parametrize("page", sorted({*TEXTS} - {CHANGES}))
def test_every_setting_exists(page):
    """`key=value` or `key=`: in commands, their comments, and running text."""
    own = set(re.findall(r"(?:scene|sand|gait)/(\w+)\.yaml", TEXTS[page]))
    own |= {path.stem for path in (ROOT / "examples").rglob("*.yaml")} | OWN
    shell = [content for language, content, _ in blocks(TEXTS[page]) if language == "sh"]
    code = [*shell, *(span for span in spans(TEXTS[page]) if "fo." not in span)]
    pattern = re.compile(r"([a-z_]+(?:[./][a-zA-Z_0-9]+)*)=(.*)")
    for word in " ".join(code).split():
        key, value = found.groups() if (found := pattern.fullmatch(word.strip('",'))) else ("", "")
        if key in GROUPS:
            named = [name for name in re.findall(r"\w+", value) if not name.isdigit()]
            assert set(named) <= set(GROUPS[key]) | own, f"{page}: {key}={value}"
        elif "." in key and not key.startswith("hydra") and not OWN & {*key.split(".")}:
            assert key in KEYS, f"{page}: {key}={value}"


def test_every_command_is_known_and_its_words_are_read():
    assert len(FOOTOPT) > 30
    for words, page in COMMANDS.items():
        arguments = footopt_words(words)
        assert arguments is not None or words[0] in OTHERS, f"{page}: {words}"
        assert all((ROOT / w.partition("::")[0]).exists() for w in words if w.startswith(("tests/", "bench")))
        overrides(arguments or ())


def bundles():
    """Settings of all commands by group, those together that do not differ in one: composing takes a while.

    One value of those of a sweep; what `examples` and the reader's own files add is left out.
    """
    found = []
    for arguments in FOOTOPT:
        if {"--config-dir", "--help", "--version"} & set(arguments) or "plugins=" in " ".join(arguments):
            continue
        own = {}
        for word in overrides(arguments):
            key = word.key_or_group
            if not key.startswith("hydra") and not word.is_interval_sweep():
                swept = word.is_sweep_override()
                line = f"{key}={next(word.sweep_string_iterator())}" if swept else word.input_line
                own.setdefault(key.partition(".")[0], []).append(line)
        fitting = (b for b in found if all(b.get(group, words) == words for group, words in own.items()))
        bundle = next(fitting, None)
        if bundle is None:
            found.append(bundle := {})
        bundle |= own
    return [[word for words in bundle.values() for word in words] for bundle in found]


@pytest.mark.slow
def test_every_command_composes():
    for words in bundles():
        try:
            composed(*words)
        except HydraException as error:
            raise AssertionError(f"footopt {' '.join(words)}") from error


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
    (code,) = [content for language, content, _ in blocks(TEXTS["README.md"]) if language == "python"]
    assert '("n_gen", 50)' in code
    monkeypatch.chdir(tmp_path)
    found = {}
    exec(code.replace('("n_gen", 50)', '("n_gen", 2)'), found)
    assert len(found["table"].values) == 1000
    assert len(found["res"].F) > 1
    assert (tmp_path / "front.png").exists()


# --- links and extras ------------------------------------------------------------------------------


def anchors(text):
    """The anchors of a page's headings, as hosting sites make them."""
    heads = re.findall(r"^#+ +(.+?) *$", prose(text), flags=re.M)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


@pytest.mark.parametrize("page", TEXTS)
def test_links_and_their_anchors_resolve(page):
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(TEXTS[page])):
        path, _, anchor = target.partition("#")
        if re.match(r"\w+:", path):
            continue
        file = ((ROOT / page).parent / path).resolve() if path else ROOT / page
        assert file.exists(), f"{page}: {target}"
        if anchor:
            assert anchor in anchors(file.read_text(encoding="utf-8")), f"{page}: {target}"


@pytest.mark.parametrize("page", sorted({*TEXTS} - {CHANGES}))
def test_python_is_python_and_its_public_names_exist(page):
    code = [content for language, content, _ in blocks(TEXTS[page]) if language == "python"]
    for text in code:
        compile(text, page, "exec")
    for name in re.findall(r"\bfo\.([a-zA-Z_]+)", "\n".join([*code, *spans(TEXTS[page])])):
        assert hasattr(fo, name), f"{page}: fo.{name}"
