"""`Study`, the base of all studies: its objects, its output and its files; and entries of result.json."""

from __future__ import annotations

import dataclasses
import math
import os
import shlex
import time
from collections.abc import Iterable, Mapping, Sequence
from contextlib import AbstractContextManager
from functools import cached_property
from pathlib import Path
from typing import Any

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from footopt.compiled import target
from footopt.design import FootProblem, Store
from footopt.design.store import listed
from footopt.effects import name_of
from footopt.effects.base import parameters
from footopt.errors import FootoptError, check
from footopt.files import identity
from footopt.files import io as files
from footopt.files.identity import finished, result_of
from footopt.foot import Foot, Waypoints
from footopt.report import terminal
from footopt.report.numbers import percent
from footopt.report.progress import Step, progress
from footopt.studies.build import make_accuracy, make_foot, make_scene, make_simulator, make_space
from footopt.studies.settings import REPORTS, Config
from footopt.walk import MEASURES, Accuracy, Scene, Simulator
from footopt.walk.accuracy import AnyAccuracy, confirming
from footopt.walk.ladder import SHARE, ladder, numerics


class Study:
    """One run of a study: a module of this package asks the question, this class does the rest.

    Its parameters are those of `footopt.studies.runs.run_study`.
    """

    def __init__(
        self, config: Config, folder: Path, settings: Mapping[str, Any], overrides: Sequence[str] = ()
    ) -> None:
        self.config, self.folder, self.settings, self.overrides = config, folder, settings, overrides
        self._foreign: list[str] = []  # how the code differs that has walked designs of the store
        self.console = terminal.console()
        check(config.report in REPORTS, "report", config.report, f"one of {', '.join(REPORTS)}")
        self._began = time.perf_counter()
        self._captions: dict[str, str] = {}

    @property
    def options(self) -> Any:
        """The study's own settings: a class of `footopt.studies`."""
        return self.config.study

    @property
    def wants_figures(self) -> bool:
        """Whether figures are wanted."""
        return self.config.report in ("full", "print")

    @property
    def wants_report(self) -> bool:
        """Whether more is wanted than what was found: the page, tables, traces, bodies."""
        return self.config.report != "none"

    @cached_property
    def scene(self) -> Scene:
        """The scene of the settings."""
        return make_scene(self.config)

    @cached_property
    def simulator(self) -> Scene | Simulator:
        """What walks by the settings: the scene, or a robot."""
        return make_simulator(self.config)

    @cached_property
    def accuracy(self) -> AnyAccuracy:
        """The accuracy of the settings."""
        return make_accuracy(self.config.accuracy)

    @cached_property
    def finer_accuracy(self) -> AnyAccuracy:
        """The accuracy that what a search found is walked again at: study.confirm, or the search's own."""
        confirm = self.options.confirm
        return confirming(confirm, self.accuracy) if confirm else self.accuracy

    @cached_property
    def space(self) -> Waypoints:
        """The design space of the settings."""
        return make_space(self.config.foot)

    @cached_property
    def foot(self) -> Foot:
        """The one foot of the settings."""
        return make_foot(self.config.foot)

    def store(self, problem: FootProblem) -> Store:
        """Where the designs of a problem are kept: study.store, or a file in the folder.

        Raises
        ------
        FootoptError
            The run is finished, and going on would replace its result by that of other code.
        """
        store = Store(self.options.store or self.folder / "designs.sqlite", problem, self.options.reuse)
        if store.foreign and self.options.reuse:
            self._foreign = store.foreign
        elif store.foreign and finished(result_of(self.folder)):
            store.close()
            raise FootoptError(
                f"{self.folder}: other code has walked this finished run ({listed(store.foreign)}). "
                "Start a new run; or add study.reuse=true, if you know that the walks are the same."
            )
        return store

    @property
    def origin(self) -> dict[str, str]:
        """The run for the page's commands: its folder, as seen from here, and its overrides."""
        overrides = [one for one in self.overrides if not one.startswith("study.start=")]
        return {"folder": shlex.quote(os.path.relpath(self.folder)), "overrides": shlex.join(overrides)}

    @property
    def seconds(self) -> float:
        """Since the study began."""
        return time.perf_counter() - self._began

    def say(self, *parts: RenderableType) -> None:
        """Print lines and tables."""
        for part in parts:
            self.console.print(part)

    def progress(self, total: int, unit: str) -> AbstractContextManager[Step]:
        """Show how far a block is: see `footopt.report.progress.progress`."""
        return progress(self.console, total, unit)

    def compiling(self, what: str = "the walk") -> AbstractContextManager[None]:
        """Say that something is being compiled if the block takes long."""
        return terminal.announce_if_slow(
            self.console, f"Compiling {what}; this is done once and kept on disk ..."
        )

    def write_csv(self, name: str, header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
        """Write a table of numbers; a NaN becomes an empty cell."""
        cells = [*rows]
        files.write_csv(self.folder / name, {n: [row[i] for row in cells] for i, n in enumerate(header)})

    def save(self, name: str, figure: Any, caption: str = "") -> None:
        """Save a figure as PNG if wanted, and as PDF to print; with a caption as SVG for `conclude`."""
        if not self.wants_figures:
            return
        from footopt.report import figures

        formats = ["png"] + ["pdf"] * (self.config.report == "print") + ["svg"] * bool(caption)
        figures.save(figure, self.folder / "figures", name, formats)
        if caption:
            self._captions[name] = caption

    def write_result(self, content: Mapping[str, Any]) -> dict[str, Any]:
        """Write result.json: the content between the study's name and how it was made.

        Returns
        -------
        record : dict
            All that was written.
        """
        record = {
            "study": self.config.study.name,
            **content,
            **({"walked_by_other_code": self._foreign} if self._foreign else {}),
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
        about: Sequence[str] = (),
        warnings: Sequence[str] = (),
        footer: Mapping[str, Any] | None = None,
    ) -> None:
        """Write result.json and report.html, then print the tables, the summary, and where all is.

        Parameters
        ----------
        title : str
            Headline of the page.
        tables : sequence of rich.table.Table
            For the terminal and the page.
        content : dict
            The study's own part of result.json.
        summary : sequence of str or rich.text.Text
            What follows from the tables, a paragraph each.
        about, warnings : sequence of str
            For the page alone: what the terminal has shown before, or shows as an error.
        footer : dict, optional
            Entries that the page has beside those of result.json.

        Raises
        ------
        FileError
            A file cannot be written; nothing is printed then.
        """
        record = self.write_result(content) | dict(footer or {})
        headline = [*about, *map(str, summary)]
        if self.wants_report:
            from footopt.report import page

            page.write_study(self.folder, title, headline, self._captions, tables, record, warnings)
        self.say(*tables, *summary)
        self.close()

    def close(self) -> None:
        """Print the last line: where the run has left what it found."""
        long = len(str(self.folder)) > self.console.width  # no line break in what is to be copied
        line = f"Everything is in {self.folder} ({self.seconds:.3g} s in all)"
        self.console.print(line, soft_wrap=long or not self.console.is_terminal)


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


def accuracy_entry(accuracy: AnyAccuracy, scene: Scene | Simulator, sole: Foot | Waypoints) -> dict[str, Any]:
    """An accuracy in result.json as a sole, or all soles of a space, walk through a scene."""
    return dataclasses.asdict(numerics(accuracy, scene, sole))


def describe_ladder(accuracy: AnyAccuracy, scene: Scene | Simulator, sole: Foot | Waypoints) -> list[str]:
    """A tolerance in words: its numbers, and what finding them cost; nothing of numbers by hand."""
    if isinstance(accuracy, Accuracy):
        return []
    numbers, found = ladder(accuracy, scene, sole)
    walks = found.price / found.work
    if not math.isfinite(walks):
        return []
    with_them = (
        f"{numbers.plates} plates and steps of {1e3 * numbers.dt:.3g} ms at most, found in the time of "
        f"{walks:.0f} walks"
    )
    if found.error <= SHARE * accuracy.error:
        return [f"Errors within {percent(accuracy.error)} take {with_them}"]
    reached = f"are {percent(found.error)}" if math.isfinite(found.error) else "of some are falls"
    wanted = f"for {percent(accuracy.error)} they should be {percent(SHARE * accuracy.error)}"
    return [f"Errors of random soles {reached}, where {wanted}, with {with_them}"]


def scene_entry(scene: Scene | Simulator, accuracy: Accuracy, names: Sequence[str]) -> dict[str, Any]:
    """A scene, its accuracy and the units and senses of the objectives in result.json."""
    sand = None if scene.sand is None else {
        "name": scene.sand.name,
        "zeta": scene.sand.zeta,
        "coefficients_N_cm3": dataclasses.asdict(scene.sand.stress_map),
        "fit_error": scene.sand.fit_error,
    }  # fmt: skip
    effects = {name_of(e): parameters(e) for e in scene.effects}
    return {
        "units": {name: MEASURES[name].unit for name in names},
        "maximise": {name: MEASURES[name].maximise for name in names},
        "scene": {"sand": sand, **scene.entry(), "effects": effects},
        "accuracy": dataclasses.asdict(accuracy),
    }
