"""What do the objectives of a foot depend on? Sobol indices, and one parameter at a time.

The scene lies apart as `study.spread` says, the foot as `study.foot_spread` does, each beside a known
other: what one parameter explains is a share of a variance, and that of the gait would hide the
sole's. A total index is the share that would be left if all but this parameter were known, the first
one the share that goes when only this one is (Saltelli et al. 2010; Jansen 1999); they sum to more
and less than 1 as far as parameters work together. The change that one standard deviation of each
parameter alone makes stands beside them, with its sign.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from rich.table import Table as RichTable

from footopt.errors import FootoptError, check, needed
from footopt.foot import Foot
from footopt.report import terminal
from footopt.report.figures.sensitivity import sensitivity
from footopt.studies.base import Study
from footopt.studies.build import make_spread
from footopt.studies.record import foot_entry, scene_entry
from footopt.studies.validation.model import model_error
from footopt.walk import FIVE, Accuracy, Scene, evaluate, simulate
from footopt.walk.scenarios import COLUMNS, Spread, vary
from footopt.walk.simulate import at_once

Array = NDArray[np.float64]

NAMES = (*FIVE, "efficiency")
FINE = 1000  # levels that a waypoint's own one is divided into
QUICK_SAMPLES = 16
RESAMPLES = 200  # bootstrap, for the confidence intervals
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Setting:
    """A foot and a scene, and how far what they are made of lies apart.

    Parameters
    ----------
    foot : Foot
        In the middle.
    scene : Scene
        In the middle.
    accuracy : Accuracy
        Its creep speed is in the middle.
    spread : Spread
        How far scenes lie apart.
    waypoint : float, m
        Standard deviation of each waypoint's height; of no use for a foot without any.
    width, creep : float
        Standard deviations of their logarithms.
    """

    foot: Foot
    scene: Scene
    accuracy: Accuracy
    spread: Spread
    waypoint: float
    width: float
    creep: float

    def __post_init__(self) -> None:
        for name in ("waypoint", "width", "creep"):
            value = getattr(self, name)
            check(0 <= value <= 2.0, f"study.foot_spread.{name}", value, "a standard deviation >= 0 and <= 2")

    @property
    def columns(self) -> tuple[str, ...]:
        """The parameter that each standard normal variable belongs to."""
        waypoints = [] if self.foot.k is None else [f"waypoint {i + 1}" for i in range(len(self.foot.k))]
        return (*COLUMNS, "width", "creep", *waypoints)

    @property
    def blocks(self) -> dict[str, tuple[str, ...]]:
        """The parameters that are spread at all, the sole's waypoints apart."""
        sigma = vars(self.spread) | {name: getattr(self, name) for name in ("width", "creep")}
        sigma |= {"thigh": self.spread.angles, "knee": self.spread.angles}
        names = dict.fromkeys(self.columns)
        parts = {
            "parameters": tuple(n for n in names if sigma.get(n, 0.0) > 0.0),
            "waypoints": tuple(n for n in names if n not in sigma and self.waypoint > 0.0),
        }
        return {title: part for title, part in parts.items() if part}

    def label(self, parameter: str) -> str:
        """A parameter with its standard deviation."""
        name = parameter.replace("_", " ")
        if parameter in ("thigh", "knee"):
            return f"{name}, {self.spread.angles:g}°"
        if parameter.startswith("ankle"):
            return f"{name}, {1e3 * getattr(self.spread, parameter):g} mm"
        if parameter.startswith("waypoint"):
            return f"{name.replace('waypoint ', 'k')}, {1e3 * self.waypoint:g} mm"
        sigma = getattr(self if parameter in ("width", "creep") else self.spread, parameter)
        return f"{name}, {100 * sigma:g} %"

    def walk(self, normals: Array) -> tuple[Array, str]:
        """Values (objectives,) for standard normal variables, (columns,), and why the walk failed."""
        scene, (width, creep), heights = np.split(normals, [len(COLUMNS), len(COLUMNS) + 2])
        scenario = vary(self.scene, self.spread, scene)
        foot = replace(
            self._moved(heights),
            width=self.foot.width * float(np.exp(self.width * width)),
            ankle=(self.foot.ankle[0] + scenario.ankle[0], self.foot.ankle[1] + scenario.ankle[1]),
        )
        accuracy = replace(self.accuracy, creep=self.accuracy.creep * float(np.exp(self.creep * creep)))
        table = evaluate([foot], scenario.scene, accuracy, NAMES, threads=1)
        return table.values[0], str(table.reasons[0])

    def _moved(self, normals: Array) -> Foot:
        """The foot with its waypoints moved, on a finer grid and in a box twice as deep."""
        foot = self.foot
        if foot.k is None or foot.space is None:
            return foot
        level = foot.space.H / foot.space.K / FINE
        k = np.round(FINE * np.array(foot.k) - normals * self.waypoint / level).astype(np.int64)
        space = replace(foot.space, H=2 * foot.space.H, K=2 * FINE * foot.space.K)
        return Foot.from_waypoints(np.clip(k, 1, space.K).tolist(), space)


