"""study=calibrate: zeta of one's own sand from tests with plates or penetrometers, as a sand for other runs.

A plate of area A at depth z feels F = zeta P z against its motion, with P = A (alpha_x cos g + alpha_z sin g)
of the stress map. The sand is prepared once for each repeat, whose forces share that error: each repeat is
fitted alone by least squares, and the mean over the repeats has Student's interval. A single repeat has only
the interval of its own least squares. Shallow tests and each set-up are fitted in the same way: where the law
holds, they have the zeta of all.
"""

import re
import shlex
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from omegaconf import OmegaConf
from rich.table import Table
from rich.text import Text

from footopt.arrays import Array, Words
from footopt.errors import Unusable, check, naming
from footopt.files.io import read_columns, write_text
from footopt.report import terminal
from footopt.report.figures.studies import calibration as draw
from footopt.report.numbers import number
from footopt.sand import GENERIC, MEDIA, Sand, StressMap, alpha
from footopt.studies.build import make_sand
from footopt.studies.runs import Study

SETTING = "study.tests"
COLUMNS = {"depth_mm": "", "force_N": "", "area_cm2": ""}
OPTIONAL = {"angle_deg": 0.0, "direction_deg": 90.0}  # a level plate that is pushed down
LABEL = "repeat"

COVERAGE = 0.95  # of the intervals
DEPTHS = 3  # different ones that each repeat must have at least
ZETAS = (0.005, 200.0)  # of any sand; the softest and hardest of the literature are .2 and 3
SHALLOWEST = 0.5  # mm, of the deepest row: less is a file in metres
SHALLOW = 1 / 3  # of the rows
CHANGE = 0.1  # of zeta in a part of the tests: less does not matter
WIDE = 0.3  # half an interval of that change: more is no test of the law
WORDS = re.compile(r"\d|(null|true|false|inf|nan)$", re.IGNORECASE)  # Hydra reads them as values


class Estimate(NamedTuple):
    """A value with its interval of `COVERAGE`."""

    value: float
    low: float
    high: float


class Calibration(NamedTuple):
    """The estimates that tests give of a sand, with their intervals."""

    zeta: Estimate
    spread: float | None  # sd of log zeta where the sand is prepared anew; None with one repeat
    repeats: dict[str, float]  # zeta of each alone
    parts: dict[str, Estimate]  # zeta of each part of the tests over that of all
    depth: Array  # (rows,), m
    local: Array  # (rows,), force over P z
    set_up: Words  # (rows,), the plate and its direction
    unread: list[str]  # other columns of the file

    @property
    def warnings(self) -> list[str]:
        """Reasons to doubt the estimates."""
        reasons = [
            f"zeta of the tests {name} is {part.value:.2f} times ({part.low:.2f} to {part.high:.2f}) that of "
            "all: the law does not hold there. Test as deep as feet sink, with plates of their size."
            for name, part in self.parts.items()
            if not part.low <= 1.0 <= part.high and abs(part.value - 1.0) > CHANGE
        ]
        reasons += [
            f"zeta of the tests {name} is {part.low:.2f} to {part.high:.2f} times that of all, which is no "
            "test of the law: measure more rows there, or more repeats."
            for name, part in self.parts.items()
            if part.low <= 1.0 <= part.high and part.high - part.low > 2.0 * WIDE
        ]
        if len(self.repeats) == 1:
            reasons.append(
                "One repeat says nothing of other places, and its interval takes rows for independent: "
                "test again, numbered in a column repeat."
            )
        if self.spread is not None and self.spread > 1.0:
            reasons.append(f"log zeta of the repeats has an sd of {self.spread:.2f}: are they of one sand?")
        if self.unread:
            reasons.append(f"Columns that are not read: {', '.join(self.unread)}.")
        return reasons


