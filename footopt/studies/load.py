"""`load`: a run as an object: its settings, foot, front and designs; walked and searched again at will."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, is_dataclass, replace
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from footopt.design import SearchResult, Solver, Store, search
from footopt.effects import EFFECTS
from footopt.errors import ERROR_FILE, FileError, SettingError, needed
from footopt.files import identity
from footopt.foot import Foot
from footopt.studies.build import (
    check_searchable,
    load_plugins,
    make_accuracy,
    make_problem,
    make_scene,
)
from footopt.studies.export import foot_of
from footopt.studies.identity import result_of
from footopt.studies.settings import Config
from footopt.walk import Accuracy, Scene, Walk, simulate


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """A run in its folder, finished or not. Nothing of it is changed; `search` adds to its store.

    Parameters
    ----------
    folder : Path
        Where it left what it found.
    settings : dict
        All its settings, resolved: what the run is.
    words : tuple of str
        What was given on the command line.
    trusted : bool
        Whether the plugins that the settings name may be run.
    """

    folder: Path
    settings: Mapping[str, Any]
    words: tuple[str, ...] = ()
    trusted: bool = False

    def __repr__(self) -> str:
        best = "; ".join(f"{name} {value:.4g}" for name, value in self.best.items() if value is not None)
        return f"<Run {self.folder}: {' '.join(self.words) or 'as it is'}; {best or 'no result'}>"

    @cached_property
    def config(self) -> Config:
        """The settings as what studies take; names that this version does not have are a `SettingError`."""
        found: Config = configured(self.settings)
        return found

    @cached_property
    def result(self) -> Mapping[str, Any]:
        """What its result.json says; empty if it left none."""
        return result_of(self.folder) or {}

    @property
    def best(self) -> dict[str, float]:
        """Objectives of its foot by name, natural signs; empty if it has none."""
        found = self.result.get("objectives") if "design" in self.result else None
        return dict(found or {})

    @cached_property
    def foot(self) -> Foot:
        """The foot that it chose or walked with; `FileError` if it has none."""
        return foot_of(self.folder)

    @cached_property
    def scene(self) -> Scene:
        """Where it walked, with the effects that `effects=auto` decided for."""
        if self.config.plugins and not self.trusted:
            hint = "Read what they do, then load the run with trust=True."
            raise FileError(f"{self.folder}: its settings name plugins, which are code. {hint}")
        load_plugins(self.config.plugins)
        effects = self.config.effects
        if not effects.auto:
            return make_scene(self.config)
        if not self.result:
            raise FileError(f"{self.folder}: has no result.json, which names the effects of effects=auto.")
        scene = make_scene(replace(self.config, effects=replace(effects, auto=False)))
        named = {name: EFFECTS[name](**values) for name, values in self.result["scene"]["effects"].items()}
        return replace(scene, effects=tuple({type(e): e for e in (*scene.effects, *named.values())}.values()))

    @property
    def front(self) -> Any:
        """The Pareto front as walked finely, the answer first: a pandas DataFrame of k1 ... and values."""
        pandas = needed("pandas", "Run.front", "pandas")
        k, values = self.result.get("front", []), self.result.get("front_values", [])
        heights = pandas.DataFrame(k).rename(columns=lambda i: f"k{i + 1}")
        return heights.join(
            pandas.DataFrame(values, columns=self.result.get("front_columns", []) if k else [])
        )

    @property
    def designs(self) -> Any:
        """Every design that it walked: a pandas DataFrame with the columns of designs.csv.

        Raises
        ------
        FileError
            It has not ended: then `search` reads its store, and walks what is missing.
        """
        path = self.folder / "designs.csv"
        if not path.is_file():
            if not self.result:
                hint = "run.search().to_frame() reads its store, and walks what is missing."
                raise FileError(f"{self.folder}: has not ended. {hint}")
            return self.search().to_frame()
        pandas = needed("pandas", "Run.designs", "pandas")
        frame = pandas.read_csv(path, keep_default_na=False, na_values={}, dtype={"reason": object})
        for name in frame.columns.difference(["reason"]):
            frame[name] = pandas.to_numeric(frame[name])
        return frame.astype({"feasible": bool, "on_front": bool}).rename_axis("design")

    def walk(self, accuracy: Accuracy | str | None = None) -> Walk:
        """Walk with its foot in its scene, by default as finely as its own numbers were."""
        if accuracy is None:
            saved = self.result.get("accuracy")
            accuracy = Accuracy(**saved) if saved else make_accuracy(self.config.accuracy)
        return simulate(self.foot, self.scene, accuracy)

    def search(self, **budget: int) -> SearchResult:
        """Its search, from its store: what is known is read, what is missing is walked and kept there.

        Parameters
        ----------
        **budget : int
            n_gen, to go further.

        Raises
        ------
        SettingError
            It was no search of one scene.
        """
        config = self.config
        if config.study.name != "optimize":
            raise SettingError("study.name", config.study.name, "optimize, to search again")
        check_searchable(config.foot)
        problem = make_problem(config, self.scene)
        solver = Solver(**vars(config.solver) | budget)
        path = config.study.store or self.folder / "designs.sqlite"
        with Store(path, problem, config.study.reuse) as store:
            return search(problem, solver, store=store)


def load(folder: str | Path, trust: bool = False) -> Run:
    """A run that is in a folder, finished or not.

    Parameters
    ----------
    folder : str or Path
        Its folder.
    trust : bool
        Whether `Run.scene` may run the plugins that its settings name, which are code.

    Raises
    ------
    FileError
        There is none, or footopt.yaml there has been changed by hand.
    """
    return read(folder, "folder", trust)


def read(folder: str | Path, setting: str, trust: bool = False) -> Run:
    """`load`, whose errors name the setting that the folder is of."""
    path = Path(folder).expanduser()
    return Run(path, *identity.read(path, setting)[:2], trusted=trust)


def load_all(pattern: str | Path) -> Any:
    """All runs below folders: a pandas DataFrame with a row for each.

    Columns are `folder`, `words`, each setting by its full name, each objective, `hypervolume`, `wall_time_s`
    and `search_time_s`, `validity.NAME`, `warnings` (how many), and `note`: why there is no better result.
    What is damaged is left out with a warning that names its folder.

    Parameters
    ----------
    pattern : str or Path
        Of folders, as in a shell, such as ``"outputs/**"``; a folder stands for all runs below it.

    Raises
    ------
    FileError
        There are no runs, or none that can be read.
    """
    pandas = needed("pandas", "load_all", "pandas")
    rows = []
    for folder in identity.runs(pattern):
        if not (folder / identity.FILE).is_file():  # a job that was refused
            continue
        try:
            rows.append(_row(load(folder)))
        except FileError as error:
            warnings.warn(f"left out: {error}", stacklevel=2)
    if not rows:
        raise FileError(f"pattern = {str(pattern)!r}: no run is there. Try 'outputs/**'.")
    return pandas.DataFrame(rows)


def _row(run: Run) -> dict[str, Any]:
    """A run in a table."""
    result, error = run.result, run.folder / ERROR_FILE
    note = error.read_text(encoding="utf-8").strip() if error.is_file() else "" if result else "no result"
    note = note or result.get("reason", "") or ("interrupted" if result.get("interrupted") else "")
    times = {name: result.get(name) for name in ("hypervolume", "wall_time_s", "search_time_s")}
    validity = {f"validity.{name}": value for name, value in (result.get("validity") or {}).items()}
    return {
        "folder": str(run.folder),
        "words": " ".join(run.words),
        **identity.flat(run.settings),
        **run.best,
        **times,
        **validity,
        "warnings": len(result.get("warnings", [])),
        "note": note,
    }


def configured(settings: Mapping[str, Any], into: Any = None, name: str = "") -> Any:
    """A `Config` of plain settings; what they do not name has its default.

    Raises
    ------
    SettingError
        There is no such setting.
    """
    config = Config() if into is None else into
    for key, value in settings.items():
        if not hasattr(config, key):
            raise SettingError(f"{name}{key}", value, "a setting of this version of footopt")
        part = getattr(config, key)
        if is_dataclass(part) and isinstance(value, Mapping):
            configured(value, part, f"{name}{key}.")
        elif isinstance(value, Mapping) and name == "effects." and key in EFFECTS:
            setattr(config, key, SimpleNamespace(**value))  # the parameters of an effect
        else:
            setattr(config, key, value)
    return config
