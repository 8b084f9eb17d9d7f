"""The progress of a study with the time left: a bar on a terminal, nothing elsewhere."""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Column

from footopt.design import Generation
from footopt.report.numbers import number, title

#: Takes news as text, "" by default, and how many units are done, 1 by default.
Step = Callable[..., None]


@contextmanager
def progress(out: Console, total: int, unit: str) -> Iterator[Step]:
    """Show the progress of a block, which calls the function that it gets after each of its units."""
    columns = (
        TextColumn(unit + " {task.completed:.0f}/{task.total:.0f}"),
        BarColumn(bar_width=12),
        TimeRemainingColumn(),
        TextColumn("{task.fields[news]}", table_column=Column(ratio=1, no_wrap=True, overflow="ellipsis")),
    )
    with Progress(*columns, console=out, expand=True, transient=True, disable=not out.is_interactive) as bar:
        task = bar.add_task(unit, total=total, news="")
        yield lambda news="", units=1: bar.update(task, advance=units, news=news)


def report_generations(
    step: Step, objective: str, units: int = 1, about: str = "", base: float | None = None
) -> Callable[[Generation], None]:
    """A search's callback that shows its best value after each generation, which counts as some units.

    With a `base`, J_W of the flat foot, the value is shown as a multiple of it.
    """

    def show(g: Generation) -> None:
        best = f"hypervolume {number(g.hypervolume)}" if g.front else "none feasible yet"
        if math.isfinite(g.best) and base and math.isfinite(base):
            best = f"best J_W x {g.best / base:.2f} of flat"
        elif math.isfinite(g.best):
            best = f"best {title(objective)} {number(g.best)}"
        front = f", front {g.front}" if g.front > 1 else ""
        step(f"{about}{best}{front}, {g.evaluations / max(g.seconds, 1e-9):.0f} evaluations/s", units)

    return show