def run(study: Study) -> None:
    """Fit the tests, and leave a sand."""
    path = study.options.tests
    check(path is not None, SETTING, None, "a file of tests", "Try study.tests=examples/sand/plates.csv.")
    sand = make_sand(study.config.sand)
    found = calibrate(path, sand.stress_map)
    name = sand.name if sand.name not in (*MEDIA, Sand.name) else Path(path).stem
    name = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_") or "mine"
    if name in (*MEDIA, Sand.name) or WORDS.match(name):
        name = f"sand_{name}"
    write_text(study.folder / "sand" / f"{name}.yaml", sand_file(name, Path(path).name, found, sand))
    caption = "zeta of the measurements by their depth, and of the sand."
    study.save("calibration", lambda: draw(found), caption)
    use = f"footopt --config-dir {shlex.quote(str(study.folder))} sand={name}"
    drawn = f"; or for how it differs from place to place: {use} study=robust study.scenarios=drawn"
    depths = f"{1e3 * found.depth.min():.3g} to {1e3 * found.depth.max():.3g}"
    entry = {"sand": name, "zeta": found.zeta._asdict(), "spread": found.spread, "repeats": found.repeats}
    entry |= {"parts": {part: ratio._asdict() for part, ratio in found.parts.items()}}
    study.conclude(
        f"The sand of {Path(path).name}",
        [table(found)],
        entry | {"warnings": found.warnings},
        summary=[
            f"{len(found.depth)} measurements {depths} mm deep; repeats: {len(found.repeats)}.",
            f"Design for it: {use}{'' if found.spread is None else drawn}",
            *(Text(w, style="yellow") for w in found.warnings),
        ],
    )


def table(found: Calibration) -> Table:
    """Estimates for the terminal."""
    repeats = "over the repeats" if len(found.repeats) > 1 else "of one repeat"
    parts = {"zeta": found.zeta} | {f"zeta {n} / zeta of all": ratio for n, ratio in found.parts.items()}
    rows = [(name, *map(number, part)) for name, part in parts.items()]
    columns, title = ("quantity", "value", "from", "to"), f"95 % intervals {repeats}"
    return terminal.table(columns, columns[:1], title, rows)


def sand_file(name: str, source: str, found: Calibration, sand: Sand) -> str:
    """The YAML of the sand: zeta, its spread, and coefficients that are not generic."""
    settings: dict[str, Any] = {"name": name, "zeta": float(f"{found.zeta.value:.4g}")}
    if sand.stress_map != GENERIC:
        settings["coefficients"] = asdict(sand.stress_map)
    if found.spread is not None:
        settings["spread"] = float(f"{min(found.spread, 1.0):.4g}")  # of the logarithm of zeta
    head = f"# From {source}: zeta {found.zeta.low:.4g} to {found.zeta.high:.4g} (95 %).\n"
    return head + OmegaConf.to_yaml(settings)


