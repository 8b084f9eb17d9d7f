"""Runs that are resumed: what is refused, and that the result is that of a run never stopped."""

import json
import shutil
import signal
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from motion_files import HUMAN, write_table
from running import BRIEF, LIMIT, QUICK, footopt, outcome, started, stored, tries, wait_for_designs

from footopt.design import FootProblem
from footopt.files import identity
from footopt.files.identity import LOCK

#: A search that is over at once, of soft sand, which is walked fast.
SMALL = ["sand=soft", "engine.threads=1", "report=light", *QUICK]


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """The folder of a small finished run."""
    cwd = tmp_path_factory.mktemp("done")
    done = footopt(*SMALL, "hydra.run.dir=run", cwd=cwd)
    assert done.returncode == 0, done.stderr
    return cwd / "run"


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


def refused(*arguments, cwd, says, alone=True):
    """A command that changes nothing, and says why; where others are at work, they may."""
    before = contents(cwd)
    done = footopt(*arguments, cwd=cwd)
    assert done.returncode == 1
    assert done.stderr.startswith("footopt: error: ")
    assert says in done.stderr
    assert "Traceback" not in done.stderr
    assert not alone or contents(cwd) == before


#: Arguments that name what cannot be resumed or shared, and what the message names.
BAD = {
    "resume=missing": "missing'",
    "resume=run sand=soft": "sand=soft",
    "resume=run +x=1": "+x=1",
    "resume=run solver.n_gen=4,5": "solver.n_gen=4,5",
    "resume=run solver.n_gen=2": "solver.n_gen = 2",
    "resume=run report=none": "report = 'none'",
    "resume=run study.laws=null": "study.laws = None",
    "hydra.run.dir=run sand=soft": "run: holds a run",
}


@pytest.mark.parametrize("arguments", BAD)
def test_what_is_another_run_is_refused_and_leaves_the_one_that_is_there(arguments, run, tmp_path):
    refused(*arguments.split(), cwd=tmp_path, says=BAD[arguments])


class TestIdentity:
    def test_settings_that_are_not_those_of_the_result_are_refused(self, run, tmp_path):
        settings, words, _ = identity.read(run)
        settings["sand"]["zeta"] = 4.0
        identity.write(run, settings, words)
        refused("resume=run", cwd=tmp_path, says="sand.zeta")

    def test_a_run_of_another_version_is_told_as_such_and_goes_on_by_force(self, run, tmp_path, monkeypatch):
        monkeypatch.setattr(identity, "version", lambda _: "0.0.9")
        identity.write(run, *identity.read(run)[:2])
        monkeypatch.undo()
        refused("resume=run", cwd=tmp_path, says="0.0.9")
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

    @pytest.mark.usefixtures("clean")
    def test_no_word_of_a_folder_is_run(self, begun, tmp_path, monkeypatch):
        """Neither plugins nor a store at another place, unless the user trusts it."""
        (tmp_path / "evil.py").write_text("open('made', 'w').close()\n")
        settings, words, _ = identity.read(begun)
        identity.write(begun, settings, [*words, "hydra.run.dir=elsewhere", "plugins=[evil.py]"])
        (begun / ".hydra").mkdir()
        (begun / ".hydra" / "overrides.yaml").write_text("- plugins=[evil.py]\n")
        ran = []
        monkeypatch.setattr("footopt.cli.main.run_study", lambda *of: ran.append(of))
        assert footopt("resume=begun", cwd=tmp_path).returncode == 0
        assert (ran[0][0].plugins, ran[0][1]) == ([], begun)
        for change, says in (
            ({"study": settings["study"] | {"store": "/tmp/x.db"}}, "study.store = '/tmp/x.db'"),
            ({"sand": settings["sand"] | {"name": "${oc.env:HOME}"}}, "is damaged"),
            ({"plugins": ["evil.py"]}, "plugins = ['evil.py']"),
        ):
            identity.write(begun, settings | change, words)
            refused("resume=begun", cwd=tmp_path, says=says)
        assert not (tmp_path / "made").exists()
        assert footopt("resume=begun", "--trust", cwd=tmp_path).returncode == 0
        assert (tmp_path / "made").exists()

    def test_weights_may_be_given_to_a_run_that_had_none(self, begun, tmp_path, monkeypatch):
        ran = []
        monkeypatch.setattr("footopt.cli.main.run_study", lambda *of: ran.append(of))
        done = footopt("resume=begun", "choose=weights", "choose.weights.work=3", cwd=tmp_path)
        assert (done.returncode, ran[0][0].choose.weights) == (0, {"work": 3.0})

    def test_another_choice_of_a_group_leaves_nothing_of_the_one_before(self, begun, tmp_path, monkeypatch):
        settings, words, _ = identity.read(begun)
        there = {"engine": {"name": "processes", "threads": None, "workers": 2}}
        identity.write(begun, settings | there, words)
        ran = []
        monkeypatch.setattr("footopt.cli.main.run_study", lambda *of: ran.append(of))
        assert footopt("resume=begun", "engine=local", cwd=tmp_path).returncode == 0
        assert (ran[0][0].engine.name, ran[0][0].engine.workers) == ("local", None)

    def test_a_gait_file_that_has_changed_makes_another_run(self, tmp_path):
        path = write_table(tmp_path / "mine.csv", HUMAN, 2.5)
        words = ["gait=file", f"gait.path={path}", *SMALL]
        assert footopt(*words, "hydra.run.dir=run", cwd=tmp_path).returncode == 0
        write_table(path, replace(HUMAN, period=1.3), 2.5)
        refused("resume=run", "solver.n_gen=4", cwd=tmp_path, says="scene.gait.")


