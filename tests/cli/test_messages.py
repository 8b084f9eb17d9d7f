"""What a user is told: which setting, which value, what is allowed, what to try; files may have any name."""

import json
import os
import subprocess
import sys

import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser
from omegaconf import OmegaConf
from running import footopt, program, started

from footopt.cli.compose import readable
from footopt.cli.messages import explain

#: What only the library, or the system, can refuse.
BAD = {
    "accuracy.plates=1": "accuracy.plates = 1: must be a whole number from 2 to 20000",
    "gait=file": "gait.path = None",
    "gait=file gait.path=broken.csv": "no column for the knee; the file has time, hip.",
    "solver=ga objective=pareto": "solver = 'ga': must be a solver of several objectives",
    "hydra.run.dir=a_file": "a_file. Write to another folder with hydra.run.dir=FOLDER.",
    "gait=file gait.path=empty.mot": "gait.path = 'empty.mot': is empty.",
    "study=simulate foot=outline foot.path=empty.svg": "foot.path = 'empty.svg': is empty.",
    "report=some": "report = 'some': must be one of none, light, full",
    "engine.threads=-1": "engine.threads = -1: must be a whole number >= 1 and <= 4096",
    "study=export": "run = None: must be the folder of a run",
    "study=simulate foot=outline": "foot.path = None: must be a drawing",
    "study=simulate foot.path=sole.dxf": "foot.path = 'sole.dxf': must be left out: foot=waypoints does not",
    "foot=outline foot.path=sole.dxf": "foot = 'outline': must be waypoints for a search",
}


@pytest.mark.parametrize(
    ("run", "arguments"),
    [*((footopt, words) for words in BAD), (program, "gait=file gait.path=broken.csv")],
)
def test_bad_input_gets_one_clear_message(run, arguments, tmp_path):
    (tmp_path / "a_file").write_text("in the way\n")
    (tmp_path / "broken.csv").write_text("time,hip\n0,1\n")
    for name in ("empty.mot", "empty.svg"):
        (tmp_path / name).write_text("\n")
    done = run(*arguments.split(), cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr.startswith("footopt: error: ")
    assert BAD[arguments] in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.rglob("result.json"))


def test_what_was_refused_leaves_no_folder_but_what_was_there_stays(tmp_path):
    refused = "study=simulate gait=file gait.path=nowhere.mot", "foot.width=0", "solver=nobody"
    for words in refused:
        assert footopt(*words.split(), cwd=tmp_path).returncode == 1
        assert footopt(*words.split(), "hydra.run.dir=mine", cwd=tmp_path).returncode == 1
    empty = footopt("study=simulate", "hydra.run.dir=", cwd=tmp_path)
    assert "hydra.run.dir=: must be a folder, and is empty." in empty.stderr
    assert not list(tmp_path.iterdir())
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("mine")
    assert footopt("foot.width=0", "hydra.run.dir=mine", cwd=tmp_path).returncode == 1
    assert (tmp_path / "mine" / "notes.txt").read_text() == "mine"