def calibrate(path: str | Path, stress_map: StressMap = GENERIC) -> Calibration:
    """Fit zeta, which scales a stress map, to tests with plates.

    They are in a CSV file with the columns ``depth_mm`` (of the plate's middle below the surface; rows above
    it are left out), ``force_N`` (against the motion), ``area_cm2`` and, optionally, ``angle_deg`` (of the
    plate, 0 is level), ``direction_deg`` (of the motion, 90 is down) and ``repeat`` (the preparation of the
    sand, any word). Raises `FileError` if the file cannot be read, lacks a column, holds
    something that is not a number, has too few depths, or no sand can have such forces.
    """
    table, words, unread = read_columns(path, SETTING, COLUMNS, OPTIONAL, LABEL)
    with naming(path, SETTING):
        for one in OPTIONAL:
            stem = one.removesuffix("_deg")
            if alike := [name for name in unread if re.match(rf"{stem}(_rad)?$", name, re.IGNORECASE)]:
                raise Unusable(f"has a column {alike[0]}, which is not read: {one} is in degrees.")
        if any(words) and not all(words):
            raise Unusable(f"has rows without a {LABEL}: each needs the number or name of its repeat.")
        inside = table["depth_mm"] > 0
        if not inside.any():
            raise Unusable("has no row with depth_mm > 0: depth is below the surface, in mm.")
        if (deepest := table["depth_mm"].max()) < SHALLOWEST:
            raise Unusable(f"is at most {deepest:g} mm deep: depth_mm is in mm, and no foot sinks so little.")
        labels = np.array(words)[inside]
        depth, force, area, angle, direction = (table[name][inside] for name in (*COLUMNS, *OPTIONAL))
        if not (area > 0).all():
            raise Unusable("area_cm2 must be > 0, the area of the plate's face.")
        if max(abs(angle).max(), abs(direction).max()) > 180:
            raise Unusable("angle_deg and direction_deg must be from -180 to 180.")
        set_up = np.array([f"{a:.3g} cm² at {b:g}° moved at {g:g}°"
                           for a, b, g in zip(area, angle, direction, strict=True)])  # fmt: skip
        shallow = np.quantile(depth, SHALLOW)
        parts = {f"less than {shallow:.3g} mm deep": depth <= shallow}
        names = dict.fromkeys(set_up.tolist())
        back = np.append(False, np.diff(depth) < 0.0)
        back[1:] &= (set_up[1:] == set_up[:-1]) & (labels[1:] == labels[:-1])
        parts |= {"on the way back": back} if back.any() else {}
        parts |= {f"with {name}": set_up == name for name in names if len(names) > 1}

        depth, area, gamma = 1e-3 * depth, 1e-4 * area, np.radians(direction)
        x, z = alpha(np.radians(angle), gamma, stress_map)
        unit = (x * np.cos(gamma) + z * np.sin(gamma)) * area * depth  # the force where zeta is 1, N
        if not (unit > 0).all():
            raise Unusable("the stress map has a plate of these angles pushed along; zeta cannot be found.")
        repeats = {name: labels == name for name in dict.fromkeys(labels.tolist())}
        for name, own in repeats.items():
            if len(np.unique(depth[own])) < DEPTHS:
                raise Unusable(f"{f'repeat {name!r} ' * bool(name)}has fewer than {DEPTHS} different depths.")
        zetas, errors = np.array([_fit(unit[own], force[own]) for own in repeats.values()]).T
        if zetas.min() < ZETAS[0] or zetas.max() > ZETAS[1]:
            raise Unusable(
                f"zeta would be {zetas.min():.3g} to {zetas.max():.3g}; that of sands is {ZETAS[0]:g} to "
                f"{ZETAS[1]:g}. Check the units (mm, N, cm2) and the sign: force_N is > 0 against the motion."
            )

    ratios = {}
    for name, part in parts.items():
        own = [(part & repeat, zeta) for repeat, zeta in zip(repeats.values(), zetas, strict=True)]
        if found := [np.divide(_fit(unit[rows], force[rows]), zeta) for rows, zeta in own if rows.sum() > 1]:
            ratio, error = np.transpose(found)
            ratios[name] = _mean(ratio, error[0], int(part.sum()) - 1)
    log = _mean(np.log(zetas), errors[0] / zetas[0], len(force) - 1)
    return Calibration(
        zeta=Estimate(*np.exp(log).tolist()),
        # of the next repeat about the mean that is known
        spread=float(np.log(zetas).std(ddof=1) * np.sqrt(1 + 1 / len(zetas))) if len(zetas) > 1 else None,
        repeats=dict(zip(repeats, zetas.tolist(), strict=True)),
        parts=ratios,
        depth=depth,
        local=force / unit,
        set_up=set_up,
        unread=unread,
    )


def _fit(unit: Array, force: Array) -> tuple[float, float]:
    """zeta by least squares and its standard error; unit: the force where zeta is 1, N.

    Whether forces scatter by as much everywhere or in proportion to their size: HC3, MacKinnon & White 1985.
    """
    weight = unit / (unit @ unit)
    zeta = float(weight @ force)
    residual = (force - zeta * unit) / (1.0 - weight * unit)
    return zeta, float(np.sqrt(np.sum((weight * residual) ** 2)))


def _mean(values: Array, error: float, freedom: int) -> Estimate:
    """The mean of repeats with Student's interval; of a single one its value with its own standard error."""
    from scipy.special import stdtrit

    if (count := len(values)) > 1:
        error, freedom = float(values.std(ddof=1) / np.sqrt(count)), count - 1
    mean, half = float(values.mean()), float(stdtrit(freedom, 0.5 + 0.5 * COVERAGE)) * error
    return Estimate(mean, mean - half, mean + half)
