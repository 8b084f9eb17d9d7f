"""How hard is your own sand? zeta from tests with plates, with its uncertainty, as a sand for other runs."""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass
from pathlib import Path

from rich.table import Table
from rich.text import Text

from footopt.errors import SettingError
from footopt.files.io import write_text
from footopt.report import terminal
from footopt.report.figures.studies import calibration as draw
from footopt.sand import GENERIC, MEDIA, Sand
from footopt.studies.base import Study
from footopt.studies.build import make_sand
from footopt.studies.calibration import SETTING, Calibration, Estimate, calibrate
from footopt.studies.settings import StudySettings, setting


@dataclass
class Settings(StudySettings):
    """zeta from tests with plates or a penetrometer, with its uncertainty, as a sand for other runs."""

    name: str = "calibrate"
    tests: str | None = setting(
        None, "CSV of tests: depth_mm, force_N, area_cm2; if known, angle_deg, direction_deg, repeat."
    )
    reads = ("sand.name", "sand.coefficients", "sand.table")


def run(study: Study) -> None:
    """Fit the tests, and leave a sand."""
    path = study.options.tests
    if path is None:
        raise SettingError(SETTING, None, "a file of tests", "Try study.tests=examples/sand/plates.csv.")
    sand = make_sand(study.config.sand)
    found = calibrate(path, sand.stress_map)
    name = sand.name if sand.name not in (*MEDIA, Sand.name) else Path(path).stem
    name = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_") or "mine"
    folder = study.folder / "sand"
    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / f"{name}.yaml", sand_file(name, Path(path).name, found, sand))
    study.write_csv(
        "repeats.csv", ("repeat", "zeta", "exponent"), [(n, *v) for n, v in found.repeats.items()]
    )
    caption = "zeta of every measurement by its depth, with the interval of the repeats' mean."
    study.save("calibration", draw(found), caption)
    study.conclude(
        f"The sand of {Path(path).name}",
        [table(found)],
        {
            "sand": name,
            "zeta": asdict(found.zeta),
            "exponent": asdict(found.exponent),
            "spread": found.spread,
            "repeats": found.repeats,
            "set_ups": [{"name": s.name, "rows": s.rows, **asdict(s.zeta)} for s in found.set_ups],
            "warnings": found.warnings,
        },
        said=[
            *said(found),
            use(study.folder, name, found),
            *(Text(w, style="yellow") for w in found.warnings),
        ],
    )


def table(found: Calibration) -> Table:
    """Estimates for the terminal."""
    shown = terminal.table(("quantity", "value", "from", "to"), words=("quantity",))
    shown.title = (
        "95 % intervals over the repeats" if len(found.repeats) > 1 else "95 % intervals, one repeat"
    )
    parts = [("zeta", found.zeta), ("exponent of depth", found.exponent)]
    if len(found.set_ups) > 1:
        parts += [(f"zeta, {s.name}", s.zeta) for s in found.set_ups]
    for name, e in parts:
        shown.add_row(name, *(terminal.number(v) for v in (e.value, e.low, e.high)))
    return shown


def said(found: Calibration) -> list[str]:
    """What the estimates rest on."""
    above = f"; {found.left_out} rows above the surface are left out" if found.left_out else ""
    rests = (
        f"{len(found.depth)} measurements, {1e3 * found.depth.min():.3g} to {1e3 * found.depth.max():.3g} mm "
        f"deep, in {len(found.repeats)} repeats and {len(found.set_ups)} set-ups{above}."
    )
    known = [f"{name} ({zeta:g})" for name, zeta in MEDIA.items() if not found.zeta.excludes(zeta)]
    return [f"{rests} Within the interval: {', '.join(known)}." if known else rests]


def use(folder: Path, name: str, found: Calibration) -> str:
    """How the sand is used."""
    here = f"footopt --config-dir {folder} sand={name}"
    if found.spread is None:
        return f"Design for it: {here}"
    robust = f"footopt --config-dir {folder} study=robust study.scenarios=drawn sand={name}"
    return f"Design for it: {here}; or for how it differs from place to place: {robust}"


def sand_file(name: str, source: str, found: Calibration, sand: Sand) -> str:
    """The YAML of the sand: zeta, its spread, and coefficients that are not generic."""

    def interval(e: Estimate) -> str:
        return f"{e.low:.4g} to {e.high:.4g}"

    lines = [
        f"# From {source}: zeta {interval(found.zeta)}, exponent of depth {interval(found.exponent)} (95 %).",
        f"name: {name}",
        f"zeta: {found.zeta.value:.4g}",
    ]
    if sand.stress_map != GENERIC:
        lines += ["coefficients:"]
        lines += [f"  {key}: {value:.6g}" for key, value in asdict(sand.stress_map).items()]
    if found.spread is not None:
        lines += [f"spread: {min(found.spread, 1.0):.4g} # of the logarithm of zeta"]
    return "\n".join(lines) + "\n"