#: What newcomers type, and what they are told.
MISTAKES = {
    "snad=soft": "snad: there is no such setting. Did you mean sand=soft?",
    "sand.zta=2": "sand.zta: there is no such setting. Did you mean sand.zeta=2?",
    "+sand.density=1600": "sand.density: there is no such setting. Those of sand: name, zeta, ",
    "seed=3": "seed: there is no such setting. Did you mean solver.seed=3?",
    "effects.slope=5": "effects.slope: holds several settings. Try effects.slope.angle=...",
    "-m sand=Hard,soft": "Did you mean hard?",
    "sand=dense": "Did you mean hard?",
    "objective=[work,distanse]": "Or yours: 'objective.names=[work,distance]'.",
    "study=validate study.cases=[Wheel]": "Did you mean wheel?",
    "study=stability study.cases=[spikysoles]": "Did you mean spiky soles?",
    "sand=2.5": "A number needs its name, such as sand.zeta=2.5.",
    "sand=soft,hard": "sand = 'soft,hard': must be one choice. For a run of each: footopt -m sand=soft,hard",
    "effects=slope,inertia": "For both at once: effects=[slope,inertia]",
    "effects.slope.angle=5": "Try effects=slope effects.slope.angle=5",
    "effects.slope.zeta=5": "effects.slope.zeta: there is no such setting. Those of effects.slope: angle.",
    "effects=slope effects.slope.zeta=5": "Those of effects.slope: angle.",
    "-m sand.zeta=interval(1,2)": "sand.zeta=interval(1,2): a multirun needs single values. Try 1,2,3 or",
    "sand soft": "sand: settings are given as name=value. Try sand=soft",
    "optimize": "optimize: settings are given as name=value. Try study=optimize",
    "help": "Try footopt --help",
    "resume": "Try resume=FOLDER, of a run",
    "--sand.zeta=2": "--sand.zeta=2: settings have no dashes. Try sand.zeta=2",
    "sand.zeta=loose": "sand.zeta = 'loose': must be a number.",
    "sand.zeta=2,5": "sand.zeta = '2,5': must be without a comma. Try sand.zeta=2.5 for a number",
    "study.quick=maybe": "study.quick = 'maybe': must be true or false.",
    "foot.k=[1,x]": "foot.k = '[1,x]': must be a list of whole numbers.",
    "foot.k=5": "foot.k = '5': must be a list in brackets. Try 'foot.k=[5]'",
    "foot.k=[1,2,3": "foot.k=[1,2,3: the list does not end. Try 'foot.k=[1,2,3]'",
    "constraint.speed=3": "Did you mean constraint.speed_loss=3?",
    "=hard": "=hard: settings are given as name=value.",
    "=5": "=5: settings are given as name=value.",
    "resume=": "resume = '': must be the folder of a run.",
    "plugins=[1": "plugins=[1: the list does not end. Try 'plugins=[1]'",
    "study=compare study.runs=a,b]": "study.runs=a,b]: the list does not begin. Try 'study.runs=[a,b]'",
    "foot.k=[1, 2, 3]": "the list has spaces in it. Leave them out, or quote it: 'foot.k=[1, 2, 3]'",
    "foot.path=a,b.dxf": "'foot.path=\"a,b.dxf\"' for a text",
    "study=simulate foot.k=[1,2,3]": "These are 3: give 11 of 1 to 10, or change foot.n.",
    "study.confirm=fien": "Did you mean fine?",
    "sand.coefficzients.B11=0.2": "Did you mean sand.coefficients.B11=0.2?",
    "effects.auto=null": "effects.auto = 'null': must be given a value. Leave it out for its default.",
    "foot.L=${foot.hight}": "foot.L=${foot.hight}: there is no setting foot.hight to refer to.",
    "plugins='a.py'": "Try 'plugins=[a.py]'",
    "solver=genetic": "Did you mean ga?",
    "accuracy=fast": "Did you mean draft?",
    "fot.K=8": "Did you mean foot.K=8?",
    "fot.k=[1,2]": "Did you mean foot.k=[1,2]?",
}


@pytest.mark.parametrize("arguments", MISTAKES)
def test_a_mistake_is_told_with_what_to_try(arguments, tmp_path):
    done = footopt(*arguments.split(" "), cwd=tmp_path)
    said = done.stderr
    assert done.returncode == 1
    assert said.startswith("footopt: error: ")
    assert MISTAKES[arguments] in said
    assert "hydra" not in said.lower()
    assert not list(tmp_path.rglob("result.json"))


def test_a_setting_may_refer_to_another(tmp_path):
    words = ["study=simulate", "accuracy=draft", "report=none", "foot.L=0.12", "walker.l2=${foot.L}"]
    done = footopt(*words, "walker.l1=${walker.l2}", "hydra.run.dir=run", cwd=tmp_path)
    assert "there is no setting" not in done.stderr
    assert json.loads((tmp_path / "run/result.json").read_text())["settings"]["walker"]["l1"] == 0.12


@pytest.mark.parametrize(
    ("word", "read"),
    {
        "gait.path=Größe.mot": "Größe.mot",
        "gait.path=my walk(1).mot": "my walk(1).mot",
        "gait.path=it's=mine{2}.mot": "it's=mine{2}.mot",
        "gait.path=a[1].mot": "a[1].mot",
        "gait.path='Größe 1.mot'": "Größe 1.mot",
        "gait.path=a\\(1\\).mot": "a(1).mot",
        "gait.path=null": None,
        "gait.path=C:\\Jörg\\a.mot": "C:\\Jörg\\a.mot",
        "gait.path=~/a.mot": "/at/home/a.mot",
        "study.runs=[Läufe/*, b, ~/c]": ["Läufe/*", "b", "/at/home/c"],
        "study.runs=['a, ü','b']": ["a, ü", "b"],
        "study.runs=[]": [],
        "run=grün [1], it's": "grün [1], it's",
        "sand.name=~/x": "~/x",
    }.items(),
)
def test_files_may_have_any_name(word, read, monkeypatch):
    monkeypatch.setenv("HOME", "/at/home")
    quoted = readable(word)
    if word.startswith("sand"):
        assert quoted == word
    else:
        assert OverridesParser.create().parse_override(quoted).value() == read


def test_files_with_any_name_are_jobs_of_a_multirun():
    words = {
        "gait.path=ä.mot,b.mot": ["ä.mot", "b.mot"],
        "gait.path=choice(b.mot,c.mot)": ["b.mot", "c.mot"],
    }
    for word, jobs in words.items():
        swept = OverridesParser.create().parse_override(readable(word))
        assert [job.strip("'") for job in swept.sweep_string_iterator()] == jobs


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        RuntimeError("can't start new thread"),
        ImportError("_ckdtree.so: failed to map segment from shared object"),
    ],
)
def test_a_machine_without_memory_is_no_bug(error):
    assert explain(error).startswith("there is too little memory (")


