"""How do I make this foot? The foot of a run that is over, as files for a workshop."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

from footopt.config import Config, FootConfig
from footopt.errors import FileError, FootoptError, SettingError
from footopt.foot import Foot
from footopt.foot.export import MM, body_outline
from footopt.foot.polygon import enclosed_area
from footopt.foot.solid import write_all
from footopt.reading import named, read_json_file
from footopt.report import files, terminal
from footopt.studies import build
from footopt.studies.simulate import foot_entry

#: What damaged settings raise, our own refusals among them.
DAMAGED = (FootoptError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


def run(config: Config, folder: Path, settings: dict[str, Any]) -> None:
    """Write the foot of the run `study.run` to `folder` in every format, each read back and checked."""
    out, clock = terminal.console(), terminal.clock()
    if config.study.run is None:
        raise SettingError(
            "study.run", None, "the folder of a run", "Try footopt study=export run=outputs/optimize/..."
        )
    foot = foot_of(Path(config.study.run), config.foot.k)
    written = write_all(foot, folder, config.foot.block)
    outline = MM * body_outline(foot, config.foot.block)
    area = enclosed_area(outline)
    files.write_json(
        folder / "result.json",
        {
            "study": "export",
            "run": config.study.run,
            "design": foot_entry(foot),
            "area_mm2": area,
            "volume_mm3": area * MM * foot.width,
            "size_mm": [*(outline.max(axis=0) - outline.min(axis=0)), MM * foot.width],
            "settings": settings,
            "versions": files.versions(),
            "wall_time_s": clock(),
        },
    )
    out.print(f"{terminal.describe_foot(foot)}: {area:.0f} mm^2, {MM * foot.width:g} mm wide")
    out.print(f"{', '.join(path.name for path in written)}: each read back; area and volume agree")
    terminal.everything_is_in(out, folder, clock())


def foot_of(folder: Path, k: list[int] | None = None) -> Foot:
    """The foot of a run: its best sole, or another of its design space.

    Parameters
    ----------
    folder : of a run of optimize or simulate. k : heights of another sole, e.g. of its Pareto front.

    Raises
    ------
    FileError : the folder does not hold such a run.
    """
    try:
        result = read_json_file(folder / "result.json", "run", "study.run")
        design, known = result["design"], {f.name for f in dataclasses.fields(FootConfig)}
        saved = FootConfig(**{key: v for key, v in result["settings"]["foot"].items() if key in known})
        own = design["k"]
        if k is None or saved.shape != "waypoints":
            found = _saved_foot(folder, design, saved)
    except DAMAGED as error:
        raise FileError(
            f"{named(folder, 'study.run')}: not the folder of a run with one foot "
            f"({type(error).__name__}: {error}). Give one of study=optimize or simulate."
        ) from None
    if k is None:
        return found
    if saved.shape != "waypoints" or own is None:
        raise SettingError("foot.k", k, f"null: the run's foot is {saved.shape}")
    return build.make_foot(dataclasses.replace(saved, k=k))


def _saved_foot(folder: Path, design: dict[str, Any], saved: FootConfig) -> Foot:
    """The foot that a run has kept."""
    if design["k"] is not None:
        foot = build.make_foot(dataclasses.replace(saved, k=design["k"]))
    else:  # the contour itself: a drawing that it came from may have changed
        width, (x, z) = float(design["width_m"]), design["ankle_m"]
        ankle = float(x), float(z)
        foot = Foot.from_file(folder / "contour.csv", width, ankle, saved.closed, saved.top)
    return dataclasses.replace(foot, name=str(design["name"]))
