"""`simulate`, one foot with full traces, and `evaluate`, many feet with objectives only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from footopt.errors import check_kind
from footopt.foot import Foot, Waypoints, as_feet
from footopt.walk import discretize
from footopt.walk.accuracy import Accuracy, AnyAccuracy, resolve
from footopt.walk.batch import REASONS, Options, chunks, walk_batch
from footopt.walk.ladder import numerics
from footopt.walk.loop import OK
from footopt.walk.metrics import RAW, Sample
from footopt.walk.objectives import FIVE, Objective, by_name, lookup, offered
from footopt.walk.results import Table, Walk
from footopt.walk.scene import Scene
from footopt.walk.simulator import Simulator
from footopt.walk.state import COUNTS

Array = NDArray[np.float64]

SAFE = 2.0  # times the differences to two refined walks, see `estimated`


def simulate(
    foot: Foot, scene: Scene | Simulator | None = None, accuracy: AnyAccuracy | str = "standard"
) -> Walk:
    """Walk through a scene with one foot, keeping full traces.

    Parameters
    ----------
    foot : Foot
        The sole.
    scene : Scene or Simulator, optional
        The paper's walk on hard sand by default; or any other simulator, such as a robot.
    accuracy : Accuracy, Tolerance or str
        Numbers, an error that is allowed, or a preset's name.

    Returns
    -------
    Walk
        Also of a walk that failed; see its `reason`.

    Raises
    ------
    SettingError
        The walk is too long to be traced at this accuracy.
    """
    check_kind(foot, Foot, "foot", "Try fo.Foot.from_waypoints(heights)")
    scene = _scene(scene)
    accuracy = numerics(resolve(accuracy), scene, foot)
    if isinstance(scene, Simulator):
        walk: Walk = scene.trace(foot, accuracy)
        return walk
    (plates,) = chunks([foot], scene, accuracy, None)
    walked = walk_batch(plates, scene, accuracy, Options(sink=True, threads=1, traced=True))
    rows, h = 1 + np.flatnonzero(np.isfinite(walked.trace[1:]).all(axis=1)), walked.bristles
    kept, which = (
        (None, None) if h is None else np.unique(rows * len(h) // len(walked.trace), return_inverse=True)
    )
    c: Any = Sample(*walked.trace[rows].T)  # columns
    return Walk(
        foot=foot,
        scene=scene,
        accuracy=accuracy,
        t=c.t,
        com=np.column_stack([c.x, c.z]),
        velocity=np.column_stack([c.vx, c.vz]),
        force=np.stack([c.fx_left, c.fz_left, c.fx_right, c.fz_right], axis=1).reshape(-1, 2, 2),
        power=np.column_stack([c.power_left, c.power_right]),
        work=np.column_stack([c.work_left, c.work_right]),
        bristles=None if h is None else np.moveaxis(h[kept][..., : plates.x.shape[1]], 2, 3),
        remembered=None if kept is None or len(kept) == len(rows) else which,
        start=np.array(Sample(*walked.trace[0])[1:3]),
        reason=REASONS[int(walked.status[0])],
        totals=dict(zip(RAW, map(float, walked.raw[0]), strict=True)),
        **{name: int(walked.counts[name][0]) for name in ("evaluations", "shortened", "repeats")},
    )


def evaluate(
    feet: Foot | Sequence[Foot] | ArrayLike,
    scene: Scene | Simulator | None = None,
    accuracy: AnyAccuracy | str = "standard",
    objectives: str | Sequence[str] | None = None,
    space: Waypoints | None = None,
    threads: int | None = None,
    errors: bool = False,
) -> Table:
    """Walk through a scene with many feet, keeping objectives only: the fast path.

    A result does not depend on the number of threads, nor on the other designs of a batch if the accuracy is
    numbers, or feet are of one space. Of other feet, ten in the batch say which numbers all of them need.

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
    scene, accuracy = _scene(scene), resolve(accuracy)
    bodies = as_feet(feet)
    scene.need_heel_strike()
    if objectives is None:
        objectives = [name for name in FIVE if name in offered(scene)]
    objectives = (objectives,) if isinstance(objectives, str) else tuple(objectives)
    lookup(objectives, scene)
    given = bodies, scene, numerics(accuracy, scene, bodies, space), objectives, space, threads
    table = _evaluated(*given)
    return replace(table, errors=estimated(table.values, *given)) if errors else table


