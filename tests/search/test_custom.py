"""The examples of one's own sand, effect, objective and solver: short, run as they are, and as plugins."""

import importlib
import os
import re
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hydra.errors import HydraException
from running import composed, footopt

import footopt as fo
from footopt.design import make_executor
from footopt.design.solvers import Solver
from footopt.design.store import key_of
from footopt.effects import name_of
from footopt.errors import SettingError
from footopt.studies.build import load_plugins, make_effects

CUSTOM = Path(__file__).parents[2] / "examples" / "custom"


#: A part of what each example prints.
SAYS = {
    "sand": r"poppy, measured: 1\.\d+ m, sole \d+ mm deep",
    "objective": r"flat 8\d\.\d J/m, best 6\d\.\d J/m",
    "solver": r"best k=\[[\d,]+\]: J_W -0\.0002\d+",
}


@pytest.mark.usefixtures("clean")
@pytest.mark.parametrize("name", SAYS)
def test_an_example_runs_and_says_what_it_found(name, capsys):
    runpy.run_path(str(CUSTOM / f"{name}.py"), run_name="__main__")
    assert re.search(SAYS[name], capsys.readouterr().out)


@pytest.mark.usefixtures("clean")
class TestPlugins:
    def test_an_effect_becomes_a_setting(self):
        words = (f"plugins=[{CUSTOM / 'effect.py'}]", "effects=[floor,slope]", "effects.floor.depth=0.05")
        floor, slope = sorted(make_effects(composed(*words).effects), key=name_of)
        assert (floor.depth, floor.length, slope) == (0.05, 0.01, fo.Slope())
        with pytest.raises(HydraException, match=r"effects\.floor\.deep"):
            composed(*words, "effects.floor.deep=0.05")

    def test_an_effect_may_have_a_list_of_numbers(self, tmp_path):
        (tmp_path / "steps.py").write_text(
            "from dataclasses import dataclass\nfrom footopt.effects import Effect\n"
            "@dataclass(frozen=True)\nclass Steps(Effect, name='steps'):\n"
            "    at: tuple[float, ...] = (1.0, 2.0)\n"
        )
        words = (f"plugins=[{tmp_path / 'steps.py'}]", "effects=[steps]")
        assert [e.at for e in make_effects(composed(*words).effects)] == [(1.0, 2.0)]
        assert [e.at for e in make_effects(composed(*words, "effects.steps.at=[3]").effects)] == [(3.0,)]

    def test_a_solver_joins_those_of_one_objective(self):
        assert (
            composed(f"plugins=[{CUSTOM / 'solver.py'}]", "solver=hill_climbing").solver.name
            == "hill_climbing"
        )
        problem = fo.FootProblem(space=fo.Waypoints(n=5), accuracy="draft")
        assert len(fo.search(problem, "hill_climbing", walks=100, seed=2).k) <= 100  # at its default size
        results = [fo.search(problem, "hill_climbing", pop_size=20, n_gen=6, seed=2) for _ in range(2)]
        np.testing.assert_array_equal(results[0].k, results[1].k)
        first = results[0].values[results[0].generation == 1][:, problem.record.index("efficiency")]
        assert results[0].history[-1].best < first.min()
        with pytest.raises(SettingError, match="a solver of several objectives"):
            Solver("hill_climbing").build(2)

    def test_a_store_knows_the_source_of_an_objective_of_one_s_own_and_what_it_imports(
        self, tmp_path, monkeypatch
    ):
        own, imported = tmp_path / "own_objective.py", tmp_path / "tariffs.py"
        text = (CUSTOM / "objective.py").read_text(
            encoding="utf-8"
        ) + "\ntry:\n    from tariffs import PRICE\nfinally:\n    pass\n"
        own.write_text(text, encoding="utf-8")
        imported.write_text("PRICE = 1.0", encoding="utf-8")
        monkeypatch.syspath_prepend(tmp_path)
        load_plugins([str(own)])
        problem = fo.FootProblem(objective="work_per_metre")
        before = key_of(problem)
        assert "own_objective.work_per_metre" in before["own"]
        own.write_text(text.replace('raw["work"] /', '2.0 * raw["work"] /'), encoding="utf-8")
        assert key_of(problem) == before  # what walks here is still the code before the edit
        importlib.reload(sys.modules["own_objective"])
        problem = fo.FootProblem(objective="work_per_metre")
        assert (after := key_of(problem)["own"]) != before["own"]
        imported.write_text("PRICE = 2.0", encoding="utf-8")
        importlib.reload(sys.modules["tariffs"])
        assert key_of(problem)["own"] != after
        assert key_of(fo.FootProblem())["own"] == {}

    @pytest.mark.parametrize("edited", ["price", "rates"])
    def test_a_run_of_the_same_session_takes_files_as_they_have_been_edited(self, edited, tmp_path):
        """A plugin, or what it imports."""
        files, found = {name: tmp_path / f"{name}_{edited}.py" for name in ("price", "rates")}, []
        files["rates"].write_text("RATE = 1.0\n")
        files["price"].write_text(
            f"from rates_{edited} import RATE\nfrom footopt.walk.objectives import measure\n"
            "@measure('foot', 'p', 'EUR', maximise=False, worst=9.0)\n"
            "def own_price(foot):\n    return 1.0 * RATE\n"
        )
        words = [f"plugins=['{files['price'].as_posix()}']", "study=simulate", "objective=own_price"]
        for name in ("before", "after"):
            given = [*words, "foot=ellipse", "accuracy=draft", "report=none"]
            found.append(fo.run(given, tmp_path / name).objectives["own_price"])
            files[edited].write_text(files[edited].read_text().replace("1.0", "22.0"))
        assert found == [1.0, 22.0]

    @pytest.mark.parametrize(
        "read", ["json.load(FILE)", "scipy.interpolate.CubicSpline([0, 1], json.load(FILE))"]
    )
    def test_a_store_knows_what_a_plugin_has_read_when_it_was_imported_and_not_what_it_keeps(
        self, read, tmp_path
    ):
        own, table = tmp_path / "own_table.py", tmp_path / "table.json"
        own.write_text(
            "import json, scipy\nfrom footopt.walk.objectives import measure\nSEEN = []\n"
            f"with open({str(table)!r}) as FILE: TABLE = {read}\n"
            "@measure('foot', 'p', 'EUR', maximise=False, worst=9.0)\n"
            "def price(foot):\n    SEEN.append(foot)\n    return len(SEEN) and float(str(TABLE) != '')\n"
        )
        table.write_text("[1.0, 2.0]")
        load_plugins([str(own)])
        before = key_of(problem := fo.FootProblem(objective=["price", "work"]))
        sys.modules["own_table"].price(fo.Foot.flat())
        assert key_of(problem) == before
        table.write_text("[1.0, 3.0]")
        importlib.reload(sys.modules["own_table"])
        assert key_of(fo.FootProblem(objective=["price", "work"])) != before

    def test_a_store_knows_any_data_that_a_plugin_reads_in_every_process(self, tmp_path):
        (tmp_path / "own_data.py").write_text(
            "import numpy as np\nfrom footopt.walk.objectives import measure\n"
            "TABLE, NAMES, PRICES = np.array([1.0, 2.0]), {'a', 'b', 'c', 'd'}, {'a': 1.0}\n"
            "@measure('foot', 's', '', maximise=False, worst=9.0)\n"
            "def score(foot):\n    return TABLE.sum() * len(NAMES) * Market().price\n"
            "class Market:\n    price = property(lambda self: PRICES['a'])\n"
        )
        code = (
            "import footopt as fo, sys\nfrom footopt.studies.build import load_plugins\n"
            "from footopt.design.store import key_of\nload_plugins(['own_data.py'])\n"
            "problem = fo.FootProblem(objective=['score', 'work'])\nprint(key_of(problem)['own'])\n"
            "for new in ({'TABLE': [1.0, 3.0]}, {'NAMES': {'a'}}, {'PRICES': {'a': 2.0}}):\n"
            "    vars(sys.modules['own_data']).update(new)\n    print(key_of(problem)['own'])\n"
        )
        runs = [
            subprocess.run(
                [sys.executable, "-c", code], cwd=tmp_path, env=os.environ | {"PYTHONHASHSEED": seed},
                capture_output=True, text=True, check=True,
            ).stdout.splitlines()
            for seed in "123"
        ]  # fmt: skip
        assert runs[0] == runs[1] == runs[2]
        assert len({*runs[0]}) == 4

    def test_a_store_knows_the_sources_of_two_plugins_whose_classes_have_one_name(self, tmp_path):
        text = (CUSTOM / "effect.py").read_text(encoding="utf-8")
        files = [tmp_path / f"{name}.py" for name in ("slab", "pan")]
        for file in files:
            file.write_text(text.replace('name="floor"', f'name="{file.stem}"'), encoding="utf-8")
        load_plugins([*map(str, files)])
        problem = fo.FootProblem(
            fo.Scene(effects=(fo.effects.EFFECTS["slab"](), fo.effects.EFFECTS["pan"]()))
        )
        found = [key_of(problem)["own"]]
        for file in files:
            file.write_text(f"{file.read_text(encoding='utf-8')}# edited", encoding="utf-8")
            importlib.reload(sys.modules[file.stem])
            found.append(key_of(problem)["own"])
        assert found[0] != found[1] != found[2]


@pytest.mark.slow
@pytest.mark.usefixtures("clean")
def test_worker_processes_load_plugins_too(tmp_path):
    """To the same last bit as in this process."""
    found = []
    with make_executor("processes", 1) as executor:  # workers of another run of this session, without plugins
        executor.submit(abs, 0).result()
    for engine in ("local", "processes"):
        words = [
            f"engine={engine}",
            *["engine.workers=1"] * (engine == "processes"),
            f"hydra.run.dir={engine}",
        ]
        words += [f"plugins=[{CUSTOM / 'objective.py'}]", "objective.names=[work_per_metre]", "report=light"]
        words += ["accuracy=draft", "solver.n_gen=2", "solver.pop_size=8", "study.confirm=null"]
        done = footopt(*words, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        found.append((tmp_path / engine / "designs.csv").read_text())
    done = footopt("study=simulate", "run=local", cwd=tmp_path)  # foreign code runs where it is asked for
    assert (done.returncode, "of the run" in done.stderr) == (1, True)
    assert found[0] == found[1]
