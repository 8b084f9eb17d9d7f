"""What is asked of a search, and how plainly it answers."""

import json

import pytest
from running import footopt, only_folder

TINY = ["accuracy=draft", "study.confirm=null", "report=light", "solver.pop_size=4", "solver.n_gen=1"]


class TestTheAnswer:
    @pytest.mark.slow
    def test_a_best_design_that_is_worse_than_the_flat_sole_is_said_to_be(self, tmp_path):
        """No gain is made of a loss, and no share of one."""
        done = footopt(*TINY, "sand=hard", "solver=ga", cwd=tmp_path)
        result = json.loads((only_folder(tmp_path) / "result.json").read_text())
        assert result["objectives"]["efficiency"] > result["flat"]["efficiency"]
        best, flat = (result[of]["efficiency"] for of in ("objectives", "flat"))
        assert f"The flat sole is as good or better in efficiency J_W: {best:.3e}"[:-4] in done.stdout
        assert f"x {best / flat:.2f}" in done.stdout
        assert "share" not in done.stdout.partition("Validity")[0]
        assert set(result["gain_shares"].values()) == {None}


FRONT = ["accuracy=draft", "report=light", "solver=nsga2", "solver.pop_size=12", "solver.n_gen=3", "foot.n=7"]


@pytest.mark.slow  # finalists walk by other laws
class TestSeveralObjectives:
    @pytest.fixture(scope="class")
    @staticmethod
    def front(tmp_path_factory):
        """A front of three objectives, within limits."""
        folder = tmp_path_factory.mktemp("front")
        words = [
            "objective.names=[distance,work,hollow]",
            "constraint.peak_power=400",
            "constraint.thickness=1e-4",
        ]
        done = footopt(*FRONT, *words, cwd=folder)
        assert done.returncode == 0, done.stderr
        return done, json.loads((only_folder(folder) / "result.json").read_text())

    def test_are_answered_with_the_knee_and_not_by_j_w(self, front):
        done, result = front
        assert "Of the front the design nearest to the ideal point" in done.stdout
        assert "share of" not in done.stdout.partition("Validity")[0]
        assert result["choose"]["by"] == "knee"

    def test_the_front_is_there_with_its_values_the_chosen_design_first(self, front):
        _, result = front
        columns = result["front_columns"]
        assert result["front"][0] == result["design"]["k"]
        first = dict(zip(columns, result["front_values"][0], strict=True))
        assert {name: first[name] for name in result["objectives"]} == result["objectives"]
        assert len(result["front"]) == len(result["front_values"]) > 1
        assert result["hypervolume"] > 0

    def test_every_foot_of_it_keeps_the_limits(self, front):
        _, result = front
        values = [dict(zip(result["front_columns"], row, strict=True)) for row in result["front_values"]]
        assert all(v["peak_power"] <= 400 and v["thickness"] >= 1e-4 for v in values)
        assert result["constraints"] == {"peak_power": 400, "thickness": 1e-4}


class TestControl:
    @pytest.mark.slow
    def test_a_search_stops_where_it_is_told_to_and_goes_on_when_resumed(self, tmp_path):
        words = [*TINY[:2], "solver=ga", "foot.n=5", "solver.n_gen=50", "solver.pop_size=6"]
        words += ["report=none", "hydra.run.dir=run"]
        done = footopt(*words, "solver.seconds=1e-9", "solver.operators={crossover_eta: 10}", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert "(stopped after 1e-09 s)" in done.stdout
        first = json.loads((tmp_path / "run" / "result.json").read_text())
        assert first["designs"] <= 6
        assert first["solver"]["operators"] == {"crossover_eta": 10}
        done = footopt("resume=run", "solver.seconds=null", "solver.walks=30", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        again = json.loads((tmp_path / "run" / "result.json").read_text())
        assert again["designs"] == 30
        assert again["reused"] == first["designs"]
