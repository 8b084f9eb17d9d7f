"""`simulate`, one foot with full traces, and `evaluate`, many feet with objectives only."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from footopt.arrays import Array
from footopt.errors import check, check_kind
from footopt.foot import Foot, Waypoints, as_feet
from footopt.walk.accuracy import Accuracy, AnyAccuracy, resolve
from footopt.walk.ladder import numerics
from footopt.walk.objectives import FIVE, by_name, lookup, offered
from footopt.walk.results import Table, Walk
from footopt.walk.scene import Scene
from footopt.walk.simulator import Simulator

SAFE = 2.0  # times the differences to two refined walks, see `estimated`


def simulate(foot: Foot, scene: Simulator | None = None, accuracy: AnyAccuracy | str = "standard") -> Walk:
    """Walk through a scene with one foot, keeping full traces.

    Parameters
    ----------
    foot : Foot
        The sole.
    scene : Simulator, optional
        A `Scene`, the paper's walk on hard sand by default; or any other simulator, such as a robot.
    accuracy : Accuracy, Tolerance or str
        Numerical parameters, an allowed error, or the name of a preset.

    Returns
    -------
    Walk
        Also of a walk that failed; see its `reason`.

    Raises
    ------
    SettingError
        The walk is too long to be traced at this accuracy.
    """
    check_kind("foot", foot, Foot, "Try fo.Foot.from_waypoints(heights)")
    scene = as_simulator(scene)
    return scene.trace(foot, numerics(resolve(accuracy), scene, foot))


def evaluate(
    feet: Foot | Sequence[Foot] | ArrayLike,
    scene: Simulator | None = None,
    accuracy: AnyAccuracy | str = "standard",
    objectives: str | Sequence[str] | None = None,
    space: Waypoints | None = None,
    threads: int | None = None,
    errors: bool = False,
) -> Table:
    """Walk through a scene with many feet, keeping objectives only: the fast path.

    A result does not depend on the number of threads. It does not depend on the other designs of a batch if
    `accuracy` is an `Accuracy`, or the feet are of one space; for other feet, ten of the batch determine the
    numerical parameters of all.

    Parameters
    ----------
    feet : Foot, sequence of Foot, or (designs, n)
        The soles; an array holds heights of waypoints in `space`.
    scene, accuracy
        As in `simulate`.
    objectives : str or sequence of str, optional
        One name, or several, of `footopt.walk.objectives.MEASURES`; those that are measured in Python
        are slow. By default the paper's five, or those that a simulator measures.
    space : Waypoints, optional
        Of the heights; the paper's by default.
    threads : int, optional
        How many to use; by default as many as the process may run on.
    errors : bool
        Whether to estimate the values' errors, `Table.errors`, by two finer walks with each foot: about
        ten times the time.

    Returns
    -------
    Table
        With ``values`` (designs, objectives) in natural signs.

    Raises
    ------
    SettingError
        The scene has no heel strike, an objective is not known, or there are no feet.
    """
    scene, accuracy = as_simulator(scene), resolve(accuracy)
    bodies = as_feet(feet, space)
    check(len(bodies) > 0, "feet", "[]", "at least one foot")
    scene.check_comparable()
    if objectives is None:
        objectives = [name for name in FIVE if name in offered(scene)]
    objectives = (objectives,) if isinstance(objectives, str) else tuple(objectives)
    lookup(objectives, scene)
    given = bodies, scene, numerics(accuracy, scene, bodies), objectives, threads
    table = evaluated(*given)
    return replace(table, errors=estimated(table.values, *given)) if errors else table


def estimated(
    values: Array,
    feet: Sequence[Foot],
    scene: Simulator,
    accuracy: Accuracy,
    names: Sequence[str],
    threads: int | None = None,
) -> Array:
    """Error estimates of values (designs, names), from walks refined once and twice.

    A walk is off by its distance to the limit: that to the walk refined twice, and from there on at most what
    the last refinement changed, if each refinement at least halves the error. `SAFE` times that also covers
    walks that refinement by chance changes little. NaN where a refined walk ends otherwise, or is too long.
    """
    finer = [accuracy.refined(times) for times in (1, 2)]
    if any(map(scene.too_long, finer)):
        return np.full_like(values, np.nan)
    once, twice = (evaluated(feet, scene, one, names, threads).values for one in finer)
    return SAFE * (np.abs(values - twice) + np.abs(once - twice))


def evaluated(
    feet: Sequence[Foot], scene: Simulator, accuracy: Accuracy, objectives: Sequence[str], threads: int | None
) -> Table:
    """`evaluate` at an accuracy that holds for all feet."""
    raw, reasons, evaluations, counts = scene.walk(feet, accuracy, threads, objectives)
    values = np.full((len(raw), len(objectives)), np.nan)
    chosen, feasible, quantities = lookup(objectives), reasons == "", by_name(raw, scene.quantities)
    for column, o in enumerate(chosen):
        if o.of == "raw":
            values[:, column] = o.value(quantities, scene)
    if slow := [column for column, o in enumerate(chosen) if o.of != "raw"]:
        for design in np.flatnonzero(feasible).tolist():
            foot, each = feet[design], [chosen[c] for c in slow]
            walk = scene.trace(foot, accuracy) if any(o.of == "walk" for o in each) else None
            values[design, slow] = [walk.measured(o) if walk else float(o.value(foot)) for o in each]
    names = tuple(objectives)
    return Table(values, names, feasible, reasons, raw, evaluations, scene, counts)


def as_simulator(scene: Simulator | None) -> Simulator:
    """The paper's walk on hard sand where there is none."""
    found = Scene() if scene is None else scene
    check_kind("scene", found, Simulator, "Try fo.Scene(sand=...)")
    return found
