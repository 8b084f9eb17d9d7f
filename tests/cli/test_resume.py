"""Runs that survive: killed, interrupted, out of disk; resumed, the result is that of a run never stopped."""

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from running import BRIEF, QUICK, ended, folder_of, footopt, outcome, started, wait_for_designs

from footopt.cli.compose import CONF
from footopt.design import store
from footopt.files import identity
from footopt.files.identity import LOCK

#: A search that is over at once, of soft sand, which is walked fast.
SMALL = ["sand=soft", "engine.threads=1", "report=light", *QUICK]


@contextlib.contextmanager
def locked_by_another(folder):
    """The number of another process that has locked a folder for the block."""
    code = "import sys, pathlib; from footopt.files.identity import locked\n"
    code += "with locked(pathlib.Path(sys.argv[1])): print('locked', flush=True); sys.stdin.read()"
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout.readline() == "locked\n"
        yield process.pid
    finally:
        process.communicate()


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
    return folder_of(tmp_path_factory, *SMALL)


@pytest.fixture
def run(finished, tmp_path):
    """A copy of it, for a test to spoil."""
    return shutil.copytree(finished, tmp_path / "run")


@pytest.fixture
def begun(finished, tmp_path):
    """The same run, as one leaves it that was killed in its first moment."""
    (tmp_path / "begun").mkdir()
    return Path(shutil.copy(finished / identity.FILE, tmp_path / "begun")).parent


def contents(folder):
    """Every file below a folder, but logs, and stores, which note who has looked."""
    files = [path for path in folder.rglob("*") if path.is_file() and path.suffix not in (".log", ".sqlite")]
    return {path: path.read_bytes() for path in files}


def refused(*arguments, cwd, says):
    """A command that changes nothing, and says why."""
    before = contents(cwd)
    done = footopt(*arguments, cwd=cwd)
    assert done.returncode == 1
    assert done.stderr.startswith("footopt: error: ")
    assert says in done.stderr
    assert "Traceback" not in done.stderr
    assert contents(cwd) == before


#: Arguments that name what cannot be resumed or shared, and what the message says.
BAD = {
    "resume=missing": "missing': not the folder of a run (there is no such folder)",
    "resume=run sand=soft": "For anything else start a new run, without resume",
    "resume=run +x=1": "must be a setting that does not make another run",
    "resume=run solver.n_gen=4,5": "solver.n_gen=4,5': must be one value",
    "resume=run solver.n_gen=abc": "solver.n_gen = 'abc': must be a whole number",
    "resume=run solver.n_gen=2": "solver.n_gen = 2: must be at least 3, as before",
    "resume=run report=none": "report = 'none': must be light or more, as before",
    "hydra.run.dir=run sand=soft": "run: holds a run that is finished",
    "hydra.run.dir=run": "run: holds a run that is finished",
}


@pytest.mark.parametrize("arguments", BAD)
def test_what_is_another_run_is_refused_and_leaves_the_one_that_is_there(arguments, run, tmp_path):
    refused(*arguments.split(), cwd=tmp_path, says=BAD[arguments])


