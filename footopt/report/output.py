"""`Output`: what a run prints, and what it leaves in its folder: result.json, figures, tables, a page."""

import threading
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from footopt.compiled import target
from footopt.effects import name_of
from footopt.effects.base import parameters
from footopt.files import identity
from footopt.files import io as files
from footopt.foot import Foot
from footopt.report import terminal
from footopt.report.progress import Step, progress
from footopt.walk import MEASURES, Accuracy, Simulator

PATIENCE = 1.5  # s


class Output:
    """A console and the folder of a run of a study: what is wanted there (`report`), and what the run is."""

    def __init__(
        self, study: str, folder: Path, report: str, settings: Mapping[str, Any], overrides: Sequence[str]
    ) -> None:
        self.study, self.folder, self.report = study, folder, report
        self.settings, self.overrides = settings, overrides
        self.foreign: list[str] = []  # how the code differs that has walked some of its designs
        self.wants_figures = report in ("full", "print")
        self.wants_report = report != "none"  # more than what was found: page, tables, traces, bodies
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

    def progress(self, total: int, unit: str) -> AbstractContextManager[Step]:
        """Show how far a block is: see `footopt.report.progress.progress`."""
        return progress(self.console, total, unit)

    @contextmanager
    def compiling(self, what: str = "the walk") -> Iterator[None]:
        """Say that something is being compiled if the block takes longer than `PATIENCE`."""
        message = f"Compiling {what}; this is done once and kept on disk ..."
        timer = threading.Timer(PATIENCE, self.say, [message])
        timer.start()
        try:
            yield
        finally:
            timer.cancel()

    def write_csv(self, name: str, header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
        """Write a table of numbers; a NaN becomes an empty cell."""
        cells = [*rows]
        files.write_csv(self.folder / name, {n: [row[i] for row in cells] for i, n in enumerate(header)})

    def save(self, name: str, figure: Any, caption: str = "") -> None:
        """Save a figure as PNG if wanted, and as PDF to print; with a caption as SVG for the page."""
        if not self.wants_figures:
            return
        from footopt.report import figures

        formats = ["png"] + ["pdf"] * (self.report == "print") + ["svg"] * bool(caption)
        figures.save(figure, self.folder / "figures", name, formats)
        if caption:
            self._captions[name] = caption

    def write_result(self, content: Mapping[str, Any]) -> dict[str, Any]:
        """Write result.json, the content between the study's name and how it was made; returns it all."""
        record = {
            "study": self.study,
            **content,
            **({"walked_by_other_code": self.foreign} if self.foreign else {}),
            "settings": self.settings,
            "versions": dict(identity.versions()),
            "commit": identity.commit(),
            "machine": target(),
            "wall_time_s": self.seconds,
            "wall_time_covers": "the study up to this file, without imports, report.html and a film",
        }
        with files.write_whole(self.folder / "result.json") as new:
            new.write_bytes(files.json_text(record).encode())
            # with what a resumed run has changed: only where there is room for both
            identity.write(self.folder, self.settings, self.overrides)
        return record

    def conclude(
        self,
        title: str,
        tables: Sequence[Table],
        content: Mapping[str, Any],
        summary: Sequence[str | Text] = (),
    ) -> None:
        """Write result.json and report.html, then print the tables, the summary, and where all is.

        `content` is the study's own part of result.json, `summary` what follows from the tables, a paragraph
        each.
        """
        record = self.write_result(content)
        if self.wants_report:
            from footopt.report import page

            page.write_study(self.folder, title, [*map(str, summary)], self._captions, tables, record)
        self.say(*tables, *summary)
        self.close()

    def close(self) -> None:
        """Print the last line: where the run has left what it found."""
        line = f"Everything is in {self.folder} ({self.seconds:.3g} s in all)"
        self.console.print(line, soft_wrap=True)  # no line break in what is to be copied


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
