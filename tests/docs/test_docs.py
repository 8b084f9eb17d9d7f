"""The pages keep their word: their commands and blocks of Python run, every message is quoted right.

Commands are those of the `sh` blocks, of code in running text, and of `footopt --help`. As many run
(`chosen`) as have every setting with every study, as they stand but for `SMALL`, which makes their
studies small, `real`, which puts files for names that are only examples, and what `OTHERS` says of
programs that are not footopt.
"""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
import warnings
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from running import LIMIT, footopt, program

import footopt as fo
from footopt.cli.compose import CONF, groups
from footopt.report.numbers import number
from footopt.studies import STUDIES
from footopt.studies.settings import known

ROOT = Path(__file__).parents[2]
PAGES = sorted(
    path
    for pattern in ("*.md", "docs/**/*.md", "examples/**/*.md", "outputs/*.md", "outputs/reference/**/*.md")
    for path in ROOT.glob(pattern)
)
TEXTS = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in PAGES}
HELP = "conf/config.yaml"
#: What makes each study small: put for the same key of its command, or else added. The choice of a group
#: (a key without a dot) is added only where the command makes none.
SEARCH = {
    "solver.pop_size": "8",
    "solver.n_gen": "2",
    "study.finalists": "2",
    "accuracy": "draft",
    "study.confirm": "null",
}
SMALL = {
    "optimize": SEARCH,
    "simulate": {"accuracy": "draft"},
    "export": {},
    "compare": {},
    "doctor": {},
    "calibrate": {},
    "accuracy": {"study.feet": "2", "study.quick": "true"},
    "stability": {"study.cases": "[standing on zeta 5,2 kg]", "study.methods": "[sdirk2,explicit_euler]"},
    "effects": {"study.feet": "2", "accuracy": "draft"},
    "validate": {"study.cases": "[growth,friction]"},
    "robust": {k: v for k, v in SEARCH.items() if k != "study.finalists"} | {"study.quick": "true"},
    "paper": {"study.cases": "[]", "solver.pop_size": "8", "solver.n_gen": "2", "accuracy": "draft",
              "study.confirm": "draft"},
    "resume": {"solver.n_gen": "3"},
}  # fmt: skip
#: Besides, whatever the study: an enumerated space of 3^5 soles, and two workers of the many.
SMALL_TOO = {
    "constraint.hollow=0.01": {"constraint.hollow": "1"},  # which no foot of so few meets
    "solver=exhaustive": {"foot.K": "3"},
    "engine=processes": {"engine.workers": "2"},
    "hydra/sweeper=optuna": {"hydra.sweeper.n_trials": "2"},
    "hydra/launcher=joblib": {"hydra.launcher.n_jobs": "2"},
    "study.video=walk.gif": {"scene.t_f": "1.2"},
}
#: Programs of other people, and what stands for running them. Besides, what needs Slurm is composed only.
OTHERS = {
    "python": "benchmarks run with --quick, and print their tables; `test_custom` runs examples",
    "make": "run by `test_project`",
    "pip": ".ci/run installs; `test_every_extra_exists` holds the names",
    "pytest": "run by .ci/run",
    "sphinx-build": "run by .ci/run",
    "pre-commit": "a convenience for who contributes",
    "sbatch": "needs Slurm; the command that it would run is run",
    "dask": "`test_engines` starts a cluster",
}


# --- what the pages say ---------------------------------------------------------------------------


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


def is_command(span):
    """Whether code in running text is a whole command, not a name."""
    return (
        bool(re.match(r"(footopt|python|pip|pytest|sbatch|dask|sphinx-build|pre-commit) +\S", span))
        or span == "footopt"
    )


