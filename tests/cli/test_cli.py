"""The command line end to end, as a user runs it, in an empty folder."""

import csv
import json

import numpy as np
import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser
from running import LIMIT, QUICK, composed, footopt, only_folder, program, started
from scipy.io import netcdf_file
from shapely import Polygon
from study_pages import check_page

import footopt as fo
from footopt.cli.compose import CONF
from footopt.cli.words import readable
from footopt.errors import SettingError
from footopt.studies import STUDIES, build
from footopt.studies.export import foot_of
from footopt.walk import STEPPERS
from footopt.walk.accuracy import MARGIN, measured_settings

GROUPS = sorted(p.name for p in CONF.iterdir() if p.is_dir())


@pytest.fixture(scope="module")
def run_ga(tmp_path_factory):
    cwd = tmp_path_factory.mktemp("ga")
    done = program(*QUICK, cwd=cwd, drawn=True)
    assert done.returncode == 0, done.stderr
    return done, only_folder(cwd)


class TestOptimize:
    def test_leaves_everything_a_user_needs(self, run_ga):
        _, folder = run_ga
        files = {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}
        figures = ("contour", "convergence", "com", "forces", "power_work", "step")
        assert files >= {
            *(f".hydra/{name}.yaml" for name in ("config", "hydra", "overrides")),
            *("result.json", "designs.csv", "walk.nc", "report.html"),
            *(f"contour.{end}" for end in ("csv", "dxf", "svg", "stl", "step")),
            *(f"figures/{name}.{end}" for name in figures for end in ("png", "pdf")),
        }
        assert folder.parts[-3:-1] == ("outputs", "optimize")

    def test_result_json_is_what_the_library_computes(self, run_ga):
        result = json.loads((run_ga[1] / "result.json").read_text())
        scene = fo.Scene(sand=fo.Sand.named("hard"))
        foot = fo.Foot.from_waypoints(result["design"]["k"])
        walk = fo.simulate(foot, scene, "fine")  # the finalists are confirmed at this accuracy
        assert result["objectives"] == {n: walk.objectives[n] for n in result["objectives"]}
        assert result["flat"]["work"] == fo.simulate(fo.Foot.flat(), scene, "fine").objectives["work"]
        errors = fo.estimate_error(foot, scene, "fine")
        assert result["error_estimate"] == {n: errors[n] for n in result["objectives"]}
        assert all(errors[n] < 2e-3 * abs(result["objectives"][n]) for n in result["objectives"])
        assert result["seed"] == 1
        assert sum(result["gain_shares"].values()) == pytest.approx(1)
        assert {"footopt", "numpy", "numba", "pymoo", "python"} <= set(result["versions"])
        assert result["settings"]["sand"]["zeta"] == 5.0

    def test_the_best_is_the_best_of_the_confirmed_finalists(self, run_ga):
        result = json.loads((run_ga[1] / "result.json").read_text())
        confirmed = result["confirmed"]
        j = [row[confirmed["columns"].index("efficiency")] for row in confirmed["values"]]
        assert j == sorted(j)
        assert confirmed["k"][0] == result["design"]["k"]
        assert 1 < len(j) <= 20
        assert 0 < confirmed["largest_change"] < 0.1
        assert "walked again at accuracy fine" in run_ga[0].stdout

    def test_designs_csv_holds_every_design(self, run_ga):
        with open(run_ga[1] / "designs.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        result = json.loads((run_ga[1] / "result.json").read_text())
        assert len(rows) == result["designs"]
        k = [[int(r[f"k{i + 1}"]) for i in range(11)] for r in rows]
        row = rows[k.index(result["design"]["k"])]
        table = fo.evaluate([result["design"]["k"]], fo.Scene(), "draft")
        assert [float(row[n]) for n in table.names] == table.values[0].tolist()
        assert {r["reason"] for r in rows} <= {"", "box"}

    def test_walk_nc_holds_the_traces(self, run_ga):
        result = json.loads((run_ga[1] / "result.json").read_text())
        walk = fo.simulate(fo.Foot.from_waypoints(result["design"]["k"]), fo.Scene(), "fine")
        with netcdf_file(run_ga[1] / "walk.nc", mmap=False) as file:
            np.testing.assert_array_equal(file.variables["com"][:], walk.com)
            np.testing.assert_array_equal(file.variables["force"][:], walk.force)
            assert file.variables["power"].units == b"W"

    def test_the_terminal_shows_the_gain_over_a_flat_foot(self, run_ga):
        text = run_ga[0].stdout
        assert "share of" in text
        assert "hollow" in text
        assert "Validity" in text
        assert "\x1b" not in text  # no colours or cursor moves in a log file

    @pytest.mark.slow
    def test_several_objectives_give_a_front_and_its_figures(self, tmp_path):
        done = footopt(*QUICK, "sand=soft", "solver=nsga2", "objective.names=[distance,work,peak_power]",
                       cwd=tmp_path, drawn=True)  # fmt: skip
        assert done.returncode == 0, done.stderr
        folder = only_folder(tmp_path)
        result = json.loads((folder / "result.json").read_text())
        assert len(result["front"]) > 1
        assert (folder / "figures" / "scatter_matrix.png").stat().st_size > 10_000
        assert (folder / "figures" / "parallel.pdf").is_file()
        with open(folder / "designs.csv", newline="") as file:
            assert sum(int(r["on_front"]) for r in csv.DictReader(file)) == len(result["front"])

    @pytest.mark.slow
    def test_two_runs_at_once_do_not_share_a_folder(self, tmp_path):
        runs = [started("study=simulate", "accuracy=draft", cwd=tmp_path) for _ in range(2)]
        for run in runs:
            _, err = run.communicate(timeout=LIMIT)
            assert run.returncode == 0, err
        assert len(list(tmp_path.rglob("result.json"))) == 2


class TestSimulate:
    @pytest.mark.parametrize("setting", ["foot.k=[5,8,9,8,5,4,4,2,2,3,4]", "foot=reversed_triangle"])
    def test_walks_with_one_sole(self, tmp_path, setting):
        done = footopt("study=simulate", setting, "sand.zeta=2.5", "accuracy=draft", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        result = json.loads((only_folder(tmp_path) / "result.json").read_text())
        assert result["feasible"]
        assert result["objectives"]["distance"] > 1.5
        assert result["scene"]["sand"]["zeta"] == 2.5

    @pytest.mark.slow
    def test_standing_still_has_no_peak_power(self, tmp_path):
        done = footopt("study=simulate", "scene=stand", "scene.t_f=0.5", "accuracy=draft", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        result = json.loads((only_folder(tmp_path) / "result.json").read_text())
        assert result["objectives"]["peak_power"] is None
        assert abs(result["objectives"]["distance"]) < 1e-9

    @pytest.mark.slow
    def test_a_walk_that_sinks_is_a_result_with_a_reason(self, tmp_path):
        done = footopt("study=simulate", "sand.zeta=0.001", "accuracy=draft", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        result = json.loads((only_folder(tmp_path) / "result.json").read_text())
        assert (result["feasible"], result["reason"]) == (False, "sunk")
        assert "sunk" in done.stdout


class TestExport:
    """study=export, of runs of either kind that are over."""

    def test_the_best_of_a_search_with_a_block(self, run_ga, tmp_path):
        done = footopt("study=export", f"run={run_ga[1]}", "foot.block=[0.06,0.02]", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        folder = only_folder(tmp_path)
        result = json.loads((folder / "result.json").read_text())
        design = json.loads((run_ga[1] / "result.json").read_text())["design"]
        assert result["design"] == design
        bare = Polygon(fo.Foot.from_waypoints(design["k"]).body_outline()).area
        assert result["area_mm2"] == pytest.approx(1e6 * bare + 1200.0)
        assert result["volume_mm3"] == pytest.approx(100.0 * result["area_mm2"])
        for ending in ("csv", "dxf", "svg", "stl"):
            assert (folder / f"contour.{ending}").is_file()
        assert (folder / "contour.csv").read_text() == (run_ga[1] / "contour.csv").read_text()

    def test_another_sole_of_the_same_space(self, run_ga):
        k = [1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 8]
        np.testing.assert_array_equal(foot_of(run_ga[1], k).contour, fo.Foot.from_waypoints(k).contour)

    @pytest.mark.slow
    def test_a_drawings_sole_even_when_the_drawing_is_gone(self, tmp_path):
        (tmp_path / "it's.csv").write_text("x_mm,z_mm\n-100,-10\n0,-20\n110,-5\n")
        given = ["foot=outline", 'foot.path="it\'s.csv"', "foot.width=0.07", "foot.ankle=[0.01,0.02]"]
        done = footopt("study=simulate", *given, "accuracy=draft", 'hydra.run.dir="it\'s"', cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        (tmp_path / "it's.csv").unlink()
        done = footopt("study=export", "run=it's", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        foot = foot_of(tmp_path / "it's")
        np.testing.assert_allclose(foot.contour, [(-0.1, -0.01), (0, -0.02), (0.11, -0.005)], atol=1e-12)
        assert (foot.width, foot.ankle, foot.name) == (0.07, (0.01, 0.02), "it's")


class TestAccuracy:
    @pytest.mark.slow
    def test_a_first_look_measures_errors_costs_and_orders(self, tmp_path):
        done = footopt("study=accuracy", "study.quick=true", "study.feet=3", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        folder = only_folder(tmp_path)
        result = json.loads((folder / "result.json").read_text())
        with open(folder / "accuracy.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        assert {r["stepper"] for r in rows} == set(STEPPERS)
        errors = {
            (r["stepper"], r["rule"], float(r["dt"]), int(r["plates"])): float(r["error"]) for r in rows
        }
        assert errors["sdirk2", "arc", 2.5e-3, 64] < errors["sdirk2", "arc", 1e-2, 32]
        assert errors["explicit_euler", "arc", 1e-3, 64] < errors["explicit_euler", "arc", 2e-3, 64]
        assert all(float(r["ms"]) > 0 for r in rows)
        assert result["orders"]["sdirk2"] > 1.5
        assert 0.5 < result["orders"]["explicit_euler"] < 1.5
        for difference in result["scipy_lsoda"].values():  # the law in its angle form, another solver
            assert max(difference.values()) < 2e-4
        assert (folder / "figures" / "accuracy.png").is_file()
        check_page(folder)

    def test_a_tolerance_picks_the_cheapest_measured_setting(self):
        for tolerance in (0.02, 0.01, 0.005):
            picked = build.make_accuracy(
                composed("accuracy=custom", f"accuracy.tolerance={tolerance}").accuracy
            )
            held = [r for r in measured_settings() if r["control"] is not None]
            good = [r for r in held if r["error"] <= MARGIN * tolerance]
            (row,) = [r for r in good if r["ms"] == min(g["ms"] for g in good)][:1]
            for name in ("stepper", "dt", "control", "plates", "creep", "rule"):
                assert getattr(picked, name) == row[name]

    def test_a_sand_is_called_what_it_is(self):
        for words, name in (
            ("sand=hard", "hard"), ("sand=hard sand.zeta=5", "hard"), ("sand.zeta=2.5", "custom"),
            ("sand=soft sand.coefficients.A00=0.3", "custom"), ("sand.name=dune sand.zeta=1.4", "dune"),
        ):  # fmt: skip
            assert build.make_sand(composed(*words.split()).sand).name == name

    def test_an_accuracy_is_called_what_it_is(self):
        picked = build.make_accuracy(composed("accuracy.tolerance=0.02").accuracy)  # beside the default name
        assert picked == fo.Accuracy.within(0.02)
        assert picked.name == "within 0.02"

    def test_parts_of_an_accuracy_are_set_by_hand_over_a_preset(self):
        fine = fo.Accuracy.named("fine")
        mine = build.make_accuracy(composed("accuracy=fine", "accuracy.plates=300").accuracy)
        assert (mine.plates, mine.dt, mine.name) == (300, fine.dt, "custom")


class TestMultirun:
    @pytest.mark.slow
    def test_every_job_has_a_folder_and_a_row_and_a_failed_one_stops_no_other(self, tmp_path):
        done = footopt("-m", "solver=ga,nsga2", "foot.n=5,3", *QUICK, cwd=tmp_path)
        assert done.returncode == 1
        assert "2 of the jobs failed" in done.stderr
        (summary,) = tmp_path.rglob("summary.csv")
        with open(summary, newline="") as file:
            rows = list(csv.DictReader(file))
        assert [r["job"] for r in rows] == [str(i) for i in range(4)]
        assert (summary.parent / "report.html").is_file()
        failed = [r for r in rows if "foot.n=3" in r["overrides"]]
        assert all("foot.n = 3: must be" in r["note"] for r in failed)
        good = [r for r in rows if "foot.n=5" in r["overrides"]]
        assert len(failed) == len(good) == 2
        assert all(float(r["distance"]) > 1 and r["k"] and not r["note"] for r in good)
        for job in (0, 2):
            assert (summary.parent / str(job) / "result.json").is_file()


@pytest.mark.slow
def test_three_sands_and_two_solvers_are_six_jobs(tmp_path):
    done = footopt("-m", "sand=soft,regular,hard", "solver=ga,nsga2", *QUICK, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    (summary,) = tmp_path.rglob("summary.csv")
    assert len(list(summary.parent.glob("*/result.json"))) == 6
    with open(summary, newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 6
    hard = [float(r["distance"]) for r in rows if "sand=hard" in r["overrides"]]
    soft = [float(r["distance"]) for r in rows if "sand=soft" in r["overrides"]]
    assert min(hard) > max(soft)


BAD = {
    "sand=mud": "sand = 'mud': must be one of",
    "sand.zeta=0": "sand.zeta = 0.0: must be a number > 0",
    "accuracy.plates=1": "accuracy.plates = 1: must be a whole number from 2 to 20000",
    "accuracy.stepper=leapfrog": "accuracy.stepper = 'leapfrog': must be one of",
    "scene.t_f=0.9": "scene.t_f = 0.9: must be later than the first heel strike at 1.1 s",
    "scene=stand": "stands still",
    "gait=file": "gait.path = None",
    "gait=file gait.path=missing.csv": "gait.path = 'missing.csv': cannot be read",
    "gait=file gait.path=broken.csv": "the header lacks thigh, knee",
    "sand=custom sand.table=missing.csv": "sand.table = 'missing.csv': cannot be read",
    "solver=ga objective=pareto": "solver = 'ga': must be a solver of several objectives",
    "objective.names=[speed]": "objective.names = 'speed': must be made of distance",
    "study=simulate foot.k=[0,2,3,4,5,6,7,8,8,8,8]": "foot.k[0] = 0.0: must be a whole number",
    "study=simulate foot.k=[1.5,2,3,4,5,6,7,8,8,8,8]": "foot.k",
    "study=simulate foot.k=[1,2,3]": "foot.k = [1, 2, 3]: must be 11 heights",
    "hydra.run.dir=a_file": "a_file",
    "hydra.run.dir=a_file/below": "a_file",
    "accuracy.name=fein": "accuracy.name = 'fein': must be one of draft, standard, fine, reference, custom.",
    "study=sensitivity engine.threads=-1": "engine.threads = -1: must be a whole number >= 1 and <= 4096",
    "study=accuracy study.feet=-60": "study.feet = -60: must be a whole number, 1 to 10,000",
    "accuracy.tolerance=1e-9": "accuracy.tolerance = 1e-09: must be at least",
    "study.finalists=0": "study.finalists = 0: must be a whole number >= 1",
    "study.confirm=best": "accuracy = 'best': must be one of",
    "study=export": "study.run = None: must be the folder of a run",
    "study=export run=a_file": "study.run = 'a_file': not the folder of a run with one foot",
    "study=simulate foot=outline": "foot.path = None: must be a drawing",
    "study=simulate foot.path=sole.dxf": "foot.path = 'sole.dxf': must be null without foot=outline",
    "study=simulate foot=outline foot.path=a.doc": "foot.path = 'a.doc': must be a file that ends in .dxf",
    "foot=outline foot.path=sole.dxf": "foot.shape = 'outline': must be waypoints for a search",
    "engine.threads=0": "engine.threads = 0: must be a whole number >= 1",
}


#: ... by the program itself too: before Hydra begins, by Hydra, and by a study.
IN_A_PROCESS = ("sand=mud", "hydra.run.dir=a_file", "gait=file gait.path=broken.csv")


@pytest.mark.parametrize(
    ("run", "arguments"),
    [*((footopt, words) for words in BAD), *((program, words) for words in IN_A_PROCESS)],
)
def test_bad_input_gets_one_clear_message(run, arguments, tmp_path):
    (tmp_path / "a_file").write_text("in the way\n")
    (tmp_path / "broken.csv").write_text("time,hip\n0,1\n")
    done = run(*arguments.split(), cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr.startswith("footopt: error: ")
    assert BAD[arguments] in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.rglob("result.json"))


def test_what_was_refused_leaves_no_folder_but_what_was_there_stays(tmp_path):
    for words in (["study=simulate", "gait=file", "gait.path=nowhere.trc"], ["foot.width=0"]):
        assert footopt(*words, cwd=tmp_path).returncode == 1
        assert footopt(*words, "hydra.run.dir=mine", cwd=tmp_path).returncode == 1
    assert not list(tmp_path.rglob(".hydra"))
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("mine")
    assert footopt("foot.width=0", "hydra.run.dir=mine", cwd=tmp_path).returncode == 1
    assert (tmp_path / "mine" / "notes.txt").read_text() == "mine"


#: What newcomers type, and what they are told.
MISTAKES = {
    "snad=soft": "snad: there is no such setting. Did you mean sand=soft?",
    "sand.zta=2": "sand.zta: there is no such setting. Did you mean sand.zeta=2?",
    "+sand.density=1600": "sand.density: there is no such setting. Those of sand: name, zeta, ",
    "seed=3": "seed: there is no such setting. Did you mean solver.seed=3?",
    "effects.slope=5": "effects.slope: holds several settings. Try effects.slope.angle=...",
    "sand=Hard": "sand = 'Hard': must be one of custom, glass_beads, hard, ",
    "-m sand=Hard,soft": "Did you mean hard?",
    "study=optimise": "Did you mean optimize?",
    "effects=[slop]": "Did you mean slope?",
    "sand=2.5": "A number needs its name, such as sand.zeta=2.5.",
    "sand=soft,hard": "sand = 'soft,hard': must be one choice. For a run of each: footopt -m sand=soft,hard",
    "effects=slope,inertia": "For both at once: effects=[slope,inertia]",
    "effects.slope.angle=5": "Try effects=slope effects.slope.angle=5",
    "effects=inertia effects.layers.depths=[0.1]": "Try effects=layers effects.layers.depths=[0.1]",
    "sand soft": "sand: settings are given as name=value. Try sand=soft",
    "optimize": "optimize: settings are given as name=value. Try study=optimize",
    "sotf": "Did you mean sand=soft?",
    "help": "Try footopt --help",
    "--sand.zeta=2": "--sand.zeta=2: settings have no dashes. Try sand.zeta=2",
    "sand.zeta=loose": "sand.zeta = 'loose': must be a number.",
    "sand.zeta=": "sand.zeta = '': must be a number.",
    "sand.zeta=2,5": "sand.zeta = '2,5': must be without a comma. Try sand.zeta=2.5 for a number",
    "solver.n_gen=10.5": "solver.n_gen = '10.5': must be a whole number.",
    "study.quick=maybe": "study.quick = 'maybe': must be true or false.",
    "foot.k=[1,x]": "foot.k = '[1,x]': must be a list of whole numbers.",
    "foot.k=5": "foot.k = '5': must be a list in brackets. Try 'foot.k=[5]'",
    "foot.k=[1,2,3": "foot.k=[1,2,3: the list does not end. Try 'foot.k=[1,2,3]'",
    "foot.k=[1, 2, 3]": "Leave out its spaces, or quote it: 'foot.k=[1, 2, 3]'",
    "foot.k=1,2,3": "Try 'foot.k=[1,2,3]' for a list",
    "foot.path=a,b.dxf": "'foot.path=\"a,b.dxf\"' for a text",
    "study=simulate foot.k=[1,2,3]": "These are 3: give 11 of 1 to 10, or change foot.n.",
    "study.confirm=fien": "Did you mean fine?",
    "study=stability study.cases=[spiky]": "Did you mean spiky soles?",
}


@pytest.mark.parametrize("arguments", MISTAKES)
def test_a_mistake_is_told_with_what_to_try(arguments, tmp_path):
    done = footopt(*arguments.split(" "), cwd=tmp_path)
    said = done.stderr
    assert done.returncode == 1
    assert said.startswith("footopt: error: ")
    assert MISTAKES[arguments] in said
    assert "hydra" not in said.lower()
    assert not list(tmp_path.rglob("result.json"))


@pytest.mark.parametrize(
    ("word", "read"),
    {
        "gait.path=Größe.trc": "Größe.trc",
        "gait.path=my walk(1).trc": "my walk(1).trc",
        "gait.path=it's=mine{2}.trc": "it's=mine{2}.trc",
        "gait.path=a[1].trc": "a[1].trc",
        "gait.path='Größe 1.trc'": "Größe 1.trc",
        "gait.path=a\\(1\\).trc": "a(1).trc",
        "gait.path=null": None,
        "gait.path=C:\\Jörg\\a.trc": "C:\\Jörg\\a.trc",
        "gait.path=~/a.trc": "/at/home/a.trc",
        "study.runs=[Läufe/*, b, ~/c]": ["Läufe/*", "b", "/at/home/c"],
        "study.runs=['a, ü','b']": ["a, ü", "b"],
        "study.runs=[]": [],
        "run=grün [1], it's": "grün [1], it's",
        "sand.name=~/x": "~/x",
    }.items(),
)
def test_files_may_have_any_name(word, read, monkeypatch):
    monkeypatch.setenv("HOME", "/at/home")
    quoted = readable(word)
    if word.startswith("sand"):
        assert quoted == word
    else:
        assert OverridesParser.create().parse_override(quoted).value() == read


def test_files_with_any_name_are_jobs_of_a_multirun():
    words = {
        "gait.path=ä.trc,b.trc": ["ä.trc", "b.trc"],
        "gait.path=choice(b.trc,c.trc)": ["b.trc", "c.trc"],
    }
    for word, jobs in words.items():
        swept = OverridesParser.create().parse_override(readable(word))
        assert [job.strip("'") for job in swept.sweep_string_iterator()] == jobs


def test_the_version_is_ours(tmp_path):
    done = footopt("--version", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, f"footopt {fo.__version__}\n")


def test_a_traceback_on_request(tmp_path):
    assert "Traceback" in program("sand.zeta=0", cwd=tmp_path, HYDRA_FULL_ERROR="1").stderr


def test_help_explains_the_groups(tmp_path):
    text = footopt("--help", cwd=tmp_path).stdout
    for group in GROUPS:
        assert f"  {group} " in text
        assert f"{group}: " in text


def test_shell_completion_knows_groups_and_options(tmp_path):
    done = program("-sc", "query=bash", cwd=tmp_path, COMP_LINE="footopt sand=", COMP_POINT="13")
    assert {"sand=soft", "sand=regular", "sand=hard"} <= set(done.stdout.split())


def test_a_named_sand_that_is_changed_loses_its_name():
    names = {
        ("sand=hard",): "hard",
        ("sand=hard", "sand.zeta=2.5"): "custom",
        ("sand=soft", "sand.coefficients.A00=0.3"): "custom",
        ("sand=hard", "sand.zeta=2.5", "sand.name=mine"): "mine",
    }
    for words, name in names.items():
        assert build.make_sand(composed(*words).sand).name == name


@pytest.mark.parametrize("choice", [f"{p.parent.name}={p.stem}" for p in sorted(CONF.glob("*/*.yaml"))])
def test_every_yaml_file_composes_and_builds(choice):
    config = composed(choice)
    group, name = choice.split("=")
    if choice not in ("gait=file", "effects=auto"):
        build.make_scene(config)
    build.make_accuracy(config.accuracy)
    if choice != "foot=outline":
        build.make_foot(config.foot)
    if group in ("study", "sand", "gait", "scene", "accuracy", "solver"):
        assert getattr(config, group).name == name


def test_presets_are_the_same_from_yaml_and_from_python():
    from footopt.sand import MEDIA
    from footopt.walk import PRESETS

    for name, accuracy in PRESETS.items():
        assert build.make_accuracy(composed(f"accuracy={name}").accuracy) == accuracy
    for name in MEDIA:
        assert build.make_sand(composed(f"sand={name}").sand) == fo.Sand.named(name)
    assert build.make_scene(composed()) == fo.Scene()
    assert build.make_space(composed().foot) == fo.Waypoints()
    assert {p.stem for p in (CONF / "study").iterdir()} == set(STUDIES)


@pytest.mark.parametrize(("solver", "names"), [("ga", 1), ("nsga2", 5)])
def test_a_solver_brings_its_objective_and_the_command_line_wins(solver, names):
    assert len(composed(f"solver={solver}").objective.names) == names
    assert composed(f"solver={solver}", "objective.names=[work]").objective.names == ["work"]
    assert composed("solver=nsga2", "objective=efficiency").objective.names == ["efficiency"]
    assert composed("scene=stand", "gait.start=1.0").gait.start == 1.0


def test_a_table_of_stresses_from_the_command_line(tmp_path):
    angles = [(b, g) for b in range(-80, 90, 20) for g in range(-180, 180, 20)]
    with open(tmp_path / "stress.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["beta", "gamma", "alpha_x", "alpha_z"])
        for b, g in angles:
            ax, az = fo.stress.alpha(np.radians(b), np.radians(g))
            writer.writerow([b, g, ax / 1e6, az / 1e6])
    sand = build.make_sand(
        composed("sand=custom", f"sand.table={tmp_path / 'stress.csv'}", "sand.zeta=2").sand
    )
    assert sand.zeta == 2.0
    assert sand.stress_map.B01 == pytest.approx(0.358)


def test_nine_coefficients_from_the_command_line(tmp_path):
    nine = {
        "A00": 0.2,
        "A10": 0.1,
        "B11": 0.2,
        "B01": 0.3,
        "Bm11": 0.05,
        "C11": -0.1,
        "C01": 0.2,
        "Cm11": 0.01,
    }
    changed = [f"sand.coefficients.{name}={value}" for name, value in nine.items()]
    sand = build.make_sand(composed("sand=custom", *changed).sand)
    assert sand.stress_map == fo.StressMap(0.2, 0.1, 0.2, 0.3, 0.05, -0.1, 0.2, 0.01, 0.088)
    assert build.make_sand(composed("sand=custom").sand).stress_map == fo.StressMap()
    with pytest.raises(SettingError, match=r"sand\.table = 'x\.csv': must be null when"):
        build.make_sand(composed("sand=custom", *changed, "sand.table=x.csv").sand)
