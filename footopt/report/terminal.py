"""What a run says on the terminal: closing tables, warnings. Plain lines in a log file."""

from __future__ import annotations

import math
import textwrap
import threading
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table as RichTable
from rich.text import Text

from footopt.design import Confirmation, SearchResult
from footopt.effects import name_of
from footopt.foot import Foot
from footopt.walk import OBJECTIVES, Scene, gain_shares
from footopt.walk.audit import parameters
from footopt.walk.validity import Diagnostic

HEADER = 8  # letters of a line of a number's header
WORDS = 10  # letters that a table's first column has in the narrowest terminal


def console() -> Console:
    """Standard output; when it is not a terminal wide enough for a table, and long lines unbroken.

    Colours only on a terminal, and not with NO_COLOR or TERM=dumb. Brackets are no markup: a user's names
    and folders may hold them.
    """
    out = Console(highlight=False, markup=False)
    return out if out.is_terminal else Console(highlight=False, soft_wrap=True, markup=False, width=130)


def everything_is_in(out: Console, folder: Path, seconds: float) -> None:
    """The last line: where a run has left what it found."""
    long = len(str(folder)) > out.width  # no line break in what is to be copied
    words = f"Everything is in {folder} ({seconds:.3g} s in all)"
    out.print(words, soft_wrap=long or not out.is_terminal)


def table(columns: Sequence[str], words: Collection[str] = (), title: str | None = None) -> RichTable:
    """An empty table that fits into 80 columns if it can: columns of `words` wrap, numbers never."""
    shown = RichTable(
        title=title,
        title_justify="left",
        caption_justify="left",
        box=box.SIMPLE,
        show_edge=False,
        pad_edge=False,
        padding=(0, 1, 0, 0),
    )
    for i, name in enumerate(columns):
        if name in words:
            shown.add_column(name, overflow="fold", min_width=None if i else WORDS)
        else:
            broken = textwrap.fill(name, HEADER, break_long_words=False)
            shown.add_column(broken, justify="right", no_wrap=True)
    return shown


@contextmanager
def told_if_slow(out: Console, message: str, patience: float = 1.5) -> Iterator[None]:
    """Say what is going on if the block takes longer than `patience` seconds."""
    timer = threading.Timer(patience, lambda: out.print(message))
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


def objective_table(
    feet: Sequence[tuple[str, dict[str, float]]],
    names: Sequence[str],
    errors: dict[str, float],
    gain: bool = False,
) -> RichTable:
    """Objectives (rows) of feet (columns: title, values by name).

    `errors` are the estimates for the first foot. With `gain`, also the change from the second foot
    to the first and each factor's share in the gain of J_W.
    """
    (first_title, _), *rest = feet
    titles = ["objective", "unit", first_title, "error", *(title for title, _ in rest)]
    shares: dict[str, float] = {}
    if gain:
        titles += ["change", "share of J_W's gain"]
        shares = gain_shares(feet[0][1], feet[1][1])
    shown = table(titles, words=("objective", "unit"))
    for name in names:
        o = OBJECTIVES[name]
        cells = [f"{name.replace('_', ' ')} ({'max' if o.maximise else 'min'})", o.unit]
        first, *others = (values[name] for _, values in feet)
        share_of_value = 100.0 * abs(errors[name] / first) if first else float("nan")
        cells += [number(first), f"{share_of_value:.2g} %" if math.isfinite(share_of_value) else "-"]
        cells += [number(value) for value in others]
        if gain:
            new, base = feet[0][1][name], feet[1][1][name]
            ratio = new / base if base else float("nan")
            times = f"x {ratio:.3f}" if name == "efficiency" else f"{100 * (ratio - 1):+.1f} %"
            cells.append(times if math.isfinite(ratio) else "-")
            share = shares.get(name, float("nan"))
            cells.append(f"{100 * share + 0.0:.1f} %" if math.isfinite(share) else "")
        shown.add_row(*cells)
    return shown


def describe_foot(foot: Foot) -> str:
    """A sole in one line: its heights, its hollow, its box violation."""
    parts = [f"k = {list(foot.k)}"] if foot.k is not None else [foot.name]
    parts.append(f"hollow {1e3 * foot.hollow:.1f} mm")
    if foot.box_violation is not None:
        parts.append(f"outside its box by {1e3 * foot.box_violation:.2f} mm")
    return ", ".join(parts)


def describe_scene(scene: Scene) -> str:
    """A scene in a few words: its sand and its effects."""
    words = [f"{scene.sand.name} sand (zeta {scene.sand.zeta:g})"]
    for effect in scene.effects:
        values = ", ".join(f"{name} {value}" for name, value in parameters(effect).items())
        words.append(name_of(effect).replace("_", " ") + (f" ({values})" if values else ""))
    return ", ".join(words)


def describe_search(result: SearchResult) -> str:
    """What a search did, in one line."""
    bad = result.infeasible
    why = f" ({', '.join(f'{n} {reason}' for reason, n in result.failures.items())})" if bad else ""
    reused = f", {result.reused} of them known" if result.reused else ""
    front = f", {len(result.front)} on the front" if result.problem.n_obj > 1 else ""
    stopped = " (interrupted)" if result.interrupted else ""
    return (
        f"{result.solver.name}, seed {result.solver.seed}: {result.evaluations} evaluations of "
        f"{result.designs} designs{reused} in {result.seconds:.1f} s, {bad} infeasible{why}{front}{stopped}"
    )


def describe_confirmation(confirmed: Confirmation) -> str:
    """What walking the finalists again has shown, in one line."""
    verdict = "the best stays the best" if confirmed.agrees else "another one is now the best"
    if math.isnan(confirmed.largest_change):
        return (
            f"None of {len(confirmed.designs)} finalists can be walked at accuracy {confirmed.accuracy.name}"
        )
    return (
        f"{len(confirmed.designs)} finalists walked again at accuracy {confirmed.accuracy.name}: "
        f"values change by up to {100 * confirmed.largest_change:.2g} %, {verdict}"
    )


def print_validity(out: Console, diagnostics: Sequence[Diagnostic]) -> None:
    """The validity of a walk, with a warning for each value outside the tested range."""
    numbers = (f"{d.name} {number(d.value)}{' ' + d.unit if d.unit else ''}" for d in diagnostics)
    out.print("Validity: " + "; ".join(numbers))
    for d in diagnostics:
        if d.outside:
            warn(out, f"{describe_outside(d)}.")


def describe_outside(d: Diagnostic) -> str:
    """What a value outside the tested range means, with the value and its limit."""
    value, limit = (f"{number(v)}{' ' + d.unit if d.unit else ''}" for v in (d.value, d.limit))
    return f"{d.name} {value} is above {limit}: {d.why}"


def warn(out: Console, words: str) -> None:
    """One line that begins with a coloured "warning"."""
    out.print(Text.assemble("  ", ("warning:", "yellow"), f" {words}"))


def number(value: float) -> str:
    """Four significant digits, 0 for rounding errors, a dash for what is not a number."""
    if not math.isfinite(value):
        return "-"
    return f"{value:.4g}" if abs(value) > 1e-12 else "0"


def clock() -> Callable[[], float]:
    """Seconds since this call."""
    started = time.perf_counter()
    return lambda: time.perf_counter() - started
