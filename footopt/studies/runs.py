"""Runs in folders: whether one may begin or go on there, and `load`, a run as an object."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any, cast

from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

from footopt.design import SearchResult, Solver, Store, search
from footopt.effects import EFFECTS
from footopt.errors import ERROR_FILE, FileError, FootoptError, SettingError, check
from footopt.files import identity
from footopt.files.identity import LOCK, Occupied, changed_settings, finished, locked, result_of
from footopt.files.io import plain, read_json_file
from footopt.files.soles import read_foot
from footopt.foot import Foot
from footopt.studies import searches
from footopt.studies.build import (
    check_searchable,
    load_plugins,
    make_accuracy,
    make_foot,
    make_problem,
    make_simulator,
)
from footopt.studies.meanings import checked, within
from footopt.studies.settings import REPORTS, STUDIES, Config, FootConfig, structured
from footopt.walk import Accuracy, Walk, simulate
from footopt.walk.accuracy import AnyAccuracy
from footopt.walk.batch import at_once

__version__ = version("footopt")

#: Settings that may change when a run goes on: how long, where and with what it ends, not what is searched.
CHANGEABLE = (
    "solver.n_gen", "solver.walks", "solver.seconds", "engine", "report", "choose", "study.confirm",
    "study.finalists", "study.store", "study.certify", "study.reuse", "study.video", "study.details",
    "foot.block", "plugins",
)  # fmt: skip

BUDGETS = ("walks", "n_gen")  # settings of the solver that may make a search longer
LOG = "footopt.log"  # Hydra's, of what is logged


def check_may_change(override: str) -> None:
    """Raise a `SettingError` unless an override of the command line sets one of `CHANGEABLE`."""
    allowed = f"a setting that does not make another run ({', '.join(CHANGEABLE)})"
    hint = "For anything else start a new run, without resume."
    check(
        "=" in override and within(override.partition("=")[0], CHANGEABLE), "resume", override, allowed, hint
    )


def claim_folder(folder: Path, settings: Mapping[str, Any], overrides: Sequence[str]) -> None:
    """Leave what a run is in its folder; `Occupied` by a finished run, or by what another one has left."""
    other = "Choose another hydra.run.dir."
    if finished(result_of(folder)):
        raise Occupied(f"{folder}: holds a run that is finished; footopt resume=... extends it. {other}")
    begun = (folder / identity.FILE).exists()
    left = {path.name for path in folder.iterdir()} - {identity.FILE, LOCK, LOG, ERROR_FILE}
    if left & {"result.json", "designs.sqlite"} or (begun and left):
        there = identity.read(folder, "hydra.run.dir").settings if begun else {}
        if names := changed_settings(settings, there):
            raise Occupied(
                f"{folder}: holds another run, which differs in {', '.join(names[:4])}. "
                f"footopt resume=... goes on with it. {other}"
            )
    identity.write(folder, settings, overrides)


def check_resumable(folder: Path, before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
    """Raise unless a run may go on: only `CHANGEABLE` settings differ, and a search becomes longer."""
    if not (found := result_of(folder)):
        return
    changed = changed_settings(plain(before), found["settings"])
    if other := [name for name in changed if not within(name, CHANGEABLE)]:
        raise FileError(
            f"resume = {str(folder)!r}: its result.json is that of another run: {', '.join(other[:4])} "
            f"differ from {identity.FILE}. Start a new run."
        )
    if not finished(found):
        return
    study = before["study"]["name"]
    allowed = f"a run of study={', '.join(filter(searches, STUDIES))}, not {study}"
    check(searches(study), "resume", str(folder), allowed)
    for name in BUDGETS:  # a search that found less would replace its result
        old, new = before["solver"][name], after["solver"][name]
        hint = "A shorter search is a run of its own: leave out resume."
        check(None in (old, new) or new >= old, f"solver.{name}", new, f"at least {old}, as before", hint)
    old, new = before["report"], after["report"]
    check(new in REPORTS[REPORTS.index(old) :], "report", new, f"{old} or more, as before")


def run_study(
    config: Config,
    folder: Path,
    settings: Mapping[str, Any],
    overrides: Sequence[str] = (),
    resumed: bool = False,
) -> Any:
    """Run the study that the settings name, in a folder where it leaves what it finds.

    Parameters
    ----------
    config, settings
        The settings, and the same as plain data: what the run is.
    overrides : sequence of str
        Settings from the command line.
    resumed : bool
        Whether it goes on with what is in the folder.

    Returns
    -------
    dict or None
        Values of the foot that the study is about, by name.

    Raises
    ------
    SettingError, Occupied
        The study does not go with the other settings, or the folder is that of another run.
    """
    from footopt.studies.base import Study  # figures and tables: nothing that loading a run needs

    at_once(config.engine.threads)
    config = checked(config, overrides)
    with locked(folder):
        (folder / ERROR_FILE).unlink(missing_ok=True)  # of a job that failed before
        before = {*folder.iterdir()}
        if not resumed:
            claim_folder(folder, settings, overrides)
        try:
            return STUDIES[config.study.name][1](Study(config, folder, settings, overrides))
        except FootoptError:
            if {*folder.iterdir()} - before == {folder / identity.FILE}:  # it was refused: there is no run
                (folder / identity.FILE).unlink()
            raise


def foot_of(folder: Path, k: list[int] | None = None) -> Foot:
    """The foot of a run: its best sole, or another one k (n,) of its design space.

    Raises
    ------
    FileError
        The folder does not hold a run of optimize or simulate.
    """
    if os.path.isfile(folder / "multirun.yaml"):  # False where it may not be read
        allowed = "the folder of one job of this multirun"
        raise SettingError("run", str(folder), allowed, f"Such as run={folder / '0'}")
    try:
        result = read_json_file(folder / "result.json", "run")
        design, given = result["design"], result["settings"]["foot"]
        saved = FootConfig(**{f.name: given[f.name] for f in fields(FootConfig) if f.name in given})
        of_space = saved.shape == "waypoints" and design["k"] is not None
        check(k is None or of_space, "foot.k", k, f"null: the run's foot is {saved.shape}")
        if k is not None:
            return make_foot(replace(saved, k=k))
        if design["k"] is not None:
            foot = make_foot(replace(saved, k=design["k"]))
        else:  # the contour itself: a drawing that it came from may have changed
            worn = {"width": design["width_m"], "ankle": tuple(design["ankle_m"])}
            foot = read_foot(folder / "contour.csv", **worn, closed=saved.closed, top=saved.top)
        return replace(foot, name=str(design["name"]))
    except SettingError:
        raise
    except (FileError, LookupError, TypeError, ValueError) as error:
        missing = not os.path.exists(folder / "result.json")
        why = identity.missing_file_error(folder, "result.json") if missing else f"{error}".rstrip(".")
        raise FileError(
            f"run = {str(folder)!r}: not the folder of a run with one foot ({why}). "
            "Give one of study=optimize or simulate."
        ) from None


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """A run in its folder, finished or not. Nothing of it is changed; `search` adds to its store."""

    folder: Path
    settings: Mapping[str, Any]  # all of them, resolved: what the run is
    overrides: tuple[str, ...] = ()  # of the command line
    version: str = __version__  # of the footopt that wrote it
    trusted: bool = False  # whether plugins that the settings name are run, and a store elsewhere written to

    def __repr__(self) -> str:
        best = "; ".join(f"{name} {value:.4g}" for name, value in self.best.items() if value is not None)
        return f"<Run {self.folder}: {' '.join(self.overrides) or 'as it is'}; {best or 'no result'}>"

    @cached_property
    def config(self) -> Config:
        """The settings as what studies take; a `FileError` if this version does not have one of them."""
        try:
            return cast(Config, OmegaConf.to_object(structured(self.settings)))
        except OmegaConfBaseException as error:
            why = f"footopt {self.version} wrote this run, and this is {__version__} ({error})"
            raise FileError(f"{self.folder}: {why}. Install that version to load it.") from None

    @cached_property
    def result(self) -> Mapping[str, Any]:
        """The content of its result.json; empty if it left none."""
        return result_of(self.folder) or {}

    @property
    def best(self) -> dict[str, float]:
        """Objectives of its foot by name, natural signs; empty if it has none."""
        found = self.result.get("objectives") if "design" in self.result else None
        return dict(found or {})

    @cached_property
    def foot(self) -> Foot:
        """The foot that it chose or simulated; `FileError` if it has none."""
        return foot_of(self.folder)

    @cached_property
    def scene(self) -> Any:
        """The `Scene` or robot that walked, with the effects that `effects=auto` decided for."""
        if self.config.plugins and not self.trusted:
            hint = "Read what they do, then load the run with trust=True."
            raise FileError(f"{self.folder}: its settings name plugins, which are code. {hint}")
        load_plugins(self.config.plugins)
        given = self.config.effects
        scene: Any = make_simulator(replace(self.config, effects=replace(given, auto=False)))
        if not given.auto:
            return scene
        if not self.result:
            raise FileError(f"{self.folder}: has no result.json, which names the effects of effects=auto.")
        effects = self.result["scene"]["effects"].items()
        return replace(scene, effects=tuple(EFFECTS[name](**values) for name, values in effects))

    @property
    def front(self) -> Any:
        """The Pareto front as walked finely, the answer first: a pandas DataFrame of k1 ... and values."""
        import pandas

        if not (heights := self.result.get("front")):
            return pandas.DataFrame()
        columns = [*(f"k{i}" for i in range(1, len(heights[0]) + 1)), *self.result["front_columns"]]
        rows = zip(heights, self.result["front_values"], strict=True)
        return pandas.DataFrame([k + values for k, values in rows], columns=columns)

    @property
    def designs(self) -> Any:
        """Every design that it walked: a pandas DataFrame with the columns of designs.csv."""
        import pandas

        path = self.folder / "designs.csv"
        if path.is_file():
            frame = pandas.read_csv(path, dtype={"reason": object}).fillna({"reason": ""})
            return frame.astype({"feasible": bool, "on_front": bool}).rename_axis("design")
        if not self.result:
            hint = "run.search().to_frame() reads its store, and walks what is missing."
            raise FileError(f"{self.folder}: has not ended. {hint}")
        return self.search().to_frame()

    def walk(self, accuracy: AnyAccuracy | str | None = None) -> Walk:
        """Walk with its foot in its scene, by default as finely as its own numbers were."""
        if accuracy is None:
            saved = self.result.get("accuracy")
            accuracy = Accuracy(**saved) if saved else make_accuracy(self.config.accuracy)
        return simulate(self.foot, self.scene, accuracy)

    def search(self, **budget: int) -> SearchResult:
        """Its search, from its store: what is missing is walked and kept there; n_gen goes further."""
        config = self.config
        if config.study.name != "optimize":
            raise SettingError("study.name", config.study.name, "optimize, to search again")
        check_searchable(config.foot)
        problem = make_problem(config, self.scene)
        solver = Solver(**vars(config.solver) | budget)
        path = self.folder / (config.study.store or "designs.sqlite")
        if not self.trusted and path.resolve().parent != self.folder.resolve():
            hint = "Load the run with trust=True, if you know it."
            raise SettingError("study.store", str(path), "in the folder of the run, to be written to", hint)
        with Store(path, problem, config.study.reuse) as store:
            return search(problem, solver, store=store)


def load(folder: str | Path, trust: bool = False) -> Run:
    """A run that is in a folder, finished or not.

    Parameters
    ----------
    folder : str or Path
        Its folder.
    trust : bool
        Whether `Run.scene` may run the plugins that its settings name, which are code, and `Run.search`
        write to a store that is elsewhere.

    Raises
    ------
    FileError
        There is none, or footopt.yaml there has been changed by hand.
    """
    path = Path(folder).expanduser()
    return Run(path, *identity.read(path, "folder"), trusted=trust)


def load_all(pattern: str | Path) -> Any:
    """All runs below folders: a pandas DataFrame with a row for each.

    Columns are `folder`, `overrides`, each setting by its full name, each objective, `hollow_mm`, `k`, the
    other numbers of result.json, `warnings` (how many), and `note`: why there is no better result.

    Parameters
    ----------
    pattern : str or Path
        Of folders, as in a shell, such as ``"outputs/**"``; a folder stands for all runs below it.

    Raises
    ------
    FileError
        There are no runs.
    """
    from footopt.report import summary  # pandas and matplotlib take a second

    found = [summary.read(folder) for folder in identity.runs(pattern)]
    if not found:
        raise FileError(f"pattern = {str(pattern)!r}: no run is there. Try 'outputs/**'.")
    return summary.as_frame(found)
