"""Sweeps: what jobs return to Hydra's sweepers and callbacks, and what is made of all of them."""

import csv
import json
import sys
from pathlib import Path
from unittest.mock import MagicMock

import pytest
import yaml
from hydra.experimental.callback import Callback
from running import footopt

import footopt as fo
from footopt.report.summary import fronts
from footopt.report.summary import read as read_run

#: A walk with one foot, of which only the numbers are kept.
WALK = ["study=simulate", "accuracy=draft", "report=none"]


def read(path):
    """The rows of a table."""
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


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


class TestAJobReturns:
    def test_its_objective_or_a_tuple_with_natural_signs(self, tmp_path):
        done, heard = listening(*WALK, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        walk = fo.simulate(fo.Foot.flat(), fo.Scene(), "draft").objectives
        assert heard == [walk["efficiency"]]
        _, heard = listening(*WALK, "objective.names=[distance,work]", cwd=tmp_path)
        assert heard == [(walk["distance"], walk["work"])]

    def test_the_worst_where_it_or_its_walk_failed_so_that_a_sweeper_goes_on(self, failing):
        heard = failing[1]
        assert heard[:3] == [1e6] * 3
        assert heard[3] < 1e6


@pytest.fixture(scope="module")
def failing(tmp_path_factory):
    """A sweep of four jobs, of which one walks: what came of it, what its callbacks heard, and its folder."""
    cwd = tmp_path_factory.mktemp("failing")
    words = ["foot.width=-1,0.1", "sand.zeta=0.001,5", "objective.names=[work]"]
    places = ["hydra.sweep.dir=sweep", "hydra.sweep.subdir=on_${foot.width}_${sand.zeta}"]
    done, heard = listening("-m", *WALK, *words, *places, cwd=cwd)
    assert done.returncode == 1
    return done, heard, cwd / "sweep"


@pytest.mark.slow
def test_the_example_of_a_callback_makes_each_job_a_run_of_mlflow(tmp_path, monkeypatch):
    """With a module in MLflow's place that writes down how it is called."""
    fake = MagicMock()
    monkeypatch.setitem(sys.modules, "mlflow", fake)
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "examples")
    words = ["foot.width=-1,0.1", "+hydra.callbacks.mine._target_=mlflow_callback.MLflow"]
    footopt("-m", *WALK, *words, "hydra.sweep.dir=sweep", cwd=tmp_path)
    assert [call.kwargs["run_name"] for call in fake.start_run.call_args_list] == ["0", "1"]
    fake.end_run.assert_called_once_with("FAILED")
    logged = [call.args[0] for call in fake.log_params.call_args_list]
    assert [given["foot.width"] for given in logged if "foot.width" in given] == [-1, 0.1]
    kept = json.loads((tmp_path / "sweep/1/result.json").read_text())["objectives"]
    assert fake.log_metrics.call_args.args[0] == {n: v for n, v in kept.items() if v is not None}


class TestReport:
    """How much a job leaves."""

    @pytest.mark.parametrize(
        ("study", "more", "tiny"),
        [("optimize", "full", ("solver.pop_size=4", "solver.n_gen=2")), ("simulate", "light", ())],
    )
    def test_none_leaves_the_numbers_and_what_a_run_is_resumed_from(self, study, more, tiny, tmp_path):
        """They are those of a longer report, in less than 100 kB."""
        left, found = {}, {}
        for report in ("none", more):
            words = (f"study={study}", "accuracy=draft", f"report={report}", f"hydra.run.dir={report}")
            done = footopt(*tiny, *words, cwd=tmp_path)
            assert done.returncode == 0, done.stderr
            left[report] = {p.name: p.stat().st_size for p in (tmp_path / report).rglob("*") if p.is_file()}
            found[report] = json.loads((tmp_path / report / "result.json").read_text())
        assert sum(left["none"].values()) < 1e5
        assert {"result.json", "contour.csv"} <= set(left["none"])
        assert not {"report.html", "walk.nc", "contour.stl", "designs.csv"} & set(left["none"])
        assert ("designs.sqlite" in left["none"]) == (study == "optimize")
        assert {"report.html", "walk.nc", "contour.stl"} <= set(left[more])
        assert ("step.png" in left[more]) == any(".png" in name for name in left[more]) == (more == "full")
        for name in ("design", "objectives", "error_estimate", "validity"):
            assert found["none"][name] == found[more][name]


