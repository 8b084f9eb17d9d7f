"""How do the paper's five shapes walk? All of them through one scene, side by side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

from rich.table import Table as RichTable
from rich.text import Text

from footopt.errors import SettingError, check
from footopt.foot import SHAPES, Foot
from footopt.report import figures, terminal
from footopt.report.numbers import title
from footopt.studies.base import Study
from footopt.studies.build import make_foot
from footopt.studies.record import foot_entry, scene_entry
from footopt.studies.settings import Config
from footopt.studies.validation.model import model_error
from footopt.walk import OBJECTIVES, Accuracy, Scene, Walk, simulate
from footopt.walk.resolution import error_of
from footopt.walk.validity import diagnose

MOUNTS = ("centre", "top")


def make_shapes(config: Config) -> dict[str, Foot]:
    """The five shapes by name; `study.mount` says where the shank meets them.

    "centre" is the centre of the shape's bounding box, "top" the middle of its upper side; the
    setting foot.ankle shifts the ankle from there.
    """
    mount = config.study.mount
    check(mount in MOUNTS, "study.mount", mount, f"one of {', '.join(MOUNTS)}")
    feet = {name: make_foot(replace(config.foot, shape=name)) for name in SHAPES}
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
    """Walk with the five shapes."""
    k = study.config.foot.k
    if k is not None:
        raise SettingError("foot.k", k, "null: these are the five shapes", "Use study=simulate.")
    feet, scene, accuracy = make_shapes(study.config), study.scene, study.accuracy
    scene.need_heel_strike()
    with study.compiling():
        walks = walk_shapes(feet, scene, accuracy)
        flat = simulate(make_foot(replace(study.config.foot, shape="waypoints")), scene, accuracy)
    entries: dict[str, dict[str, Any]] = {}
    with study.progress(len(walks), "shape") as step:
        for name, walk in walks.items():
            diagnostics = diagnose(walk)
            entries[name] = {
                "design": foot_entry(walk.foot),
                "feasible": walk.feasible,
                "reason": walk.reason,
                "objectives": walk.objectives,
                "error_estimate": error_of(walk),
                "model_error": model_error(walk, spread=study.options.spread.zeta),
                "accuracy": asdict(walk.accuracy),
                "validity": {d.name: d.value for d in diagnostics},
                "warnings": [f"{d.name}: {d.why}" for d in diagnostics if d.outside],
            }
            step(news=name)
    rows = ([name, *walk.objectives.values(), walk.reason] for name, walk in walks.items())
    study.write_csv("shapes.csv", ["shape", *OBJECTIVES, "reason"], rows)
    shown = {title(name): walk for name, walk in walks.items()}
    soles = {name: walk.foot for name, walk in shown.items()}
    for name, figure, caption in (
        ("shapes", figures.contours(soles), "The contact lines of the five shapes, all of one length."),
        ("states", figures.com(shown), "Position and velocity of the COM, for each shape."),
        ("forces", figures.forces(shown), "Vertical and forward force of each foot, for each shape."),
        ("power_work", figures.power_work(shown), "Power and work of the sand, for each shape."),
    ):
        study.save(name, figure, caption)
    heading = f"Five shapes on {scene.sand.name} sand (zeta {scene.sand.zeta:g})"
    warnings = _warnings(entries)
    study.say(heading, *(Text.assemble(("Warning:", "yellow"), f" {warning}") for warning in warnings))
    study.conclude(
        heading,
        [table(walks, flat)],
        {"shapes": entries, **scene_entry(scene, accuracy, tuple(OBJECTIVES))},
        said=[
            "* is the best of its line.",
            *terminal.describe_model(e["model_error"] for e in entries.values()),
        ],
        about=[terminal.describe_scene(scene)],
        warnings=warnings,
        footer={"error_estimate": {name: entry["error_estimate"] for name, entry in entries.items()}},
    )


def _warnings(entries: Mapping[str, dict[str, Any]]) -> list[str]:
    """Every warning once, with the shapes that it is about."""
    found: dict[str, list[str]] = {}
    for name, entry in entries.items():
        for warning in entry["warnings"]:
            found.setdefault(warning, []).append(title(name))
    return [f"{warning} ({', '.join(names)})." for warning, names in sorted(found.items())]


def table(walks: Mapping[str, Walk], flat: Walk) -> RichTable:
    """Objectives (rows) of walks (columns), the best of each row marked; J_W against the flat foot's, too."""
    titles = [title(name) for name in walks]
    shown = terminal.table(("objective", *titles), words=("objective",))
    for objective in OBJECTIVES.values():
        values = [walk.objectives[objective.name] for walk in walks.values()]
        good = [value for value in values if value == value]
        best = (max if objective.maximise else min)(good, default=float("nan"))
        cells = [terminal.number(v) + ("*" if v == best else " ") for v in values]
        sense = "max" if objective.maximise else "min"
        unit = f", {objective.unit}" if objective.unit else ""
        if objective.name == "efficiency" and (base := flat.objectives[objective.name]) < 0.0:
            multiples = (f"{v / base:.2f} " if v == v else f"{terminal.number(v)} " for v in values)
            shown.add_row("J_W, x of flat (max)", *multiples)
        shown.add_row(f"{objective.name.replace('_', ' ')}{unit} ({sense})", *cells)
    return shown
