"""A run is an object: loaded in a line, with its foot, front and designs, walked and searched again."""

import shutil

import numpy as np
import pytest
from running import composed, footopt, unrender

import footopt as fo
from footopt.errors import FileError, FootoptError, SettingError
from footopt.files import identity
from footopt.studies.build import checked

WORDS = [
    *("sand=soft", "accuracy=draft", "objective.names=[distance,work]", "solver=nsga2", "solver.pop_size=8"),
    *("solver.n_gen=2", "study.confirm=null", "walker.mass=50", "foot.n=5", "engine.threads=1"),
    "report=light",
]
TEST = ["study=simulate", "accuracy=draft", "report=light", "effects=slope", "effects.slope.angle=4"]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A search, a walk and a multirun, below one folder."""
    cwd = tmp_path_factory.mktemp("made")
    with pytest.MonkeyPatch.context() as patch:
        unrender(patch)
        patch.chdir(cwd)
        runs = fo.run(WORDS), fo.run(TEST, folder="out/walk")
    done = footopt("-m", *TEST[:3], "sand.zeta=0.001,5", "hydra.sweep.dir=out/sweep", cwd=cwd)
    assert done.returncode == 1  # one of the walks sinks
    return cwd, *runs


class TestLoad:
    def test_gives_the_objects_of_a_search(self, made):
        run = fo.load(made[1].folder)
        assert run.config == composed(*WORDS)
        assert run.scene == fo.Scene(sand=fo.Sand.named("soft"), walker=fo.Walker(mass=50.0))
        assert run.foot.k == tuple(run.result["design"]["k"])
        assert not run.result["laws"]  # nothing is walked again
        assert {n: run.walk().objectives[n] for n in run.objectives} == run.objectives

    def test_gives_its_designs_and_its_front_as_frames(self, made):
        run = made[1]
        designs, front = run.designs, run.front
        assert len(designs) == run.result["designs"]
        found = run.search()
        assert (found.reused, len(found.k)) == (len(designs), len(designs))
        np.testing.assert_array_equal(designs[[f"k{i}" for i in range(1, 6)]], found.k)
        np.testing.assert_array_equal(designs["work"], found.column("work"))
        assert designs["reason"].tolist() == found.reasons.tolist()
        assert designs["on_front"].sum() == len(found.front)
        assert front.iloc[0][[f"k{i}" for i in range(1, 6)]].astype(int).tolist() == list(run.foot.k)
        assert front.iloc[0]["work"] == run.objectives["work"]
        (run.folder / "designs.csv").rename(run.folder / "away")  # as report=none leaves it
        assert run.designs.drop(columns="reason").equals(designs.drop(columns="reason"))

    def test_gives_the_objects_of_a_walk(self, made):
        run = made[2]
        assert run.scene.effects == (fo.Slope(angle=4.0),)
        walk = run.walk()
        assert {n: walk.objectives[n] for n in run.objectives} == run.objectives
        with pytest.raises(SettingError, match="must be optimize, to search again"):
            run.search()

    @pytest.mark.usefixtures("clean")
    def test_code_that_its_settings_name_is_run_only_for_who_trusts_it(self, made, tmp_path):
        folder = shutil.copytree(made[2].folder, tmp_path / "plugged")
        settings, words, _ = identity.read(folder)
        (tmp_path / "mine.py").write_text("raise SystemExit('run')\n")
        robot = settings["robot"] | {"controller": "mine.py:f"}
        for change in ({"robot": robot}, {"plugins": [str(tmp_path / "mine.py")]}):
            identity.write(folder, {**settings, **change}, words)
            with pytest.raises(SettingError, match=r"must be trusted: it comes from .*trust=True"):
                _ = fo.load(folder).scene
        with pytest.raises(SettingError, match="SystemExit: run"):  # a plugin may not end the process
            _ = fo.load(folder, trust=True).scene

    def test_a_file_that_has_changed_since_is_told_of_and_no_search_goes_on(self, tmp_path, caplog):
        phase, gait = np.arange(0.0, 101.0, 2.0), tmp_path / "walk.csv"
        for knee in (30.0, 25.0):
            angles = 20.0 * np.cos(0.02 * np.pi * phase), knee * (1.0 - np.cos(0.02 * np.pi * phase))
            table = np.stack([phase, *angles], axis=1)
            np.savetxt(gait, table, delimiter=",", header="percent,hip,knee", comments="")
            if knee == 30.0:
                words = [*WORDS, "gait=file", f"gait.path={gait}", "gait.period=1.2"]
                run = fo.run(words, tmp_path / "run")
                assert (run.walk().feasible, caplog.messages) == (True, [])
        again = fo.load(run.folder)
        again.walk()
        assert "has changed since" in caplog.text
        with pytest.raises(FootoptError, match="with other files"):
            again.search()
        walk = fo.run(["study=simulate", f"study.run={run.folder}", "report=none"], tmp_path / "walk")
        assert "has changed since" in walk.result["notes"][-1]
        with pytest.raises(SettingError, match="scene = 'brisk'"):
            fo.run(["study=simulate", f"study.run={run.folder}", "scene=brisk"], tmp_path / "brisk")

    def test_a_folder_without_a_run_is_refused(self, tmp_path):
        with pytest.raises(FileError, match="not the folder of a run"):
            fo.load(tmp_path)
        with pytest.raises(FileError, match="no run is there"):
            fo.load_all(tmp_path)
        newer = {"study": {"name": "simulate"}, "sand": {"density": 1}}
        with pytest.raises(FileError, match=r"footopt 9\.9 wrote this run, .*density"):
            _ = fo.Run(tmp_path, newer, (), "9.9").config


def test_all_runs_are_a_table_with_a_column_for_each_setting_objective_and_time(made):
    cwd, search, walk = made
    table = fo.load_all(cwd / "out*")
    places = [cwd / "out/sweep/0", cwd / "out/sweep/1", cwd / "out/walk", search.folder]
    assert sorted(table["folder"]) == sorted(map(str, places))
    row = table.set_index("folder").loc[str(search.folder)]
    assert (row["sand.zeta"], row["solver.name"], row["walker.mass"]) == (0.2, "nsga2", 50.0)
    assert row["work"] == search.objectives["work"]
    assert row["hypervolume"] == search.result["hypervolume"]
    assert row["wall_time_s"] > 0
    notes = table.set_index("folder")["note"]
    assert (notes[str(cwd / "out/sweep/0")], notes[str(walk.folder)]) == ("sunk", "")
    assert row["overrides"] == " ".join(WORDS)
    assert set(table["solver.seed"]) == {1}  # a setting in which no two differ


@pytest.mark.slow
def test_a_robots_run_is_loaded_and_walked_again_as_a_robot(tmp_path, monkeypatch):
    pytest.importorskip("mujoco")
    unrender(monkeypatch)
    monkeypatch.chdir(tmp_path)
    words = ["study=simulate", "simulator=biped", "sand=soft", "accuracy=custom", "accuracy.dt=2e-3"]
    run = fo.run([*words, "robot.duration=1.4", "foot.k=[1,2,3,2,1]", "foot.n=5"], folder="first")
    assert run.scene == fo.mujoco.Robot(sand=fo.Sand.named("soft"), duration=1.4)
    again = fo.run(["study=simulate", "study.run=first"], folder="again")
    assert (again.objectives, again.scene) == (run.objectives, run.scene)
    with pytest.raises(SettingError, match=r"scene\.t_f"):
        fo.run(["study=simulate", "study.run=first", "scene.t_f=2"])


@pytest.mark.parametrize("study", ["effects", "accuracy", "stability", "paper"])
def test_a_study_of_the_walker_refuses_a_robot_wherever_it_is_named(study):
    """Also in a file of settings, which may name what a study does not read."""
    config = composed(f"study={study}", "simulator=biped")
    with pytest.raises(SettingError, match="simulator"):
        checked(config, [])
