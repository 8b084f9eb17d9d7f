"""study=effects: the changes that each effect makes in a scene, and its cost; `effects=auto` follows them."""

import os
import statistics
import time
from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from rich.table import Table

from footopt.arrays import Array
from footopt.design.to_print import drafted
from footopt.effects import EFFECTS, Effect, name_of, parameters
from footopt.errors import check, check_whole
from footopt.foot import Foot, Waypoints
from footopt.report import terminal
from footopt.report.numbers import percent
from footopt.report.output import scene_entry
from footopt.studies.build import make_scene
from footopt.studies.runs import Study
from footopt.studies.settings import Config
from footopt.walk import FIVE, Scene, Simulator, evaluate
from footopt.walk.accuracy import TOLERANCES, AnyAccuracy
from footopt.walk.ladder import numerics
from footopt.walk.objectives import relative_change

#: Processor time of this thread, s, whatever else the machine does. That of Windows is too coarse (1/64 s).
own_time = time.perf_counter if os.name == "nt" else time.thread_time
QUANTILE = 95.0  # of the feet: the change that this share of them does not exceed, as for accuracy, %
REPEATS = 3  # of the evaluations that are timed
TOLERANCE = 0.01  # where neither the effects nor the accuracy state one
RANDOM_FEET = 40  # that decide for a search


class Audit(NamedTuple):
    """The changes that one effect makes in a scene."""

    effect: Effect
    changes: Array  # (FIVE,), relative, not exceeded by 95 % of the feet; NaN if no foot walks in both
    shifts: Array  # (FIVE,), the median change with its sign
    gain: float  # the median ratio of J_W with it to J_W without
    kendall_tau: float  # Kendall's, of J_W over the feet without and with it: 1 is the same ranking
    walks_lost: int  # feet that walk without it and fail with it
    time_ratio: float  # time of a walk with it over that without it
    tolerance: float  # the relative change that matters

    @property
    def name(self) -> str:
        """The effect, in words."""
        return name_of(self.effect).replace("_", " ")

    @property
    def matters(self) -> bool:
        """Whether it changes an objective by more than the tolerance, or makes walks fail."""
        return self.walks_lost > 0 or not bool((self.changes <= self.tolerance).all())

    @property
    def verdict(self) -> str:
        """In words, for the user's tolerance."""
        worst = int(np.argmax(np.nan_to_num(self.changes, nan=-1.0)))
        says = f"{self.name} changes {FIVE[worst].replace('_', ' ')} by {percent(self.changes[worst])}"
        limit = f"your {percent(self.tolerance)}"
        if self.matters:
            fails = f", {self.walks_lost} walks fail" if self.walks_lost else ""
            return f"{says}{fails}: above {limit}, keep it"
        saves = 100.0 * (1.0 - 1.0 / self.time_ratio)
        return f"{says}: below {limit}, leave it out" + (f", saves {saves:.0f} %" if saves >= 0.5 else "")

    @property
    def entry(self) -> dict[str, Any]:
        """In result.json."""
        return {
            **self._asdict(),
            "effect": name_of(self.effect),
            "parameters": parameters(self.effect),
            "changes": dict(zip(FIVE, self.changes.tolist(), strict=True)),
            "shifts": dict(zip(FIVE, self.shifts.tolist(), strict=True)),
            "matters": self.matters,
            "verdict": self.verdict,
        }


def run(study: Study) -> None:
    """Audit every effect on random feet."""
    count = study.options.feet
    check_whole("study.feet", count, 2, 10_000, "Two can be ranked.")
    scene, space, accuracy, limit = study.scene, study.space, study.accuracy, tolerance(study.config)
    feet = space.random(count, seed=study.config.solver.seed, inside=True)
    effects, found = every_effect(scene), list[Audit]()
    with study.compiling("a walk for each effect, minutes in all"):
        for effect in effects:
            evaluate(feet[:1], switched(effect, scene)[1], accuracy, space=space)
    with study.progress(len(effects), "effect") as step:
        for effect in effects:
            found.append(audit(effect, scene, feet, accuracy, limit, space))
            step(news=found[-1].name)
    walked = [asdict(numerics(accuracy, switched(effect, scene)[1], space)) for effect in effects]
    entry: dict[str, Any] = {"seed": study.config.solver.seed, "feet": feet.tolist()}
    entry["audit"] = [a.entry | {"accuracy": own} for a, own in zip(found, walked, strict=True)]
    entry["called_for"] = sorted(name_of(a.effect) for a in found if a.matters)
    study.conclude(
        "The changes by each effect",
        [table(found)],
        entry | scene_entry(scene, numerics(accuracy, scene, space), ()),
        summary=[
            "+ or -: the median's sign; tau: how alike both rank the feet, 1 if the same; time: of a walk",
            *(a.verdict for a in found),
        ],
    )


