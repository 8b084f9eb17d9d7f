"""The choices that the paper leaves open, and the walks of its feet for one set of them."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib.resources import files
from math import nan
from typing import Any

import numpy as np
import yaml

from footopt.arrays import Array
from footopt.design import FootProblem, Solver, search
from footopt.design.store import digest, key_of, typed_json
from footopt.effects import EFFECTS
from footopt.errors import check
from footopt.foot import SHAPES, Foot, lower_hull
from footopt.sand import Sand
from footopt.studies import Paper
from footopt.studies.build import make_accuracy, make_foot, make_scene, make_space
from footopt.studies.settings import Config, shown
from footopt.walk import OBJECTIVES, Walk, simulate
from footopt.walk.accuracy import resolve
from footopt.walk.objectives import SLOW

SANDS = ("soft", "regular", "hard")
SWITCHES = 3  # stance switches that the paper names: t = 1.1, 1.7, 2.3 s
LIFTED = 0.05  # of the weight: a foot that carries less does not stand

#: Designs that a search evaluates unless the settings say otherwise: `memetic` finds the best sole of every
#: sand in fewer, that of the best of five seeds of a GA of 100 x 100.
EVALUATIONS = 3000

#: About each heel strike, from and to when a fall counts, in strides, by how dV_x is read ("walk": always).
SPEED_LOSS = {"walk": (1 / 4, 1 / 2), "window": (1 / 4, 1 / 4), "narrow": (1 / 8, 1 / 8)}

#: Settings that the paper leaves open, and their values; the first is the default.
CHOICES: dict[str, list[Any]] = yaml.safe_load((files(__package__) / "choices.yaml").read_text("utf-8"))


def changed(config: Config, choice: str, value: Any) -> Config:
    """A copy of the settings with one of them changed, or one more effect."""
    if choice == "effects":
        choice, value = f"effects.{value}", EFFECTS[value]()
    group, name = choice.split(".")
    return replace(config, **{group: replace(getattr(config, group), **{name: value})})


def changes(config: Config) -> Iterator[tuple[str, Config]]:
    """Yield the settings with each open choice made otherwise, one at a time, named "choice=level"."""
    for choice in CHOICES if config.study.cases is None else config.study.cases:
        check(choice in CHOICES, "study.cases", choice, f"some of {', '.join(CHOICES)}")
        group, _, name = choice.partition(".")
        own = getattr(getattr(config, group), name) if name else None
        for level in CHOICES[choice]:
            if level != own:
                yield f"{choice}={shown(level)}", changed(config, choice, level)


@contextmanager
def objective(study: Paper) -> Iterator[str]:
    """A measure of J_W, by its name, with p_max and dV_x as the settings read them; it exists in the block.

    Any reading but the default needs the traces of every walk.
    """
    own, name = OBJECTIVES["efficiency"], "efficiency"
    if (study.peak_power, study.speed_loss) != ("stance", "walk"):
        name = f"efficiency_{study.peak_power}_{study.speed_loss}"
        SLOW[name] = replace(
            own, name=name, of="walk", value=lambda walk: read(walk, study).objectives["efficiency"]
        )
    try:
        yield name
    finally:
        SLOW.pop(name, None)


def read(walk: Walk, study: Paper) -> Walk:
    """The walk with p_max and dV_x, which the paper does not define, as the settings read them.

    "single" counts p_max only while the other foot carries less than `LIFTED` of the weight; "narrow" is a
    window about a heel strike that is about as long as both feet stand. J_W follows.
    """
    totals = dict(walk.totals)
    if walk.feasible and study.peak_power == "single":
        totals["peak_power"] = single_stance_power(walk)
    if walk.feasible and study.speed_loss != "walk":
        totals["speed_loss"] = max(_falls(walk, study.speed_loss), default=nan)
    return replace(walk, totals=totals)


def single_stance_power(walk: Walk) -> float:
    """The largest |sum f.v| of a foot that stands alone, W; NaN if none ever does."""
    after = walk.t >= walk.scene.gait.heel_strike
    alone = np.abs(walk.force[after, ::-1, 1]) < LIFTED * walk.scene.walker.weight
    return float(np.abs(walk.power[after])[alone].max()) if alone.any() else nan


def switch_losses(walk: Walk, speed_loss: str) -> Array:
    """The fall of V_x about each of the paper's three switches, (3,), m/s; NaN where there is none."""
    return np.array([*_falls(walk, speed_loss), *[nan] * SWITCHES])[:SWITCHES]


def _falls(walk: Walk, speed_loss: str) -> list[float]:
    """The fall of V_x within the window of `SPEED_LOSS` about each heel strike, m/s."""
    gait, losses, (before, behind) = walk.scene.gait, [], SPEED_LOSS[speed_loss]
    for strike in gait.heel_strikes(walk.scene.duration) if walk.feasible else ():
        since, until = strike - before * gait.period, strike + behind * gait.period
        speed = walk.velocity[(walk.t >= since) & (walk.t <= until), 0]
        if strike < walk.t[-1]:
            losses.append(float((np.maximum.accumulate(speed) - speed).max(initial=0.0)))
    return losses


def evidence(config: Config, found: dict[str, list[int]]) -> dict[str, Walk]:
    """Search the best feet by J_W as it is read, and simulate all that claims need, by name.

    They are those of each sand's best foot and of the five shapes; "crossed", the foot for regular sand on
    hard sand; "filled", the foot for hard sand with its hollow filled up. `found` has the soles that searches
    have found, by their settings: no search is done twice.
    """
    study, solver = config.study, Solver(**vars(config.solver))
    for choice, allowed in CHOICES.items():
        group, _, name = choice.partition(".")
        if group == "study":
            value = getattr(study, name)
            check(value in allowed, choice, value, f"one of {', '.join(allowed)}")
    if not (solver.walks or solver.n_gen):
        solver = replace(solver, walks=EVALUATIONS)
    space, accuracy, scene = make_space(config.foot), make_accuracy(config.accuracy), make_scene(config)
    confirm = resolve(study.confirm, "study.confirm") if study.confirm else accuracy
    scene.check_comparable()
    scenes = {sand: replace(scene, sand=Sand.named(sand)) for sand in SANDS}

    def best(sand: str) -> Foot:
        with objective(study) as name:  # a measure of samples needs the accuracy of the claims
            finely = accuracy if name == "efficiency" else confirm
            problem = FootProblem(scenes[sand], name, space, finely, config.engine.threads)
            key = digest([key_of(problem), typed_json(space), typed_json(solver)])
            if key not in found:
                found[key] = [int(height) for height in search(problem, solver).foot.k or ()]
        return replace(Foot.from_waypoints(found[key], space), name=sand)

    def walk(foot: Foot, sand: str) -> Walk:
        return read(simulate(foot, scenes[sand], confirm), study)

    shapes = {name: make_foot(replace(config.foot, shape=name)) for name in SHAPES}
    feet = {sand: best(sand) for sand in SANDS}
    hull = lower_hull(feet["hard"].contour)[0]
    filled = replace(feet["hard"], contour=hull, name="filled", k=None, space=None)
    return (
        {sand: walk(foot, sand) for sand, foot in feet.items()}
        | {name: walk(foot, study.shape_sand) for name, foot in shapes.items()}
        | {"crossed": walk(feet["regular"], "hard"), "filled": walk(filled, "hard")}
    )
