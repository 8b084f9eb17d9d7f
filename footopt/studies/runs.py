"""Runs: `Study`, one at work, what may begin or go on in a folder, and `load`, a run as an object."""

import logging
import os
import shlex
from collections.abc import Collection, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, cast

import numpy as np
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

from footopt import __version__
from footopt.design import FootProblem, SearchResult, Solver, Store, make_executor, search
from footopt.design.result import check_finalists
from footopt.design.store import listed
from footopt.effects import EFFECTS
from footopt.errors import ERROR_FILE, FileError, FootoptError, SettingError, check
from footopt.files import identity
from footopt.files import io as files
from footopt.files.identity import changed_settings, finished, locked, result_of
from footopt.files.soles import read_foot
from footopt.foot import Foot, Waypoints
from footopt.report.output import Output
from footopt.studies import ROBOT, SCENE, SETTING_OF_GROUP, build, searches, within
from footopt.studies.settings import (
    CHANGEABLE,
    CODE,
    REPORTS,
    STUDIES,
    AccuracyConfig,
    Config,
    FootConfig,
    structured,
)
from footopt.walk import Accuracy, Scene, Simulator, Walk, simulate
from footopt.walk.accuracy import AnyAccuracy, confirming
from footopt.walk.loop import at_once
from footopt.walk.objectives import relative_change

log = logging.getLogger(__name__)
SAME = 1e-6  # relative: processors differ by less
BUDGETS = ("walks", "n_gen")  # settings of the solver that may make a search longer


class Study(Output):
    """One run of a study: a module of this package asks the question, this class does the rest.

    Its parameters are those of `run_study`.
    """

    def __init__(
        self, config: Config, folder: Path, settings: Mapping[str, Any], overrides: Sequence[str] = ()
    ) -> None:
        check(config.report in REPORTS, "report", config.report, f"one of {', '.join(REPORTS)}")
        super().__init__(config.study.name, folder, config.report, settings, overrides)
        self.config, self.options = config, config.study  # all settings, and the study's own

    # the library's objects of the settings, each made when it is first asked for
    scene = cached_property[Scene](lambda self: build.make_scene(self.config))
    simulator = cached_property[Simulator](lambda self: build.make_simulator(self.config))
    accuracy = cached_property[AnyAccuracy](lambda self: build.make_accuracy(self.config.accuracy))
    space = cached_property[Waypoints](lambda self: build.make_space(self.config.foot))
    foot = cached_property[Foot](lambda self: build.make_foot(self.config.foot))  # the one of the settings

    @cached_property
    def finer_accuracy(self) -> AnyAccuracy:
        """The accuracy that what a search found is walked again at: study.confirm, or the search's own."""
        confirm = self.options.confirm
        return confirming(confirm, self.accuracy) if confirm else self.accuracy

    def some_of(self, known: Collection[str], name: str = "cases") -> list[str]:
        """The names that a setting of the study lists, or all that are `known` where it is null."""
        given = getattr(self.options, name)
        allowed = f"null for all, or some of: {', '.join(known)}"
        check(given is None or (given and {*given} <= {*known}), f"study.{name}", given, allowed)
        return [*known] if given is None else given

    def solver(self) -> Solver:
        """The solver of a search; raises a `SettingError`, before any walk, where it does not fit."""
        build.check_searchable(self.config.foot)
        check_finalists(self.options.finalists)
        n_obj = len(self.config.objective.names)
        solver = Solver(**vars(self.config.solver)).fitting(n_obj)
        solver.build(n_obj)
        solver.check_space(self.space)
        return solver

    def executor(self) -> AbstractContextManager[Executor | None]:
        """What evaluates the designs of a search, by the settings of `engine`."""
        return make_executor(self.config.engine.name, self.config.engine.workers)

    def store(self, problem: FootProblem) -> Store:
        """Where designs are kept; see `opened`."""
        path, before = self.options.store or self.folder / "designs.sqlite", result_of(self.folder) or {}
        same = before and before["settings"]["study"].get("store") == self.settings["study"].get("store")
        store = opened(self.folder, path, problem, self.options.reuse, bool(same))
        if self.options.reuse and store.foreign:
            self.foreign = store.foreign
        return store

    @property
    def origin(self) -> dict[str, str]:
        """The run for the page's commands: its folder, as seen from here, and its overrides."""
        overrides = [one for one in self.overrides if not one.startswith("study.start=")]
        return {"folder": shlex.quote(os.path.relpath(self.folder)), "overrides": shlex.join(overrides)}


