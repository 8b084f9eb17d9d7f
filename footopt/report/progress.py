"""How far a study is, how fast it goes, and how long it will take yet: a bar, or about ten plain lines."""

from __future__ import annotations

import math
import threading
import time
from bisect import bisect_left
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple, Protocol

from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.measure import Measurement
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn
from rich.table import Column
from rich.text import Text

from footopt.design import Generation
from footopt.report.numbers import duration, number, title

PATIENCE = 2.0  # s; of what takes less nothing is shown
LINES = 10  # where there is no terminal


class Step(Protocol):
    """Says news, and how many units are done."""

    def __call__(self, news: str = "", units: int = 1) -> None: ...


class _Mark(NamedTuple):
    seconds: float
    units: int


class Pace:
    """How much is done of a piece of work, and how long the rest will take.

    Parameters
    ----------
    total : int
        Units of it.
    clock : callable
        The time, s.
    """

    def __init__(self, total: int, clock: Callable[[], float] = time.perf_counter) -> None:
        self._total, self._clock, self._began = total, clock, clock()
        self._marks = [_Mark(0.0, 0)]

    def step(self, units: int = 1) -> None:
        """So many units are done."""
        self._marks.append(_Mark(self.seconds, self.done + units))

    @property
    def seconds(self) -> float:
        """Since the beginning."""
        return self._clock() - self._began

    @property
    def done(self) -> int:
        """Units."""
        return self._marks[-1].units

    @property
    def share(self) -> float:
        """Of the units that are done, 0 to 1."""
        return self.done / self._total

    @property
    def left(self) -> float:
        """Seconds; NaN before the first unit is done."""
        last, before = self._marks[-1], self._before()
        if last.units <= before.units:
            return math.nan
        late = self._began + last.seconds - self._clock()
        each = (last.seconds - before.seconds) / (last.units - before.units)
        return max(each * (self._total - last.units) + late, 0.0)

    @property
    def rate(self) -> str:
        """Units a second, or the seconds that each takes."""
        last, before = self._marks[-1], self._before()
        if last.seconds <= before.seconds:
            return ""
        rate = (last.units - before.units) / (last.seconds - before.seconds)
        return f"{rate:.3g}/s" if rate >= 1.0 else f"{duration(1.0 / rate)} each"

    def _before(self) -> _Mark:
        """Where the pace is measured from: half of the time ago.

        What came first may have been compiled, or read from a store, and tells little of the rest.
        Where no unit ended about then, a few long ones make up the time, and all count.
        """
        now = self._marks[-1].seconds
        mark = self._marks[bisect_left(self._marks, (now / 2,))]
        return mark if mark.seconds <= 0.75 * now else self._marks[0]


@contextmanager
def progress(out: Console, total: int, unit: str) -> Iterator[Step]:
    """Show how far a block is that calls what it is given after each of its units.

    Parameters
    ----------
    out : rich.console.Console
        Where to show it.
    total : int
        How many units there are.
    unit : str
        What a unit is, in the singular.
    """
    pace = Pace(total)
    shown = _bar(out, total, unit, pace) if out.is_interactive else _lines(out, total, unit, pace)
    with shown as step:
        yield step


@contextmanager
def _bar(out: Console, total: int, unit: str, pace: Pace) -> Iterator[Step]:
    columns = (
        TextColumn(unit + " {task.completed:.0f}/{task.total:.0f}", table_column=Column(no_wrap=True)),
        BarColumn(bar_width=12),
        _Words(pace),
        _News(table_column=Column(ratio=1, no_wrap=True)),
    )
    bar = Progress(*columns, console=out, expand=True)
    task = bar.add_task(unit, total=total, news="")

    def step(news: str = "", units: int = 1) -> None:
        pace.step(units)
        bar.update(task, completed=pace.done, news=news)

    patience = threading.Timer(PATIENCE, bar.start)
    patience.daemon = True
    patience.start()
    try:
        yield step
    finally:
        patience.cancel()
        patience.join()  # it may be about to start the bar
        bar.stop()


class _News(ProgressColumn):
    """What a unit says, as many of its parts as fit: a number that is cut would be another one."""

    def render(self, task: Task) -> RenderableType:
        return _Parts(task.fields["news"].split(", "))


class _Parts:
    """Parts of a line; those that do not fit are left out."""

    def __init__(self, parts: list[str]) -> None:
        self.parts = parts

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        lines = [", ".join(self.parts[:n]) for n in range(len(self.parts) + 1)]
        yield Text(max((line for line in lines if len(line) <= options.max_width), key=len), no_wrap=True)

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        return Measurement(0, len(", ".join(self.parts)))


class _Words(ProgressColumn):
    """Rate and time left, counting down between units."""

    max_refresh = 0.5

    def __init__(self, pace: Pace) -> None:
        self._pace = pace
        super().__init__(table_column=Column(no_wrap=True))

    def render(self, task: Task) -> Text:
        return Text(f"{self._pace.rate}  left {duration(self._pace.left)}".strip())


@contextmanager
def _lines(out: Console, total: int, unit: str, pace: Pace) -> Iterator[Step]:
    def step(news: str = "", units: int = 1) -> None:
        before = pace.share
        pace.step(units)
        last = pace.done == total
        if pace.seconds > PATIENCE and (last or int(LINES * pace.share) > int(LINES * before)):
            left = duration(0.0 if last else pace.left)
            out.print(f"{unit} {pace.done}/{total}  {pace.rate}  left {left}  {news}".rstrip())

    yield step


def report_generations(
    step: Step, guide: str, units: int = 1, about: str = "", base: float | None = None, scale: str = "flat"
) -> Callable[[Generation], None]:
    """What a search calls after each generation to show its best value.

    Parameters
    ----------
    step : Step
        Of `progress`.
    guide : str
        Name of the objective whose best value is shown.
    units : int
        That a generation counts as.
    about : str
        Which search it is.
    base : float, optional
        Best values are shown as multiples of it.
    scale : str
        What it is the value of.
    """

    def show(g: Generation) -> None:
        if math.isfinite(g.best):
            best = f"best {title(guide)} {number(g.best)}"
            if base and math.isfinite(base):
                name = "J_W" if guide == "efficiency" else title(guide)
                best = f"best {name} x {g.best / base:.2f} of {scale}"
        else:
            best = f"hypervolume {number(g.hypervolume)}" if g.front else "none feasible yet"
        front = f", front {g.front}" if g.front > 1 else ""
        speed = f"{g.evaluations / max(g.seconds, 1e-9):.0f} evaluations/s"
        step(f"{about}{best}{front}, {speed}", units)

    return show