class TestIdentity:
    @pytest.mark.parametrize(
        ("name", "value"),
        [("sand.zeta", 4.0), ("solver.seed", 2)],
    )
    def test_settings_that_are_not_those_of_the_result_are_refused(self, name, value, run, tmp_path):
        settings, words, _ = identity.read(run)
        group, _, last = name.partition(".")
        settings[group][last] = value
        identity.write(run, settings, words)
        refused("resume=run", cwd=tmp_path, says=f"is that of another run: {name} differ")

    def test_a_run_of_another_version_is_told_as_such_and_goes_on_by_force(self, run, tmp_path, monkeypatch):
        monkeypatch.setattr(identity, "version", lambda _: "0.0.9")
        identity.write(run, *identity.read(run)[:2])
        monkeypatch.undo()
        refused(
            "resume=run", cwd=tmp_path, says="which this is, not of 0.0.9. Start a new run; or add --force"
        )
        done = footopt("resume=run", "--force", "solver.n_gen=4", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert json.loads((run / "result.json").read_text())["reused"] == 30

    def test_a_new_run_takes_no_folder_that_another_one_has_walked_in_and_the_same_goes_on(
        self, run, tmp_path
    ):
        (run / "result.json").unlink()
        refused("hydra.run.dir=run", *SMALL, "sand=hard", cwd=tmp_path, says="which differs in sand.name")
        done = footopt(*SMALL, "hydra.run.dir=run", cwd=tmp_path)
        assert "30 designs of this search are known" in done.stdout

    def test_a_new_run_takes_no_folder_with_the_files_of_one_that_died(self, begun, tmp_path):
        """Its figures would stay beside the new result."""
        words = ["study=simulate", "hydra.run.dir=begun", "accuracy=draft"]
        (begun / "contour.csv").write_text("x_mm,z_mm\n")
        refused(*words, cwd=tmp_path, says="begun: holds another run, which differs in ")
        (begun / "contour.csv").unlink()
        assert footopt(*words, cwd=tmp_path).returncode == 0

    def test_no_word_of_a_folder_is_run(self, begun, tmp_path, monkeypatch):
        (tmp_path / "evil.py").write_text("open('made', 'w')\n")
        (tmp_path / "evil.yaml").write_text("x: 1\n")
        settings, words, _ = identity.read(begun)
        wrong = ["--experimental-rerun=evil.pickle", "hydra.run.dir=elsewhere", "plugins=[evil.py]"]
        identity.write(begun, settings, [*words, *wrong])
        (begun / ".hydra").mkdir()
        (begun / ".hydra" / "overrides.yaml").write_text("- plugins=[evil.py]\n")
        ran = []
        monkeypatch.setattr("footopt.cli.run.run_study", lambda *of: ran.append(of))
        assert footopt("resume=begun", cwd=tmp_path).returncode == 0
        assert (ran[0][0].plugins, ran[0][1]) == ([], begun)
        for change, says in (
            ({"plugins": ["evil.py"]}, "plugins = ['evil.py']: must be trusted: it comes from"),
            (
                {"engine": settings["engine"] | {"address": "tcp://there:1"}},
                "engine.address = 'tcp://there:1'",
            ),
            ({"study": settings["study"] | {"video": "/tmp/x.gif"}}, "study.video = '/tmp/x.gif'"),
            (
                {"study": settings["study"] | {"store": "/tmp/x.db"}},
                "study.store = '/tmp/x.db': must be trusted",
            ),
        ):
            identity.write(begun, settings | change, words)
            refused("resume=begun", cwd=tmp_path, says=says)
            assert footopt("resume=begun", "--trust", cwd=tmp_path).returncode == 0
            assert str(ran[-1][0]).count(says.split("'")[1]) == 1
        assert len(ran) == 5
        identity.write(begun, settings | {"plugins": ["evil.py"]}, words)
        assert footopt("resume=begun", "plugins=[mine.py]", cwd=tmp_path).returncode == 0
        assert ran[-1][0].plugins == ["mine.py"]
        settings["sand"]["name"] = "${oc.env:HOME}"
        identity.write(begun, settings, words)
        refused("resume=begun", cwd=tmp_path, says="is damaged")
        assert not (tmp_path / "made").exists()

    def test_a_design_walked_by_other_code_does_not_enter_a_finished_result_unasked(
        self, run, tmp_path, monkeypatch
    ):
        monkeypatch.setattr(store, "_versions", lambda: {"numba": "another"})
        refused("resume=run", cwd=tmp_path, says="other code has walked this finished run (versions")
        before = json.loads((run / "result.json").read_text())
        done = footopt("resume=run", "study.reuse=true", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        after = json.loads((run / "result.json").read_text())
        assert (after["objectives"], after["reused"]) == (before["objectives"], before["designs"])
        assert after["walked_by_other_code"][0].startswith("versions.")
        assert after["settings"]["study"]["reuse"]
        assert "walked_by_other_code" not in before


class TestLock:
    def test_a_second_run_in_a_folder_is_refused(self, run, tmp_path):
        with locked_by_another(run):
            for words in (["resume=run"], ["hydra.run.dir=run", "sand=soft"]):
                refused(*words, cwd=tmp_path, says="another run is at work")

    def test_the_lock_of_a_dead_process_is_taken_over(self, run, tmp_path):
        with locked_by_another(run) as process:
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)
            done = footopt("resume=run", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert not (run / LOCK).exists()


class TestResume:
    def test_goes_on_with_the_settings_of_the_run_and_a_larger_budget(self, finished, tmp_path):
        folder = tmp_path / "it's, a run = 100 % é"  # all of which mean something to Hydra's grammar
        shutil.copytree(finished, folder)
        done = footopt(f"resume={folder.name}/", "solver.n_gen=5", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert "30 designs of this search are known" in done.stdout
        assert "30 of them known" in done.stdout
        result = json.loads((folder / "result.json").read_text())
        assert (result["evaluations"], result["reused"]) == (50, 30)
        assert result["settings"]["solver"]["n_gen"] == 5
        assert identity.read(folder).overrides == (*SMALL[:-1], "solver.n_gen=5")
        assert [p.name for p in tmp_path.iterdir()] == [folder.name]
        done = footopt(*SMALL, "solver.n_gen=5", "hydra.run.dir=fresh", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert outcome(folder) == outcome(tmp_path / "fresh")

    def test_with_another_engine_which_does_not_read_what_was_given_for_the_first(self, begun, tmp_path):
        settings, words, _ = identity.read(begun)
        settings["engine"] |= {"name": "dask", "timeout": 60.0}
        identity.write(begun, settings, [*words, "engine=dask", "engine.timeout=60"])
        done = footopt("resume=begun", "engine=local", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        kept = [word for word in words if not word.startswith("engine.")]
        assert identity.read(begun).overrides == (*kept, "engine=local")

    @pytest.mark.parametrize("how", ["--config-dir=mine sand=dune", "-cd mine -cn own", "-cp MINE -cn own"])
    def test_runs_of_settings_of_one_s_own_are_resumed_as_they_were(self, how, tmp_path, monkeypatch):
        own, ran = tmp_path / "mine", []
        (own / "sand").mkdir(parents=True)
        (own / "sand" / "dune.yaml").write_text("name: dune\nzeta: 3.3\n")
        ours = "hydra:\n  searchpath: [file://CONF]\ndefaults: [config, {override sand: dune}, _self_]\n"
        (own / "own.yaml").write_text(ours.replace("CONF", str(CONF)) + "walker: {mass: 44.0}\n")
        monkeypatch.setattr("footopt.cli.run.run_study", lambda *of: ran.append(of))
        words = how.replace("MINE", str(own)).split()
        assert footopt(*words, *QUICK, "hydra.run.dir=run", cwd=tmp_path).returncode == 0
        config, folder, settings, *_ = ran[0]
        identity.write(folder, settings, words)
        shutil.rmtree(own)
        assert footopt("resume=run", cwd=tmp_path).returncode == 0
        assert ran[1][:3] == (config, folder, settings)
        assert (config.sand.zeta, config.walker.mass) == (3.3, 44.0 if "own" in how else 60.0)


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

    def test_killed_it_goes_on_to_the_same_bits_and_a_second_ctrl_c_ends_it_at_once(
        self, undisturbed, tmp_path
    ):
        words = ["solver=memetic", "hydra.run.dir=run"]
        for first, second, code in ((signal.SIGKILL, None, -9), (signal.SIGINT, signal.SIGINT, -2)):
            run = started(*BRIEF, *words, cwd=tmp_path, drawn=True)
            wait_for_designs(run, tmp_path / "run", 10 * 16)
            run.send_signal(first)
            if second:
                time.sleep(0.5)
                run.send_signal(second)
            _, err = ended(run)
            assert run.returncode == code
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
        done = footopt("resume=ga", "--trust", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        result = json.loads((tmp_path / "ga" / "result.json").read_text())
        assert result["reused"] == result["designs"]


def test_files_of_a_run_are_found_from_another_folder(tmp_path, monkeypatch):
    there, here = tmp_path / "it's there", tmp_path / "here"
    for place in (there, here):
        place.mkdir()
    ran = []
    monkeypatch.setattr("footopt.cli.run.run_study", lambda *of: ran.append(of))
    words = ["gait=file", 'gait.path="Größe.mot"', "plugins=[mine.py,a.module]", "hydra.run.dir=run"]
    assert footopt(*words, cwd=there).returncode == 0
    config, folder, settings, *_ = ran[0]
    assert config.gait.path == "Größe.mot"  # as messages say it
    identity.write(folder, settings, words)
    assert footopt(f"resume={folder}", "--trust", cwd=here).returncode == 0
    config = ran[1][0]
    assert config.gait.path == str(there / "Größe.mot")
    assert config.plugins == [str(there / "mine.py"), "a.module"]
    assert config.sand.table is None
