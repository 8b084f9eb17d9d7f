"""A multirun that is killed is told as it is, and one command finishes it."""

import csv
import json
import shutil

import pytest
from running import folder_of, footopt

from footopt.cli import run as cli_run
from footopt.files import identity

JOBS = [0.2, 0.5, 1.0]  # sand.zeta
SWEEP = [
    *("study=simulate", "-m", "accuracy=draft", "report=light"),
    *(f"sand.zeta={','.join(map(str, JOBS))}", "sand=regular"),
]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The folder of a multirun that nothing stopped."""
    return folder_of(tmp_path_factory, *SWEEP, setting="hydra.sweep.dir")


def found(sweep):
    """What all jobs of a multirun have found, and the table over them."""
    jobs = {}
    for path in sweep.glob("*/result.json"):
        result = json.loads(path.read_text())
        kept = {name: value for name, value in result.items() if not name.endswith("time_s")}
        jobs[path.parent.name] = kept, (path.parent / "walk.nc").read_bytes()
    with open(sweep / "summary.csv", newline="") as file:
        rows = [{k: v for k, v in row.items() if "time" not in k} for row in csv.DictReader(file)]
    return jobs, rows


@pytest.fixture(scope="module")
def halved(tmp_path_factory):
    """The folder of the same multirun, stopped before its second job."""
    cwd = tmp_path_factory.mktemp("halved")
    run, count = cli_run.run_study, 0

    def stop(*of):
        nonlocal count
        count += 1
        if count == 2:
            raise KeyboardInterrupt
        return run(*of)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("footopt.cli.run.run_study", stop)
        done = footopt(*SWEEP, "hydra.sweep.dir=sweep", cwd=cwd)
    assert done.returncode == 130
    assert len(list(cwd.glob("sweep/*/result.json"))) == 1
    return cwd / "sweep"


@pytest.fixture
def stopped(halved, tmp_path):
    """A copy of it, to go on with."""
    return shutil.copytree(halved, tmp_path / "sweep")


@pytest.mark.slow
class TestResume:
    def test_finishes_the_jobs_that_are_missing_and_walks_no_other(self, stopped, whole):
        assert len(list(stopped.glob(f"*/{identity.FILE}"))) == 3
        before = {path: path.stat().st_mtime_ns for path in stopped.rglob("0/*")}
        done = footopt("resume=sweep", cwd=stopped.parent)
        assert done.returncode == 0, done.stderr
        assert [line for line in done.stdout.splitlines() if line.startswith("job ")][:2] == [
            f"job {i}: study=simulate accuracy=draft report=light sand.zeta={JOBS[i]} sand=regular"
            for i in (1, 2)
        ]
        assert "3 runs in" in done.stdout
        assert {path: path.stat().st_mtime_ns for path in before} == before
        assert found(stopped) == found(whole)

    def test_a_job_that_failed_is_tried_again_and_told(self, stopped):
        settings, words, _ = identity.read(stopped / "2")
        settings["foot"]["width"] = -1.0
        identity.write(stopped / "2", settings, words)
        done = footopt("resume=sweep", cwd=stopped.parent)
        assert done.returncode == 1
        assert "1 of the jobs failed" in done.stderr
        assert "foot.width = -1.0: must be" in (stopped / "2" / "error.txt").read_text()

    def test_takes_what_a_single_run_may_change(self, stopped):
        done = footopt("resume=sweep", "sand=soft", cwd=stopped.parent)
        assert done.returncode == 1
        assert "start a new run, without resume" in done.stderr
        assert len(list(stopped.glob("*/result.json"))) == 1

    def test_one_job_is_resumed_in_its_folder(self, stopped, whole):
        done = footopt("resume=sweep/2", cwd=stopped.parent)
        assert done.returncode == 0, done.stderr
        assert (
            json.loads((stopped / "2" / "result.json").read_text())["objectives"]
            == (json.loads((whole / "2" / "result.json").read_text())["objectives"])
        )


@pytest.mark.slow
def test_a_job_that_cannot_be_is_written_down_and_so_are_those_after_it(whole, tmp_path, monkeypatch):
    """They never begin: a killed sweep is resumed from what was written before its first job."""

    def killed(*of, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr("footopt.cli.main.execute", killed)
    words = [*SWEEP[:4], f"study.run=missing,{whole / '0'},{whole / '1'}", "hydra.sweep.dir=sweep"]
    words += ["hydra.sweep.subdir=job_${hydra.job.num}"]  # no number, by which a job would be known
    assert footopt(*words, cwd=tmp_path).returncode == 130
    assert "not the folder of a run" in (tmp_path / "sweep" / "job_0" / "error.txt").read_text()
    assert [path.parent.name for path in sorted(tmp_path.glob(f"sweep/*/{identity.FILE}"))] == [
        "job_1",
        "job_2",
    ]
    monkeypatch.undo()
    reason = (tmp_path / "sweep" / "job_0" / "error.txt").read_text()
    done = footopt("resume=sweep", cwd=tmp_path)
    assert (done.returncode, "1 of the jobs failed" in done.stderr) == (1, True)
    assert (tmp_path / "sweep" / "job_0" / "error.txt").read_text() == reason
    assert len(list(tmp_path.glob("sweep/*/result.json"))) == 2


@pytest.mark.slow
def test_folders_of_runs_with_a_comma_between_them_are_two_jobs(tmp_path):
    done = footopt("-m", "study=simulate", "run=a,b", "hydra.sweep.dir=sweep", cwd=tmp_path)
    assert done.returncode == 1
    said = [(tmp_path / "sweep" / job / "error.txt").read_text() for job in "01"]
    assert ["run = 'a'" in said[0], "run = 'b'" in said[1]] == [True, True]


def test_another_multirun_takes_no_folder_that_holds_one(whole):
    before = found(whole)
    done = footopt(*SWEEP, "scene=brisk", "hydra.sweep.dir=run", cwd=whole.parent)
    assert done.returncode == 1
    assert "holds a multirun. footopt resume=" in done.stderr
    assert found(whole) == before