def commands_of(text):
    """Commands of a page, one each, without comments."""
    lines = [
        line
        for language, content, _ in blocks(text)
        if language == "sh"
        for line in content.replace("\\\n", " ").splitlines()
    ]
    lines += [span for span in spans(text) if is_command(span)]
    for line in lines:
        words = shlex.split(os.path.expandvars(line), comments=True)
        while "&&" in words:
            yield tuple(words[: words.index("&&")])
            words = words[words.index("&&") + 1 :]
        if words:
            yield tuple(words)


def help_commands():
    """Commands that `footopt --help` shows: what follows after two spaces says what they do."""
    lines = re.findall(r"^ {8}(footopt(?: [^ \n]+)*)(?:  .*)?$", (CONF / "config.yaml").read_text(), re.M)
    return [tuple(shlex.split(line)) for line in lines]


def every_command():
    """Commands by the page where they stand first."""
    found = {}
    for page, text in TEXTS.items():
        for words in commands_of(text):
            found.setdefault(words, page)
    for words in help_commands():
        found.setdefault(words, HELP)
    return found


COMMANDS = every_command()


def footopt_words(words):
    """The arguments if the command is footopt, also as a module or as what sbatch runs; else None."""
    if words[0] == "sbatch":
        return footopt_words(tuple(shlex.split(words[-1])))
    if words[:3] == ("python", "-m", "footopt"):
        return words[3:]
    return words[1:] if words[0] == "footopt" else None


def small(words):
    """The arguments of a command, made small; None for a study that `SMALL` does not know."""
    words = [word for word in words if word != "..."]
    if "--help" in words or "--version" in words:
        return words
    given = {word.partition("=")[0]: word.partition("=")[2] for word in words if "=" in word}
    study = "resume" if "resume" in given else given.get("study", "optimize")
    if study not in SMALL:
        return None
    changes = dict(SMALL[study])
    if "solver=exhaustive" in words:
        changes.pop("solver.n_gen", None)  # which it does not read
    for choice, more in SMALL_TOO.items():
        if choice in words:
            changes |= more
    if "-m" in words:
        words = [first_values(word) for word in words]
    if any(word.startswith("hydra/launcher=") for word in words):  # a process for each job
        swept = [word for word in words if "," in word and "[" not in word]
        words = [first_values(word, 1) if word in swept[1:] else word for word in words]
    for key, value in changes.items():
        if key not in given:
            words.append(f"{key}={value}")
        elif "." in key:
            words = [f"{key}={value}" if word.startswith(f"{key}=") else word for word in words]
    return words


def first_values(word, count=2):
    """The first values of a sweep."""
    key, _, values = word.partition("=")
    if values.startswith("["):
        return word
    if values.startswith("range("):
        begin = int(values[6:].split(",")[0])
        values = ",".join(map(str, range(begin, begin + count)))
    return f"{key}={','.join(values.split(',')[:count])}" if values else word


def settings_named(text):
    """Settings of a page, `key=value` or `key=`: in commands, their comments, and running text."""
    shell = [content for language, content, _ in blocks(text) if language == "sh"]
    candidates = " ".join(shell).split() + [
        word for span in spans(text) if "fo." not in span for word in span.split()
    ]
    pattern = re.compile(r"([a-z_]+(?:[./][a-zA-Z_0-9]+)*)=(.*)")
    return [found.groups() for word in candidates if (found := pattern.fullmatch(word.strip('",')))]


# --- what footopt knows ---------------------------------------------------------------------------


GROUPS = groups()
KEYS = {key[:end] for key in known() for end in (*(i for i, c in enumerate(key) if c == "."), len(key))}