@dataclass(frozen=True, eq=False)
class Indices:
    """Sobol indices and single changes of a setting's parameters.

    Parameters
    ----------
    parameters : (parameters,)
        Their names.
    first, total : (parameters, objectives)
        Indices.
    first_error, total_error : (parameters, objectives)
        The half width of their intervals of `CONFIDENCE`.
    change : (parameters, objectives)
        Relative, of one standard deviation up; NaN for a parameter of several variables.
    walks : int
        How many it took.
    """

    parameters: tuple[str, ...]
    first: Array
    first_error: Array
    total: Array
    total_error: Array
    change: Array
    walks: int

    @property
    def rows(self) -> Array:
        """All numbers, (parameters, objectives, 5), as sensitivity.csv has them."""
        numbers = (self.first, self.first_error, self.total, self.total_error, self.change)
        return np.stack(numbers, axis=-1)


def analyse(
    setting: Setting,
    parameters: tuple[str, ...],
    samples: int,
    seed: int,
    threads: int | None = None,
    step: Callable[[], None] = lambda: None,
) -> Indices:
    """Walk with samples of some parameters, the others in the middle, and attribute the variance.

    Parameters
    ----------
    setting : Setting
        What is varied.
    parameters : tuple of str
        Which of its parameters.
    samples, seed : int
        Of Sobol's sequence; a power of two.
    threads : int, optional
        All by default.
    step : callable
        Called after every walk.

    Raises
    ------
    SettingError
        `samples` is no power of two.
    FootoptError
        SALib is missing, or a walk fails: the indices need every one.
    """
    needed("SALib.sample", "study=sensitivity", "sensitivity")
    from SALib.analyze import sobol as sobol_analysis
    from SALib.sample import sobol as sobol_sampling
    from scipy.special import ndtri

    check(
        2 <= samples <= 2**16 and samples & (samples - 1) == 0, "study.samples", samples,
        "a power of two, at least 2 and at most 65536",
        "Sobol's sequence is even only then.",
    )  # fmt: skip
    columns = setting.columns
    used = [i for i, name in enumerate(columns) if name in parameters]
    problem = {
        "num_vars": len(used),
        "names": [f"{columns[i]} {i}" for i in used],
        "groups": [columns[i] for i in used],
        "bounds": [[0.0, 1.0]] * len(used),
    }
    quantiles = sobol_sampling.sample(problem, samples, calc_second_order=False, seed=seed)
    normals = np.zeros((len(quantiles), len(columns)))
    normals[:, used] = ndtri(np.clip(quantiles, 1e-6, 1.0 - 1e-6))
    single = _single(columns, parameters)
    values = _walk_all(setting, np.concatenate([single, normals]), threads, step)
    low, high = values[1 : len(single)].reshape(len(parameters), 2, -1).transpose(1, 0, 2)
    change = (high - low) / (2.0 * values[0])
    change[[columns.count(name) > 1 for name in parameters]] = np.nan
    options = {"num_resamples": RESAMPLES, "conf_level": CONFIDENCE, "seed": seed}
    found = [
        sobol_analysis.analyze(problem, column, calc_second_order=False, **options)
        for column in values[len(single) :].T
    ]
    first, first_error, total, total_error = (
        np.stack([np.asarray(f[name]) for f in found], axis=1) for name in ("S1", "S1_conf", "ST", "ST_conf")
    )
    return Indices(parameters, first, first_error, total, total_error, change, len(values))


