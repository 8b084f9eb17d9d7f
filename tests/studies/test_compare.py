"""Earlier runs side by side: found by name or pattern, told where they are, and never mixed up."""

import csv
import json

import pytest
from study_pages import leave_job

import footopt as fo
from footopt.errors import FileError, SettingError
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


def test_objectives_of_plugins_are_compared_by_what_the_runs_say_of_them(runs):
    for i, name in enumerate(("old/a", "old/b")):
        path = runs / name / "result.json"
        result = json.loads(path.read_text())
        result["objectives"]["work_per_metre"] = 80.0 + i
        result["units"]["work_per_metre"], result["maximise"]["work_per_metre"] = "J/m", False
        path.write_text(json.dumps(result))
    compare(runs / "here", f"{runs}/old/[ab]")
    text = (runs / "here" / "report.html").read_text()
    assert '"name":"work_per_metre","title":"work per metre","unit":"J/m","maximise":false' in text


def test_each_run_once_and_not_the_one_that_is_running(runs):
    own = runs / "old" / "a"
    found = run_folders([f"{runs}/*/[ab]", str(runs / "old" / "b"), f"{runs}/**/c"], own)
    assert found == [runs / "old" / "b", runs / "new" / "c"]


def test_a_multirun_stands_for_its_jobs_in_their_order(runs):
    (runs / "multi").mkdir()
    for job in ("10", "9", "2"):
        (runs / "multi" / job).mkdir()
        identity.write(runs / "multi" / job, {}, [])
    (runs / "old" / "b").rename(runs / "multi" / "0")
    expected = [runs / "multi" / job for job in ("0", "2", "9", "10")]
    assert run_folders([f"{runs}/mul*"], runs) == expected
    assert run_folders([f"{runs}/multi/0", f"{runs}/multi"], runs) == expected


@pytest.mark.parametrize(
    ("patterns", "error", "message"),
    [
        ([], SettingError, r"study\.runs = \[\]: must be folders of runs\. Try footopt study=compare"),
        (["nowhere"], FileError, r"study\.runs = 'nowhere': not the folder of a run"),
        (["{runs}/old/o*"], FileError, "none of the 1 folders has a foot to compare"),
    ],
)
def test_what_cannot_be_compared(runs, patterns, error, message):
    with pytest.raises(error, match=message):
        compare(runs / "here", *(pattern.format(runs=runs) for pattern in patterns))
    assert not (runs / "here" / "summary.csv").exists()
