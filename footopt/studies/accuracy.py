"""What does accuracy cost in time? A work-precision study of steppers, time steps, plates and creep.

Random feet walk on the three sands at many settings; the error of a setting is measured against the
limit of many plates and small steps, its cost on one thread. The presets and
`accuracy.tolerance` come from the table that this study writes (`footopt/walk/accuracy.csv` is
one such table). One foot on each sand is also checked against SciPy's LSODA on the angle form of
the law, which shares no code with the compiled walk.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table as RichTable

from footopt.errors import check
from footopt.files import run as files
from footopt.foot import Foot, Waypoints
from footopt.report import figures, summary, terminal
from footopt.report.figures.accuracy import work_precision
from footopt.report.progress import progress
from footopt.sand import Sand, alpha
from footopt.studies import build
from footopt.studies.base import Study
from footopt.walk import FIVE, Accuracy, Scene, evaluate, simulate
from footopt.walk.accuracy import PRESETS, TABLE_COLUMNS
from footopt.walk.audit import own_time
from footopt.walk.simulate import at_once
from footopt.walk.steppers import STEPPERS

Array = NDArray[np.float64]

SANDS = ("soft", "regular", "hard")
QUANTILE = 95.0  # of the feet: the error that this share of them does not exceed, %
LIMIT = Accuracy("sdirk2", 1e-4, 800, 1e-5, "limit")
PLATES = 64  # of settings that differ in time only
LSODA, QUICK_LSODA = 8e3, 1e3  # ms that one of SciPy's walks takes, about

IMPLICIT_DT = (
    2e-2,
    1.25e-2,
    1e-2,
    8e-3,
    7e-3,
    6.25e-3,
    5.5e-3,
    5e-3,
    4e-3,
    2.5e-3,
    1.6e-3,
    1e-3,
    5e-4,
    2.5e-4,
)
EXPLICIT_DT = (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1e-4, 5e-5)
ARC_PLATES = (24, 32, 40, 48, 52, 56, 60, 64, 80, 96, 128, 192, 256)
CHORD_PLATES = (25, 50, 100, 200, 400)
CREEPS = (1e-2, 1e-3, 1e-5)
CONTROLS = (3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5)  # m/s
LONGEST_DT = (1.25e-2, 1e-2, 8e-3, 7e-3)  # of steps under control


@dataclass(frozen=True)
class Measurement:
    """One setting: its error against the limit and its cost.

    errors : (sands, objectives), of the `QUANTILE`; infinite where a walk failed.
    worst : (sands,), that of each foot's worst objective.
    time_error : as the largest of `worst`, but against small steps with the same plates and creep;
        NaN where it was not measured.
    ms : per design on one thread, mean over the sands.
    """

    accuracy: Accuracy
    errors: Array
    worst: Array
    time_error: float
    ms: float

    @property
    def error(self) -> float:
        """The largest of `worst` over the sands."""
        return float(self.worst.max())


def run(study: Study) -> None:
    """Measure all settings, write the table, the figure and the presets that follow."""
    config, folder, settings = study.config, study.folder, study.settings
    out, clock = study.console, terminal.clock()
    check(1 <= config.study.feet <= 10_000, "study.feet", config.study.feet, "a whole number, 1 to 10,000")
    space = build.make_space(config.foot)
    base = build.make_scene(config)
    scenes = [replace(base, sand=Sand.named(name)) for name in SANDS]
    feet = space.random(config.study.feet, seed=config.solver.seed, inside=True)
    grid = quick_grid() if config.study.quick else full_grid()
    about = f"{len(grid)} settings, {len(feet)} feet inside their box, sands {', '.join(SANDS)}"
    out.print(about)
    limit = quick_limit() if config.study.quick else LIMIT
    in_time = replace(limit, plates=PLATES, creep=1e-4)
    threads = config.engine.threads
    limits, measured, independent = [], [], []
    # all at once: on all threads, or on one
    spread = {a: effort(a) * len(feet) / at_once(threads) for a in (limit, in_time)}
    single = {a: effort(a) * len(feet) * len(scenes) for a in grid}
    lsoda = QUICK_LSODA if config.study.quick else LSODA
    work = len(scenes) * (sum(spread.values()) + lsoda) + sum(single.values())
    with terminal.told_if_slow(out, "Compiling every stepper; this is done once and kept on disk ..."):
        for stepper in STEPPERS:
            _values(feet[:1], scenes[0], Accuracy(stepper), space, 1)
    with progress(out, len(grid) + 3 * len(scenes), "measurement", work) as step:
        for accuracy, cost in spread.items():
            for scene in scenes:
                limits.append(_values(feet, scene, accuracy, space, threads))
                step(cost, "the limit of small steps and many plates")
        references, same_plates = limits[: len(scenes)], limits[len(scenes) :]
        for accuracy, cost in single.items():
            measured.append(measure(accuracy, feet, scenes, space, references, same_plates))
            step(cost, f"{accuracy.stepper}, dt {1e3 * accuracy.dt:g} ms, {accuracy.plates} plates")
        for scene in scenes:
            foot = Foot.from_waypoints(feet[0], space)
            independent.append(check_against_scipy(foot, scene, quick=config.study.quick))
            step(lsoda, "SciPy's LSODA")
    best = pareto(measured)
    write_table(folder / "accuracy.csv", measured)
    figures.save(work_precision(measured, list(PRESETS.values())), folder / "figures", "accuracy")
    orders = {name: order(measured, name) for name in STEPPERS}
    picks = {tolerance: cheapest(measured, tolerance) for tolerance in (0.02, 0.005, 0.0005)}
    record = {
        "study": "accuracy",
        "seed": config.solver.seed,
        "feet": feet.tolist(),
        "orders": orders,
        "cheapest": {str(t): None if m is None else _row(m) for t, m in picks.items()},
        "scipy_lsoda": dict(zip(SANDS, independent, strict=True)),
        "settings": settings,
        "versions": files.versions(),
        "wall_time_s": clock(),
    }
    shown, said = table(best), found_words(orders, picks)
    said += [
        f"{name} sand against SciPy's LSODA on the angle form: {100 * max(difference.values()):.4f} %"
        for name, difference in zip(SANDS, independent, strict=True)
    ]
    says = {
        "accuracy": "Error of the worst objective, for 95 % of the feet, against the time that a design "
        "takes, for every stepper, time step and number of plates; the presets are marked."
    }
    summary.conclude(folder, "What accuracy costs", said, says, [shown], record, about=[about])


def effort(accuracy: Accuracy) -> float:
    """About how long one design takes, ms, to a factor of 2.5: enough to tell how much is left."""
    stepper = STEPPERS[accuracy.stepper]
    evaluations = len(stepper.nodes) * (3 if stepper.implicit else 1)
    dt = accuracy.dt
    if accuracy.control is not None:  # how long a step it allows, of the measured settings
        dt = min(dt, 0.018 * accuracy.control**0.16)
    return 2.8e-6 * evaluations * (accuracy.plates + 60) / dt


def full_grid() -> list[Accuracy]:
    """All settings of the study."""
    grid = [Accuracy("sdirk2", dt, n) for dt, n in itertools.product(IMPLICIT_DT, ARC_PLATES)]
    small = [dt for dt in IMPLICIT_DT if dt <= 2.5e-3]
    grid += [Accuracy("sdirk2", dt, n, 2e-5) for dt in small for n in ARC_PLATES if n >= 96]
    for dt, control, n in itertools.product(LONGEST_DT, CONTROLS, ARC_PLATES):
        if control >= 1e-3 or dt == 1e-2:
            grid.append(Accuracy("sdirk2", dt, n, control=control))
        if control <= 1e-4 and dt == 1e-2 and n >= 96:
            grid.append(Accuracy("sdirk2", dt, n, 2e-5, control=control))
    grid += [Accuracy("implicit_euler", dt, PLATES) for dt in IMPLICIT_DT]
    grid += [
        Accuracy(name, dt, PLATES)
        for name in ("explicit_euler", "semi_implicit_euler", "heun", "rk4")
        for dt in EXPLICIT_DT
    ]
    grid += [Accuracy("sdirk2", 2.5e-3, n, rule="chord") for n in CHORD_PLATES]
    grid += [Accuracy("sdirk2", 1e-3, 192, creep) for creep in CREEPS]
    return list(dict.fromkeys(grid))


def quick_grid() -> list[Accuracy]:
    """A few settings of each kind, for a first look (and for the tests)."""
    grid = [Accuracy("sdirk2", dt, n) for dt in (1e-2, 5e-3, 2.5e-3) for n in (32, PLATES)]
    grid += [Accuracy(name, dt, PLATES) for name in STEPPERS if name != "sdirk2" for dt in (2e-3, 1e-3)]
    grid += [Accuracy("sdirk2", 1e-2, PLATES, control=3e-4)]
    return [*grid, Accuracy("sdirk2", 2.5e-3, 50, rule="chord")]


def quick_limit() -> Accuracy:
    """The limit as far as a first look needs it."""
    return Accuracy("sdirk2", 5e-4, 256, 1e-4, "limit")


def measure(
    accuracy: Accuracy,
    feet: NDArray[np.int64],
    scenes: Sequence[Scene],
    space: Waypoints,
    references: Sequence[Array],
    same_plates: Sequence[Array],
) -> Measurement:
    """Errors and cost of one setting."""
    errors, worst, in_time, seconds = [], [], [], 0.0
    evaluate(feet[:1], scenes[0], accuracy, space=space, threads=1)  # compiled, pose table made
    for scene, reference, other in zip(scenes, references, same_plates, strict=True):
        started = own_time()
        values = _values(feet, scene, accuracy, space, 1)
        seconds += own_time() - started
        error = _error(values, reference)
        errors.append(np.percentile(error, QUANTILE, axis=0))
        worst.append(np.percentile(error.max(axis=1), QUANTILE))
        in_time.append(np.percentile(_error(values, other).max(axis=1), QUANTILE))
    time_only = accuracy == Accuracy(accuracy.stepper, accuracy.dt, PLATES, 1e-4)
    return Measurement(
        accuracy=accuracy,
        errors=np.array(errors),
        worst=np.array(worst),
        time_error=float(max(in_time)) if time_only else float("nan"),
        ms=1e3 * seconds / len(scenes) / len(feet),
    )


def pareto(measured: Sequence[Measurement]) -> list[Measurement]:
    """Settings that no other beats in both error and cost, cheapest first."""
    best: list[Measurement] = []
    for m in sorted(measured, key=lambda m: (m.ms, m.error)):
        if np.isfinite(m.error) and (not best or m.error < best[-1].error):
            best.append(m)
    return best


def cheapest(measured: Sequence[Measurement], tolerance: float) -> Measurement | None:
    """The cheapest setting whose error is within the tolerance."""
    good = [m for m in measured if m.error <= tolerance]
    return min(good, key=lambda m: m.ms) if good else None


def order(measured: Sequence[Measurement], stepper: str) -> float:
    """Measured order of a stepper: slope of log error over log dt, where the error is below 5 %."""
    rows = [
        (np.log(m.accuracy.dt), np.log(m.time_error))
        for m in measured
        if m.accuracy.stepper == stepper and 1e-6 < m.time_error < 0.05
    ]
    if len(rows) < 2:
        return float("nan")
    x, y = np.array(rows).T
    return float(np.polyfit(x, y, 1)[0])


def write_table(path: Path, measured: Sequence[Measurement]) -> None:
    """All settings with their errors (fractions) and cost (ms per design and core)."""
    header = [*TABLE_COLUMNS, *(f"error_{s}" for s in SANDS)]
    header += [f"error_{s}_{name}" for s in SANDS for name in FIVE]
    rows = []
    for m in sorted(measured, key=lambda m: m.ms):
        detail = [float(f"{e:.3g}") for e in (*m.worst, *m.errors.ravel())]
        rows.append([*_row(m).values(), *detail])
    files.write_csv(path, header, rows)


def _row(m: Measurement) -> dict[str, Any]:
    a = m.accuracy
    setting = {name: getattr(a, name) for name in TABLE_COLUMNS[:-2]}
    return {**setting, "error": float(f"{m.error:.3g}"), "ms": float(f"{m.ms:.3g}")}


def _values(
    feet: NDArray[np.int64], scene: Scene, accuracy: Accuracy, space: Waypoints, threads: int | None
) -> Array:
    return evaluate(feet, scene, accuracy, space=space, threads=threads).values


def _error(values: Array, reference: Array) -> Array:
    """Relative error (feet, objectives); infinite where only one of the two walks failed."""
    with np.errstate(invalid="ignore"):
        error = np.abs(values / reference - 1.0)
    both = np.isnan(values) & np.isnan(reference)
    return np.where(both, 0.0, np.where(np.isfinite(error), error, np.inf))


def check_against_scipy(foot: Foot, scene: Scene, quick: bool = False) -> dict[str, float]:
    """Relative differences of the five objectives between the compiled walk and SciPy's LSODA.

    Both use 100 chord plates (30 in the quick form) and the default creep speed; the reference takes
    the law in its angle form and integrates work and height along with the motion.
    """
    from scipy.integrate import solve_ivp

    accuracy = Accuracy("sdirk2", 2e-4, 30 if quick else 100, rule="chord")
    compiled = simulate(foot, scene, accuracy)
    walker, t_f = scene.walker, scene.duration
    points = foot.points(accuracy.plates)
    chord, middle = np.diff(points, axis=0), 0.5 * (points[1:] + points[:-1]) - foot.ankle
    angle = np.arctan2(chord[:, 1], chord[:, 0])
    area = np.hypot(*chord.T) * foot.width

    def contact(t: Array, state: Array) -> tuple[Array, Array]:
        """Force (T, 2 feet, 2) and power (T, 2) of states (4, T)."""
        pose = scene.gait.pose(t, walker.l1, walker.l2)
        cos, sin = np.cos(pose.pitch)[..., None], np.sin(pose.pitch)[..., None]
        rx, rz = cos * middle[:, 0] - sin * middle[:, 1], sin * middle[:, 0] + cos * middle[:, 1]
        depth = np.maximum(-(state[1][:, None] + pose.z)[..., None] - rz, 0.0)
        vx = (state[2][:, None] + pose.vx)[..., None] - pose.rate[..., None] * rz
        vz = (state[3][:, None] + pose.vz)[..., None] + pose.rate[..., None] * rx
        beta, gamma = angle + pose.pitch[..., None], np.arctan2(-vz, vx)
        forth = alpha(beta, gamma, scene.sand.stress_map)
        back = alpha(beta, gamma + np.pi, scene.sand.stress_map)
        speed = np.hypot(vx, vz)
        h = speed / np.sqrt(speed**2 + accuracy.creep**2)  # the part that turns with the motion
        ax, az = (0.5 * (f + b) + h * 0.5 * (f - b) for f, b in zip(forth, back, strict=True))
        pull = scene.sand.zeta * depth * area
        fx, fz = -pull * ax, pull * az
        force = np.stack([fx.sum(axis=-1), fz.sum(axis=-1)], axis=-1)
        return force, (fx * vx + fz * vz).sum(axis=-1)

    def rate(t: float, y: Array) -> Array:
        force, power = contact(np.array([t]), y[:4, None])
        fx, fz = force[0].sum(axis=0)
        return np.array([y[2], y[3], fx / walker.mass, fz / walker.mass - walker.g, power.sum(), y[1]])

    start = [0.0, compiled.start[1], 0.0, 0.0, 0.0, 0.0]
    tight = 1e-7 if quick else 1e-9
    solution = solve_ivp(
        rate,
        (0.0, t_f),
        start,
        method="LSODA",
        rtol=tight,
        atol=1e-2 * tight,
        max_step=5e-3,
        dense_output=True,
    )
    t = np.linspace(scene.gait.heel_strike, t_f, 20_001)
    states = solution.sol(t)
    power = np.concatenate([contact(part, states[:4, i])[1] for part, i in _parts(t)])
    expected = {
        "distance": solution.y[0, -1],
        "mean_height": solution.y[5, -1] / t_f,
        "work": abs(solution.y[4, -1]),
        "peak_power": np.abs(power).max(),
        "speed_loss": np.max(np.maximum.accumulate(states[2]) - states[2]),
    }
    found = compiled.objectives
    return {name: float(abs(found[name] / expected[name] - 1.0)) for name in FIVE}


def _parts(t: Array) -> list[tuple[Array, slice]]:
    """Times in pieces of 1000, with their places."""
    places = [slice(i, i + 1000) for i in range(0, len(t), 1000)]
    return [(t[place], place) for place in places]


def table(best: Sequence[Measurement]) -> RichTable:
    """The settings that no other beats, for the terminal."""
    shown = terminal.table(
        ("stepper", "plates", "dt (ms), control", "creep (m/s)", "error (%)", "ms per design and core"),
        words=("stepper",),
        title="settings that no other beats (error: worst objective, 95 % of the feet)",
    )
    for m in best:
        a = m.accuracy
        shown.add_row(
            a.stepper,
            f"{a.plates} {a.rule}",
            f"{1e3 * a.dt:g}" if a.control is None else f"<= {1e3 * a.dt:g}, {a.control:g} m/s",
            f"{a.creep:g}",
            f"{100 * m.error:.3g}",
            f"{m.ms:.3g}",
        )
    return shown


def found_words(orders: dict[str, float], picks: dict[float, Measurement | None]) -> list[str]:
    """Measured orders, and the cheapest setting for each tolerance, a line each."""
    said = ["Measured order: " + ", ".join(f"{name} {value:.1f}" for name, value in orders.items())]
    for tolerance, pick in picks.items():
        text = "none of these settings"
        if pick is not None:
            a = pick.accuracy
            control = "" if a.control is None else f", control {a.control:g} m/s"
            text = f"{a.stepper}, dt {a.dt:g} s{control}, {a.plates} {a.rule} plates, {pick.ms:.3g} ms"
        said.append(f"Cheapest within {100 * tolerance:g} %: {text}")
    return said
