"""Which effects does a scene call for? Each on in turn: what it changes, what it costs, a verdict."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rich.table import Table

from footopt.effects import EFFECTS, Effect
from footopt.errors import check
from footopt.report import terminal
from footopt.report.figures.studies import changes
from footopt.studies.audit import Audit, audit, percent, switched
from footopt.studies.auto_effects import audit_entry, screening_entry, screening_table, soles, tolerance
from footopt.studies.base import Study, accuracy_entry, scene_entry
from footopt.studies.screening import screening
from footopt.studies.settings import FEET_HELP, SCENE, SPACE, StudySettings, setting
from footopt.walk import FIVE, Scene, evaluate

HEADER = (
    "effect", "sand", *(f"change_{n}" for n in FIVE), *(f"shift_{n}" for n in FIVE),
    "tau", "lost", "feet", "cost", "tolerance", "matters", "verdict",
)  # fmt: skip


@dataclass
class Settings(StudySettings):
    """Which effects a scene calls for: each is turned on alone on random soles of the design space."""

    name: str = "effects"
    feet: int = setting(40, FEET_HELP)
    reads = (*SCENE, *SPACE, "accuracy", "solver.seed")


def run(study: Study) -> None:
    """Audit every effect on random feet."""
    count = study.options.feet
    check(2 <= count <= 10_000, "study.feet", count, "2, to rank them, to 10,000")
    scene, space, limit = study.scene, study.space, tolerance(study.config)
    feet = space.random(count, seed=study.seed, inside=True)
    screened = screening(scene, soles(feet, space), limit)
    effects = to_audit(scene)
    found: list[Audit] = []
    with study.compiling("a walk for each effect, minutes in all"):
        for effect in effects:
            for walked in switched(effect, scene):
                evaluate(feet[:1], walked, study.accuracy, space=space)
    with study.progress(len(effects), "effect") as step:
        for effect in effects:
            found.append(audit(effect, scene, feet, study.accuracy, limit, space))
            step(news=found[-1].name.replace("_", " "))
    study.write_csv("effects.csv", HEADER, [_row(a) for a in found])
    caption = "What each effect changes in every objective, against the change that matters."
    study.save("effects", changes(found), caption)
    study.conclude(
        "What each effect changes",
        [screening_table(screened), table(found)],
        {
            "screening": [screening_entry(c) for c in screened],
            "seed": study.seed,
            "feet": feet.tolist(),
            **scene_entry(scene, study.accuracy, ()),
            "audit": [
                audit_entry(a)
                | {"accuracy": accuracy_entry(study.accuracy, switched(a.effect, scene)[1], space)}
                for a in found
            ],
            "called_for": sorted(a.name for a in found if a.matters),
        },
        said=[
            *(f"{a.name.replace('_', ' ')} {a.verdict}" for a in found),
            *(f"Outside of what was tested: {c.warning}." for c in screened if c.warning),
        ],
    )


def to_audit(scene: Scene) -> list[Effect]:
    """Every effect, as the scene names it or with its own defaults."""
    given = {type(effect): effect for effect in scene.effects}
    return [given.get(kind) or kind() for kind in EFFECTS.values()]


def _row(a: Audit) -> list[object]:
    numbers = [*a.changes.tolist(), *a.shifts.tolist(), a.tau, a.lost, a.feet, a.cost, a.tolerance]
    return [a.name, a.scene.sand.name, *numbers, int(a.matters), a.verdict]


def table(found: Sequence[Audit]) -> Table:
    """Audits for the terminal: changes in %, with the median's sign."""
    shown = terminal.table(
        ("effect", *(n.replace("_", " ") for n in FIVE), "tau", "time", "keep"),
        words=("effect",),
        title="change that 95 % of the feet do not exceed (%), + or -: the median's sign; tau: how alike "
        "both rank the feet, 1 if the same; time: of a walk; keep: whether a change is above the tolerance",
    )
    for a in found:
        pairs = zip(a.changes, a.shifts, strict=True)
        cells = [f"{'+' if shift > 0 else '-'}{percent(100 * change)}" for change, shift in pairs]
        cells += [f"{a.tau:.2f}", f"x {a.cost:.2f}", "yes" if a.matters else "no"]
        shown.add_row(a.name.replace("_", " "), *cells)
    return shown
