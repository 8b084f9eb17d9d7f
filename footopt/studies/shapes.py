"""How do the paper's five shapes walk? All of them through one scene, side by side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from rich.table import Table as RichTable

from footopt.errors import SettingError, check
from footopt.files import run as files
from footopt.foot import SHAPES, Foot
from footopt.report import figures, page, terminal
from footopt.report.figures import paper as paper_figures
from footopt.report.progress import progress
from footopt.studies import build
from footopt.studies.base import Study
from footopt.studies.record import foot_entry, scene_entry
from footopt.studies.settings import Config
from footopt.walk import OBJECTIVES, Accuracy, Scene, Walk, estimate_error, simulate
from footopt.walk.validity import diagnose

MOUNTS = ("centre", "top")

#: What each figure shows.
SAYS = {
    "shapes": "The five shapes with their contact lines and the ankle.",
    "states": "Position, height and speed of the COM over time, for each shape.",
    "forces": "Vertical and forward force of each foot over time, for each shape.",
    "power_work": "Power and work of the sand over time, for each shape.",
}


def make_shapes(config: Config) -> dict[str, Foot]:
    """The five shapes by name; `study.mount` says where the shank meets them.

    "centre" is the centre of the shape's bounding box, "top" the middle of its upper side; the
    setting foot.ankle shifts the ankle from there.
    """
    mount = config.study.mount
    check(mount in MOUNTS, "study.mount", mount, f"one of {', '.join(MOUNTS)}")
    feet = {name: build.make_foot(replace(config.foot, shape=name)) for name in SHAPES}
    if mount == "centre":
        return feet
    # the box's centre is the origin, and every shape's contact line reaches its lower side
    return {
        name: replace(foot, ankle=(foot.ankle[0], foot.ankle[1] - float(foot.contour[:, 1].min())))
        for name, foot in feet.items()
    }


def walk_shapes(feet: Mapping[str, Foot], scene: Scene, accuracy: Accuracy | str) -> dict[str, Walk]:
    """Walks of the shapes by name."""
    return {name: simulate(foot, scene, accuracy) for name, foot in feet.items()}


def run(study: Study) -> None:
    """Walk with the five shapes and write tables and figures to `folder`."""
    config, folder, settings = study.config, study.folder, study.settings
    out, clock = study.console, terminal.clock()
    if config.foot.k is not None:
        raise SettingError("foot.k", config.foot.k, "null: these are the five shapes", "Use study=simulate.")
    feet = make_shapes(config)
    scene, accuracy = build.make_scene(config), build.make_accuracy(config.accuracy)
    scene.need_heel_strike()
    with terminal.told_if_slow(out, "Compiling the walk; this is done once and kept on disk ..."):
        walks = walk_shapes(feet, scene, accuracy)
    entries: dict[str, dict[str, Any]] = {}
    with progress(out, len(walks), "shape") as step:
        for name, walk in walks.items():
            diagnostics = diagnose(walk)
            entries[name] = {
                "design": foot_entry(walk.foot),
                "feasible": walk.feasible,
                "reason": walk.reason,
                "objectives": walk.objectives,
                "error_estimate": estimate_error(walk.foot, scene, accuracy),
                "validity": {d.name: d.value for d in diagnostics},
                "warnings": [f"{d.name}: {d.why}" for d in diagnostics if d.outside],
            }
            step(news=name)
    files.write_csv(
        folder / "shapes.csv",
        ["shape", *OBJECTIVES, "reason"],
        ([name, *walk.objectives.values(), walk.reason] for name, walk in walks.items()),
    )
    record = {
        "study": "shapes",
        "shapes": entries,
        **scene_entry(scene, accuracy, tuple(OBJECTIVES)),
        "settings": settings,
        "versions": files.versions(),
        "wall_time_s": clock(),
    }
    files.write_json(folder / "result.json", record)
    shown = paper_figures.labelled(walks)
    for name, figure in {
        "shapes": paper_figures.shapes(feet),
        "states": paper_figures.states(shown),
        "forces": figures.forces(shown),
        "power_work": figures.power_work(shown),
    }.items():
        figures.save(figure, folder / "figures", name)
    compared, title = table(walks), f"Five shapes on {scene.sand.name} sand (zeta {scene.sand.zeta:g})"
    out.print(title)
    out.print(compared)
    warnings = []
    for warning in sorted({w for entry in entries.values() for w in entry["warnings"]}):
        names = [name for name, entry in entries.items() if warning in entry["warnings"]]
        warnings.append(f"{warning} ({', '.join(names)}).")
        terminal.warn(out, warnings[-1])
    errors = {name: entry["error_estimate"] for name, entry in entries.items()}
    said = [terminal.describe_scene(scene), *(f"Warning: {warning}" for warning in warnings)]
    page.write_study(folder, title, said, SAYS, [compared], record | {"error_estimate": errors})
    terminal.everything_is_in(out, folder, clock())


def table(walks: Mapping[str, Walk]) -> RichTable:
    """Objectives (rows) of walks (columns), with the best of each row marked."""
    titles = [paper_figures.title(name) for name in walks]
    shown = terminal.table(("objective", *titles), words=("objective",))
    for objective in OBJECTIVES.values():
        values = {name: walk.objectives[objective.name] for name, walk in walks.items()}
        good = [value for value in values.values() if value == value]
        best = (max if objective.maximise else min)(good, default=float("nan"))
        cells = [terminal.number(v) + ("*" if v == best else " ") for v in values.values()]
        sense = "max" if objective.maximise else "min"
        unit = f", {objective.unit}" if objective.unit else ""
        shown.add_row(f"{objective.name.replace('_', ' ')}{unit} ({sense})", *cells)
    return shown
