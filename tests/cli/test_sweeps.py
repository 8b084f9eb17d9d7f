"""Sweeps: what jobs return to Hydra, what is made of all of them, and how a stopped one is finished."""

import csv
import json
import shutil

import pytest
import yaml
from hydra import compose, initialize_config_dir
from hydra.experimental.callback import Callback
from running import footopt

import footopt as fo
from footopt.cli import main as cli_run
from footopt.cli.compose import CONF, register
from footopt.files import identity

#: A walk with one foot, of which only the numbers are kept.
WALK = ["study=simulate", "accuracy=draft", "report=none"]


def read(path):
    """The rows of a table, without what took how long."""
    with open(path, newline="") as file:
        return [{k: v for k, v in row.items() if "time" not in k} for row in csv.DictReader(file)]


def result_of(folder):
    """What a job has found, without how long it took."""
    result = json.loads((folder / "result.json").read_text())
    return {name: value for name, value in result.items() if not name.endswith("time_s")}


class Listener(Callback):
    """Remembers what every job has returned."""

    heard: list = []  # noqa: RUF012

    def on_job_end(self, config, job_return, **kwargs):
        self.heard.append(job_return.return_value)


def listening(*arguments, cwd):
    """What a callback of one's own hears of the jobs of a command."""
    Listener.heard.clear()
    done = footopt(*arguments, "+hydra.callbacks.mine._target_=test_sweeps.Listener", cwd=cwd)
    return done, list(Listener.heard)


@pytest.fixture(scope="module")
def failing(tmp_path_factory):
    """A sweep of three jobs, one of which walks: what came of it, what callbacks heard, and its folder."""
    cwd = tmp_path_factory.mktemp("failing")
    words = ["sand.zeta=-1,0.001,5", "objective.names=[work]"]
    places = ["hydra.sweep.dir=sweep", "hydra.sweep.subdir=${foot.width}_on_${sand.zeta}"]
    done, heard = listening("-m", *WALK, *words, *places, cwd=cwd)
    assert done.returncode == 1
    return done, heard, cwd / "sweep"


