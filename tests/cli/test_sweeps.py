"""Sweeps: what jobs return to Hydra's sweepers and callbacks, and what is made of all of them."""

import json

import pytest
import yaml
from hydra.experimental.callback import Callback
from running import footopt

import footopt as fo

#: A walk with one foot, of which only the numbers are kept.
WALK = ["study=simulate", "accuracy=draft", "report=none"]


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

    def test_the_worst_where_it_failed_so_that_a_sweeper_goes_on(self, tmp_path):
        words = ["sand.zeta=0.001,5", "objective.names=[work]"]
        done, heard = listening("-m", *WALK, *words, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert heard[0] == 1e6 > heard[1]
        done, heard = listening("-m", *WALK, "foot.width=-1,0.1", "objective.names=[work]", cwd=tmp_path)
        assert done.returncode == 1
        assert heard[0] == 1e6 > heard[1]


class TestReport:
    """How much a job leaves."""

    TINY = ("accuracy=draft", "solver.pop_size=4", "solver.n_gen=2")

    @pytest.mark.parametrize("study", ["optimize", "simulate"])
    def test_none_leaves_the_numbers_and_what_a_run_is_resumed_from(self, study, tmp_path):
        """They are those of a full report, in less than 100 kB."""
        for report in ("none", "light", "full"):
            words = (f"study={study}", f"report={report}", f"hydra.run.dir={report}")
            done = footopt(*self.TINY, *words, cwd=tmp_path)
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