def _single(columns: tuple[str, ...], parameters: tuple[str, ...]) -> Array:
    """The middle, then each parameter alone one standard deviation down and up."""
    normals = np.zeros((1 + 2 * len(parameters), len(columns)))
    for i, name in enumerate(parameters):
        normals[1 + 2 * i, columns.index(name)] = -1.0
        normals[2 + 2 * i, columns.index(name)] = 1.0
    return normals


def _walk_all(
    setting: Setting, normals: Iterable[Array], threads: int | None, step: Callable[[], None]
) -> Array:
    """Values of every row, (rows, objectives)."""
    walked = []
    with ThreadPoolExecutor(at_once(threads)) as pool:
        for found in pool.map(setting.walk, normals):
            walked.append(found)
            step()
    if failed := Counter(reason for _, reason in walked if reason):
        why = ", ".join(f"{count} {reason}" for reason, count in failed.items())
        raise FootoptError(
            f"{failed.total()} of {len(walked)} walks failed ({why}), and Sobol indices need all. "
            "Try a smaller study.spread, such as study.spread.zeta=0.1, or harder sand."
        )
    return np.array([values for values, _ in walked])


def run(study: Study) -> None:
    """Analyse one foot in one scene."""
    options, scene, foot = study.options, study.scene, study.foot
    scene.need_heel_strike()
    spread = make_spread(study.config)
    setting = Setting(foot, scene, study.accuracy, spread, **vars(options.foot_spread))
    blocks = setting.blocks
    check(blocks, "study.spread", "all 0", "more than 0 for something")
    samples = min(options.samples, QUICK_SAMPLES) if options.quick else options.samples
    walks = sum(samples * (len(part) + 2) + 2 * len(part) + 1 for part in blocks.values())
    about = f"{terminal.describe_scene(scene)}; {terminal.describe_foot(foot)}"
    study.say(f"{about}: {walks} walks")
    with study.progress(walks, "walk") as step:
        found = {
            title: analyse(setting, part, samples, study.seed, study.threads, step)
            for title, part in blocks.items()
        }
    study.write_csv(
        "sensitivity.csv",
        ["block", "parameter", "objective", "first", "first_error", "total", "total_error", "change"],
        (
            [title, parameter, name, *map(float, numbers)]
            for title, block in found.items()
            for parameter, rows in zip(block.parameters, block.rows, strict=True)
            for name, numbers in zip(NAMES, rows, strict=True)
        ),
    )
    caption = "Total Sobol index of every parameter in every objective, with its interval."
    study.save("sensitivity", sensitivity(found, NAMES, setting.label), caption)
    widest = max(float(block.total_error.max()) for block in found.values())
    model = model_error(simulate(foot, scene, study.accuracy), spread=options.spread.zeta)
    study.conclude(
        "What the objectives depend on",
        [table(found, setting)],
        {
            "design": foot_entry(foot),
            "objectives": NAMES,
            "model_error": model,
            "blocks": {title: vars(block) for title, block in found.items()},
            "confidence": CONFIDENCE,
            "samples": samples,
            "seed": study.seed,
            **scene_entry(scene, study.accuracy, NAMES),
        },
        said=[
            f"{sum(block.walks for block in found.values())} walks; the widest interval is +- {widest:.2f}, "
            "and four times the study.samples halve it",
            *terminal.describe_model([model]),
        ],
        about=[about],
    )


def table(found: Mapping[str, Indices], setting: Setting) -> RichTable:
    """Total indices with their intervals for the terminal."""
    first = "parameter, standard deviation"
    shown = terminal.table(
        (first, *(name.replace("_", " ") for name in NAMES)),
        words=(first,),
        title="total Sobol index: the part of an objective's variance in which a parameter has a share"
        f"±half width of its {100 * CONFIDENCE:.0f} % interval",
    )
    for block in found.values():
        for parameter, total, error in zip(block.parameters, block.total, block.total_error, strict=True):
            cells = [f"{t:.2f}±{e:.2f}" for t, e in zip(total, error, strict=True)]
            shown.add_row(setting.label(parameter), *cells)
        shown.add_section()
    return shown
