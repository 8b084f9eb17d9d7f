"""The command line end to end, as a user runs it, in an empty folder."""

import json
import os
from importlib.util import find_spec

import pytest
from running import QUICK, footopt, only_folder, program

import footopt as fo
from footopt.studies.load import foot_of

STEP = ["step"] if find_spec("OCP") else []  # needs footopt[cad]


@pytest.fixture(scope="module")
def run_ga(tmp_path_factory):
    cwd = tmp_path_factory.mktemp("ga")
    done = footopt(*QUICK, cwd=cwd)
    assert done.returncode == 0, done.stderr
    return done, only_folder(cwd)


class TestOptimize:
    def test_leaves_everything_a_user_needs(self, run_ga):
        _, folder = run_ga
        files = {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}
        figures = ("contour", "convergence", "com", "forces", "power_work", "step")
        assert files >= {
            *("footopt.yaml", "result.json", "designs.csv", "walk.nc", "report.html"),
            *(f"contour.{end}" for end in ("csv", "dxf", "svg", "stl", *STEP)),
            *(f"figures/{name}.png" for name in figures),
        }
        assert folder.parts[-3:-1] == ("outputs", "optimize")

    def test_result_json_is_what_the_library_computes(self, run_ga):
        result = json.loads((run_ga[1] / "result.json").read_text())
        scene = fo.Scene(sand=fo.Sand.named("hard"))
        foot = fo.Foot.from_waypoints(result["design"]["k"])
        walk = fo.simulate(foot, scene, "standard")  # the finalists are confirmed at this accuracy
        assert result["objectives"] == {n: walk.objectives[n] for n in result["objectives"]}
        assert result["flat"]["work"] == fo.simulate(fo.Foot.flat(), scene, "standard").objectives["work"]
        errors = fo.estimate_error(foot, scene, "standard")
        assert result["error_estimate"] == {n: errors[n] for n in result["objectives"]}
        assert all(errors[n] < 1e-2 * abs(result["objectives"][n]) for n in result["objectives"])
        assert result["seed"] == 1
        assert sum(result["gain_shares"].values()) == pytest.approx(1)
        assert {"footopt", "numpy", "numba", "llvmlite", "moocore", "python"} <= set(result["versions"])
        assert set(result["machine"]) == {"system", "processor", "features"}
        assert "report.html" in result["wall_time_covers"]
        assert result["settings"]["sand"]["zeta"] == 5.0

    def test_the_best_is_the_best_of_the_confirmed_finalists(self, run_ga):
        result = json.loads((run_ga[1] / "result.json").read_text())
        confirmed = result["confirmed"]
        j = [row[confirmed["columns"].index("efficiency")] for row in confirmed["values"]]
        assert j == sorted(j)
        assert confirmed["k"][0] == result["design"]["k"]
        assert 1 < len(j) <= 20
        assert 0 < confirmed["largest_change"] < 0.1


@pytest.mark.slow
def test_the_foot_of_a_run_walks_in_its_world_but_for_what_is_given(tmp_path):
    world = ("walker.mass=40", "gait.period=1.3", "accuracy=draft", "sand=regular", "foot.width=0.08")
    words = [*world, "solver.pop_size=4", "solver.n_gen=2", "study.confirm=standard"]
    done = footopt(*words, "hydra.run.dir=run", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    words = ["study=simulate", "run=run", "report=none", "sand=hard", "walker.g=3", "hydra.run.dir=again"]
    done = footopt(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    result = json.loads((tmp_path / "again" / "result.json").read_text())
    scene = fo.Scene(
        sand=fo.Sand.named("hard"), gait=fo.Gait.human(period=1.3), walker=fo.Walker(mass=40.0, g=3.0)
    )
    walk = fo.simulate(foot_of(tmp_path / "run"), scene, "standard")
    assert result["objectives"]["work"] == walk.objectives["work"]
    assert result["design"]["width_m"] == 0.08


def test_where_all_soles_are_walked_with_it_is_said_what_the_answer_is_worth_and_not_to_search_on(tmp_path):
    words = ["foot.n=4", "foot.K=1", "accuracy=draft", "study.confirm=null"]  # no sole but the flat one
    done = footopt(*words, "hydra.run.dir=one", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    (remark,) = json.loads((tmp_path / "one" / "result.json").read_text())["remarks"]
    assert "flat sole is as good" in remark
    assert not (tmp_path / "one" / "figures" / "convergence.png").exists()  # of one generation


def test_a_walk_that_sinks_is_a_result_with_a_reason(tmp_path):
    done = footopt("study=simulate", "sand.zeta=0.001", "accuracy=draft", "report=light", cwd=tmp_path)
    assert done.returncode == 1
    assert "footopt: error: the walk failed: sunk. " in done.stderr
    result = json.loads((only_folder(tmp_path) / "result.json").read_text())
    assert (result["feasible"], result["reason"]) == (False, "sunk")
    assert result["objectives"]["peak_power"] is None


def test_output_goes_to_a_pipe_and_a_drive_that_cannot_take_its_names(tmp_path, monkeypatch):
    folder = tmp_path / "Łódź (1)"
    folder.mkdir()
    monkeypatch.setenv("PYTHONIOENCODING", "ascii")
    first = program("study=simulate", "report=none", "hydra.run.dir=first", cwd=folder)
    assert (first.returncode, (folder / "first/result.json").is_file()) == (0, True)
    again = program("study=simulate", f"run={folder / 'first'}", "hydra.run.dir=again", cwd=folder)
    assert again.returncode == 0

    def apart(path, start):
        raise ValueError("path is on mount 'D:', start on mount 'C:'")

    monkeypatch.setattr(os.path, "relpath", apart)
    assert footopt("study=simulate", f"hydra.run.dir={tmp_path / 'run'}", cwd=tmp_path).returncode == 0
    assert (tmp_path / "run/report.html").is_file()
