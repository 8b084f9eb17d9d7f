"""study=calibrate: zeta of a sand from tests with plates, with its uncertainty, as a sand for other runs."""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from omegaconf import OmegaConf
from rich.table import Table
from rich.text import Text

from footopt.errors import SettingError
from footopt.files.io import write_text
from footopt.report import terminal
from footopt.report.figures.studies import calibration as draw
from footopt.report.numbers import number
from footopt.sand import GENERIC, MEDIA, Sand
from footopt.studies.base import Study
from footopt.studies.build import make_sand
from footopt.studies.calibration import SETTING, Calibration, calibrate
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
    caption = "zeta of every measurement by its depth, with the interval of the repeats' mean."
    study.save("calibration", draw(found), caption)
    use = f"footopt --config-dir {study.folder} sand={name}"
    drawn = f"; or for how it differs from place to place: {use} study=robust study.scenarios=drawn"
    depths = f"{1e3 * found.depth.min():.3g} to {1e3 * found.depth.max():.3g}"
    study.conclude(
        f"The sand of {Path(path).name}",
        [table(found)],
        {
            "sand": name,
            "zeta": found.zeta._asdict(),
            "exponent": found.exponent._asdict(),
            "spread": found.spread,
            "repeats": found.repeats,
            "set_ups": [{"name": name, **zeta._asdict()} for name, zeta in found.set_ups.items()],
            "warnings": found.warnings,
        },
        summary=[
            f"{len(found.depth)} measurements {depths} mm deep, in {len(found.repeats)} repeats and "
            f"{len(found.set_ups)} set-ups.",
            f"Design for it: {use}{'' if found.spread is None else drawn}",
            *(Text(w, style="yellow") for w in found.warnings),
        ],
    )


def table(found: Calibration) -> Table:
    """Estimates for the terminal."""
    shown = terminal.table(("quantity", "value", "from", "to"), words=("quantity",))
    repeats = "over the repeats" if len(found.repeats) > 1 else "of one repeat"
    shown.title = f"95 % intervals {repeats}"
    parts = [("zeta", found.zeta), ("exponent of depth", found.exponent)]
    if len(found.set_ups) > 1:
        parts += [(f"zeta, {name}", zeta) for name, zeta in found.set_ups.items()]
    for name, estimate in parts:
        shown.add_row(name, *map(number, estimate))
    return shown


def sand_file(name: str, source: str, found: Calibration, sand: Sand) -> str:
    """The YAML of the sand: zeta, its spread, and coefficients that are not generic."""
    zeta, exponent = (f"{e.low:.4g} to {e.high:.4g}" for e in (found.zeta, found.exponent))
    settings: dict[str, Any] = {"name": name, "zeta": float(f"{found.zeta.value:.4g}")}
    if sand.stress_map != GENERIC:
        settings["coefficients"] = asdict(sand.stress_map)
    if found.spread is not None:
        settings["spread"] = float(f"{min(found.spread, 1.0):.4g}")  # of the logarithm of zeta
    head = f"# From {source}: zeta {zeta}, exponent of depth {exponent} (95 %).\n"
    return head + OmegaConf.to_yaml(settings)
