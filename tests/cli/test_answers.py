"""What is asked of a search, and how plainly it answers."""

import json

import pytest
from running import footopt, only_folder

TINY = ["accuracy=draft", "study.confirm=null", "report=light", "solver.pop_size=4", "solver.n_gen=1"]


@pytest.mark.slow
def test_a_best_design_that_is_worse_than_the_flat_sole_is_said_to_be(tmp_path):
    """No gain is made of a loss, and no share of one."""
    done = footopt(*TINY, "sand=hard", "solver=ga", cwd=tmp_path)
    result = json.loads((only_folder(tmp_path) / "result.json").read_text())
    assert result["objectives"]["efficiency"] > result["flat"]["efficiency"]
    best, flat = (result[of]["efficiency"] for of in ("objectives", "flat"))
    assert f"The flat sole is as good or better in efficiency J_W: {best:.3e}"[:-4] in done.stdout
    assert f"x {best / flat:.2f}" in done.stdout
    assert "share" not in done.stdout.partition("Validity")[0]
    assert set(result["gain_shares"].values()) == {None}


@pytest.mark.slow  # finalists walk by other laws
def test_a_front_within_limits_is_answered_with_its_knee_and_not_by_j_w(tmp_path):
    words = ["accuracy=draft", "report=light", "solver=nsga2", "solver.pop_size=12", "solver.n_gen=3"]
    words += ["foot.n=7", "objective.names=[distance,work,hollow]"]
    words += ["constraint.peak_power=400", "constraint.thickness=1e-4"]
    done = footopt(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    result = json.loads((only_folder(tmp_path) / "result.json").read_text())
    assert "Of the front the design nearest to the ideal point" in done.stdout
    assert "share of" not in done.stdout.partition("Validity")[0]
    assert result["choose"]["by"] == "knee"
    assert result["front"][0] == result["design"]["k"]
    assert len(result["front"]) == len(result["front_values"]) > 1
    values = [dict(zip(result["front_columns"], row, strict=True)) for row in result["front_values"]]
    assert {name: values[0][name] for name in result["objectives"]} == result["objectives"]
    assert all(v["peak_power"] <= 400 and v["thickness"] >= 1e-4 for v in values)
    assert result["constraints"] == {"peak_power": 400, "thickness": 1e-4}
    assert result["hypervolume"] > 0
