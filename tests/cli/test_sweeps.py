"""Sweeps: what jobs return to Hydra's sweepers and callbacks, and what is made of all of them."""

import json

import pytest
import yaml
from hydra.experimental.callback import Callback
from running import footopt

import footopt as fo

#: A walk with one foot.
WALK = ["study=simulate", "accuracy=draft"]


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
