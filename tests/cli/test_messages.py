"""What a user is told: which setting, which value, what is allowed, what to try."""

import json

import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser
from running import footopt, program, started

from footopt.cli.compose import hydra_overrides
from footopt.cli.messages import explain

#: Wrong inputs, and what must be named: the setting, and what to try where footopt knows it.
WRONG = {
    # names and choices that are not there
    "sand=quicksand": "sand = 'quicksand': must be one of",
    "engine.threads=-1": "engine.threads = -1: must be a whole number",
    "objective=work": "objective.names=[work]",
    "sand=2.5": "A number needs its name, such as sand.zeta=2.5.",
    "snad=soft": "snad: there is no such setting. Did you mean sand=soft?",
    "sand.zta=2": "Did you mean sand.zeta=2?",
    "seed=3": "Did you mean solver.seed=3?",
    "solver.popsize=50": "Did you mean solver.pop_size=50?",
    "+sand.density=1600": "sand.density: there is no such setting.",
    "sand.coefficzients.B11=0.2": "Did you mean sand.coefficients.B11=0.2?",
    "constraint.speed=3": "Did you mean constraint.speed_loss=3?",
    "effects.slope.angle=5": "Try effects=slope effects.slope.angle=5",
    "effects=slope effects.slope.zeta=5": "effects.slope.zeta: there is no such setting.",
    "foot.L=${foot.hight}": "foot.hight",
    # words that cannot be read
    "sand soft": "sand: settings are given as name=value.",
    "optimize": "Try study=optimize",
    "=5": "=5: settings are given as name=value.",
    "sand=soft,hard": "For a run of each: footopt -m sand=soft,hard",
    "effects=slope,inertia": "effects=[slope,inertia]",
    "sand.zeta=2,5": "sand.zeta = '2,5': must be one value.",
    "foot.k=[1, 2, 3]": "Lists have no spaces",
    "foot.k=[1,2,3": "foot.k=[1,2,3",
    "gait.path=a=b.mot": "gait.path=\"'a=b.mot'\"",
    "gait.path=Größe(1).mot": "gait.path=\"'Größe(1).mot'\"",
    "resume=": "resume = '': must be the folder of a run.",
    # values of another kind
    "sand.zeta=loose": "sand.zeta = 'loose': must be a number.",
    "solver.n_gen=2.5": "solver.n_gen = '2.5': must be a whole number.",
    "study=robust study.reuse=maybe": "study.reuse = 'maybe': must be true or false.",
    "foot.k=5": "foot.k = '5': must be a list in brackets",
    "effects.auto=null": "effects.auto = 'null': must be given a value.",
    # values that the library refuses
    "sand.zeta=0": "sand.zeta = 0",
    "accuracy.plates=1": "accuracy.plates = 1: must be a whole number",
    "study.confirm=fien": "must be one of draft, standard, fine",
    "report=some": "report = 'some': must be one of none, light, full",
    "study=simulate foot.k=[1,2,3]": "must be 11 whole numbers (foot.n) from 1 to 10",
    "study=validate study.cases=[Wheel]": "must be one of wheel",
    "solver=ga objective=pareto": "solver = 'ga'",
    "gait=file": "gait.path = None",
    "gait=file gait.path=nowhere.mot": "gait.path = 'nowhere.mot'",
    "gait=file gait.path=broken.csv": "no column for the knee; the file has time, hip.",
    "study=simulate foot=outline": "foot.path = None: must be a drawing",
    "foot=outline foot.path=sole.dxf": "foot = 'outline': must be waypoints for a search",
    "study=export": "run = None: must be the folder of a run",
    "hydra.run.dir=broken.csv": "broken.csv",
    "constraint.own={colour:9}": "constraint = 'colour': must be one of distance",
    "choose=limits objective=pareto": "must be given with choose=limits",
    # settings that nothing reads
    "study=simulate foot.length=.18": "It is read by foot=ellipse, ",
    "study=simulate foot.path=sole.dxf": "foot.path = 'sole.dxf': must be left out",
    "study.draws=3": "study=optimize does not read it. It is read by study=robust.",
    "study=simulate solver.n_gen=3": "It is read by study=optimize, paper, robust",
    "gait.names.knee=K": "gait.names.knee = 'K': must be left out",
    "engine.timeout=3": "It is read by engine=dask.",
    "study=robust sand=soft": "It is read by study.scenarios=drawn, laws.",
    "study=doctor planet=moon": "walker.g = 1.62: must be left out",
    "study=simulate constraint.work=9": "constraint = {'work': 9.0}",
    "choose=knee": "choose.name = 'knee': must be left out",
}


