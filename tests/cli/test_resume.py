"""Runs that survive: killed, interrupted, out of disk; resumed, the result is that of a run never stopped."""

import json
import random
import resource
import shutil
import signal
import time

import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser
from running import BRIEF, QUICK, ended, footopt, outcome, started, wait_for, wait_for_designs

from footopt.cli.resume import resumed


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """Folders of runs that nothing stopped, by solver."""
    folders = {}
    cwd = tmp_path_factory.mktemp("undisturbed")

    def run(solver):
        if solver not in folders:
            done = footopt(*BRIEF, f"solver={solver}", f"hydra.run.dir={solver}", cwd=cwd)
            assert done.returncode == 0, done.stderr
            folders[solver] = cwd / solver
        return folders[solver]

    return run


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """The folder of a small finished run."""
    cwd = tmp_path_factory.mktemp("finished")
    done = footopt(*QUICK, "hydra.run.dir=run", cwd=cwd)
    assert done.returncode == 0, done.stderr
    return cwd / "run"


#: Arguments that name what cannot be resumed or shared, and what the message says.
BAD = {
    "resume=missing": "resume = 'missing': not the folder of a run",
    "resume=": "resume = '': not the folder of a run",
    "resume=a_file": "resume = 'a_file': not the folder of a run",
    "resume=empty": "resume = 'empty': not the folder of a run",
    "resume=broken": "resume = 'broken': not the folder of a run (its overrides.yaml is no list of settings)",
    "resume=simulate": "must be a run of study=optimize, robust, not simulate",
    "resume=sweep": "must be the folder of one job of this multirun. Jobs without a result: 1 (of 0, 1)",
    "resume=run -m solver.seed=1,2": "must be given without -m",
    "resume=run study=simulate": "must be given without study=simulate",
    "resume=run hydra.run.dir=elsewhere": "must be given without hydra.run.dir=elsewhere",
    "study.store=a_file": "study.store = 'a_file': is not a store of footopt",
}


def make_run(folder, study="optimize", words="[]\n"):
    """What a run that was killed in its first moment leaves."""
    (folder / ".hydra").mkdir(parents=True)
    (folder / ".hydra" / "config.yaml").write_text(f"study:\n  name: {study}\n")
    (folder / ".hydra" / "overrides.yaml").write_text(words)


class TestArguments:
    def test_are_those_of_the_run_then_the_new_ones_in_the_same_folder(self, tmp_path):
        make_run(tmp_path / "run", words="- sand=soft\n- gait.path=${oc.env:HOME}/x.csv\n- solver.seed=3\n")
        given = ["solver.seed=4", f"resume={tmp_path}/run/", "--info"]
        assert resumed(given) == [
            *("sand=soft", "gait.path=${oc.env:HOME}/x.csv", "solver.seed=3", "solver.seed=4", "--info"),
            *(f"hydra.run.dir='{tmp_path}/run'", "hydra.output_subdir=null"),
        ]
        assert resumed(["sand=soft"]) == ["sand=soft"]

    def test_wrong_new_settings_leave_the_old_ones(self, tmp_path):
        make_run(tmp_path / "it's, a run = 100 % é", words="- solver.seed=3\n")
        before = {p: p.read_bytes() for p in tmp_path.rglob("*.yaml")}
        for wrong in ("solver.n_gen=0", "solver.generations=9"):
            done = footopt(f"resume={tmp_path}/it's, a run = 100 % é", wrong, cwd=tmp_path)
            assert done.returncode == 1
            assert done.stderr.startswith("footopt: error: ")
            assert wrong.split("=")[0].split(".")[1] in done.stderr
            assert "Traceback" not in done.stderr
            assert {p: p.read_bytes() for p in tmp_path.rglob("*.yaml")} == before

    @pytest.mark.parametrize("arguments", BAD)
    def test_what_cannot_be_resumed_gets_one_clear_message(self, arguments, tmp_path):
        (tmp_path / "a_file").write_text("not a store, and in the way\n" * 100)
        (tmp_path / "empty").mkdir()
        for name in ("run", "sweep/0", "sweep/1"):
            make_run(tmp_path / name)
        make_run(tmp_path / "broken", words="")
        make_run(tmp_path / "simulate", study="simulate")
        (tmp_path / "sweep" / "multirun.yaml").touch()
        (tmp_path / "sweep" / "0" / "result.json").touch()
        done = footopt(*arguments.split(), cwd=tmp_path)
        assert done.returncode == 1
        assert done.stderr.startswith("footopt: error: ")
        assert BAD[arguments] in done.stderr
        assert "Traceback" not in done.stderr
        assert (tmp_path / "a_file").read_text().startswith("not a store")