class TestResume:
    def test_goes_on_with_the_settings_of_the_run_and_a_larger_budget(self, finished, tmp_path):
        folder = tmp_path / "it's, a run = 100 % é"  # all of which mean something to Hydra's grammar
        shutil.copytree(finished, folder)
        done = footopt(f"resume={folder.name}/", "solver.n_gen=5", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert "30 designs of this search are known" in done.stdout
        result = json.loads((folder / "result.json").read_text())
        assert (result["evaluations"], result["reused"]) == (50, 30)
        assert result["settings"]["solver"]["n_gen"] == 5
        assert identity.read(folder).overrides == (*SMALL[:-1], "solver.n_gen=5")
        assert [p.name for p in tmp_path.iterdir()] == [folder.name]
        done = footopt(*SMALL, "solver.n_gen=5", "hydra.run.dir=fresh", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert outcome(folder) == outcome(tmp_path / "fresh")


def test_a_search_that_is_interrupted_has_no_foot_to_print_yet(tmp_path, monkeypatch):
    """No other law has been searched then."""
    with monkeypatch.context() as patch:
        walk, calls = FootProblem.walk, []

        def interrupted(problem, k):
            calls.append(k)
            if len(calls) == 3:
                raise KeyboardInterrupt
            return walk(problem, k)

        patch.setattr(FootProblem, "walk", interrupted)
        done = footopt(*SMALL, "hydra.run.dir=run", cwd=tmp_path)
    folder = tmp_path / "run"
    assert done.returncode == 130
    assert "to_print" not in json.loads((folder / "result.json").read_text())
    assert not [*folder.glob("to_print.*")]
    assert footopt("resume=run", cwd=tmp_path).returncode == 0
    assert json.loads((folder / "result.json").read_text())["to_print"]["k"]
    assert (folder / "to_print.stl").is_file()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(tries(1)))
def test_killed_and_interrupted_anywhere_it_goes_on_to_the_same_bits(seed, tmp_path):
    """A Ctrl-C leaves a finished report, a kill whatever was written, and a lock that nobody holds."""
    draw = np.random.default_rng(seed)
    # walks so long that the search lasts while another program starts
    words = [*BRIEF, "accuracy.dt=1e-4", f"solver={draw.choice(['memetic', 'nsga2'])}"]
    assert footopt(*words, "hydra.run.dir=whole", cwd=tmp_path).returncode == 0
    folder = tmp_path / "run"
    for sent in (signal.SIGKILL, signal.SIGINT):
        run = started(*words, "hydra.run.dir=run", cwd=tmp_path)
        wait_for_designs(run, folder, stored(folder) + int(draw.integers(16, 120)))
        if sent == signal.SIGKILL:
            refused("resume=run", cwd=tmp_path, says="another run is at work", alone=False)
        run.send_signal(sent)
        out, err = run.communicate(timeout=LIMIT)
        assert "Traceback" not in err
    assert run.returncode == 130
    assert "interrupted" in out
    assert err.startswith("footopt: stopped after generation ")
    assert (folder / "report.html").is_file()
    done = footopt("resume=run", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert outcome(folder) == outcome(tmp_path / "whole")
    assert json.loads((folder / "result.json").read_text())["reused"] > 2 * 16
    assert not (folder / LOCK).exists()


@pytest.mark.usefixtures("clean")
def test_files_of_a_run_are_found_from_another_folder(tmp_path, monkeypatch):
    there, here = tmp_path / "it's there", tmp_path / "here"
    for place in (there, here):
        place.mkdir()
    (there / "mine.py").touch()
    ran = []
    monkeypatch.setattr("footopt.cli.main.run_study", lambda *of: ran.append(of))
    words = ["gait=file", 'gait.path="Größe.mot"', "plugins=[mine.py,json.tool]", "hydra.run.dir=run"]
    assert footopt(*words, cwd=there).returncode == 0
    config, folder, settings, *_ = ran[0]
    assert config.gait.path == "Größe.mot"  # as messages say it
    identity.write(folder, settings, words)
    assert footopt(f"resume={folder}", "--trust", cwd=here).returncode == 0
    config = ran[1][0]
    assert config.gait.path == str(there / "Größe.mot")
    assert config.plugins == [str(there / "mine.py"), "json.tool"]
    assert config.sand.table is None
    assert footopt(f"resume={folder}", "--trust", "choose=limits", cwd=here).returncode == 0
    assert ran[2][0].choose.name == "limits"
