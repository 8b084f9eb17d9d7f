"""What the paper leaves open, and the walks of its feet for one way of choosing it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import inf
from typing import Any

from footopt.design import FootProblem, Solver, search
from footopt.design.store import context, digest, plain
from footopt.effects import EFFECTS
from footopt.errors import check
from footopt.files.tasks import Tasks
from footopt.foot import SHAPES, Foot
from footopt.sand import Sand
from footopt.studies.build import make_accuracy, make_foot, make_scene, make_space
from footopt.studies.paper.claims import SANDS, Evidence
from footopt.studies.paper.quantities import filled
from footopt.studies.paper.readings import Readings, read
from footopt.studies.settings import Config
from footopt.walk import Accuracy, Walk, simulate

#: Designs that a search evaluates unless the settings say otherwise: `memetic` finds the best sole of every
#: sand in fewer, that of the best of five seeds of a GA of 100 x 100.
EVALUATIONS = 3000


#: What the paper leaves open: settings, and what they may be; the first is the default.
CHOICES: dict[str, tuple[Any, ...]] = {
    "foot.ankle": ([0.0, 0.0], [-0.03, 0.0], [-0.06, 0.0], [0.0, 0.05]),
    "foot.width": (0.10, 0.05, 0.15),  # it acts like zeta
    "foot.apex": ("middle", "toe"),  # how the triangle stands
    "foot.upright": ("toe", "heel"),  # how the L stands
    "study.mount": ("centre", "top"),  # where the shank meets a shape
    "study.shape_sand": ("regular", "soft", "hard"),
    "gait.pitch": ("shank", "measured"),  # whether the ankle is locked or moves as measured
    "gait.harmonics": (6, 4, 2),  # which data the gait is
    "scene.t_f": (None, 2.6, 3.5),  # when the walk ends
    "study.speed_loss": ("walk", "window", "narrow"),
    "study.peak_power": ("stance", "single"),  # whether the formula or the text defines p_max
    "foot.box_tolerance": (0.05, inf),  # whether the spline may leave the box
    "solver.seed": (1, 2, 3),  # which random numbers the search draws
    "effects": (None, "leading_edge", "shadowing"),  # whether faces that trail, and grooves, feel sand
}


def changed(config: Config, setting: str, value: Any) -> Config:
    """Return the configuration with one setting changed, or one more effect; the one given is left alone."""
    if setting == "effects":
        setting, value = f"effects.{value}", EFFECTS[value]()
    group, name = setting.split(".")
    part = replace(getattr(config, group), **{name: value})
    return replace(config, **{group: part})


def changes(config: Config) -> Iterator[tuple[str, Config]]:
    """Yield the configuration with each open choice made otherwise, one at a time, as "setting=level"."""
    wanted = list(CHOICES) if config.study.cases is None else config.study.cases
    for setting in wanted:
        check(setting in CHOICES, "study.cases", setting, f"some of {', '.join(CHOICES)}")
        group, _, name = setting.partition(".")
        own = getattr(getattr(config, group), name) if name else None
        for level in CHOICES[setting]:
            if level != own:
                yield f"{setting}={shown(level)}", changed(config, setting, level)


def shown(level: Any) -> str:
    """Return a level as it is written on the command line."""
    if isinstance(level, list):
        return "[" + ",".join(f"{v:g}" for v in level) + "]"
    return "null" if level is None else str(level).replace("inf", ".inf")


def make_shapes(config: Config) -> dict[str, Foot]:
    """Return the five shapes by name; foot.ankle shifts the ankle from where `study.mount` puts it.

    That is the centre of the shape's bounding box, or the middle of its upper side, "top".
    """
    mount = config.study.mount
    check(mount in ("centre", "top"), "study.mount", mount, "one of centre, top")
    feet = {name: make_foot(replace(config.foot, shape=name)) for name in SHAPES}
    if mount == "centre":
        return feet
    # the box's centre is the origin, and every shape's contact line reaches its lower side
    return {
        name: replace(foot, ankle=(foot.ankle[0], foot.ankle[1] - float(foot.contour[:, 1].min())))
        for name, foot in feet.items()
    }


def evidence(config: Config, done: Tasks) -> Evidence:
    """Search the best feet by J_W as it is read, and walk all that claims need.

    Parameters
    ----------
    config : Config
        The settings.
    done : Tasks
        Where the soles that searches find are kept: no search is done twice.
    """
    study, solver, readings = config.study, Solver(**vars(config.solver)), Readings.of(config.study)
    check(study.shape_sand in SANDS, "study.shape_sand", study.shape_sand, f"one of {', '.join(SANDS)}")
    if not (solver.walks or solver.n_gen):
        solver = replace(solver, walks=EVALUATIONS)
    shapes, space, accuracy = make_shapes(config), make_space(config.foot), make_accuracy(config.accuracy)
    confirm = Accuracy.named(study.confirm) if study.confirm else accuracy
    scene = make_scene(config)
    scene.need_heel_strike()
    scenes = {sand: replace(scene, sand=Sand.named(sand)) for sand in SANDS}

    def best(sand: str) -> Foot:
        problem = FootProblem(scenes[sand], readings.objective(), space, accuracy, config.engine.threads)
        task = [sand, digest([context(problem), plain(space), plain(solver)])]
        k = done(task, lambda: [int(height) for height in search(problem, solver).foot.k or ()])
        return replace(Foot.from_waypoints(k, space), name=sand)

    def walk(foot: Foot, sand: str) -> Walk:
        return read(simulate(foot, scenes[sand], confirm), readings)

    feet = {sand: best(sand) for sand in SANDS}
    return Evidence(
        shapes={name: walk(foot, study.shape_sand) for name, foot in shapes.items()},
        optima={sand: walk(foot, sand) for sand, foot in feet.items()},
        crossed=walk(feet["regular"], "hard"),
        filled=walk(filled(feet["hard"]), "hard"),
        readings=readings,
    )
