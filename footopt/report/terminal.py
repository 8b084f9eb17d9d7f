"""Output of a run on the terminal: tables, descriptions in a line, warnings. Plain lines in a log file."""

import inspect
import math
import os
import re
import sys
import textwrap
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table as RichTable
from rich.text import Text

from footopt.design import EXHAUSTIVE, Confirmation, SearchResult
from footopt.design.archive import causes
from footopt.design.search import ENOUGH
from footopt.effects import Effect, name_of, parameters
from footopt.foot import Foot, Waypoints
from footopt.foot.waypoints import heights_text
from footopt.report.numbers import TINY, change, counted, number, percent, quantity, title
from footopt.sand.law import EARTH
from footopt.walk import MEASURES, Diagnostic, Simulator, gain_shares

HEADER = 8  # letters of a line of a number's header
FEW = 1_000  # designs, with which a search may still be some percent from the best known
WORDS = 10  # letters of a table's first column in the narrowest terminal


def console() -> Console:
    """Standard output; where it is no terminal, tables have COLUMNS letters, or 80, and lines are not broken.

    It has colours only on a terminal, and not with NO_COLOR or TERM=dumb. Brackets are no markup, because
    a user's names and folders may hold them.
    """
    return _Output(highlight=False, markup=False, soft_wrap=not sys.stdout.isatty())


class _Output(Console):
    """A console behind which a pipe may be closed, as by `| head`: a run survives it and writes its files."""

    def on_broken_pipe(self) -> None:
        self.quiet = True
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def table(
    columns: Sequence[str],
    words: Collection[str] = (),
    title: str | None = None,
    rows: Iterable[Sequence[str | Text]] = (),
) -> RichTable:
    """A table that fits into 80 columns if it can: columns of `words` wrap, those of numbers never."""
    looks: Any = {"title_justify": "left", "caption_justify": "left", "padding": (0, 1, 0, 0)}
    shown = RichTable(title=title, box=box.SIMPLE, show_edge=False, pad_edge=False, **looks)
    cells = [*rows]
    for i, name in enumerate(columns):
        if name in words:
            shown.add_column(name, overflow="fold", min_width=None if i else WORDS)
        else:
            width = max([HEADER, *(len(row[i]) for row in cells)])
            header = textwrap.fill(name, width, break_long_words=False)
            shown.add_column(header, justify="right", no_wrap=True)
    for row in cells:
        shown.add_row(*row)
    return shown


def objective_table(
    title: str,
    values: Mapping[str, float],
    flat: Mapping[str, float] | None = None,
    errors: Mapping[str, float] | None = None,
    under: Mapping[str, Sequence[float]] | None = None,
    told: str = "",
) -> RichTable:
    """Objectives (rows) of a foot beside the flat one, what made most of its gain in J_W first.

    `errors` are those of the numbers, `under` the relative changes from the flat foot under other sand laws;
    the objective `told` is left out.
    """
    parts = gain_shares(values, flat) if flat else {}
    names = sorted((name for name in values if name != told), key=lambda name: -abs(parts.get(name, 0.0)))
    columns: dict[str, list[str]] = {
        "objective": [name.replace("_", " ") for name in names],
        "unit": [MEASURES[name].unit for name in names],
        title: [number(values[name]) for name in names],
    }
    if errors:
        shares = {name: abs(errors[name] / values[name]) for name in names if abs(values[name]) > TINY}
        columns["error"] = [percent(shares.get(name, math.nan)) for name in names]
    if flat:
        columns["flat"] = [number(flat[name]) for name in names]
        columns["change"] = [change(name, values[name], flat[name]) for name in names]
    if flat and under:
        own = {name: values[name] / flat[name] - 1.0 if flat[name] else math.nan for name in names}
        columns["other laws"] = [span(name, under[name]) for name in names]
        columns[""] = [doubtful(own[name], under[name]) for name in names]
    shown = table([*columns], ("objective", "unit", ""), rows=zip(*columns.values(), strict=True))
    shown.box, shown.padding = None, (0, 2, 0, 0)
    return shown


