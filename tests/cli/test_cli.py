"""The command line end to end, as a user runs it, in an empty folder."""

import csv
import json
from importlib.util import find_spec

import numpy as np
import pytest
from running import QUICK, footopt, only_folder
from study_pages import check_page

import footopt as fo
from footopt.studies.runs import foot_of
from footopt.walk import STEPPERS
from footopt.walk.accuracy import TOLERANCES

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

    def test_the_foot_to_print_is_there_in_every_form_and_loses_no_more_than_the_best(self, run_ga):
        _, folder = run_ga
        found = json.loads((folder / "result.json").read_text())["to_print"]
        assert found["worst_loss"] <= found["worst_loss_of_best"]
        contour = np.loadtxt(folder / "to_print.csv", delimiter=",", skiprows=1)
        np.testing.assert_allclose(contour, 1e3 * fo.Foot.from_waypoints(found["k"]).contour, atol=1e-6)
        assert {path.suffix for path in folder.glob("to_print.*")} >= {".csv", ".dxf", ".svg", ".stl"}

    def test_the_answer_has_14_lines_that_fit_a_terminal_with_its_range_and_what_to_open(self, run_ga):
        said, entry = run_ga[0].stdout.splitlines(), json.loads((run_ga[1] / "result.json").read_text())
        (first,) = (i for i, line in enumerate(said) if line.startswith("Best foot"))
        caution = next(line for line in said if "Only" in line)  # a search of more designs has none
        answer = [line.rstrip() for line in said[first:] if line != caution]
        assert len(answer) <= 14
        assert all(len(line) <= 80 for line in answer[2:-1])
        gains = [1.0 + law["change"]["efficiency"] for law in entry["laws"]]
        assert f"x {gains[0]:.2f} " in answer[1]
        assert f"x {min(gains[1:]):.2f} to {max(gains[1:]):.2f} by 5 other" in answer[1]
        for name in ("report.html", "to_print.stl"):
            assert name in answer[-1]
            assert (run_ga[1] / name).is_file()


def test_any_measure_is_an_objective_and_is_told_once(tmp_path):
    done = footopt(*QUICK, "objective=work", "report=none", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert [line.split()[-4:] for line in done.stdout.splitlines() if line.startswith("work ")] == [
        ["against", "a", "flat", "foot."]
    ]


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


@pytest.mark.slow
def test_errors_of_every_stepper_and_preset_are_measured(tmp_path):
    done = footopt(
        "study=accuracy", "study.feet=3", "sand=soft", "scene.t_f=2", "hydra.run.dir=run", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "run" / "accuracy.csv", newline="") as file:
        assert {row["stepper"] for row in csv.DictReader(file)} == set(STEPPERS)
    result = json.loads((tmp_path / "run" / "result.json").read_text())
    errors = {row["method"]: row["error"] for row in result["presets"]}
    assert all(errors[name] < tolerance for name, tolerance in TOLERANCES.items())
    assert errors["standard"] > errors["fine"]
    check_page(tmp_path / "run")


def test_a_walk_that_sinks_is_a_result_with_a_reason(tmp_path):
    done = footopt("study=simulate", "sand.zeta=0.001", "accuracy=draft", "report=light", cwd=tmp_path)
    assert done.returncode == 1
    assert "footopt: error: the walk failed: sunk. " in done.stderr
    result = json.loads((only_folder(tmp_path) / "result.json").read_text())
    assert (result["feasible"], result["reason"]) == (False, "sunk")
    assert result["objectives"]["peak_power"] is None