class TestSettings:
    @pytest.mark.parametrize("page", sorted({*TEXTS} - {"CHANGELOG.md"}))  # it tells of settings that went
    def test_every_setting_exists(self, page):
        own = set(re.findall(r"(?:scene|sand|gait)/(\w+)\.yaml", TEXTS[page]))
        own |= {path.stem for path in (ROOT / "examples").rglob("*.yaml")}
        for key, value in settings_named(TEXTS[page]):
            if key in ("run", "resume") or key.startswith("hydra"):
                continue
            if key in GROUPS:
                named = [name for name in re.findall(r"\w+", value) if not name.isdigit()]
                assert set(named) <= set(GROUPS[key]) | own, f"{page}: {key}={value}"
            elif "." in key:
                assert key in KEYS, f"{page}: {key}={value}"

    def test_the_page_of_settings_lists_every_choice(self):
        rows = re.findall(r"^\| `(\w+)=` \| ([^|]+) \|", TEXTS["docs/settings.md"], flags=re.M)
        assert {"sand", "accuracy", "effects", "scene", "solver", "engine"} <= {group for group, _ in rows}
        for group, text in rows:
            listed = set(re.findall(r"\w+", re.sub(r"\([^)]*\)|;.*|, or .*", "", text)))
            assert listed == set(GROUPS[group]), group

    def test_the_help_names_every_group(self):
        listed = re.findall(r"^        (\w+)  +\S", (CONF / "config.yaml").read_text(), flags=re.M)
        assert GROUPS.keys() <= set(listed)


# --- commands -------------------------------------------------------------------------------------


def only_composed(arguments):
    """Whether a command is not run: it needs Slurm or a search that runs, or is not all there."""
    clusters = ("hydra/launcher=submitit_slurm", "hydra/launcher=cluster", "engine=dask")
    return arguments[-1:] == ("...",) or any(word in clusters for word in arguments)


def test_every_command_is_known():
    assert len(COMMANDS) > 30
    for words, page in COMMANDS.items():
        arguments = footopt_words(words)
        if arguments is not None:
            assert small(arguments) is not None, f"{page}: {words}: add its study to SMALL"
        else:
            assert words[0] in OTHERS, f"{page}: {' '.join(words)}"
    assert {*SMALL} >= {*STUDIES}


def test_every_block_has_a_language_that_is_tested():
    for page, text in TEXTS.items():
        assert {language for language, _, _ in blocks(text)} <= {"", "sh", "python", "yaml", "console"}, page


def extras(text):
    """The extras of footopt that a text names."""
    return {
        name for named in re.findall(r"(?:footopt|\.)\[([a-z0-9,]+)\]", text) for name in named.split(",")
    }


