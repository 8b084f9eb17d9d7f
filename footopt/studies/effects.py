"""Which effects does a scene call for? Each on in turn: what it changes, what it costs, a verdict."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rich.table import Table

from footopt.effects import EFFECTS, Effect, LeadingEdge
from footopt.errors import check
from footopt.files import run as files
from footopt.report import summary, terminal
from footopt.report.figures import save
from footopt.report.figures.effects import changes
from footopt.report.progress import progress
from footopt.sand import Sand
from footopt.studies import build
from footopt.studies.auto import COMPILING, entry, tolerance
from footopt.studies.base import Study
from footopt.studies.record import scene_entry
from footopt.walk import FIVE, Scene, evaluate
from footopt.walk.audit import Audit, audit, percent, switched

#: The leading edge is always audited on these: faces that trail do a fifth to a half of the work.
SANDS = ("soft", "regular", "hard")


def run(study: Study) -> None:
    """Audit every effect and write the verdicts to `folder`."""
    config, folder, settings = study.config, study.folder, study.settings
    out, clock = study.console, terminal.clock()
    check(2 <= config.study.feet <= 10_000, "study.feet", config.study.feet, "2, to rank them, to 10,000")
    scene, space = build.make_scene(config), build.make_space(config.foot)
    accuracy, limit = build.make_accuracy(config.accuracy), tolerance(config)
    feet = space.random(config.study.feet, seed=config.solver.seed, inside=True)
    pairs = candidates(scene)
    found: list[Audit] = []
    with terminal.told_if_slow(out, COMPILING):
        for walked in dict.fromkeys(scene for pair in pairs for scene in switched(*pair)):
            evaluate(feet[:1], walked, accuracy, space=space)
    with progress(out, len(pairs), "effect") as step:
        for effect, where in pairs:
            found.append(audit(effect, where, feet, accuracy, limit, space))
            step(news=f"{found[-1].name.replace('_', ' ')} on {where.sand.name} sand")
    header = ["effect", "sand", *(f"change_{n}" for n in FIVE), *(f"shift_{n}" for n in FIVE)]
    header += ["tau", "lost", "feet", "cost", "tolerance", "matters", "verdict"]
    files.write_csv(folder / "effects.csv", header, [_row(a) for a in found])
    save(changes(found), folder / "figures", "effects")
    record = {
        "study": "effects",
        "seed": config.solver.seed,
        "feet": feet.tolist(),
        **scene_entry(scene, accuracy, ()),
        "audit": [entry(a) for a in found],
        "called_for": sorted({a.name for a in found if a.matters and a.scene.sand == scene.sand}),
        "settings": settings,
        "versions": files.versions(),
        "wall_time_s": clock(),
    }
    verdicts = [f"{a.name.replace('_', ' ')} on {a.scene.sand.name} sand {a.verdict}" for a in found]
    says = {"effects": "What each effect changes in every objective, against the change that matters."}
    summary.conclude(folder, "What each effect changes", verdicts, says, [table(found)], record)


def candidates(scene: Scene) -> list[tuple[Effect, Scene]]:
    """Every effect, as the scene names it or with its own defaults, and where it is switched on."""
    found: list[tuple[Effect, Scene]] = []
    for kind in EFFECTS.values():
        named = [effect for effect in scene.effects if isinstance(effect, kind)]
        effect = named[0] if named else kind()
        found.append((effect, scene))
        if kind is LeadingEdge:
            others = [Sand.named(name) for name in SANDS if Sand.named(name).zeta != scene.sand.zeta]
            found += [(effect, replace(scene, sand=sand)) for sand in others]
    return found


def _row(a: Audit) -> list[object]:
    numbers = [*a.changes.tolist(), *a.shifts.tolist(), a.tau, a.lost, a.feet, a.cost, a.tolerance]
    return [a.name, a.scene.sand.name, *numbers, int(a.matters), a.verdict]


def table(found: Sequence[Audit]) -> Table:
    """Audits for the terminal: changes in %, with the median's sign."""
    shown = terminal.table(
        ("effect", "sand", *(n.replace("_", " ") for n in FIVE), "tau", "time", "keep"),
        words=("effect", "sand"),
        title="change that 95 % of the feet do not exceed (%), + or -: the median's sign",
    )
    for a in found:
        pairs = zip(a.changes, a.shifts, strict=True)
        cells = [f"{'+' if shift > 0 else '-'}{percent(100 * change)}" for change, shift in pairs]
        mark = "yes" if a.matters else "no"
        shown.add_row(
            a.name.replace("_", " "), a.scene.sand.name, *cells, f"{a.tau:.2f}", f"x {a.cost:.2f}", mark
        )
    return shown