def estimated(
    values: Array,
    feet: Any,
    scene: Scene | Simulator,
    accuracy: Accuracy,
    names: Sequence[str],
    space: Waypoints | None = None,
    threads: int | None = None,
) -> Array:
    """Error estimates of values (designs, names), from walks refined once and twice.

    A walk is off by its distance to the limit: that to the walk refined twice, and from there on at most what
    the last refinement changed, if each refinement at least halves the error. `SAFE` times that also covers
    walks that refinement by chance changes little. NaN where a refined walk ends otherwise, or is too long.
    """
    finer = [accuracy.refined(times) for times in (1, 2)]
    if isinstance(scene, Scene) and any(discretize.too_many_poses(scene, one) for one in finer):
        return np.full_like(values, np.nan)
    once, twice = (_evaluated(feet, scene, one, names, space, threads).values for one in finer)
    return SAFE * (np.abs(values - twice) + np.abs(once - twice))


def _evaluated(
    feet: Any,
    scene: Scene | Simulator,
    accuracy: Accuracy,
    objectives: Sequence[str],
    space: Waypoints | None,
    threads: int | None,
) -> Table:
    """`evaluate` at an accuracy that holds for all feet."""
    if isinstance(scene, Simulator):
        names, none = scene.quantities, np.zeros(len(feet), np.int64)
        raw, reasons, evaluations = scene.walk([_foot(f, space) for f in feet], accuracy, threads)
        counts: dict[str, Any] = dict.fromkeys(COUNTS.names or (), none) | {"evaluations": evaluations}
    else:
        sink, names = "maximum_sinkage" in objectives, RAW
        given = chunks(feet, scene, accuracy, space)
        parts = [walk_batch(plates, scene, accuracy, Options(sink, threads))[:3] for plates in given]
        raw, status, walked = (np.concatenate(column) for column in zip(*parts, strict=True))
        raw[status != OK] = np.nan
        if not sink:
            raw[:, RAW.index("maximum_sinkage")] = np.nan
        reasons = np.array([REASONS[int(s)] for s in status], dtype=np.str_)
        counts = {name: walked[name] for name in COUNTS.names or ()}
    values = np.full((len(raw), len(objectives)), np.nan)
    chosen, feasible = lookup(objectives, scene), reasons == ""
    for column, o in enumerate(chosen):
        if o.of == "raw":
            values[:, column] = o.value(by_name(raw, names), scene)
    if slow := [column for column, o in enumerate(chosen) if o.of != "raw"]:
        for design in np.flatnonzero(feasible).tolist():
            foot = _foot(feet[design], space)
            values[design, slow] = _measured(foot, [chosen[c] for c in slow], scene, accuracy)
    return Table(values, tuple(objectives), feasible, reasons, raw, scene=scene, quantities=names, **counts)


def _foot(foot: Any, space: Waypoints | None) -> Foot:
    """A foot, or that of a row of heights."""
    return foot if isinstance(foot, Foot) else Foot.from_waypoints(foot, space)


def _measured(foot: Foot, measures: Sequence[Objective], scene: Any, accuracy: Accuracy) -> list[float]:
    """Measures in Python, of one foot and its walk."""
    if all(m.of == "foot" for m in measures):
        return [float(m.value(foot)) for m in measures]
    walk = simulate(foot, scene, accuracy)
    return [walk.measured(m) for m in measures]


def _scene(scene: Scene | Simulator | None) -> Any:
    """The paper's walk on hard sand where there is none."""
    found = Scene() if scene is None else scene
    check_kind(found, (Scene, Simulator), "scene", "Try fo.Scene(sand=...)")
    return found
