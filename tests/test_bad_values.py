"""The table of bad values: the library refuses each by the name of its setting, wherever it is given."""

import math
import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from motion_files import HUMAN, degrees

import footopt as fo
from footopt.design import Choice, Solver, make_executor
from footopt.design.solvers import register
from footopt.effects import Effect
from footopt.errors import FileError, SettingError
from footopt.files.feet import body_outline
from footopt.walk.objectives import lookup, objective


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
SHORT, LONG = fo.Scene(t_f=0.5), fo.Scenario("long", fo.Scene())
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
    *several("angles", lambda t: fo.fit_gait(t, t, t), [], [[1.0]], 3.0),
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
    *several("scene.t_f", lambda s: fo.RobustProblem([LONG, s], references=[1, 1]), fo.Scenario("a", SHORT)),
]


@pytest.mark.parametrize("row", range(len(LIBRARY)), ids=lambda row: f"{LIBRARY[row][0]}-{row}")
def test_the_library_names_the_setting_of_a_value_that_cannot_be(row):
    setting, call = LIBRARY[row]
    with pytest.raises(SettingError, match=rf"^{re.escape(setting)} = ") as caught:
        call()
    assert caught.value.setting == setting


@pytest.mark.parametrize("last", [60.0, 80.0, 200.0, 2.0 * math.pi])
def test_a_table_by_phase_is_of_one_whole_stride(last, tmp_path):
    def write(last):
        phase = np.linspace(0.0, last, 51)
        rows = zip(phase, *degrees(HUMAN, np.linspace(0.0, 1.0, 51)).values(), strict=True)
        (tmp_path / "a.csv").write_text(
            "percent,thigh,knee,foot\n" + "\n".join(",".join(map(str, row)) for row in rows)
        )

    write(last)
    with pytest.raises(FileError, match="whole stride"):
        fo.read_gait(tmp_path / "a.csv")
    write(100.0)
    for setting, value in {"window": (0.1, 0.9), "names": {"pelvis": "tilt"}}.items():
        with pytest.raises(SettingError, match=f"gait.{setting}"):
            fo.read_gait(tmp_path / "a.csv", **{setting: value})
