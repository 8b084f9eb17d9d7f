"""study=simulate: one sole through one scene, with traces, figures and files."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.text import Text

from footopt.errors import check
from footopt.files import io as files
from footopt.files.feet import body_outline, write_all, write_foot
from footopt.files.identity import result_of
from footopt.foot import Foot
from footopt.report import terminal
from footopt.report.numbers import title
from footopt.report.output import foot_entry, scene_entry
from footopt.studies import ROBOT, SCENE
from footopt.studies.build import make_strides
from footopt.studies.effects import choose_effects
from footopt.studies.load import changed_since, foot_of
from footopt.studies.runs import Study
from footopt.walk import Diagnostic, Walk, diagnose, simulate
from footopt.walk.resolution import error_of, resolution
from footopt.walk.results import stance

SHORTEST = 12  # samples of a contact that is drawn in six pictures


def run(study: Study) -> Any:
    """Walk with one foot and leave everything about the walk; returns its values."""
    folder, k, accuracy = study.options.run, study.config.foot.k, study.accuracy
    foot = study.foot if folder is None else foot_of(Path(folder), k)
    check_files(study, foot)
    scene, chosen = choose_effects(study, foot)
    study.say(terminal.describe_setup(scene, foot))
    with study.compiling():
        walk = simulate(foot, scene, accuracy)
        level = Foot.flat(foot.space) if foot.space else flattened(foot)
        flat = walk if level == foot else simulate(level, scene, accuracy)
    names = tuple(dict.fromkeys((*walk.objectives, *study.config.objective.names)))
    entry, diagnostics = walk_entry(study, walk, flat, names, chosen)
    values, base = entry["objectives"], entry["flat"]
    strides = make_strides(study.config.gait)
    read = [] if strides is None else [*strides.notes]
    if strides is not None and study.wants_figures:
        from footopt.report.figures.scenes import gait_fit

        study.save("gait", gait_fit(strides, walk.world.gait))
    notes = [*foot.notes, *write_walk(study, walk, {title(foot.name): walk}), *_undefined(walk, values)]
    before, changed = result_of(Path(folder)) if folder and k is None else None, list[str]()
    if before and all(before["settings"][name] == study.settings[name] for name in (*SCENE, *ROBOT)):
        changed += changed_since(before, walk) if before.get("accuracy") == asdict(walk.accuracy) else []
    about = {"design": foot_entry(foot), "feasible": walk.feasible, "reason": walk.reason}
    record = study.write_result({**about, **entry, "notes": [*notes, *changed], "gait_file": read})
    if study.wants_report:
        from footopt.report import page

        page.write(study.folder / "report.html", page.walk_content(walk, record, flat) | study.origin)
    write_film(study, walk)

    study.say(terminal.describe_foot(foot))
    if strides is not None:
        misfit = ", ".join(f"{joint} {rms:.2f}" for joint, rms in walk.world.gait.residual)
        study.say(f"Gait from {study.config.gait.path}: {'; '.join(read)}. Misfit (rms, deg): {misfit}")
    if not walk.feasible:
        study.say(Text(f"The walk failed: {walk.reason} after {len(walk.t)} steps of time.", style="yellow"))
    others = None if flat is walk else base
    study.say(terminal.objective_table("sole", values, others, entry["error_estimate"]))
    terminal.print_validity(study.console, diagnostics)
    for note in changed:
        terminal.warn(study.console, note)
    study.close()
    return values


def flattened(foot: Foot) -> Foot:
    """The level sole that is as long as another one, at its lowest point."""
    (left, low), (right, _) = foot.contour.min(axis=0), foot.contour.max(axis=0)
    return replace(foot, contour=np.array([(left, low), (right, low)]), name="flat")


def _undefined(walk: Walk, values: Mapping[str, float]) -> list[str]:
    """Why a walk that has not failed has no value of some objectives."""
    names = [name.replace("_", " ") for name, value in values.items() if not math.isfinite(value)]
    if not (walk.feasible and names):
        return []
    strikes = len(walk.scene.strikes)
    why = "a number is beyond what can be computed" if strikes else "there is no heel strike in this walk"
    return [f"There is no value of {', '.join(names)}: {why}."]


def walk_entry(
    study: Study, walk: Walk, flat: Walk, names: Sequence[str], chosen: Mapping[str, Any]
) -> tuple[dict[str, Any], list[Diagnostic]]:
    """A walk in result.json, with errors, validity, and the flat sole's values; and its diagnostics.

    `chosen` are the effects that an audit chose.
    """
    errors = error_of(walk, names)
    try:
        level = flat.measures(names)
    except Exception as error:  # of a user's own measure, whose feet a search leaves out
        study.say(f"The flat sole has no measures: {type(error).__name__}: {error}")
        level = dict.fromkeys(names, math.nan)
    diagnostics = [*diagnose(walk), *resolution(walk, errors)]
    entry = {
        "objectives": walk.measures(names),
        "flat": level,
        "error_estimate": errors,
        **scene_entry(walk.scene, walk.accuracy, names),
        "validity": {d.name: d.value for d in diagnostics},
        "validity_units": {d.name: d.unit for d in diagnostics},
        "warnings": [terminal.describe_outside(d) for d in diagnostics if d.outside],
        **chosen,
    }
    return entry, diagnostics


def write_walk(study: Study, walk: Walk, walks: Mapping[str, Walk]) -> list[str]:
    """Write a walk's traces, its foot for the workshop, and figures of `walks` by name, if wanted.

    Returns notes on the files for the workshop.
    """
    if not study.wants_report:
        write_foot(walk.foot, study.folder / "contour.csv")
        return []
    order = {"foot_order": ", ".join(walk.sides), "reason": walk.reason}
    files.write_walk(study.folder / "walk.nc", walk.variables, order)
    _, notes = write_all(walk.foot, study.folder, study.config.foot.block)
    if study.wants_figures:
        from footopt.report import figures  # matplotlib takes a second

        study.save("com", figures.com(walks))
        study.save("forces", figures.forces(walks))
        study.save("power_work", figures.power_work(walks))
        study.save("contour", figures.contour(walk.foot))
        found = stance(walk)
        if found is not None and found.last - found.first >= SHORTEST:  # a step, no fall
            study.save("step", figures.step(walk))
    return notes


def check_files(study: Study, foot: Foot) -> None:
    """Raise a `SettingError`, before any walk, if foot.block does not fit, or study.video cannot be made."""
    if study.config.foot.block is not None:
        body_outline(foot, study.config.foot.block)
    if study.options.video is not None:
        from footopt.report import film

        name = study.options.video
        check(Path(name).name == name, "study.video", name, "a name, for a file in the run's folder")
        film.check_film(study.folder / study.options.video, setting="study.video")


def write_film(study: Study, walk: Walk) -> None:
    """Write the film that `study.video` asks for, unless the walk failed at once."""
    if study.options.video is not None and len(walk.t):
        from footopt.report import film

        film.animate(walk, study.folder / study.options.video)