@pytest.mark.slow
class TestJobs:
    def test_return_their_objectives_with_natural_signs(self, tmp_path):
        done, heard = listening(*WALK, "objective.names=[distance,work]", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        walk = fo.simulate(fo.Foot.flat(), fo.Scene(), "draft").objectives
        assert heard == [(walk["distance"], walk["work"])]

    def test_return_the_worst_where_they_failed_so_that_a_sweeper_goes_on(self, failing):
        heard = failing[1]
        assert heard[:2] == [1e6] * 2
        assert heard[2] < 1e6

    def test_have_their_settings_and_why_they_failed_in_a_table(self, failing):
        done, _, sweep = failing
        rows = {row["run"]: row for row in read(sweep / "summary.csv")}
        zetas = {f"0.1_on_{zeta}": str(float(zeta)) for zeta in (-1, 0.001, 5)}
        assert {name: row["sand.zeta"] for name, row in rows.items()} == zetas
        assert "sand.zeta = -1" in rows["0.1_on_-1"]["note"]
        assert [rows[f"0.1_on_{zeta}"]["note"] for zeta in (0.001, 5)] == ["sunk", ""]
        assert (sweep / "report.html").is_file()
        assert "2 of the jobs failed" in done.stderr  # one that is refused, and a walk that sinks


@pytest.mark.parametrize(
    "launcher", ["joblib", pytest.param("submitit_local", marks=pytest.mark.slow), "submitit_slurm"]
)
def test_launchers_compose(launcher):
    pytest.importorskip(f"hydra_plugins.hydra_{launcher.partition('_')[0]}_launcher", reason="an extra")
    register()
    with initialize_config_dir(str(CONF), version_base="1.3"):
        found = compose("config", [f"hydra/launcher={launcher}"], return_hydra_config=True)
    assert launcher.partition("_")[0] in found.hydra.launcher._target_


def test_a_number_in_place_of_a_name_is_refused_as_in_a_single_run(tmp_path):
    done = footopt("-m", *WALK, "sand=soft,0.01", cwd=tmp_path)
    assert done.returncode == 1
    assert "sand.zeta=0.01" in done.stderr
    assert "Warning" not in done.stderr


@pytest.mark.slow
def test_a_sweep_over_seeds_has_a_row_each_and_one_picture_of_all_fronts(tmp_path):
    words = ["accuracy=draft", "report=none", "foot.n=5", "solver.pop_size=8", "solver.n_gen=2"]
    words += ["objective.names=[distance,work]", "solver.name=nsga2,smsemoa", "solver.seed=1,2,3"]
    done = footopt("-m", *words, "hydra.sweep.dir=sweep", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rows = read(tmp_path / "sweep" / "summary.csv")
    assert "sand.zeta" not in rows[0]  # it does not differ
    for row in rows:
        result = result_of(tmp_path / "sweep" / row["run"])
        assert float(row["work"]) == result["objectives"]["work"]
        assert 0 <= float(row["hypervolume_share"]) <= 1
    assert (tmp_path / "sweep" / "figures" / "fronts.png").exists()


@pytest.mark.slow
def test_a_sweep_that_was_stopped_is_finished_by_one_command(tmp_path):
    """What it has walked is not walked again, and a job that failed is tried again."""
    sweep = ["-m", *WALK, "sand.zeta=0.2,0.5,1.0", "hydra.sweep.dir=sweep"]
    assert footopt(*sweep[:-1], "hydra.sweep.dir=whole", cwd=tmp_path).returncode == 0
    run, count = cli_run.run_study, 0

    def stop(*of):
        nonlocal count
        count += 1
        if count == 2:
            raise KeyboardInterrupt
        return run(*of)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("footopt.cli.main.run_study", stop)
        assert footopt(*sweep, cwd=tmp_path).returncode == 130
    stopped, whole = tmp_path / "sweep", tmp_path / "whole"
    assert len(list(stopped.glob(f"*/{identity.FILE}"))) == 3
    spoilt = shutil.copytree(stopped, tmp_path / "spoilt")
    before = {path: path.stat().st_mtime_ns for path in stopped.rglob("0/*")}
    assert footopt(*sweep, "scene=brisk", cwd=tmp_path).returncode == 1  # another one takes no folder of it
    assert footopt("resume=sweep", "sand=soft", cwd=tmp_path).returncode == 1
    done = footopt("resume=sweep", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert {path: path.stat().st_mtime_ns for path in before} == before
    assert [result_of(stopped / job) for job in "012"] == [result_of(whole / job) for job in "012"]
    assert read(stopped / "summary.csv") == read(whole / "summary.csv")
    settings, words, _ = identity.read(spoilt / "2")
    settings["foot"]["width"] = -1.0
    identity.write(spoilt / "2", settings, words)
    assert footopt("resume=spoilt", cwd=tmp_path).returncode == 1
    assert "foot.width = -1.0" in (spoilt / "2" / "error.txt").read_text()


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::FutureWarning")
def test_optuna_finds_the_widest_foot_to_go_farthest(tmp_path):
    """Hydra's own sweeper of settings, as it is."""
    pytest.importorskip("hydra_plugins.hydra_optuna_sweeper", reason="needs footopt[optuna]")
    sweeper = ["hydra/sweeper=optuna", "hydra.sweeper.n_trials=6", "hydra.sweeper.n_jobs=1",
               "hydra.sweeper.sampler.seed=1", "hydra.sweeper.direction=maximize"]  # fmt: skip
    words = ["foot.width=interval(0.05,0.15)", "objective.names=[distance]", "sand=soft"]
    done = footopt("-m", *sweeper, *WALK, *words, "hydra.sweep.dir=sweep", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = yaml.safe_load((tmp_path / "sweep" / "optimization_results.yaml").read_text())
    jobs = [result_of(path.parent) for path in (tmp_path / "sweep").glob("*/result.json")]
    values = {job["settings"]["foot"]["width"]: job["objectives"]["distance"] for job in jobs}
    assert len(values) == 6
    assert found["best_value"] == max(values.values())
    assert found["best_params"]["foot.width"] == max(values, key=values.get)