def span(name: str, changes: Sequence[float]) -> str:
    """The range of relative changes of an objective, in words."""
    if not (known := [c for c in changes if math.isfinite(c)]):
        return "-"
    ends = min(known), max(known)
    if name == "efficiency":
        return "x " + " to ".join(dict.fromkeys(f"{1.0 + c:.2f}" for c in ends))
    return " to ".join(dict.fromkeys(f"{round(100.0 * c):+d}".replace("+0", "0") for c in ends)) + " %"


def doubtful(own: float, changes: Sequence[float]) -> str:
    """A remark if the relative changes by the scene's own law and by others differ in sign, or ""."""
    return "sign not certain" if any(own * c < 0.0 for c in changes) else ""


def headline(by: str, value: float, flat: float, under: Mapping[str, Sequence[float]]) -> str:
    """What the best foot gains over the flat one, and by how much under other laws."""
    laws, name = under.get(by, ()), f"{'Efficiency ' * (by == 'efficiency')}{title(by)}"
    told = f"; {span(by, laws)} by {len(laws)} other sand laws" if laws else ""
    doubt = doubtful(value / flat - 1.0, laws) if flat else ""
    return f"{name} {change(by, value, flat)} against a flat foot{told}{doubt and f', {doubt}'}."


def describe_errors(errors: Mapping[str, float], values: Mapping[str, float]) -> str:
    """The largest error of the numbers; that of the law is the range under other laws."""
    shares = [abs(error / values[name]) for name, error in errors.items() if values[name]]
    if not all(map(math.isfinite, shares)):
        return "No estimate of the numbers' errors."
    return f"Numerical error <= {percent(max(shares, default=math.nan))}."


def describe_foot(foot: Foot) -> str:
    """A sole in one line: its heights, its hollow, and by how much it leaves its box if that is too far."""
    parts = [f"k = {heights_text(foot.k)}"] if foot.k is not None else [title(foot.name)]
    parts.append(f"hollow {1e3 * foot.hollow:.1f} mm")
    if foot.space and foot.k and foot.box_violation and not foot.space.inside(foot.k)[0]:
        parts.append(f"outside its box by {1e3 * foot.box_violation:.2f} mm")
    return ", ".join(parts)


def describe_scene(scene: Simulator) -> str:
    """A scene in a few words: its sand, its gravity where it is not the Earth's, and its effects."""
    if scene.sand is None:
        return scene.title
    words = [f"{scene.sand.name} sand (zeta {scene.sand.zeta:g})"]
    if abs((g := scene.g) - EARTH) > 1e-9:
        words.append(f"gravity {g:g} m/s^2 (sand {g / EARTH:.3g} times as strong as on the Earth)")
    for effect in scene.effects:
        given = {name: value for name, value in parameters(effect).items() if value is not None}
        values = ", ".join(_parameter(effect, name, value) for name, value in given.items())
        words.append(name_of(effect).replace("_", " ") + (f" ({values})" if values else ""))
    return ", ".join(words)


def _parameter(effect: Effect, name: str, value: object) -> str:
    kind: Any = type(effect)
    unit = described(kind).get(name, ("", ""))[0].partition(", ")[2]
    unit = unit.removesuffix("optional").rstrip(", ")  # "1" is none
    values = value if isinstance(value, (tuple, list)) else [value]
    listed = " and ".join(f"{v:g}" if isinstance(v, float) else str(v) for v in values)
    return f"{name} {listed}" + (f" {unit}" if unit not in ("", "1") else "")


