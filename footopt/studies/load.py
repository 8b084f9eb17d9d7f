"""`load`, a run in its folder as an object, and its foot."""

import logging
import os
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any, cast

import numpy as np
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

from footopt import __version__
from footopt.design import SearchResult, Solver, search
from footopt.effects import EFFECTS
from footopt.errors import FileError, SettingError, check
from footopt.files import identity
from footopt.files import io as files
from footopt.files.soles import read_foot
from footopt.foot import Foot
from footopt.report.numbers import percent, title
from footopt.studies import build
from footopt.studies.runs import opened
from footopt.studies.settings import CODE, Config, FootConfig, structured
from footopt.walk import Accuracy, Walk, simulate
from footopt.walk.accuracy import AnyAccuracy
from footopt.walk.objectives import relative_change

log = logging.getLogger(__name__)
SAME = 1e-6  # relative: processors differ by less


def changed_since(result: Mapping[str, Any], walk: Walk) -> list[str]:
    """A note if the objectives of a walk differ from those in its run's result, as a file has changed."""
    values, before = walk.objectives, result.get("objectives") or {}
    names = [name for name in values if before.get(name) is not None]
    changes = [float(relative_change(np.array(values[name]), np.array(before[name]))) for name in names]
    if all(abs(change) <= SAME for change in changes):
        return []
    most = int(np.argmax(np.nan_to_num(np.abs(changes), nan=np.inf)))
    why = "A file that the run reads has changed since, or code"
    return [f"{why}: {title(names[most])} changes by {percent(changes[most])}."]


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
    """A run in its folder, finished or not. It is only read, except that `search` adds to its store."""

    folder: Path
    settings: Mapping[str, Any]  # all of them, resolved: what the run is
    overrides: tuple[str, ...] = ()  # of the command line
    version: str = __version__  # of the footopt that wrote it
    trusted: bool = False  # whether plugins that the settings name are run, and a store elsewhere written to

    def __getstate__(self) -> dict[str, Any]:
        return {field.name: vars(self)[field.name] for field in fields(self)}  # not what has been cached

    def __repr__(self) -> str:
        best = "; ".join(f"{k} {v:.4g}" for k, v in self.objectives.items() if v is not None)
        return f"<Run {self.folder}: {' '.join(self.overrides) or 'as it is'}; {best or 'no result'}>"

    @cached_property
    def config(self) -> Config:
        """The settings, with their types; a `FileError` if this version does not have one of them."""
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
        return identity.result_of(self.folder) or {}

    @property
    def objectives(self) -> dict[str, float]:
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
        if not self.result or self.settings["study"]["name"] != "optimize":
            hint = "run.search().to_frame() reads its store, and walks what is missing."
            raise FileError(f"{self.folder}: has no designs.csv. {hint}")
        return self.search().to_frame()

    def walk(self, accuracy: AnyAccuracy | str | None = None) -> Walk:
        """Walk with its foot in its scene, by default at the accuracy of the numbers that it reported."""
        if accuracy is not None:
            return simulate(self.foot, self.scene, accuracy)
        saved = self.result.get("accuracy")
        numbers = Accuracy(**saved) if saved else build.make_accuracy(self.config.accuracy)
        walk = simulate(self.foot, self.scene, numbers)
        for note in changed_since(self.result, walk):
            log.warning("%s: %s", self.folder, note)
        return walk

    def search(self, **budget: int) -> SearchResult:
        """Its search again, from its store: missing designs are evaluated; `n_gen` or `walks` extends it."""
        config = self.config
        check(config.study.name == "optimize", "study.name", config.study.name, "optimize, to search again")
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