@pytest.mark.skipif(os.name != "posix", reason="no limits there")
def test_an_address_space_in_which_libraries_would_hang_is_refused(tmp_path):
    import resource

    done = subprocess.run(
        [sys.executable, "-m", "footopt"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (500 << 20, 500 << 20)),
    )
    assert done.returncode == 1
    assert done.stderr == "footopt: error: `ulimit -v` allows 500 MB of address space; 700 are needed.\n"


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("SOURCE_DATE_EPOCH", "abc", "SOURCE_DATE_EPOCH = 'abc': must be a number of seconds, or unset."),
        ("NUMBA_NUM_THREADS", "0", "NUMBA_NUM_THREADS = '0': must be a whole number > 0, or unset."),
        ("NUMBA_NUM_THREADS", "two", "NUMBA_NUM_THREADS = 'two': must be a whole number > 0, or unset."),
        ("NUMBA_DISABLE_JIT", "1", "NUMBA_DISABLE_JIT is set, and the walk is always compiled. Unset it."),
    ],
)
def test_variables_that_libraries_would_fail_by_are_refused(name, value, said, tmp_path):
    done = program("study=simulate", cwd=tmp_path, **{name: value})
    assert (done.returncode, done.stderr) == (1, f"footopt: error: {said}\n")


def test_letters_that_a_terminal_lacks_are_no_bug(tmp_path):
    words = ["study=simulate", "accuracy=draft", "report=none", "hydra.run.dir=\u6f22"]
    done = program(*words, cwd=tmp_path, PYTHONIOENCODING="latin-1")
    assert done.returncode == 0, done.stderr
    assert "\\u6f22" in done.stdout


def test_a_run_goes_on_though_nobody_reads_any_more(tmp_path):
    words = ["study=simulate", "accuracy=draft", "report=none", "hydra.run.dir=run"]
    run = started(*words, cwd=tmp_path)
    run.stdout.close()
    with run.stderr:
        assert run.stderr.read() == ""
    assert run.wait(300) == 0
    assert (tmp_path / "run" / "result.json").is_file()


def test_a_working_folder_that_is_gone_is_said_to_be():
    assert "Is the working folder gone?" in explain(FileNotFoundError(2, "No such file or directory"))


@pytest.mark.slow
def test_variables_of_other_programs_are_no_bug(tmp_path):
    """A backend of notebooks is not needed."""
    words = ["study=simulate", "accuracy=draft", "hydra.run.dir=run"]
    done = program(*words, cwd=tmp_path, drawn=True, MPLBACKEND="nonsense", SOURCE_DATE_EPOCH="")
    assert done.returncode == 0, done.stderr


def test_a_folder_that_may_not_be_written_is_told_what_to_do_about():
    error = PermissionError(13, "Permission denied", "run")
    assert explain(error) == "Permission denied: run. Write to another folder with hydra.run.dir=FOLDER."
    assert explain(error, ["resume=run"]) == "Permission denied: run. Resume a copy that is yours."


def test_an_error_of_the_system_without_words_has_its_name():
    assert explain(TimeoutError()) == "TimeoutError"


#: Settings that the study, its foot, gait or solver does not read, and what is said.
UNREAD = {
    "study=simulate foot.length=.18": "foot.length = 0.18: must be left out: foot=waypoints does not "
    "read it. It is read by foot=ellipse, ",
    "study=simulate foot=ellipse foot.L=.05": "foot=ellipse does not read it. It is read by foot=waypoints.",
    "study=export run=R foot.width=.2": "foot.width = 0.2: must be left out: study=export does not read it",
    "study=simulate run=R foot.width=.2": "study=simulate run=... does not read it",
    "study=simulate run=R foot=ellipse": "foot.shape = 'ellipse': must be left out: study=simulate run=...",
    "study=simulate solver.n_gen=3": "It is read by study=optimize, paper, robust",
    "gait.names.knee=K": "gait.names.knee = 'K': must be left out",
    "effects.tolerance=.1": "It is read by effects=auto.",
    "engine.timeout=3": "It is read by engine=dask.",
    "study=robust study.tail=.3": "It is read by study.measure=tail.",
    "study=robust sand=soft": "It is read by study.scenarios=drawn, laws.",
    "study=doctor planet=moon": "walker.g = 1.62: must be left out: study=doctor does not read it",
}


@pytest.mark.parametrize("arguments", UNREAD)
def test_a_setting_without_effect_is_refused_and_what_reads_it_is_said(arguments, tmp_path, monkeypatch):
    monkeypatch.setattr("footopt.cli.main.resolved", lambda settings, here: OmegaConf.to_container(settings))
    done = footopt(*arguments.split(), cwd=tmp_path)
    assert done.returncode == 1
    assert UNREAD[arguments] in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.rglob("footopt.yaml"))
