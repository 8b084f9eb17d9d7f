"""`footopt resume=FOLDER [settings]`: go on with a run in its folder, with its own settings and new ones."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from hydra.core.hydra_config import HydraConfig
from hydra.core.override_parser.overrides_parser import OverridesParser
from omegaconf import DictConfig, OmegaConf

from footopt.cli.words import quoted
from footopt.errors import FileError, SettingError, check
from footopt.files.reading import is_missing, read_json_file, read_text
from footopt.files.run import write_text
from footopt.studies import RESUMABLE

#: What a resumed run cannot change.
FIXED = ("study", "study.name", "hydra.run.dir", "hydra.mode", "hydra.output_subdir", "-m", "--multirun")
#: Settings that name files which a run reads or shares.
READ = ("foot.path", "gait.path", "sand.table", "study.store", "plugins")


def resumed(given: Sequence[str]) -> list[str]:
    """The command line with ``resume=FOLDER`` replaced by the settings of the run in that folder.

    The search itself does the rest: what its store holds is not walked again. New settings come
    after the saved ones and win.
    """
    folders = [word.removeprefix("resume=") for word in given if word.startswith("resume=")]
    if not folders:
        return list(given)
    new = [word for word in given if not word.startswith("resume=")]
    named, folder = folders[-1], Path(folders[-1]).absolute()
    if (folder / "multirun.yaml").is_file():
        jobs = sorted(path.parent.name for path in folder.glob("*/.hydra"))
        left = [job for job in jobs if not (folder / job / "result.json").is_file()]
        hint = f"Jobs without a result: {', '.join(left) or 'none'} (of {', '.join(jobs)})."
        raise SettingError("resume", named, "the folder of one job of this multirun", hint)
    for word in new:
        if word.partition("=")[0] in FIXED:
            raise SettingError("resume", named, f"given without {word}", "It goes on as it began.")
    try:
        config, saved = _saved(folder)
        study = config.study.name
    except Exception as error:  # whatever can be wrong with a folder and its files
        gone = is_missing(folder / ".hydra" / "config.yaml")
        why = "it has no .hydra/config.yaml" if gone else str(error).partition("\n")[0]
        raise FileError(
            f"resume = {named!r}: not the folder of a run ({why}). "
            "Give one with a .hydra folder in it, such as outputs/optimize/2026-01-31_12-00-00-000000."
        ) from None
    if study not in RESUMABLE:
        raise SettingError("resume", named, f"a run of study={', '.join(RESUMABLE)}, not {study}")
    _check_longer(folder, config, new)
    # Hydra would truncate the settings before it writes them: a kill then could lose them
    return [*saved, *new, f"hydra.run.dir={quoted(str(folder))}", "hydra.output_subdir=null"]


def _saved(folder: Path) -> tuple[Any, list[str]]:
    """The settings of the run in a folder, and the words that it was begun with, its files where they are."""

    def load(name: str) -> Any:
        return OmegaConf.create(read_text(folder / ".hydra" / f"{name}.yaml", "settings", "resume"))

    config, words = load("config"), OmegaConf.to_container(load("overrides"))
    if not (isinstance(words, list) and all(isinstance(word, str) for word in words)):
        raise ValueError("its overrides.yaml is no list of settings")
    if (folder / ".hydra" / "hydra.yaml").is_file():
        began = Path(load("hydra").hydra.runtime.cwd)
        words = [_with_files_of(began, word) for word in words]
    return config, words


def _with_files_of(there: Path, word: str) -> str:
    """A setting of a run that began in the folder `there`, with its files where they are."""
    name = word.partition("=")[0]
    if name.lstrip("+") not in READ or there == Path.cwd():
        return word
    value: Any = OverridesParser.create().parse_override(word).value()
    listed = isinstance(value, list)
    found = [str(there / v) if (there / v).exists() else v for v in (value if listed else [value]) if v]
    files = ",".join(map(quoted, found)) or "null"
    return f"{name}=[{files}]" if listed else f"{name}={files}"


def _check_longer(folder: Path, saved: Any, new: Sequence[str]) -> None:
    """Raise a `SettingError` for a resumed search that would be shorter than what its folder holds."""
    if not (folder / "result.json").is_file():
        return
    before = read_json_file(folder / "result.json", "run", "resume").get("evaluations", 0)
    given = {name: value for name, _, value in (word.partition("=") for word in new)}
    try:
        size, generations = (int(given.get(f"solver.{n}", saved.solver[n])) for n in ("pop_size", "n_gen"))
    except ValueError:  # no numbers: refused when they are read
        return
    check(
        saved.solver.name == "exhaustive" or size * generations >= before,
        "solver.n_gen",
        generations,
        f"at least {math.ceil(before / max(size, 1))}: the run has {before} evaluations",
        "A shorter search is a run of its own: leave out resume.",
    )


@contextmanager
def settings_kept(settings: DictConfig, folder: Path) -> Iterator[None]:
    """Write down what a resumed run goes on with; put the old settings back if it ends with an error."""
    here = HydraConfig.get()
    if here.output_subdir is not None:  # Hydra has written them: the run is a new one
        yield
        return
    new = {"config": OmegaConf.to_yaml(settings), "overrides": OmegaConf.to_yaml(here.overrides.task)}
    paths = {name: folder / ".hydra" / f"{name}.yaml" for name in new}
    before = {name: path.read_text(encoding="utf-8") for name, path in paths.items()}
    try:
        for name, text in new.items():
            write_text(paths[name], text)
        yield
    except Exception:  # whatever it is: it is raised again once the settings are back
        with suppress(OSError):
            for name, text in before.items():
                write_text(paths[name], text)
        raise