@pytest.mark.parametrize("arguments", WRONG)
def test_wrong_input_gets_one_clear_message_and_leaves_nothing(arguments, tmp_path):
    (tmp_path / "broken.csv").write_text("time,hip\n0,1\n")
    done = footopt(*arguments.split(" "), cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr.startswith("footopt: error: ")
    assert done.stderr.count("\n") == 1
    assert WRONG[arguments] in done.stderr
    assert "unexpected" not in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["broken.csv"]


REFUSED = ["study=simulate", "foot.width=-1"]


@pytest.mark.parametrize("place", ["results", "..", ".", "results/deep"])
def test_a_refused_run_removes_no_folder_that_was_there(place, tmp_path):
    """Not even one with nothing in it but folders and links."""
    here = tmp_path / "above" / "here"
    for folder in ("results/empty", "results/deep", "linked"):
        (here / folder).mkdir(parents=True)
    (here / "results" / "link").symlink_to(here / "linked")
    before = sorted(tmp_path.rglob("*"))
    assert "foot.width" in footopt(*REFUSED, f"hydra.run.dir={place}", cwd=here).stderr
    assert sorted(tmp_path.rglob("*")) == before


def test_a_refused_run_leaves_no_file_and_no_folder_that_was_not_asked_for(tmp_path):
    assert footopt(*REFUSED, cwd=tmp_path).returncode == 1
    assert not list(tmp_path.iterdir())
    assert footopt(*REFUSED, "hydra.run.dir=a/b/c", cwd=tmp_path).returncode == 1
    assert not list((tmp_path / "a" / "b" / "c").iterdir())


def test_a_process_ends_with_the_message_and_its_exit_code(tmp_path):
    done = program("sand.zeta=0", cwd=tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (1, 1)
    assert done.stderr.startswith("footopt: error: sand.zeta = 0")


def test_a_flag_between_settings_is_named(tmp_path):
    done = footopt("study=simulate", "--config-dir", "mine", "sand=soft", cwd=tmp_path)
    assert done.returncode == 2  # of argparse
    assert "unrecognized arguments: sand=soft" in done.stderr


def test_a_setting_may_refer_to_another(tmp_path):
    words = ["study=simulate", "accuracy=draft", "report=none", "foot.L=0.12", "walker.l2=${foot.L}"]
    done = footopt(*words, "walker.l1=${walker.l2}", "hydra.run.dir=run", cwd=tmp_path)
    assert done.returncode in (0, 1)  # such legs may not walk
    assert json.loads((tmp_path / "run/result.json").read_text())["settings"]["walker"]["l1"] == 0.12


def test_files_in_one_s_own_folder_and_runs_are_named_shortly(monkeypatch):
    monkeypatch.setenv("HOME", "/at/home")
    for word, value in {
        "gait.path=~/a.mot": "/at/home/a.mot",
        "study.runs=[a,~/b]": ["a", "/at/home/b"],
        "run=outputs/optimize/2026-01-31_12-00-00-000000": "outputs/optimize/2026-01-31_12-00-00-000000",
    }.items():
        assert OverridesParser.create().parse_override(*hydra_overrides([word])).value() == value


@pytest.mark.slow
def test_a_run_goes_on_though_nobody_reads_any_more(tmp_path):
    words = ["study=simulate", "accuracy=draft", "report=none", "hydra.run.dir=run"]
    run = started(*words, cwd=tmp_path)
    run.stdout.close()
    with run.stderr:
        assert run.stderr.read() == ""
    assert run.wait(300) == 0
    assert (tmp_path / "run" / "result.json").is_file()


def test_errors_of_the_system_are_no_bug():
    assert explain(PermissionError(13, "Permission denied", "run")) == "Permission denied: run"
    assert explain(TimeoutError()) == "TimeoutError"
    assert explain(MemoryError()) == "MemoryError"
