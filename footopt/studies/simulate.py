"""How does this foot walk? One sole through one scene, with traces, figures and files."""

from __future__ import annotations

from footopt.files import run as files
from footopt.foot.export import write_all
from footopt.report import figures, film, page, terminal
from footopt.report.figures.gait import gait_fit
from footopt.studies import build
from footopt.studies.auto import settle
from footopt.studies.base import Study
from footopt.studies.record import foot_entry, scene_entry, validity_entry
from footopt.walk import OBJECTIVES, estimate_error, simulate
from footopt.walk.validity import diagnose


def run(study: Study) -> None:
    """Walk with one foot and write everything about it to `folder`."""
    config, folder, settings = study.config, study.folder, study.settings
    out, clock = study.console, terminal.clock()
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
        film.animate(walk, folder / config.study.video)

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