def test_every_extra_exists():
    known = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    for page, text in TEXTS.items():
        assert extras(text) <= set(known), page


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with the files that pages name, an earlier run and an earlier sweep."""
    folder = tmp_path_factory.mktemp("docs")
    shutil.copytree(ROOT / "examples", folder / "examples")
    for source, name in (("gait/walk.mot", "walk.mot"),
                         ("sole/rocker.csv", "sole.csv"), ("sand/stresses.csv", "stresses.csv"),
                         ("sand/plates.csv", "plates.csv")):  # fmt: skip
        shutil.copy(ROOT / "examples" / source, folder / name)
    fo.Foot.from_file(folder / "sole.csv").to_file(folder / "sole.dxf")
    for text in TEXTS.values():
        for language, content, before in blocks(text):
            names = re.findall(r"`(?:mine/)?([\w/]+\.yaml)`", before)
            if language == "yaml" and names:  # the file that the text before it names
                name = names[-1]
                (folder / "mine" / name).parent.mkdir(parents=True, exist_ok=True)
                (folder / "mine" / name).write_text(content)
            paragraph = before.rstrip().rpartition("\n\n")[2]
            if language == "python" and (names := re.findall(r"file `(\w+\.py)`", paragraph)):
                (folder / names[0]).write_text(content)
    words = [f"{key}={value}" for key, value in SEARCH.items()]
    assert footopt(*words, "hydra.run.dir=earlier", cwd=folder).returncode == 0
    sweep = ["-m", "sand=regular,hard", "hydra.sweep.dir=sweep1", *words]
    assert footopt(*sweep, cwd=folder).returncode == 0
    return folder


def real(word, place):
    """A word of a command with real files and folders for the names that are only examples."""
    key, _, value = word.partition("=")
    if key == "run":
        return f"run={place / 'earlier'}"
    if key == "study.runs":
        return f"study.runs=[{place / 'earlier'},{place / 'sweep1'}/*]"
    if key == "resume":
        parts = re.search(r"(sweep1)(/\d+)?$", value)
        return f"resume={place / ('sweep1' + ('/1' if parts[2] else '') if parts else 'earlier')}"
    if key == "hydra.sweep.dir":
        return f"{key}={place / 'sweeps' / Path(value).name}"
    return word


FOOTOPT = {a: page for words, page in COMMANDS.items() if (a := footopt_words(words)) is not None}
COMPOSED = [arguments for arguments in FOOTOPT if only_composed(arguments)]


def ways(arguments):
    """What a command needs of the program: its study with each of its settings."""
    study = next((word for word in arguments if word.startswith("study=")), "")
    parts = (word.partition("=") for word in arguments)
    # of choices what is chosen counts, too; `TestSettings` has the other values
    own = {"resume", "run", "sand", "foot", "plugins", "--config-dir"}
    return {(study, k if "." in k or "," in v or k in own else f"{k}={v}") for k, _, v in parts}


def chosen():
    """Commands that together have every setting with every study that the pages have, the long ones first."""
    found, seen = [], set()
    for arguments in sorted(FOOTOPT, key=len, reverse=True):
        if arguments not in COMPOSED and not ways(arguments) <= seen:
            found.append(arguments)
            seen |= ways(arguments)
    return found


RUN = chosen()


def test_every_study_is_run_and_a_multirun():
    """Each has to leave report.html there."""
    studies = {word.partition("=")[2] for arguments in RUN for word in arguments if word.startswith("study=")}
    assert studies | {"optimize"} == {*STUDIES}
    assert any("-m" in arguments for arguments in RUN)


@pytest.mark.slow
@pytest.mark.parametrize("arguments", RUN, ids=" ".join)
def test_the_command_runs(arguments, place, request):
    drawn = any(word.startswith("study.video=") for word in arguments)
    words = [real(word, place) for word in small(arguments)]
    before = {path for path in place.rglob("*") if path.is_file()}
    if any(word.startswith("hydra/launcher=") for word in words):
        pytest.importorskip("hydra_plugins", reason="needs footopt[joblib,submitit]")
    if "hydra/sweeper=optuna" in words:  # what it imports uses what is deprecated
        warnings.simplefilter("ignore")
    # launchers leave processes behind, and plugins what they register
    away = any(word.startswith(("hydra/launcher=", "plugins=", "-cn", "--version")) for word in words)
    done = (program if away else footopt)(*words, cwd=place, drawn=drawn)
    assert done.returncode == 0, f"{FOOTOPT[arguments]}: footopt {' '.join(words)}\n{done.stderr}"
    told = {
        "--help": "Each run writes to its own folder",
        "--version": fo.__version__,
        "--help sand": "sand.zeta",
    }
    if " ".join(words) in told:
        assert told[" ".join(words)] in done.stdout
        return
    left = {path for path in place.rglob("*") if path.is_file()} - before
    if "study.video=walk.gif" in words:
        (film,) = [path for path in left if path.name == "walk.gif"]
        with Image.open(film) as image:
            assert image.n_frames == pytest.approx(1.2 * 25 / 0.5 + 1, abs=1)
    ended = {path.parent for path in left if path.name in ("result.json", "summary.csv")}
    assert "report=none" in words or all((folder / "report.html").is_file() for folder in ended)
    results = [json.loads(path.read_text()) for path in left if path.name == "result.json"]
    assert all(result.get("feasible", True) for result in results)
    if not any(word.startswith("resume=") for word in words):
        assert any(path.suffix == ".json" for path in left), words


@pytest.mark.slow
def test_what_needs_a_cluster_composes(place):
    pytest.importorskip("hydra_plugins.hydra_submitit_launcher", reason="needs footopt[submitit]")
    found = []
    for arguments in COMPOSED:
        words = [first_values(word, 1) for word in arguments if word not in ("-m", "...")]
        done = footopt(*words, "--cfg", "all", cwd=place)
        assert done.returncode == 0, done.stderr
        found += re.findall(r"_target_: hydra_plugins\.hydra_(\w+)_launcher|(mem_gb: 4)", done.stdout)
    assert ("submitit", "") in found
    assert ("", "mem_gb: 4") in found  # the page's own launcher


def of(name):
    """Commands of a program that is not footopt."""
    return [words for words in COMMANDS if words[0] == name and footopt_words(words) is None]


def other(*words):
    """Run a Python program at the top of the checkout, as no part of these tests: what it printed."""
    plain = {key: value for key, value in os.environ.items() if not key.startswith("PYTEST_")}
    done = subprocess.run(
        [sys.executable, *words], cwd=ROOT, env=plain, capture_output=True, text=True, timeout=LIMIT
    )
    assert done.returncode == 0, f"{' '.join(words)}\n{done.stdout}\n{done.stderr}"
    return done.stdout, done.stderr


#: The rows that a benchmark's table has at least.
ROWS = {
    "report.py": 20,
    "effects.py": 4,
    "solvers.py": 9,
    "ablation.py": 5,
    "fronts.py": 5,
    "mujoco_steps.py": 4,
    "page.py": 1,
    "command.py": 1,
}
#: Parts of benchmarks/report.py that are not a benchmark of their own.
PARTS = ["paper", "euler", "absolute", "plates", "size", "start", "ga"]


@pytest.mark.slow
@pytest.mark.parametrize("words", of("python"), ids=" ".join)
def test_a_script_runs_and_prints_its_table(words):
    path = Path(words[1])
    if path.name not in ROWS:
        # others run these: `test_custom`, `test_biped`, `test_promises`, `test_rest`
        long = "large_search", "pairs"
        assert path.stem in long or path.parent.name in ("custom", "examples", "mujoco", "tests")
        return
    said, _ = other(*words[1:], "--quick", *(PARTS if path.name == "report.py" else []))
    lines = [line for line in said.splitlines() if line.startswith("|")]
    heads = {n for i, line in enumerate(lines) if "---" in line for n in (i - 1, i)}  # of one table or more
    rows = [line.strip("| ").split(" | ") for i, line in enumerate(lines) if i not in heads]
    assert len(rows) >= ROWS[path.name], said
    for name, *cells in rows:
        assert name
        assert re.search(r"\d|skipped", " ".join(cells)), said
        assert not re.search(r"\b(nan|inf)\b", " ".join(cells)), said


@pytest.mark.parametrize("words", of("pytest"), ids=" ".join)
def test_the_tests_that_a_page_names_are_there(words):
    """The run that this test is part of runs them."""
    named = [word for word in words[1:] if word.startswith("tests")]
    assert all((ROOT / path.partition("::")[0]).exists() for path in named)


# --- Python ---------------------------------------------------------------------------------------

#: Before the blocks of a page: `fo` and `np` as everywhere, searches of two generations, films of few frames.
PREAMBLE = """
import numpy as np
import footopt as fo
from footopt.design import search

