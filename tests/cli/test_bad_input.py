"""The tables of bad inputs: each is refused by the name of its setting and its value, and leaves nothing."""

import math
import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from running import footopt, program

import footopt as fo
from footopt.design import Choice, Solver, make_executor
from footopt.design.solvers import register
from footopt.effects import Effect
from footopt.errors import SettingError
from footopt.files.feet import body_outline
from footopt.walk.objectives import lookup, objective

#: Words of a command, and what the message names.
COMMANDS = {
    # names and choices that are not there
    "sand=quicksand": "sand = 'quicksand'",
    "sand=2.5": "sand.zeta=2.5",
    "solver=[ga,nsga2]": "footopt -m solver=ga,nsga2",
    "snad=soft": "sand=soft",
    "effects.slope.angle=5": "effects=slope effects.slope.angle=5",
    "foot.L=${foot.hight}": "foot.hight",
    # words that cannot be read
    "sand soft": "sand",
    "sand=soft,hard": "sand=soft,hard",
    "foot.k=[1, 2, 3]": "foot.k=[1,",
    "resume=": "resume = ''",
    # values of another kind
    "sand.zeta=loose": "sand.zeta = 'loose'",
    "study=simulate sand.coefficients=3": "sand.coefficients.A00",
    # values that the library refuses
    "foot.block=[1,0.02]": "foot.block = [1.0, 0.02]",
    "study=compare": "study.runs = []",
    "solver=ga objective=pareto": "solver = 'ga'",
    "gait=file gait.path=broken.csv": "gait.path = 'broken.csv'",
    # what would take years or all memory
    "study=effects study.feet=1000000000": "study.feet",
    "study=simulate scene.t_f=1e6": "scene.t_f",
    "objective=torque": "objective",
    "study.draws=3": "study.draws",
}
#: Each is refused much as one above is.
LIKEWISE = {
    "sand=custom sand.table=[1]": "sand.table = '[1]': must be one word",
    "sand=hard sand.table=broken.csv": "sand.table = 'broken.csv'",
    "gait=steps/human.csv": "gait = 'steps/human.csv'",
    "seed=3": "solver.seed=3",
    "+sand.density=1600": "sand.density",
    "constraint.speed=3": "constraint.speed_loss=3",
    "optimize": "study=optimize",
    "=5": "=5",
    "effects=slope,inertia": "effects=[slope,inertia]",
    "gait.path=Größe(1).mot": "gait.path=\"'Größe(1).mot'\"",
    "solver.n_gen=2.5": "solver.n_gen = '2.5'",
    "foot.k=5": "foot.k = '5'",
    "plugins=[mine.py]": "plugins = 'mine.py'",
    "study=simulate foot.k=[1,2,3]": "foot.k = [1, 2, 3]",
    "study=validate study.cases=[Wheel]": "study.cases = ['Wheel']",
    "study=calibrate study.tests=broken.csv": "study.tests = 'broken.csv'",
    "study=export": "run = None",
    "foot=outline foot.path=sole.dxf": "foot = 'outline'",
    "choose=limits objective=pareto": "choose.limits",
    "simulator=robot": "robot.model = None",
    "simulator=biped walker.mass=20": "walker.mass",
    "robot.duration=3": "robot.duration",
    "objective=distance,work": "'objective=[distance,work]'. For a run of each: footopt -m",
    "solver={a:1}": "footopt --help solver",
    "study.confirm=fien": "study.confirm = 'fien'",
    "constraint.colour=9": "constraint.colour",
    "simulator=biped robot.feet=[left_hoof,right_hoof]": "robot.feet = 'left_hoof'",
    "simulator=biped robot.controller=steps.csv": "robot.controller = 'steps.csv'",
    "study=simulate foot.length=.18": "foot.length = 0.18",
    "study=compare planet=moon": "walker.g = 1.62",
    "choose=knee": "choose.name = 'knee'",
    "solver=nsga2 sand=[1,2]": "sand = '[1,2]'",
    "study=simulate foot=[1,2,[3]]": "foot.k = [1, 2, [3]]",
    "simulator=biped robot.joints={a:{b:1}}": "robot.joints = {'a': {'b': 1}}",
    "effects=slope effects.slope.zeta=5": "effects.slope.zeta",
    "sand.zeta=2,5": "sand.zeta = '2,5'",
    "study=robust study.reuse=maybe": "study.reuse = 'maybe'",
    "plugins=mine.py": "plugins = 'mine.py'",
    "simulator=biped robot.controller=broken.csv:f": "robot.controller = 'broken.csv:f'",
    "study.laws=-1": "study.laws = -1",
    "study=paper study.cases=[foot.colour]": "study.cases",
    "study=stability study.cases=[flying]": "study.cases",
    "study=robust study.measure=median": "study.measure = 'median'",
    "study=transfer study.sands=[mud]": "study.sands",
    "gait=file": "gait.path = None",
    "simulator=robot robot.model=mine.xml": "robot.model",
    "simulator=biped robot.feet=[left_foot,right_foot,torso]": "robot.feet",
    "simulator=biped robot.joints={knee:left_hip}": "joints = 'knee'",
    "objective=[torque]": "objective.names = 'torque'",
    "study=simulate solver.n_gen=3": "solver.n_gen = 3",
}


