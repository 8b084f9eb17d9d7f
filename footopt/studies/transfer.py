"""study=transfer: feet designed on the planar walker and on a robot, each walked on both."""

from dataclasses import asdict, replace
from typing import Any, NamedTuple

import numpy as np
from rich.table import Table

from footopt.design import FootProblem, Solver
from footopt.design.robust import regret
from footopt.errors import SettingError, check, check_whole
from footopt.foot import Foot
from footopt.report import terminal
from footopt.report.figures.studies import transfer as draw
from footopt.report.numbers import number, title
from footopt.sand import MEDIA, Sand
from footopt.studies.robust import searched
from footopt.studies.runs import Study
from footopt.walk import FIVE, MEASURES, Scene, Simulator, evaluate
from footopt.walk.accuracy import AnyAccuracy, confirming, resolve
from footopt.walk.ladder import numerics

ENOUGH = 0.1  # of the objective: a smaller loss on the robot leaves the walker's foot as good as its own
FLAT, WALKER, ROBOT = "flat", "walker", "robot"
CAPTION = "What each foot loses against the better designed one, on both; tau ranks random soles by both."


class Side(NamedTuple):
    """One of the two simulators on a sand, and how finely it searches and judges."""

    name: str
    simulator: Simulator
    accuracy: AnyAccuracy
    finer: AnyAccuracy
    walks: int | None


class Comparison(NamedTuple):
    """Feet on one sand: the flat one, that of the walker and that of the robot, walked on both."""

    sand: Sand
    feet: dict[str, Foot]
    values: dict[str, dict[str, dict[str, float]]]  # by side, foot and objective
    losses: dict[str, dict[str, float]]  # by side and foot, against the better of the designed ones
    tau: float  # Kendall's, of random soles
    soles: int  # how many of these walk on both


def run(study: Study) -> None:
    """Design feet on both simulators on every sand, walk with each on both, and rank random soles.

    The walker has the robot's mass and gravity.
    """
    config, options = study.config, study.options
    names = config.objective.names
    check(len(names) == 1, "objective", names, "one objective", "Such as objective=efficiency.")
    check_whole("study.soles", options.soles, 2, 100_000)
    check(options.sands, "study.sands", options.sands, "one sand, or several", "Such as [hard,2.5].")
    robot: Any = study.simulator
    if isinstance(robot, Scene):
        raise SettingError("simulator", WALKER, "a robot, to compare with the walker", "Try simulator=biped.")
    solver = study.solver()
    planar, found = resolve("standard"), list[Comparison]()
    walker = replace(study.scene.walker, mass=robot.weight / robot.g, g=robot.g)
    scene = replace(study.scene, walker=walker)
    for sand in map(named, options.sands):
        sides = (
            Side(WALKER, replace(scene, sand=sand), planar, confirming("finer", planar), options.walks),
            Side(ROBOT, replace(robot, sand=sand), study.accuracy, study.finer_accuracy, solver.walks),
        )
        found.append(_compared(study, sand, sides, names[0], solver))
        study.say(describe(found[-1], names[0]))
    study.save("transfer", lambda: draw(found, names[0]), CAPTION)
    entry: dict[str, Any] = {"seed": solver.seed, "solver": asdict(solver), "objective_names": names}
    entry["search_accuracy"] = asdict(numerics(study.accuracy, robot, study.space))
    entry["transfer"] = [
        t._asdict() | {"sand": t.sand.name, "zeta": t.sand.zeta, "feet": {n: f.k for n, f in t.feet.items()}}
        for t in found
    ]
    study.conclude(
        "Which model should a foot be designed on?",
        [table(found, names[0])],
        entry,
        summary=[describe(t, names[0]) for t in found],
    )


def named(sand: Any) -> Sand:
    """A sand by its name, or by its zeta."""
    try:
        return Sand.named(sand) if sand in MEDIA else Sand(zeta=float(sand), name=f"zeta {sand}")
    except ValueError:
        raise SettingError("study.sands", sand, f"a zeta, or one of {', '.join(MEDIA)}") from None


def _compared(study: Study, sand: Sand, sides: tuple[Side, Side], by: str, solver: Solver) -> Comparison:
    """The best foot of a search on each side, all feet on both, and the order of random soles by both."""
    from scipy.stats import kendalltau

    space, threads = study.space, study.config.engine.threads
    feet, values, losses, ranked = {FLAT: Foot.flat(space)}, {}, {}, []
    for side in sides:
        problem = FootProblem(side.simulator, by, space, side.accuracy, threads)
        asked, name = replace(solver, walks=side.walks), f"{problem.scene.title}, {side.name}"
        with study.executor() as executor, study.progress(asked.generations(space), "generation") as step:
            result, confirmed = searched(study, problem, asked, name, side.finer, executor, step)
        best = result.k[confirmed.designs[0]].tolist()
        feet[side.name] = replace(Foot.from_waypoints(best, space), name=side.name)
    names = list(dict.fromkeys((*FIVE, "joint_work", by)))
    k = space.random(study.options.soles, seed=solver.seed, inside=True)
    for side in sides:
        walked = evaluate(list(feet.values()), side.simulator, side.finer, names, space, threads).values
        values[side.name] = {
            foot: dict(zip(names, row, strict=True)) for foot, row in zip(feet, walked.tolist(), strict=True)
        }
        own, sign = walked[:, names.index(by)], MEASURES[by].sign
        best_known = np.asarray(sign * np.nanmin(sign * own[1:]))
        losses[side.name] = dict(zip(feet, regret(own, best_known, by).tolist(), strict=True))
        ranked.append(evaluate(k, side.simulator, side.accuracy, by, space, threads).values[:, 0])
    good = np.isfinite(ranked).all(axis=0)
    tau = float(kendalltau(ranked[0][good], ranked[1][good]).statistic)
    return Comparison(sand, feet, values, losses, tau, int(good.sum()))


def describe(found: Comparison, objective: str) -> str:
    """The answer for a sand in words."""
    loss, what = found.losses[ROBOT][WALKER], title(objective)
    answer = "the walker is enough" if loss <= ENOUGH else "design on the robot"
    if np.isnan(loss):
        answer = "design on the robot, on which the walker's foot fails"
    elif found.losses[ROBOT][FLAT] < 0.0:
        answer = "no search on it found a foot as good as the flat one; more solver.walks may"
    elif found.losses[ROBOT][ROBOT] > 0.0:
        answer = "the robot's search found no better foot than the walker's; more solver.walks may"
    return (
        f"{found.sand.name} sand: {answer}. The walker's foot loses {100 * loss:.1f} % of {what} on the "
        f"robot, the robot's foot {100 * found.losses[WALKER][ROBOT]:.1f} % on the walker; Kendall's tau of "
        f"{found.soles} random soles is {found.tau:.2f}."
    )


def table(found: list[Comparison], objective: str) -> Table:
    """The feet on the robot, and what they lose on both simulators."""
    names = list(dict.fromkeys((objective, "peak_power", "speed_loss", "joint_work")))
    heads = [f"{name.replace('_', ' ')} ({MEASURES[name].unit})".removesuffix(" ()") for name in names]
    columns = ("sand", "foot", *heads, "lost (%)", "on the walker")
    shown = terminal.table(columns, words=("sand", "foot"), title="On the robot; lost against the better one")
    for t in found:
        for foot in t.feet:
            values = t.values[ROBOT][foot]
            lost = (f"{100 * t.losses[side][foot]:.1f}" for side in (ROBOT, WALKER))
            shown.add_row(t.sand.name, foot, *(number(values[name]) for name in names), *lost)
    return shown