def small_search(problem, solver=None, *arguments, **options):
    if solver is None or isinstance(solver, str):  # an algorithm of pymoo has its own
        options |= {"pop_size": 8, "n_gen": 2}
    return search(problem, solver, *arguments, **options)

def small_film(walk, path, **options):
    return film(walk, path, **options | {"fps": 2})

fo.search = small_search
fo.animate, film = small_film, fo.animate
"""
PYTHON = {
    page: "\n".join(content for language, content, _ in blocks(text) if language == "python")
    for page, text in TEXTS.items()
}
PYTHON = {page: code for page, code in PYTHON.items() if code}


@pytest.mark.slow
@pytest.mark.parametrize("page", PYTHON)
def test_the_python_of_a_page_runs_from_top_to_bottom(page, place):
    """In a process of its own, because a page may register effects and objectives."""
    (place / "block.py").write_text(PREAMBLE + PYTHON[page])
    done = subprocess.run(
        [sys.executable, "-W", "error", "block.py"], cwd=place, capture_output=True, text=True, timeout=LIMIT
    )
    assert done.returncode == 0, done.stderr
    if page == "docs/python.md":
        assert all((place / name).stat().st_size > 1000 for name in ("mine.pdf", "foot.png", "walk.gif"))


# --- messages -------------------------------------------------------------------------------------


def messages():
    """Quoted sessions: (page, what is typed, what it answers)."""
    for page, text in TEXTS.items():
        for language, content, _ in blocks(text):
            if language == "console":
                for part in re.split(r"^(?=\$ |>>> )", content, flags=re.M):
                    if part.strip():
                        typed, _, answer = part.partition("\n")
                        yield page, typed, " ".join(answer.split())


MESSAGES = list(messages())


@pytest.mark.slow
@pytest.mark.parametrize(("page", "typed", "answer"), MESSAGES, ids=[typed for _, typed, _ in MESSAGES])
def test_a_quoted_message_is_what_footopt_says(page, typed, answer, place):
    """All of an error; of what a run prints, the lines that are quoted. `...` is anything."""
    pattern = re.escape(answer).replace(re.escape("..."), ".*")
    if typed.startswith(">>> "):
        with pytest.raises(fo.FootoptError) as raised:
            exec(typed.removeprefix(">>> "), {"fo": fo, "np": np})
        kind = type(raised.value)
        said = f"{kind.__module__}.{kind.__name__}: {raised.value}"
        assert re.fullmatch(pattern, " ".join(said.split())), page
        return
    words = shlex.split(typed)
    assert words[:2] == ["$", "footopt"], page
    done = footopt(*words[2:], cwd=place)
    if done.returncode == 1:
        assert re.fullmatch(pattern, " ".join(done.stderr.split())), f"{page}: {done.stderr}"
    else:  # what a run prints, or Hydra's own parser
        text = done.stdout + done.stderr
        assert re.search(pattern, " ".join(text.split())), f"{page}: {text}"
        assert done.returncode == (2 if "error:" in answer else 0)


# --- numbers --------------------------------------------------------------------------------------


def test_the_closing_table_is_that_of_its_foot():
    """To the digits shown: the best foot and the flat one, as the finalists of a search are walked."""
    (table,) = [
        content for _, content, _ in blocks(TEXTS["docs/getting-started.md"]) if "Best design" in content
    ]
    (k,) = re.findall(r"k = \[([\d, ]+)\]", table)
    foot = fo.Foot.from_waypoints([int(height) for height in k.split(",")])
    best, flat = (fo.simulate(sole, accuracy="fine").objectives for sole in (foot, fo.Foot.flat()))
    rows = re.findall(r"^ +(\w[\w ]+) \(\w+\) .*?(-?[\d.e-]+) +[\d.e-]+ % +(-?[\d.e-]+) ", table, flags=re.M)
    assert len(rows) == 6
    for title, *shown in rows:
        name = title.replace(" ", "_")
        assert [number(best[name]), number(flat[name])] == shown, title


def test_the_claims_are_those_of_the_study():
    judged = TEXTS["outputs/reference/paper/claims.md"].splitlines()
    rows = re.findall(r"^\| Fig\. .*\|$", TEXTS["docs/claims.md"], flags=re.M)
    assert all(row in judged for row in rows)
    plain = [line for line in judged if line.endswith(("| holds |", "| does not hold |"))]
    assert sorted(rows) == sorted(plain)