@pytest.mark.parametrize(
    "arguments", [*COMMANDS, *(pytest.param(words, marks=pytest.mark.slow) for words in LIKEWISE)]
)
def test_a_command_that_is_refused_names_setting_and_value_and_leaves_nothing(arguments, tmp_path):
    (tmp_path / "broken.csv").write_text("time,hip\n0,1\n")
    done = footopt(*arguments.split(" "), cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr.startswith("footopt: error: ")
    assert done.stderr.count("\n") == 1
    assert (COMMANDS | LIKEWISE)[arguments] in done.stderr
    assert "unexpected" not in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["broken.csv"]


@pytest.mark.slow
def test_a_process_ends_with_the_message_and_its_exit_code(tmp_path):
    done = program("sand.zeta=0", cwd=tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (1, 1)
    assert done.stderr.startswith("footopt: error: sand.zeta = 0")
    done = program("--version", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, f"footopt {fo.__version__}\n")


@pytest.mark.parametrize(
    "place", ["results", pytest.param("..", marks=pytest.mark.slow), ".", "results/deep"]
)
def test_a_refused_run_removes_no_folder_that_was_there(place, tmp_path):
    """Not even one with nothing in it but folders and links."""
    here = tmp_path / "above" / "here"
    for folder in ("results/empty", "results/deep", "linked"):
        (here / folder).mkdir(parents=True)
    (here / "results" / "link").symlink_to(here / "linked")
    before = sorted(tmp_path.rglob("*"))
    done = footopt("study=simulate", "foot.width=-1", f"hydra.run.dir={place}", cwd=here)
    assert "foot.width" in done.stderr
    assert sorted(tmp_path.rglob("*")) == before


def each(group, make, **values):
    """A setting of a group and a call with a value of it, for each value."""
    return [(f"{group}.{name}", partial(make, **{name: value})) for name in values for value in values[name]]


def several(setting, make, *values):
    """The same of a setting that a call takes by its place."""
    return [(setting, partial(make, value)) for value in values]


def built(solver, **operators):
    return Solver(solver, operators=operators).build(1)


def chosen(limit):
    return fo.FootProblem(objective=["distance", "hollow"], choose=Choice("limits", limits={"hollow": limit}))


def own(name):
    """A function of a plugin, with a name that it may share with one of footopt's."""
    exec(f"def {name}(*given): pass", namespace := {"__name__": "plugin"})
    return namespace[name]


FLAT, CIRCLE = fo.Foot.flat(), fo.Foot.shape("circle", closed=True)
NOT_ABOVE_ZERO = (0.0, -1.0, math.nan, math.inf)
SHORT = fo.Scene(t_f=0.5)
#: Settings, and calls of the library with a value that each cannot have.
LIBRARY = [
    *each("accuracy", fo.Accuracy, stepper=["leapfrog"], rule=["square"], dt=[0.0, 1.5, math.nan]),
    *each("accuracy", fo.Accuracy, plates=[1, 50.0, True, "24"], creep=NOT_ABOVE_ZERO),
    *several("accuracy.tolerance", fo.Tolerance, 0.0, 1e-9, 1.0, math.nan),
    *each("walker", fo.Walker, mass=NOT_ABOVE_ZERO, l1=NOT_ABOVE_ZERO, l2=NOT_ABOVE_ZERO, g=NOT_ABOVE_ZERO),
    *each("scene", fo.Scene, t_f=NOT_ABOVE_ZERO),
    *several("scene.t_f", partial(fo.evaluate, [FLAT]), SHORT),
    *each("effects.inertia", fo.Inertia, factor=[-1.0, math.nan], rho=[-1.0, math.nan]),
    *each("effects.slope", fo.Slope, angle=[30.0, -25.1, math.nan]),
    *several("effects.layers.depths", lambda at: fo.Layers(at, (1.0,) * len(at)), (), (0.0,), (0.05, 0.02)),
    *several("effects.layers.factors", lambda f: fo.Layers((0.02,), f), (1.0, 2.0), (0.0,), (math.nan,)),
    *several("effects.patches.ends", lambda end: fo.Patches((0.2,), end, (2.0,)), (), (0.1,), (math.inf,)),
    *several("effects.patches.begins", lambda at: fo.Patches((0.3, at), (0.6, 0.9), (0.3, 0.3)), 0.5),
    *several("effects.patches.factors", lambda f: fo.Patches((0.1,), (0.2,), f), (), (-1.0,)),
    *each("effects.patches", fo.Patches, blur=[0.0, math.nan]),
    *several("effects", lambda two: fo.Scene(effects=two), (fo.Slope(1.0), fo.Slope(2.0))),
    *several("effects", lambda kind: fo.Scene(effects=(kind(),)), type("A", (Effect,), {"__hash__": None})),
    *several("plugins", lambda name: objective("", "", False, 1.0)(own(name)), "work", "hollow"),
    *several("plugins", lambda name: register(own(name)), "ga"),
    *several("plugins", lambda name: type("Own", (Effect,), {}, name=name), "rest"),
    *several("sand", fo.Sand.named, "concrete"),
    *each("sand", fo.Sand, zeta=[0, *NOT_ABOVE_ZERO, "5", None, True]),
    *each("sand.coefficients", fo.StressMap, B01=[math.nan, math.inf, 1.1e4]),
    *each("gait", fo.Gait.human, period=[0.0, math.inf, math.nan], start=[-0.1, math.nan], pitch=["ankle"]),
    *several("gait.pitch", lambda pitch: replace(fo.Gait.human(), foot=None, pitch=pitch), "measured"),
    *several("foot.shape", fo.Foot.shape, "clown"),
    *each("foot", partial(fo.Foot.shape, "circle"), length=[0.0, math.nan], width=[-1.0]),
    *each("foot", partial(fo.Foot.shape, "reversed_l"), upright=["middle"]),
    *each("foot", partial(fo.Foot.shape, "reversed_triangle"), apex=["heel"], ankle=[(0.0, math.inf)]),
    *each("foot", fo.Waypoints, n=[3, 201, 11.0, True], K=[0, 2.5], L=[0.0], H=[-0.03, math.nan]),
    *each("foot", fo.Waypoints, ankle=[(0.0,), (0.0, math.nan)], box_tolerance=[-0.1, math.nan]),
    *several("foot.k", fo.Foot.from_waypoints, 3, [1, 2, "x", 3], [[1, 2, 3, 4], [1, 2, 3, 4]]),
    *several("foot.k[2]", fo.Foot.from_waypoints, [1, 2, 0, 3], [1, 2, 2.5, 3], [1, 2, math.nan, 3]),
    *several("foot.n", fo.Foot.from_waypoints, [1, 2, 3], []),
    *several("foot.n", lambda n: fo.search(fo.FootProblem(space=fo.Waypoints(n)), "exhaustive"), 11, 200),
    *several("foot.contour", fo.Foot, np.zeros((1, 2)), np.zeros(4), [[0.0, 0.0], [math.nan, 1.0]]),
    *several("foot.contour", fo.Foot, 1e3 * FLAT.contour),  # in mm
    *several("foot.closed", fo.evaluate, [FLAT, CIRCLE]),
    *several("feet", partial(fo.evaluate, accuracy=fo.Accuracy()), []),
    *each("foot", partial(fo.Foot, FLAT.contour), top=[math.nan]),
    *several("foot.block", partial(body_outline, FLAT), (0.3, 0.02), (0.06, 0.0), (-0.1, 0.1), (0.06,)),
    *several("objective.names", lookup, [], ["speed"], ["work", "work"]),
    *each("solver", Solver, name=["sa"], pop_size=[3, 10**6], n_gen=[0, 10**7], seed=[-1]),
    *each("solver", Solver, walks=[0], seconds=[0]),
    *several("solver.operators", lambda name: built("ga", **{name: 0.5}), "CR", "F"),
    *each("solver.operators", partial(built, "ga"), mutation_prob=[90]),
    *several("solver.pop_size", lambda size: Solver("rvea", size).build(5), 5000),
    *several("constraint", lambda name: fo.FootProblem(limits={name: 1.0}), "colour"),
    *several("constraint.work", lambda limit: fo.FootProblem(limits={"work": limit}), math.nan, "much"),
    *several("constraint.hollow", lambda limit: fo.FootProblem(limits={"hollow": limit}), -3, math.inf),
    *several("choose.limits.hollow", chosen, -3, math.inf),
    *several("engine", make_executor, "mpi"),
    *each("engine", partial(fo.evaluate, [FLAT]), threads=[0, 10**9]),
    *each("engine", partial(make_executor, "processes"), workers=[0]),
    *each("study.spread", fo.Spread, zeta=[-0.1], mass=[math.inf], angles=[31.0]),
    *several("study.draws", partial(fo.draw, fo.Scene(), fo.Spread()), 0),
    *several("scene.t_f", lambda s: fo.RobustProblem([s], references=np.ones(1)), fo.Scenario("a", SHORT)),
]


@pytest.mark.parametrize("row", range(len(LIBRARY)), ids=lambda row: f"{LIBRARY[row][0]}-{row}")
def test_the_library_names_the_setting_of_a_value_that_cannot_be(row):
    setting, call = LIBRARY[row]
    with pytest.raises(SettingError, match=rf"^{re.escape(setting)} = ") as caught:
        call()
    assert caught.value.setting == setting
