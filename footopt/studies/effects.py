"""study=effects: which effects a scene calls for, by the audit of each."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from footopt.effects import name_of
from footopt.errors import check
from footopt.report import terminal
from footopt.report.numbers import percent
from footopt.studies.audit import Audit, audit, every_effect, switched, tolerance
from footopt.studies.base import Study, accuracy_entry, scene_entry
from footopt.walk import FIVE, evaluate
from footopt.walk.ladder import numerics


def run(study: Study) -> None:
    """Audit every effect on random feet."""
    count = study.options.feet
    check(2 <= count <= 10_000, "study.feet", count, "2, to rank them, to 10,000")
    scene, space, accuracy, limit = study.scene, study.space, study.accuracy, tolerance(study.config)
    feet = space.random(count, seed=study.seed, inside=True)
    effects, found = every_effect(scene), list[Audit]()
    with study.compiling("a walk for each effect, minutes in all"):
        for effect in effects:
            evaluate(feet[:1], switched(effect, scene)[1], accuracy, space=space)
    with study.progress(len(effects), "effect") as step:
        for effect in effects:
            found.append(audit(effect, scene, feet, accuracy, limit, space))
            step(news=found[-1].name)
    walked = [accuracy_entry(accuracy, switched(effect, scene)[1], space) for effect in effects]
    study.conclude(
        "The changes by each effect",
        [table(found)],
        {
            "seed": study.seed,
            "feet": feet.tolist(),
            **scene_entry(scene, numerics(accuracy, scene, space), ()),
            "audit": [a.entry | {"accuracy": own} for a, own in zip(found, walked, strict=True)],
            "called_for": sorted(name_of(a.effect) for a in found if a.matters),
        },
        summary=[a.verdict for a in found],
    )


def table(found: Sequence[Audit]) -> Table:
    """Audits for the terminal: changes with the sign of their median."""
    shown = terminal.table(
        ("effect", *(n.replace("_", " ") for n in FIVE), "tau", "time"),
        words=("effect",),
        title="change that 95 % of the feet do not exceed (%), + or -: the median's sign; tau: how alike "
        "both rank the feet, 1 if the same; time: of a walk",
    )
    for a in found:
        pairs = zip(a.changes, a.shifts, strict=True)
        cells = [
            f"{'+' if shift > 0 else '-'}{percent(change).removesuffix(' %')}" for change, shift in pairs
        ]
        shown.add_row(a.name, *cells, f"{a.tau:.2f}", f"x {a.cost:.2f}")
    return shown
