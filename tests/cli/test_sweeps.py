"""Sweeps: what jobs return to Hydra's sweepers and callbacks, and what is made of all of them."""

import csv
import json
import os
import sys

import numpy as np
import pytest
import yaml
from hydra.experimental.callback import Callback
from running import footopt

import footopt as fo
from footopt.cli.trackers import MLflow
from footopt.errors import SettingError
from footopt.report.runs import read_run
from footopt.report.sweeps import fronts

JOBS = int(os.environ.get("FOOTOPT_JOBS", 24))

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

    @pytest.mark.slow
    def test_the_worst_where_it_failed_so_that_a_sweeper_goes_on(self, tmp_path):
        words = ["sand.zeta=0.001,5", "objective.names=[work]"]
        done, heard = listening("-m", *WALK, *words, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert heard[0] == 1e6 > heard[1]
        done, heard = listening("-m", *WALK, "foot.width=-1,0.1", "objective.names=[work]", cwd=tmp_path)
        assert done.returncode == 1
        assert heard[0] == 1e6 > heard[1]


class TestTracker:
    """Who keeps runs elsewhere hears of every job."""

    def test_a_line_of_json_is_written_for_each_job_the_failed_ones_too(self, tmp_path):
        words = ["foot.width=-1,0.1", "hydra/callbacks=jsonl", "hydra.sweep.dir=sweep"]
        footopt("-m", *WALK, *words, cwd=tmp_path)
        failed, good = map(json.loads, (tmp_path / "runs.jsonl").read_text().splitlines())
        assert failed["objectives"] == {}
        assert "foot.width = -1.0: must be" in failed["note"]
        assert good["settings"]["foot.width"] == 0.1
        assert good["objectives"] == json.loads((tmp_path / "sweep/1/result.json").read_text())["objectives"]

    def test_a_tracker_that_is_not_installed_is_named(self, tmp_path, monkeypatch):
        monkeypatch.setitem(sys.modules, "mlflow.tracking", None)
        with pytest.raises(SettingError, match=r"pip install 'footopt\[mlflow\]'"):
            MLflow()

    @pytest.mark.slow
    def test_mlflow_has_a_run_for_each_job(self, tmp_path, monkeypatch):
        tracking = pytest.importorskip("mlflow.tracking")
        monkeypatch.setenv("MLFLOW_ALLOW_FILE_STORE", "true")
        store = f"file://{tmp_path}/kept"
        words = ["foot.width=-1,0.1", "hydra/callbacks=mlflow", f"hydra.callbacks.mlflow.uri={store}"]
        footopt("-m", *WALK, *words, "hydra.sweep.dir=sweep", cwd=tmp_path)
        client = tracking.MlflowClient(store)
        found = client.search_runs([client.get_experiment_by_name("footopt").experiment_id])
        good, failed = sorted((run for run in found), key=lambda run: run.info.run_name, reverse=True)
        assert (good.info.status, failed.info.status) == ("FINISHED", "FAILED")
        assert "foot.width = -1.0: must be" in failed.data.tags["note"]
        assert good.data.params["foot.width"] == "0.1"
        kept = json.loads((tmp_path / "sweep/1/result.json").read_text())["objectives"]
        assert good.data.metrics == {name: value for name, value in kept.items() if value is not None}


class TestReport:
    """How much a job leaves."""

    @pytest.mark.parametrize(
        ("study", "tiny"),
        [
            ("optimize", ("accuracy=draft", "solver.pop_size=4", "solver.n_gen=2")),
            ("simulate", ("accuracy=draft",)),
        ],
    )
    def test_none_leaves_the_numbers_and_what_a_run_is_resumed_from(self, study, tiny, tmp_path):
        """They are those of a full report, in less than 100 kB."""
        for report in ("none", "light", "full"):
            words = (f"study={study}", f"report={report}", f"hydra.run.dir={report}")
            done = footopt(*tiny, *words, cwd=tmp_path)
            assert done.returncode == 0, done.stderr
        left = {report: {p.name: p.stat().st_size for p in (tmp_path / report).rglob("*") if p.is_file()}
                for report in ("none", "light", "full")}  # fmt: skip
        assert sum(left["none"].values()) < 1e5
        assert {"result.json", "contour.csv"} <= set(left["none"])
        assert not {"report.html", "walk.nc", "contour.stl", "designs.csv"} & set(left["none"])
        assert ("designs.sqlite" in left["none"]) == (study == "optimize")
        assert {"report.html", "walk.nc", "contour.stl"} <= set(left["light"])
        assert not any(name.endswith((".png", ".pdf")) for name in left["light"])
        assert "step.png" in left["full"]
        found = [json.loads((tmp_path / report / "result.json").read_text()) for report in left]
        for name in ("design", "objectives", "error_estimate", "validity"):
            assert found[0][name] == found[1][name] == found[2][name]

    def test_any_other_word_is_refused(self, tmp_path):
        done = footopt(*WALK[:2], "report=some", cwd=tmp_path)
        assert done.returncode == 1
        assert "report = 'some': must be one of none, light, full" in done.stderr

    def test_a_sweep_has_its_table_and_page_without_them(self, tmp_path):
        done = footopt("-m", *WALK, "sand=soft,hard", "hydra.sweep.dir=sweep", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert (tmp_path / "sweep" / "report.html").is_file()
        assert len((tmp_path / "sweep" / "summary.csv").read_text().splitlines()) == 3


class TestSummary:
    """Many runs in one table: a column for each setting that differs, seeds summarised, fronts compared."""

    TINY = ("accuracy=draft", "report=none", "foot.n=5", "solver.pop_size=8", "solver.n_gen=2")

    @pytest.fixture(scope="class")
    @staticmethod
    def sweep(tmp_path_factory):
        """Two solvers with three seeds each, and the rows of their summary."""
        folder = tmp_path_factory.mktemp("fronts")
        words = ["objective.names=[distance,work]", "solver.name=nsga2,agemoea2", "solver.seed=1,2,3"]
        done = footopt("-m", *TestSummary.TINY, *words, "hydra.sweep.dir=sweep", cwd=folder)
        assert done.returncode == 0, done.stderr
        return done, folder / "sweep"

    def test_each_setting_that_differs_has_a_column_and_no_other(self, sweep):
        rows = read(sweep[1] / "summary.csv")
        assert [(row["solver.name"], row["solver.seed"]) for row in rows] == [
            (name, str(seed)) for name in ("nsga2", "agemoea2") for seed in (1, 2, 3)
        ]
        assert "sand.zeta" not in rows[0]
        for row in rows:
            result = json.loads((sweep[1] / row["job"] / "result.json").read_text())
            assert float(row["work"]) == result["objectives"]["work"]
            assert float(row["seconds"]) == result["wall_time_s"]
            assert int(float(row["warnings"])) == len(result["warnings"])
            assert int(float(row["front"])) == len(result["front"])
            assert 0 <= float(row["hypervolume_share"]) <= 1

    def test_seeds_are_summarised_by_median_and_quartiles(self, sweep):
        rows, groups = read(sweep[1] / "summary.csv"), read(sweep[1] / "seeds.csv")
        assert [(g["solver.name"], g["seeds"]) for g in groups] == [("nsga2", "3"), ("agemoea2", "3")]
        for group in groups:
            own = sorted(float(r["work"]) for r in rows if r["solver.name"] == group["solver.name"])
            assert float(group["work_median"]) == own[1]
            assert own[0] <= float(group["work_q1"]) <= own[1] <= float(group["work_q3"]) <= own[2]
        assert "Median over seeds" in sweep[0].stdout

    def test_fronts_are_drawn_over_each_other_with_what_half_of_the_seeds_attain(self, sweep):
        """A point of the median front is reached or beaten by two of three runs, and by no more beyond it."""
        jobs = [read_run(sweep[1] / str(i), f"job {i}", str(i)) for i in range(6)]
        (found,) = fronts(jobs)
        assert found.labels == ["nsga2"] * 3 + ["agemoea2"] * 3
        points = found.median_attainment("nsga2") * found.sign
        reached = [[(v * found.sign <= p).all(axis=1).any() for v in found.values[:3]] for p in points]
        assert all(sum(row) >= 2 for row in reached)
        merged = np.concatenate(found.values) * found.sign
        low, span = merged.min(axis=0), np.ptp(merged, axis=0)
        assert (merged >= low).all()
        assert (span > 0).all()
        assert (sweep[1] / "figures" / "fronts.png").exists()

    def test_one_seed_each_is_no_spread(self, tmp_path):
        done = footopt("-m", *WALK, "sand=soft,hard", "hydra.sweep.dir=sweep", cwd=tmp_path)
        assert "Median over seeds" not in done.stdout
        assert not (tmp_path / "sweep" / "seeds.csv").exists()
        assert [row["sand.zeta"] for row in read(tmp_path / "sweep" / "summary.csv")] == ["0.2", "5"]

    def test_folders_may_have_any_name(self, tmp_path):
        words = [*WALK, "sand=soft,hard", "hydra.sweep.dir=m"]
        done = footopt("-m", *words, "hydra.sweep.subdir=on_${sand.name}", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert {row["job"] for row in read(tmp_path / "m" / "summary.csv")} == {"on_soft", "on_hard"}

    def test_a_job_that_failed_has_its_settings_and_its_reason(self, tmp_path):
        footopt("-m", *WALK, "foot.width=-1,0.1", "hydra.sweep.dir=sweep", cwd=tmp_path)
        rows = read(tmp_path / "sweep" / "summary.csv")
        assert [row["foot.width"] for row in rows] == ["-1", "0.1"]
        assert "foot.width = -1" in rows[0]["note"]

    @pytest.mark.slow
    @pytest.mark.timeout(3000)
    def test_many_jobs_by_joblib_in_one_call(self, tmp_path):
        """FOOTOPT_JOBS=200 tries two hundred."""
        pytest.importorskip("hydra_plugins.hydra_joblib_launcher", reason="needs footopt[joblib]")
        words = [
            "hydra/launcher=joblib",
            "hydra.launcher.n_jobs=2",
            f"solver.seed=range(1,{JOBS // 2 + 1})",
            "sand=soft,hard",
        ]
        done = footopt("-m", *self.TINY, *words, "hydra.sweep.dir=sweep", "engine.threads=1", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert (f"... and {JOBS - 60} more" in done.stdout) == (JOBS > 60)
        rows = read(tmp_path / "sweep" / "summary.csv")
        assert len(rows) == JOBS
        assert len({(row["sand.zeta"], row["solver.seed"]) for row in rows}) == JOBS
        assert [group["seeds"] for group in read(tmp_path / "sweep" / "seeds.csv")] == [str(JOBS // 2)] * 2


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
