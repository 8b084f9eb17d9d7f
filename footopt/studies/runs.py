"""`Study`, a run at work; and the rules by which a run may begin or be resumed in a folder."""

import shlex
from collections.abc import Collection, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from functools import cached_property
from pathlib import Path
from typing import Any, cast

from omegaconf import OmegaConf

from footopt.design import FootProblem, Solver, Store, make_executor
from footopt.design.result import check_finalists
from footopt.design.store import differences, listed
from footopt.errors import ERROR_FILE, FileError, FootoptError, SettingError, check
from footopt.files import identity
from footopt.files import io as files
from footopt.foot import Foot, Waypoints
from footopt.report.output import Output
from footopt.studies import ROBOT, SCENE, SETTING_OF_GROUP, build, searches, within
from footopt.studies.settings import CHANGEABLE, REPORTS, STUDIES, AccuracyConfig, Config
from footopt.walk import Scene, Simulator
from footopt.walk.accuracy import AnyAccuracy, confirming
from footopt.walk.loop import at_once

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

    # the objects that the settings describe, each made when it is first used
    scene = cached_property[Scene](lambda self: build.make_scene(self.config))
    simulator = cached_property[Simulator](lambda self: build.make_simulator(self.config))
    accuracy = cached_property[AnyAccuracy](lambda self: build.make_accuracy(self.config.accuracy))
    space = cached_property[Waypoints](lambda self: build.make_space(self.config.foot))
    foot = cached_property[Foot](lambda self: build.make_foot(self.config.foot))  # the one of the settings

    @cached_property
    def finer_accuracy(self) -> AnyAccuracy:
        """The accuracy at which the best designs are evaluated again: study.confirm, or the search's own."""
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
        """The store of designs; see `opened`."""
        path = self.options.store or self.folder / "designs.sqlite"
        before = identity.result_of(self.folder) or {}
        same = before and before["settings"]["study"].get("store") == self.settings["study"].get("store")
        store = opened(self.folder, path, problem, self.options.reuse, bool(same))
        if self.options.reuse and store.foreign:
            self.foreign = store.foreign
        return store

    @property
    def origin(self) -> dict[str, str]:
        """The run for the page's commands: its folder, as seen from here, and its overrides."""
        overrides = [one for one in self.overrides if not one.startswith("study.start=")]
        return {"folder": shlex.quote(files.relative(self.folder)), "overrides": shlex.join(overrides)}


def opened(folder: Path, path: str | Path, problem: FootProblem, reuse: bool, own: bool) -> Store:
    """A run's store; a `FootoptError` if others would replace a finished run's result.

    `own` says whether it is the store in which the finished run left its designs.
    """
    store = Store(path, problem, reuse)
    other = store.foreign or (store.nearest if own and type(problem) is FootProblem else [])
    if other and not (reuse and store.foreign) and identity.finished(identity.result_of(folder)):
        store.close()
        hint = "; or add study.reuse=true, if you know that the walks are the same" if store.foreign else ""
        why = f"other code, or with other files, has walked this finished run ({listed(other)})"
        raise FootoptError(f"{folder}: {why}. Start a new run{hint}.")
    return store


def check_resumable(folder: Path, before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
    """Raise unless a run may be resumed: only `CHANGEABLE` settings differ, and no budget is smaller."""
    if not (found := identity.result_of(folder)):
        return
    changed = differences(files.plain(before), found["settings"])
    if other := [name for name in changed if not within(name, CHANGEABLE)]:
        raise FileError(
            f"resume = {str(folder)!r}: its result.json is that of another run: {', '.join(other[:4])} "
            f"differ from {identity.FILE}. Start a new run."
        )
    if not identity.finished(found):
        return
    study = before["study"]["name"]
    allowed = f"a run of study={', '.join(filter(searches, STUDIES))}, not {study}"
    check(searches(study), "resume", str(folder), allowed)
    for name in BUDGETS:  # a search that found less would replace its result
        old, new = before["solver"][name], after["solver"][name]
        hint = "A shorter search is a run of its own: leave out resume."
        check(None in (old, new) or new >= old, f"solver.{name}", new, f"at least {old}, as before", hint)
    old, new = (settings["study"].get("laws") for settings in (before, after))
    check(new or not old, "study.laws", new, "a share, as before: the run has a foot to print")
    old, new = before["report"], after["report"]
    check(new in REPORTS[REPORTS.index(old) :], "report", new, f"{old} or more, as before")


def run_study(
    config: Config,
    folder: Path,
    settings: Mapping[str, Any],
    overrides: Sequence[str] = (),
    resumed: bool = False,
) -> Any:
    """Run the study that the settings name, in a folder to which it writes its results.

    `settings` are those of `config` as plain data, which identify the run; `overrides` those of the command
    line. A `resumed` run continues with what is in the folder. Returns the values of the study's foot by
    name. Raises a `SettingError` if settings contradict each other, `Occupied` if the folder has another run.
    """
    at_once(config.engine.threads)  # raises unless it is a number of threads
    config = build.checked(config, overrides)
    with identity.locked(folder):
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
    """Settings with the foot and the world of the run that study.run names, except for those that are given.

    The accuracy is the one at which that run reported its numbers. `given` are the names of settings and
    groups on the command line; settings that differ from `default` count as given, too.
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
    found, now = OmegaConf.create({**settings, **world, "foot": foot}), OmegaConf.create({**settings})
    for name in given:
        good = "." in name or (name != "scene" and name in {**settings, **SETTING_OF_GROUP})
        chosen = settings["scene"]["name"] if name == "scene" else "chosen"
        check(good, name, chosen, "left out with run=: give what it sets, such as sand=hard")
    changed = {*differences(settings, default), *(SETTING_OF_GROUP.get(name, name) for name in given)}
    for name in sorted(changed):  # a group before what is in it
        if name.partition(".")[0] in world:
            OmegaConf.update(found, name, OmegaConf.select(now, name), merge=False)
    return cast(dict[str, Any], OmegaConf.to_container(found))