def table(found: Sequence[Audit]) -> Table:
    """Audits for the terminal: changes with the sign of their median."""
    shown = terminal.table(
        ("effect", "J_W", *(n.replace("_", " ") for n in FIVE), "tau", "time"),
        words=("effect",),
        title="J_W of the median foot, x without the effect; changes of 95 % of the feet (%)",
    )
    for a in found:
        pairs = zip(a.changes, a.shifts, strict=True)
        cells = [f"{'+' if way > 0 else '-'}{percent(size).removesuffix(' %')}" for size, way in pairs]
        shown.add_row(a.name, f"x {a.gain:.2f}", *cells, f"{a.kendall_tau:.2f}", f"x {a.time_ratio:.2f}")
    return shown


def audit(
    effect: Effect,
    scene: Scene,
    feet: Sequence[Foot] | ArrayLike,
    accuracy: AnyAccuracy | str,
    tolerance: float,
    space: Waypoints | None = None,
) -> Audit:
    """Evaluate feet in a scene with an effect, in place of one of its kind, and without it.

    `feet`, `accuracy` and `space` are as in `evaluate`, `tolerance` is the relative change that matters.
    """
    from scipy.stats import kendalltau

    scenes = switched(effect, scene)
    without, with_ = (evaluate(feet, s, accuracy, space=space) for s in scenes)  # compiled, poses made
    ratios = []
    for _ in range(REPEATS):
        began = own_time()
        evaluate(feet, scenes[0], accuracy, space=space, threads=1)
        between = own_time()
        evaluate(feet, scenes[1], accuracy, space=space, threads=1)
        ratios.append((own_time() - between) / (between - began))
    both = without.feasible & with_.feasible
    ranked = without.efficiency[both], with_.efficiency[both]
    change = relative_change(with_.values, without.values)
    change = change[np.isfinite(change).all(axis=1)]  # of feet that walk in both
    none = np.full(len(FIVE), np.nan)
    return Audit(
        effect=effect,
        changes=np.percentile(np.abs(change), QUANTILE, axis=0) if len(change) else none,
        shifts=np.median(change, axis=0) if len(change) else none,
        gain=float(np.median(ranked[1] / ranked[0])) if both.any() else np.nan,
        kendall_tau=kendalltau(*ranked).statistic if both.sum() > 1 else np.nan,
        walks_lost=int((without.feasible & ~with_.feasible).sum()),
        time_ratio=statistics.median(ratios),
        tolerance=tolerance,
    )


def switched(effect: Effect, scene: Scene) -> tuple[Scene, Scene]:
    """A scene without an effect, and with it in place of one of its kind."""
    others = tuple(e for e in scene.effects if not isinstance(e, type(effect)))
    return replace(scene, effects=others), replace(scene, effects=(*others, effect))


def every_effect(scene: Scene) -> list[Effect]:
    """Every effect, as the scene names it or with its own defaults."""
    given = {type(effect): effect for effect in scene.effects}
    return [given.get(kind) or kind() for kind in EFFECTS.values()]


def tolerance(config: Config) -> float:
    """The relative change that matters: the effects' own, the accuracy's, or `TOLERANCE`."""
    given = config.effects.tolerance
    if given is not None:
        check(0 < given < 1, "effects.tolerance", given, "a relative change between 0 and 1")
        return given
    return config.accuracy.tolerance or TOLERANCES.get(config.accuracy.name, TOLERANCE)


def choose_effects(study: Study, foot: Foot | None = None) -> tuple[Simulator, dict[str, Any]]:
    """The scene of a study with the effects that `effects=auto` chooses, or its robot.

    Effects from the literature are audited one after the other, each in the scene with those before it that
    matter; then those that matter again, in the scene with all of them. The foot that is simulated decides,
    or else random soles of the design space, by changes between two walks with the same numbers, which need
    be no finer than `draft`. Returns the audits, too, as result.json has them.
    """
    config, space = study.config, study.space
    if not config.effects.auto:
        return study.simulator, {"effects_audit": []}
    scene = make_scene(replace(config, effects=replace(config.effects, auto=False)))
    feet: Any = [foot] if foot else space.random(RANDOM_FEET, seed=study.config.solver.seed, inside=True)
    limit, accuracy = tolerance(config), study.accuracy
    if foot is None:
        accuracy = numerics(drafted(accuracy), scene, space)
    audits: dict[str, Audit] = {}
    given = scene.effects
    for effect in every_effect(scene):
        if effect.literature and effect not in given:
            with study.compiling(f"a walk with {name_of(effect)}"):
                audits[name_of(effect)] = found = audit(effect, scene, feet, accuracy, limit, space)
            scene = switched(effect, scene)[found.matters]
    for name, found in audits.items():
        if found.matters and len(scene.effects) > len(given) + 1:
            audits[name] = again = audit(found.effect, scene, feet, accuracy, limit, space)
            scene = switched(found.effect, scene)[again.matters]
    study.say(*(f"effects=auto: {a.verdict}" for a in audits.values()))
    return scene, {"effects_audit": [a.entry for a in audits.values()]}
