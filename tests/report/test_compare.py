"""Earlier runs side by side: found by name or pattern, and told where they are."""

import csv
import json

import pytest
from study_pages import leave_job

import footopt as fo
from footopt.files import identity
from footopt.studies import Compare
from footopt.studies.compare import run_folders
from footopt.studies.runs import run_study
from footopt.studies.settings import Config


@pytest.fixture(scope="module")
def walks():
    return {z: fo.simulate(fo.Foot.flat(), fo.Scene(sand=fo.Sand(zeta=z)), "draft") for z in (1.0, 5.0, 2.5)}


@pytest.fixture
def runs(tmp_path, walks):
    """Three runs with a foot, in two folders; one without a result; one of another study."""
    for i, (name, (zeta, walk)) in enumerate(zip(("old/b", "old/a", "new/c"), walks.items(), strict=True)):
        folder = tmp_path / name
        folder.parent.mkdir(exist_ok=True)
        leave_job(folder, walk, [f"solver.seed={i}", f"sand.zeta={zeta}", "gait=human"])
    (tmp_path / "old" / "broken").mkdir()
    identity.write(tmp_path / "old" / "broken", {}, [])
    (tmp_path / "old" / "other").mkdir()
    (tmp_path / "old" / "other" / "result.json").write_text('{"study": "accuracy"}')
    (tmp_path / "new" / "c" / "report.html").touch()
    return tmp_path


def compare(folder, *patterns):
    folder.mkdir()
    run_study(Config(study=Compare(runs=list(patterns))), folder, {})


def test_a_table_a_file_and_a_page(runs, capsys):
    compare(runs / "here", f"{runs}/old/[ab]", f"{runs}/new/c")
    out = " ".join(capsys.readouterr().out.split())
    assert "3 runs" in out
    assert all(unit in out.split(" old/a: ")[0] for unit in ("(m)", "(J)", "(W)", "(m/s)", "(mm)"))
    assert "old/a: solver.seed=1 " in out
    assert "sand.zeta=5.0" in out
    assert out.count("gait=human") == 1  # what all share
    with open(runs / "here" / "summary.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["run"] for row in rows] == ["old/a", "old/b", "new/c"]
    assert len({float(row["distance"]) for row in rows}) == 3
    text = (runs / "here" / "report.html").read_text()
    assert '"link":"../new/c/report.html"' in text
    assert text.count('"link":null') == 2
    assert (runs / "here" / "result.json").is_file()


def test_the_gain_of_a_search_has_its_range_over_the_other_laws(runs, capsys):
    path = runs / "old" / "a" / "result.json"
    result = json.loads(path.read_text())
    gains = {"own law": 0.8, "shadowing": 0.5, "both": -0.1, "a walk that failed": None}
    result["laws"] = [{"law": law, "loss": 0.0, "change": {"efficiency": g}} for law, g in gains.items()]
    path.write_text(json.dumps(result))
    compare(runs / "here", f"{runs}/old/[ab]")
    said = capsys.readouterr().out
    assert said.count("x 0.90 to 1.50") == 1
    assert "sign not certain: a: " in said
    assert (runs / "here" / "report.html").read_text().count('"laws":"x 0.90 to 1.50, sign not certain"') == 1


def test_a_multirun_stands_for_its_jobs_in_their_order(runs):
    (runs / "multi").mkdir()
    for job in ("10", "9", "2"):
        (runs / "multi" / job).mkdir()
        identity.write(runs / "multi" / job, {}, [])
    (runs / "old" / "b").rename(runs / "multi" / "0")
    expected = [runs / "multi" / job for job in ("0", "2", "9", "10")]
    assert run_folders([f"{runs}/mul*"], runs) == expected
    assert run_folders([f"{runs}/multi/0", f"{runs}/multi"], runs) == expected