@pytest.mark.slow
class TestResume:
    def test_goes_on_with_the_settings_of_the_run_and_new_ones(self, finished, tmp_path):
        folder = tmp_path / "it's, a run = 100 % é"  # all of which mean something to Hydra's grammar
        shutil.copytree(finished, folder)
        done = footopt(f"resume={folder.name}/", "solver.n_gen=5", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert "30 designs of this search are known" in done.stdout
        assert "30 of them known" in done.stdout
        result = json.loads((folder / "result.json").read_text())
        assert (result["evaluations"], result["reused"]) == (50, 30)
        assert result["settings"]["solver"]["n_gen"] == 5
        saved = (folder / ".hydra" / "overrides.yaml").read_text().split()
        assert saved[1::2] == [*QUICK, "solver.n_gen=5"]
        assert [p.name for p in tmp_path.iterdir()] == [folder.name]
        done = footopt(*QUICK, "solver.n_gen=5", "hydra.run.dir=fresh", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert outcome(folder) == outcome(tmp_path / "fresh")

    def test_a_shorter_search_does_not_replace_a_longer_one(self, finished, tmp_path):
        shutil.copytree(finished, tmp_path / "run")
        before = (tmp_path / "run" / "result.json").read_bytes()
        done = footopt("resume=run", "solver.n_gen=2", cwd=tmp_path)
        assert done.returncode == 1
        assert "solver.n_gen = 2: must be at least 3: the run has 30 evaluations" in done.stderr
        assert (tmp_path / "run" / "result.json").read_bytes() == before

    def test_other_settings_are_walked_anew_and_the_difference_is_said(self, finished, tmp_path):
        shutil.copytree(finished, tmp_path / "run")
        done = footopt("resume=run", "sand=soft", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert "can be used again: scene.sand.name (hard there, soft here)" in done.stdout
        assert json.loads((tmp_path / "run" / "result.json").read_text())["reused"] == 0


@pytest.mark.slow
class TestKilled:
    KILLS = 21

    def test_at_random_moments_the_resumed_run_ends_like_one_never_stopped(self, undisturbed, tmp_path):
        rng, kills, rounds = random.Random(time.time_ns()), 0, 0
        while kills < self.KILLS:
            solver = ("memetic", "nsga2", "de")[rounds % 3]
            rounds += 1
            folder = tmp_path / str(rounds)
            first = [*BRIEF, f"solver={solver}", f"hydra.run.dir={folder.name}"]
            for i in range(7):
                begun = (folder / ".hydra" / "overrides.yaml").is_file()
                run = started(*([f"resume={folder.name}"] if begun else first), cwd=tmp_path)
                if i:  # the first is hit in its start or later, the others while they search
                    wait_for(run, "Searching")
                time.sleep(rng.uniform(0.0, 1.0 if i else 4.0))
                if run.poll() is None:
                    run.kill()
                    kills += 1
                ended(run)
            done = footopt(f"resume={folder.name}", cwd=tmp_path)
            assert done.returncode == 0, done.stderr
            assert outcome(folder) == outcome(undisturbed(solver))

    def test_a_killed_extension_is_extended_by_a_plain_resume(self, finished, tmp_path):
        shutil.copytree(finished, tmp_path / "run")
        run = started("resume=run", "solver.n_gen=2000", cwd=tmp_path)
        wait_for(run, "/2000")
        run.kill()
        ended(run)
        run = started("resume=run", cwd=tmp_path)
        wait_for(run, "/2000")
        run.kill()
        ended(run)


@pytest.mark.slow
class TestInterrupted:
    def test_ctrl_c_leaves_a_finished_report_and_resume_the_rest(self, undisturbed, tmp_path):
        run = started(*BRIEF, "solver=nsga2", "hydra.run.dir=run", cwd=tmp_path, drawn=True)
        wait_for_designs(run, tmp_path / "run", 5 * 16)
        run.send_signal(signal.SIGINT)
        out, err = ended(run)
        assert run.returncode == 130
        assert err.startswith("footopt: stopped after generation ")
        assert f"with a full report; go on with: footopt resume={tmp_path / 'run'}" in err
        assert "Traceback" not in err
        assert "(interrupted)" in out
        result = json.loads((tmp_path / "run" / "result.json").read_text())
        assert result["interrupted"]
        assert 16 * 4 <= result["evaluations"] < 16 * 25
        assert (tmp_path / "run" / "figures" / "scatter_matrix.png").stat().st_size > 10_000
        done = footopt("resume=run", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert outcome(tmp_path / "run") == outcome(undisturbed("nsga2"))

    @pytest.mark.parametrize("pause", [0.0, 0.3, 1.5])
    def test_a_second_ctrl_c_in_the_report_loses_no_design(self, undisturbed, tmp_path, pause):
        run = started(*BRIEF, "hydra.run.dir=run", cwd=tmp_path, drawn=True)
        wait_for_designs(run, tmp_path / "run", 10 * 16)
        run.send_signal(signal.SIGINT)
        time.sleep(pause)
        run.send_signal(signal.SIGINT)
        _, err = ended(run)
        assert run.returncode == 130
        assert "footopt: stopped" in err
        assert "footopt resume=" in err
        assert "Traceback" not in err
        done = footopt("resume=run", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert outcome(tmp_path / "run") == outcome(undisturbed("memetic"))
        assert json.loads((tmp_path / "run" / "result.json").read_text())["reused"] > 100


@pytest.mark.slow
class TestSharedStore:
    def test_two_runs_at_once_find_what_each_finds_alone(self, undisturbed, tmp_path):
        solvers = ("ga", "nsga2")
        runs = [
            started(*BRIEF, f"solver={s}", f"hydra.run.dir={s}", "study.store=shared.sqlite", cwd=tmp_path)
            for s in solvers
        ]
        for run in runs:
            _, err = ended(run)
            assert run.returncode == 0, err
        for solver in solvers:
            shared, alone = outcome(tmp_path / solver), outcome(undisturbed(solver))
            assert shared[0] | {"settings": 0} == alone[0] | {"settings": 0}
            assert shared[1:] == alone[1:]
            assert not (tmp_path / solver / "designs.sqlite").exists()
        done = footopt("resume=ga", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        result = json.loads((tmp_path / "ga" / "result.json").read_text())
        assert result["reused"] == result["designs"]

    def test_one_job_of_a_multirun_is_resumed_in_its_folder(self, tmp_path):
        done = footopt(
            "-m", "solver.seed=1,2", "sand.zeta=5,0.001", *QUICK, "hydra.sweep.dir=sweep", cwd=tmp_path
        )
        assert done.returncode == 1
        assert "Jobs without a result: 1, 3 (of 0, 1, 2, 3)" in footopt("resume=sweep", cwd=tmp_path).stderr
        before = outcome(tmp_path / "sweep" / "2")
        done = footopt("resume=sweep/2", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert outcome(tmp_path / "sweep" / "2") == before
        assert (tmp_path / "sweep" / "1" / "error.txt").is_file()
        done = footopt("resume=sweep/1", "sand.zeta=5", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert not (tmp_path / "sweep" / "1" / "error.txt").is_file()


@pytest.mark.slow
def test_a_full_disk_is_said_and_what_was_kept_is_used(undisturbed, tmp_path):
    def failing(kilobytes, *arguments):
        """The error of a run whose files may not grow beyond a size."""
        run = started(
            *arguments,
            cwd=tmp_path,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (kilobytes << 10,) * 2),
        )
        _, err = ended(run)
        assert run.returncode == 1
        assert err.startswith("footopt: error: ")
        assert "Traceback" not in err
        assert "unexpected" not in err
        return err

    def resume():
        done = footopt("resume=run", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert outcome(tmp_path / "run") == outcome(undisturbed("memetic"))

    assert "Make room on the disk" in failing(0, *BRIEF, "hydra.run.dir=nothing")
    store = f"study.store = '{tmp_path}/run/designs.sqlite': cannot be written"
    assert store in failing(8, *BRIEF, "hydra.run.dir=run")
    assert store in failing(60, "resume=run")  # some generations later
    resume()
    result = (tmp_path / "run" / "result.json").read_bytes()
    assert f"cannot write {tmp_path}/run/.hydra/config.yaml" in failing(0, "resume=run", "solver.n_gen=26")
    assert f"cannot write {tmp_path}/run/designs.csv" in failing(40, "resume=run")
    assert (tmp_path / "run" / "result.json").read_bytes() == result
    assert not list((tmp_path / "run").rglob("*.new"))
    resume()


def test_files_of_a_run_are_found_from_another_folder(tmp_path, monkeypatch):
    there, here = tmp_path / "it's there", tmp_path / "here"
    for place in (there / "run" / ".hydra", here):
        place.mkdir(parents=True)
    for name in ("Größe.trc", "mine.py"):
        (there / name).touch()
    saved = ["gait.path='Größe.trc'", "plugins=[mine.py,a.module]", "sand.table=null", "foot.n=7"]
    (there / "run" / ".hydra" / "config.yaml").write_text("study:\n  name: optimize\n")
    (there / "run" / ".hydra" / "overrides.yaml").write_text("".join(f'- "{word}"\n' for word in saved))
    (there / "run" / ".hydra" / "hydra.yaml").write_text(f'hydra:\n  runtime:\n    cwd: "{there}"\n')
    monkeypatch.chdir(there)
    assert resumed(["resume=run"])[: len(saved)] == saved
    monkeypatch.chdir(here)
    words = resumed([f"resume={there / 'run'}"])[: len(saved)]
    parsed = {word.key_or_group: word.value() for word in OverridesParser.create().parse_overrides(words)}
    assert parsed["gait.path"] == str(there / "Größe.trc")
    assert parsed["plugins"] == [str(there / "mine.py"), "a.module"]
    assert parsed["sand.table"] is None
    assert words[-1] == "foot.n=7"