def opened(folder: Path, path: str | Path, problem: FootProblem, reuse: bool, own: bool) -> Store:
    """A run's store; a `FootoptError` if others would replace a finished run's result.

    `own` says whether the store is that in which the run has left its designs.
    """
    store = Store(path, problem, reuse)
    other = store.foreign or (store.nearest if own and type(problem) is FootProblem else [])
    if other and not (reuse and store.foreign) and finished(result_of(folder)):
        store.close()
        hint = "; or add study.reuse=true, if you know that the walks are the same" if store.foreign else ""
        why = f"other code, or with other files, has walked this finished run ({listed(other)})"
        raise FootoptError(f"{folder}: {why}. Start a new run{hint}.")
    return store


def changed_since(result: Mapping[str, Any], walk: Walk) -> list[str]:
    """That a walk is not the one in a run's result, where the run was of the same: a file has changed."""
    values, before = walk.objectives, result.get("objectives") or {}
    for name in values.keys() & before.keys():
        value, once = values[name], before[name]
        if once is not None and abs(relative_change(np.array(value), np.array(once))) > SAME:
            why = "A file that the run reads has changed since, or code"
            return [f"{why}: {name.replace('_', ' ')} is {value:.4g}, and was {once:.4g}."]
    return []


def check_resumable(folder: Path, before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
    """Raise unless a run may go on: only `CHANGEABLE` settings differ, and a search becomes longer."""
    if not (found := result_of(folder)):
        return
    changed = changed_settings(files.plain(before), found["settings"])
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

    `settings` are those of `config` as plain data: what the run is; `overrides` those of the command line. A
    `resumed` run goes on with what is in the folder. Returns the values of the study's foot by
    name; raises a `SettingError` if settings do not go together, `Occupied` if the folder is another's.
    """
    at_once(config.engine.threads)
    config = build.checked(config, overrides)
    with locked(folder):
        (folder / ERROR_FILE).unlink(missing_ok=True)  # of a job that failed before
        before = {*folder.iterdir()}
        if not resumed:
            identity.claim_folder(folder, settings, overrides)
        try:
            return STUDIES[config.study.name][1](Study(config, folder, settings, overrides))
        except FootoptError:
            if {*folder.iterdir()} - before == {folder / identity.FILE}:  # it was refused: there is no run
                (folder / identity.FILE).unlink()
            raise


def in_world_of_run(
    settings: Mapping[str, Any], default: Mapping[str, Any], given: Sequence[str]
) -> dict[str, Any]:
    """Settings with the foot and the world of the run that study.run names, but for those that are given.

    The accuracy is that of the run's own numbers. `given` are the names of settings and groups on the command
    line; what differs from `default` has been given, too.
    """
    run = identity.read(Path(settings["study"]["run"]).expanduser(), "run").settings
    loaded = {Path(one).name for one in settings["plugins"]}
    if lacking := [one for one in run["plugins"] if Path(one).name not in loaded]:
        hint = f"Add 'plugins=[{','.join(run['plugins'])}]'"
        raise SettingError("plugins", settings["plugins"], f"with {', '.join(lacking)}, of the run", hint)
    world = {name: run[name] for name in (*SCENE, *ROBOT, "accuracy")}
    if confirm := run["study"].get("confirm"):
        finer = confirming(confirm, build.make_accuracy(AccuracyConfig(**run["accuracy"])))
        world["accuracy"] = dict.fromkeys(run["accuracy"]) | {"name": finer.name}
    foot = run["foot"] | {name: settings["foot"][name] for name in ("k", "block")}
    found, now = (OmegaConf.create({**settings, **new}) for new in ({**world, "foot": foot}, {}))
    for name in given:
        good = "." in name or (name != "scene" and name in {**settings, **SETTING_OF_GROUP})
        check(good, name, "given", "left out with run=: give what it sets, such as sand=hard")
    changed = {*changed_settings(settings, default), *(SETTING_OF_GROUP.get(name, name) for name in given)}
    for name in sorted(changed):  # a group before what is in it
        if name.partition(".")[0] in world:
            OmegaConf.update(found, name, OmegaConf.select(now, name), merge=False)
    return cast(dict[str, Any], OmegaConf.to_container(found))


def foot_of(folder: Path, k: list[int] | None = None, which: str = "best") -> Foot:
    """The foot of a run: its best sole, or the one "to_print", or another one k (n,) of its design space."""
    if os.path.isfile(folder / "multirun.yaml"):  # False where it may not be read
        allowed = "the folder of one job of this multirun"
        raise SettingError("run", str(folder), allowed, f"Such as run={folder / '0'}")
    try:
        result = files.read_json_file(folder / "result.json", "run")
        design, saved = result["design"], FootConfig(**result["settings"]["foot"])
    except (FileError, LookupError, TypeError) as error:
        missing = not os.path.exists(folder / "result.json")
        why = identity.missing_file_error(folder, "result.json") if missing else f"{error}".rstrip(".")
        raise FileError(
            f"run = {str(folder)!r}: not the folder of a run with one foot ({why}). "
            "Give one of study=optimize or simulate."
        ) from None
    if which != "best":
        here = "best: this run has searched no foot to print"
        check(which == "to_print" and "to_print" in result, "study.foot", which, here)
        design = result["to_print"]
    if k is not None:
        of_space = saved.shape == "waypoints" and design["k"] is not None
        check(of_space, "foot.k", k, f"null: the run's foot is {saved.shape}")
        return build.make_foot(replace(saved, k=k))
    if design["k"] is not None:
        foot = build.make_foot(replace(saved, k=design["k"]))
    else:  # the contour itself: a drawing that it came from may have changed
        worn = {"width": design["width_m"], "ankle": tuple(design["ankle_m"])}
        foot = read_foot(folder / "contour.csv", **worn, closed=saved.closed, top=saved.top)
    return replace(foot, name=str(design["name"]))


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
        build.check_trusted(self.folder, self.settings, () if self.trusted else CODE)
        build.load_plugins(self.settings.get("plugins", ()))
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
        return dict(self.result.get("objectives") or {}) if "design" in self.result else {}

    @cached_property
    def foot(self) -> Foot:
        """The foot that it chose or simulated; `FileError` if it has none."""
        return foot_of(self.folder)

    @cached_property
    def scene(self) -> Any:
        """The `Scene` or robot that walked, with the effects that `effects=auto` decided for."""
        given = self.config.effects
        scene: Any = build.make_simulator(replace(self.config, effects=replace(given, auto=False)))
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

        heights, found = self.result.get("front"), self.result
        check(heights, "run", str(self.folder), "a search of several objectives, which alone has a front")
        values = pandas.DataFrame(found["front_values"], columns=found["front_columns"])
        return pandas.DataFrame(heights).rename(columns=lambda i: f"k{i + 1}").join(values)

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
        if accuracy is not None:
            return simulate(self.foot, self.scene, accuracy)
        saved = self.result.get("accuracy")
        walk = simulate(
            self.foot, self.scene, Accuracy(**saved) if saved else build.make_accuracy(self.config.accuracy)
        )
        for note in changed_since(self.result, walk):
            log.warning("%s: %s", self.folder, note)
        return walk

    def search(self, **budget: int) -> SearchResult:
        """Its search, from its store: what is missing is walked and kept there; n_gen goes further."""
        config = self.config
        if config.study.name != "optimize":
            raise SettingError("study.name", config.study.name, "optimize, to search again")
        problem = build.make_problem(config, self.scene)
        solver = Solver(**vars(config.solver) | budget)
        path = self.folder / (config.study.store or "designs.sqlite")
        build.check_trusted(self.folder, self.settings, () if self.trusted else ["study.store"])
        start = build.make_start(config.study.start, problem.space)
        with opened(self.folder, path, problem, config.study.reuse, True) as store:
            return search(problem, solver, store=store, start=start)


def load(folder: str | Path, trust: bool = False) -> Run:
    """A run that is in a folder, finished or not.

    Parameters
    ----------
    folder : str or Path
        Its folder.
    trust : bool
        Whether the plugins that its settings name, which are code, may be run, and `Run.search` may write to
        a store that is elsewhere.

    Raises
    ------
    FileError
        There is none, or footopt.yaml there has been changed by hand.
    """
    path = Path(folder).expanduser()
    return Run(path, *identity.read(path, "folder"), trusted=trust)