@cache
def described(kind: type) -> dict[str, tuple[str, str]]:
    """Type with unit, and description, of each parameter in a class's numpydoc."""
    text = inspect.cleandoc(kind.__doc__ or "")
    part = text.partition("Parameters\n----------\n")[2]
    part = re.split(r"\n\n\w+\n-+\n", part)[0]
    found: dict[str, tuple[str, str]] = {}
    for names, typed, words in re.findall(r"^(\w[\w, ]*) : (.*)\n((?:[ ]+.*\n?|\n)+)", part + "\n", re.M):
        found |= {n.strip(): (typed, " ".join(words.split())) for n in names.split(",")}
    return found


def describe_setup(scene: Simulator, foot: Foot | Waypoints) -> str:
    """A walk in two lines: the walker and the gait; the foot or its space, and the sand."""
    if isinstance(foot, Waypoints):
        what, length, height = "Soles in a box of", 2.0 * foot.L, foot.H
    else:
        name = "" if foot.name.startswith("k=") else f"({title(foot.name)}) "  # k is told with the result
        what, (length, height) = f"Sole {name}of", np.ptp(foot.contour, axis=0)
    size = " x ".join(f"{round(1e3 * value, 6):.4g}" for value in (length, height, foot.width))
    return f"{scene.about}\n{what} {size} mm (length, height, width) on {describe_scene(scene)}"


def describe_search(result: SearchResult) -> str:
    """A search in one line: its evaluations, and how many designs were infeasible."""
    reused = f", {result.reused} of them known" if result.reused else ""
    lost = result.failures
    why = f" ({causes(lost)})" if lost else ""
    shown = f" ({len(result.shown)} of them shown)" if len(result.shown) < len(result.front) else ""
    front = f", {len(result.front)} on the front{shown}" if result.problem.n_obj > 1 else ""
    ended = " (interrupted)" if result.interrupted else f" (stopped {result.stopped})" * bool(result.stopped)
    return (
        f"{result.solver.name}, seed {result.solver.seed}: {counted(result.evaluations, 'evaluation')} of "
        f"{counted(result.designs, 'design')}{reused} in {result.seconds:.1f} s, "
        f"{sum(lost.values())} infeasible{why}{front}{ended}"
    )


def describe_few(result: SearchResult) -> list[str]:
    """A caution where a search that is not exact has evaluated few designs."""
    space = result.problem.space
    ended = result.stopped == ENOUGH or result.solver.name == EXHAUSTIVE
    if ended or result.designs >= min(FEW, space.K**space.n):
        return []
    return [f"Only {counted(result.designs, 'design')} evaluated: a search of 10,000 may find a better foot."]


def describe_confirmation(confirmed: Confirmation) -> str:
    """The finalists at the finer accuracy, in one line."""
    finalists, accuracy = counted(len(confirmed.designs), "finalist"), confirmed.accuracy.name
    if math.isnan(confirmed.largest_change):
        return f"None of {finalists} is feasible at accuracy {accuracy}"
    verdict = "the best design is unchanged" if confirmed.agrees else "another design is now the best"
    if worse := int((~confirmed.good).sum()):
        verdict += f"; {counted(worse, 'finalist')} became infeasible or dominated"
    change = f"values change by up to {percent(confirmed.largest_change)}"
    return f"{finalists} evaluated again at accuracy {accuracy}: {change}, {verdict}"


def print_validity(out: Console, diagnostics: Sequence[Diagnostic]) -> None:
    """The validity of a walk, with a warning for each value outside the tested range."""
    if diagnostics:  # of a walk that did not fail
        out.print("Validity: " + "; ".join(f"{d.name} {quantity(d.value, d.unit)}" for d in diagnostics))
    for d in diagnostics:
        if d.outside:
            warn(out, f"{describe_outside(d)}.")


def describe_outside(d: Diagnostic) -> str:
    """A value outside the tested range, with its limit and the consequence."""
    return f"{d.name} {quantity(d.value, d.unit)} is above {quantity(d.limit, d.unit)}: {d.why}"


def warn(out: Console, words: str) -> None:
    """One line that begins with a coloured "warning"."""
    out.print(Text.assemble("  ", ("warning:", "yellow"), f" {words}"))
