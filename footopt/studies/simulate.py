"""How does this foot walk? One sole through one scene, with traces, figures and files."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from footopt.files import run as files
from footopt.foot import Foot
from footopt.foot.export import write_all
from footopt.report import figures, film, page, terminal
from footopt.report.gait_figure import gait_fit
from footopt.studies import build
from footopt.studies.auto import settle
from footopt.studies.settings import Config
from footopt.walk import OBJECTIVES, Accuracy, Scene, estimate_error, simulate
from footopt.walk.audit import name_of, parameters
from footopt.walk.validity import Diagnostic, diagnose


def run(config: Config, folder: Path, settings: dict[str, Any]) -> None:
    """Walk with one foot and write everything about it to `folder`."""
    out, clock = terminal.console(), terminal.clock()
    if config.study.video is not None:
        film.check_film(folder / config.study.video, setting="study.video")
    foot = build.make_foot(config.foot)
    accuracy = build.make_accuracy(config.accuracy)
    scene, audits = settle(config, foot, out)
    with terminal.told_if_slow(out, "Compiling the walk; this is done once and kept on disk ..."):
        walk = simulate(foot, scene, accuracy)
    errors = estimate_error(foot, scene, accuracy)
    diagnostics = diagnose(walk)
    files.write_walk(folder / "walk.nc", walk.variables, {"reason": walk.reason})
    _, notes = write_all(foot, folder, config.foot.block)
    walks = {foot.name: walk}
    drawn = {
        "contour": figures.contour(foot),
        "com": figures.com(walks),
        "forces": figures.forces(walks),
        "power_work": figures.power_work(walks),
        "step": figures.step(walk),
    }
    strides = build.make_strides(config.gait)
    if strides is not None:
        drawn["gait"] = gait_fit(strides, scene.gait)
    entry = {
        "study": "simulate",
        "design": foot_entry(foot),
        "feasible": walk.feasible,
        "reason": walk.reason,
        "objectives": walk.objectives,
        "error_estimate": errors,
        **scene_entry(scene, accuracy, tuple(OBJECTIVES)),
        **validity_entry(diagnostics),
        "notes": notes,
        "gait_file": strides.notes if strides is not None else [],
        "effects_audit": audits,
        "settings": settings,
        "versions": files.versions(),
        "wall_time_s": clock(),
    }
    files.write_json(folder / "result.json", entry)
    for name, figure in drawn.items():
        figures.save(figure, folder / "figures", name)
    page.write(folder / "report.html", page.walk_content(walk, entry))
    if config.study.video is not None and len(walk.t):
        film.write(walk, folder / config.study.video)

    out.print(f"{terminal.describe_scene(scene)}; {terminal.describe_foot(foot)}")
    if strides is not None:
        fitted = ", ".join(f"{joint} {rms:.2f}" for joint, rms in scene.gait.residual)
        out.print(f"Gait from {config.gait.path}: {'; '.join(strides.notes)}. Misfit (rms, deg): {fitted}")
    if not walk.feasible:
        out.print(f"The walk failed: {walk.reason} after {len(walk.t)} steps of time.", style="yellow")
    out.print(terminal.objective_table([(foot.name, walk.objectives)], tuple(OBJECTIVES), errors))
    terminal.print_validity(out, diagnostics)
    for note in notes:
        out.print(note)
    terminal.everything_is_in(out, folder, clock())


def foot_entry(foot: Foot) -> dict[str, Any]:
    """A foot in result.json."""
    return {
        "name": foot.name,
        "k": foot.k,
        "hollow_mm": 1e3 * foot.hollow,
        "box_violation_mm": None if foot.box_violation is None else 1e3 * foot.box_violation,
        "width_m": foot.width,
        "ankle_m": foot.ankle,
    }


def validity_entry(diagnostics: Sequence[Diagnostic]) -> dict[str, Any]:
    """The validity of a walk in result.json."""
    return {
        "validity": {d.name: d.value for d in diagnostics},
        "validity_units": {d.name: d.unit for d in diagnostics},
        "warnings": [terminal.describe_outside(d) for d in diagnostics if d.outside],
    }


def scene_entry(scene: Scene, accuracy: Accuracy, names: Sequence[str]) -> dict[str, Any]:
    """A scene, its accuracy and the units and senses of the objectives in result.json."""
    return {
        "units": {name: OBJECTIVES[name].unit for name in names},
        "maximise": {name: OBJECTIVES[name].maximise for name in names},
        "scene": {
            "sand": {
                "name": scene.sand.name,
                "zeta": scene.sand.zeta,
                "coefficients_N_cm3": dataclasses.asdict(scene.sand.stress_map),
                "fit_error": scene.sand.fit_error,
            },
            "gait": {
                "name": scene.gait.name,
                "period_s": scene.gait.period,
                "pitch": scene.gait.pitch,
                "source": scene.gait.source,
                "fit_residual_deg": dict(scene.gait.residual),
            },
            "walker": dataclasses.asdict(scene.walker),
            "t_f_s": scene.duration,
            "effects": {name_of(e): parameters(e) for e in scene.effects},
        },
        "accuracy": dataclasses.asdict(accuracy),
    }
