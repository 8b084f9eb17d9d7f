"""`Output`: what a run prints, and what it writes to its folder: result.json, figures, tables, a page."""

import math
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import RenderableType
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Column, Table
from rich.text import Text

from footopt.compiled import target
from footopt.design import Generation
from footopt.effects import name_of, parameters
from footopt.files import identity
from footopt.files import io as files
from footopt.foot import Foot
from footopt.report import terminal
from footopt.report.numbers import number, title
from footopt.walk import MEASURES, Accuracy, Simulator

PATIENCE = 1.5  # s

#: Takes news as text, "" by default, and how many units are done, 1 by default.
Step = Callable[..., None]


class Output:
    """The console and the folder of a run of a study, with the settings that identify the run."""

    def __init__(
        self, study: str, folder: Path, report: str, settings: Mapping[str, Any], overrides: Sequence[str]
    ) -> None:
        self.study, self.folder, self.report = study, folder, report
        self.settings, self.overrides = settings, overrides
        self.foreign: list[str] = []  # how other code differs that evaluated some of its designs
        self.wants_figures = report in ("full", "print")
        self.wants_report = report != "none"  # page, tables, traces and bodies, beside the numbers
        self.console = terminal.console()
        self._began = time.perf_counter()
        self._captions: dict[str, str] = {}

    @property
    def seconds(self) -> float:
        """Since the run began."""
        return time.perf_counter() - self._began

    def say(self, *parts: RenderableType) -> None:
        """Print lines and tables."""
        for part in parts:
            self.console.print(part)

    @contextmanager
    def progress(self, total: int, unit: str) -> Iterator[Step]:
        """Show a progress bar on a terminal; the block calls the `Step` that it gets after each unit."""
        rest = Column(ratio=1, no_wrap=True, overflow="ellipsis")
        columns = (
            TextColumn(unit + " {task.completed:.0f}/{task.total:.0f}"),
            BarColumn(bar_width=12),
            TimeRemainingColumn(),
            TextColumn("{task.fields[news]}", table_column=rest),
        )
        quiet = not self.console.is_interactive
        with Progress(*columns, console=self.console, expand=True, transient=True, disable=quiet) as bar:
            task = bar.add_task(unit, total=total, news="")
            yield lambda news="", units=1: bar.update(task, advance=units, news=news)

    @contextmanager
    def compiling(self, what: str = "the walk") -> Iterator[None]:
        """Say that something is being compiled if the block takes longer than `PATIENCE`."""
        message = f"Compiling {what}; footopt's own code is kept on disk ..."
        timer = threading.Timer(PATIENCE, self.say, [message])
        timer.start()
        try:
            yield
        finally:
            timer.cancel()

    def save(self, name: str, figure: Any, caption: str = "") -> None:
        """Save a figure, or what a function draws, if wanted: PNG, also PDF to print, SVG with a caption."""
        if not self.wants_figures:
            return
        from footopt.report import figures

        formats = ["png"] + ["pdf"] * (self.report == "print") + ["svg"] * bool(caption)
        figures.save(figure() if callable(figure) else figure, self.folder / "figures", name, formats)
        if caption:
            self._captions[name] = caption

    def write_result(self, content: Mapping[str, Any]) -> dict[str, Any]:
        """Write result.json: the content, with the study's name, settings, versions and times; returns it."""
        known = [MEASURES[name] for name in content.get("objectives", ()) if name in MEASURES]
        kinds = {"units": {o.name: o.unit for o in known}, "maximise": {o.name: o.maximise for o in known}}
        record = {
            "study": self.study,
            **(kinds if known else {}),
            **content,
            **({"walked_by_other_code": self.foreign} if self.foreign else {}),
            "settings": self.settings,
            "versions": dict(identity.versions()),
            "machine": target(),
            "wall_time_s": self.seconds,
            "wall_time_covers": "the study up to this file, without imports, report.html and a film",
        }
        files.write_text(self.folder / "result.json", files.json_text(record))
        identity.write(self.folder, self.settings, self.overrides)  # with what a resumed run has changed
        return record

    def conclude(
        self,
        title: str,
        tables: Sequence[Table],
        content: Mapping[str, Any],
        summary: Sequence[str | Text] = (),
    ) -> None:
        """Write result.json and report.html, then print the tables, the summary, and the folder.

        `content` is the study's own part of result.json, `summary` what follows from the tables, a paragraph
        each.
        """
        record = self.write_result(content)
        if self.wants_report:
            from footopt.report import page

            page.write_study(self.folder, title, [*map(str, summary)], self._captions, tables, record)
        self.say(*tables, *summary)
        self.close()

    def close(self, todo: str = "") -> None:
        """Print the last line: the folder with the results, and what to do next."""
        todo = f": open report.html{todo and f', {todo}'}" if self.wants_report else ""
        line = f"Everything is in {self.folder} ({self.seconds:.3g} s in all){todo}"
        self.console.print(line, soft_wrap=True)  # no line break in what is to be copied


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


def scene_entry(scene: Simulator, accuracy: Accuracy, names: Sequence[str]) -> dict[str, Any]:
    """A scene, its accuracy and the units and senses of the objectives in result.json."""
    sand = None if scene.sand is None else {
        "name": scene.sand.name,
        "zeta": scene.sand.zeta,
        "coefficients_N_cm3": asdict(scene.sand.stress_map),
        "fit_error": scene.sand.fit_error,
    }  # fmt: skip
    effects = {name_of(e): parameters(e) for e in scene.effects}
    return {
        "units": {name: MEASURES[name].unit for name in names},
        "maximise": {name: MEASURES[name].maximise for name in names},
        "scene": {"sand": sand, **scene.entry(), "effects": effects},
        "accuracy": asdict(accuracy),
    }