@pytest.mark.slow
class TestSummary:
    """Many runs in one table: a column for each setting that differs, seeds summarised, fronts compared."""

    TINY = ("accuracy=draft", "report=none", "foot.n=5", "solver.pop_size=8", "solver.n_gen=2")

    @pytest.fixture(scope="class")
    @staticmethod
    def sweep(tmp_path_factory):
        """Two solvers with three seeds each, and the rows of their summary."""
        folder = tmp_path_factory.mktemp("fronts")
        words = ["objective.names=[distance,work]", "solver.name=nsga2,smsemoa", "solver.seed=1,2,3"]
        done = footopt("-m", *TestSummary.TINY, *words, "hydra.sweep.dir=sweep", cwd=folder)
        assert done.returncode == 0, done.stderr
        return done, folder / "sweep"

    def test_each_setting_that_differs_has_a_column_and_no_other(self, sweep):
        rows = read(sweep[1] / "summary.csv")
        assert [(row["solver.name"], row["solver.seed"]) for row in rows] == [
            (name, str(seed)) for name in ("nsga2", "smsemoa") for seed in (1, 2, 3)
        ]
        assert "sand.zeta" not in rows[0]
        for row in rows:
            result = json.loads((sweep[1] / row["run"] / "result.json").read_text())
            assert float(row["work"]) == result["objectives"]["work"]
            assert float(row["wall_time_s"]) == result["wall_time_s"]
            assert int(float(row["warnings"])) == len(result["warnings"])
            assert 0 <= float(row["hypervolume_share"]) <= 1

    def test_seeds_are_summarised_by_median_and_quartiles(self, sweep):
        rows, groups = read(sweep[1] / "summary.csv"), read(sweep[1] / "seeds.csv")
        assert [(g["solver.name"], g["seeds"]) for g in groups] == [("nsga2", "3"), ("smsemoa", "3")]
        for group in groups:
            own = sorted(float(r["work"]) for r in rows if r["solver.name"] == group["solver.name"])
            assert float(group["work_median"]) == own[1]
            assert own[0] <= float(group["work_q1"]) <= own[1] <= float(group["work_q3"]) <= own[2]
        assert "over seeds" in sweep[0].stdout

    def test_fronts_are_drawn_over_each_other(self, sweep):
        ((rows, shares, _),) = fronts([read_run(sweep[1] / str(i)) for i in range(6)])
        assert rows == list(range(6))
        assert 0 < min(shares) <= max(shares) <= 1
        assert (sweep[1] / "figures" / "fronts.png").exists()

    def test_every_job_has_its_settings_and_why_it_failed_wherever_its_folder_is(self, failing):
        done, _, sweep = failing
        rows = {row["run"]: row for row in read(sweep / "summary.csv")}
        assert list(rows["on_-1.0_5.0"]) == list(rows["on_0.1_5.0"])
        assert {name: (row["foot.width"], row["sand.zeta"]) for name, row in rows.items()} == {
            f"on_{width}_{zeta}": (str(width), str(zeta)) for width in (-1.0, 0.1) for zeta in (0.001, 5.0)
        }
        assert "foot.width = -1" in rows["on_-1.0_5.0"]["note"]
        assert rows["on_0.1_0.001"]["note"] == "sunk"
        assert not rows["on_0.1_5.0"]["note"]
        assert (sweep / "report.html").is_file()
        assert "3 of the jobs failed" in done.stderr  # two that are refused, and a walk that sinks

    def test_one_seed_each_is_no_spread(self, failing):
        assert "over seeds" not in failing[0].stdout
        assert not (failing[2] / "seeds.csv").exists()


@pytest.mark.slow
class TestOptuna:
    """Hydra's own sweeper of settings, as it is."""

    @pytest.fixture(autouse=True)
    def needs(self):
        pytest.importorskip("hydra_plugins.hydra_optuna_sweeper", reason="needs footopt[optuna]")

    @pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::FutureWarning")
    def test_finds_the_widest_foot_to_go_farthest(self, tmp_path):
        sweeper = ["hydra/sweeper=optuna", "hydra.sweeper.n_trials=6", "hydra.sweeper.n_jobs=1",
                   "hydra.sweeper.sampler.seed=1", "hydra.sweeper.direction=maximize"]  # fmt: skip
        words = ["foot.width=interval(0.05,0.15)", "objective.names=[distance]", "sand=soft"]
        done = footopt("-m", *sweeper, *WALK, *words, "hydra.sweep.dir=sweep", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        found = yaml.safe_load((tmp_path / "sweep" / "optimization_results.yaml").read_text())
        jobs = [json.loads(path.read_text()) for path in (tmp_path / "sweep").glob("*/result.json")]
        values = {job["settings"]["foot"]["width"]: job["objectives"]["distance"] for job in jobs}
        assert len(values) == 6
        assert found["best_value"] == max(values.values())
        assert found["best_params"]["foot.width"] == max(values, key=values.get)
