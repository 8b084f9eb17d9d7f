"""The command line: Hydra composes the settings, this module checks them and runs one study."""

from __future__ import annotations

import errno
import logging
import math
import os
import re
import shlex
import shutil
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import islice
from pathlib import Path
from types import FrameType
from typing import Any

import hydra
from hydra.core.config_store import ConfigStore
from hydra.core.hydra_config import HydraConfig
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
from hydra.experimental.callback import Callback
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException

from footopt.cli.words import check_words, folders_after
from footopt.errors import ERROR_FILE, FileError, FootoptError, SettingError, check, one_line
from footopt.files.reading import is_missing, read_json_file, read_yaml
from footopt.studies.settings import Config

log = logging.getLogger("footopt")

PACKAGE = Path(__file__).parents[1]
#: conf/ inside the installed package, or at the top of a checkout.
CONF = PACKAGE / "conf" if (PACKAGE / "conf").is_dir() else PACKAGE.parent / "conf"

CONFIG_DIR = ("--config-dir", "-cd", "--config-path", "-cp")
OWN_FILES = 1000  # YAML files in a user's own folder that are looked at

#: What a resumed run cannot change.
FIXED = ("study", "study.name", "hydra.run.dir", "hydra.mode", "hydra.output_subdir")

#: Settings that name files which a run reads or shares.
READ = ("foot.path", "gait.path", "sand.table", "study.store", "plugins")
#: Settings that name files or folders.
FILES = ("foot.path", "gait.path", "sand.table", "study.run", "study.runs", "study.store", "study.video",
         "plugins", "hydra.run.dir", "hydra.sweep.dir")  # fmt: skip
PLAIN = re.compile(r"[A-Za-z0-9_/\\\-+.$%*@?|: ]*")  # what Hydra reads without quotes
GRAMMAR = re.compile(r"""\s*['"]|.*\$\{|.*\\[()\[\]{}:=, ]|\w+\(.*\)$""")  # who writes this knows Hydra's

_wants_traceback = os.environ.get("HYDRA_FULL_ERROR") == "1"

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
LAUNCHERS = ("submitit", "joblib")  # what their errors come from
STOPPED = 130  # exit code after Ctrl-C, as of any program that a shell stops

ConfigStore.instance().store(name="footopt_schema", node=Config)


@hydra.main(version_base="1.3", config_path=str(CONF), config_name="config")
def _job(settings: DictConfig) -> None:
    """One job: a single run, or one of a multirun."""
    from footopt import studies

    here = HydraConfig.get()
    folder = Path(here.runtime.output_dir)
    resume = f"footopt resume={shlex.quote(str(folder))}"
    hint = f"; go on with: {resume}" if settings.study.name in studies.RESUMABLE else ""
    try:
        (folder / ERROR_FILE).unlink(missing_ok=True)  # of a job that is resumed
        config: Any = OmegaConf.to_object(settings)
        plain: Any = OmegaConf.to_container(settings, resolve=True)
        with settings_kept(settings, folder), one_ctrl_c(f"footopt: stopped{hint}"):
            studies.run(config, folder, plain)
    except KeyboardInterrupt as stop:
        print(" ".join(["footopt: stopped", *map(str, stop.args)]) + hint, file=sys.stderr)
        sys.exit(STOPPED)
    except (FootoptError, OmegaConfBaseException, OSError) as error:
        if here.mode != RunMode.MULTIRUN:
            if _wants_traceback:
                raise
            tidied(folder)
            sys.exit(f"footopt: error: {explain(error)}")
        # the other jobs go on; `Summary` reports this one at the end
        log.error("job %s failed: %s", here.job.num, explain(error))
        (folder / ERROR_FILE).write_text(f"{explain(error)}\n", encoding="utf-8")


class Summary(Callback):
    """After a multirun: a table over all its jobs, on the terminal and as summary.csv."""

    failed = 0
    folder = ""  # of the multirun

    def on_multirun_start(self, config: DictConfig, **kwargs: Any) -> None:
        """Remember where the jobs leave what they find."""
        Summary.folder = config.hydra.sweep.dir

    def on_multirun_end(self, config: DictConfig, **kwargs: Any) -> None:
        """Read what the jobs left in their folders."""
        from footopt.report import summary

        Summary.failed = summary.of_multirun(Path(config.hydra.sweep.dir))


def tidied(folder: Path) -> None:
    """Remove the folder of a run that was refused, if it holds nothing but what Hydra wrote before it."""
    left = [path for path in folder.rglob("*") if path.is_file()]
    logs = [path for path in left if path.suffix == ".log"]
    own = {folder / ".hydra" / f"{name}.yaml" for name in ("config", "hydra", "overrides")}
    if folder != Path.cwd() and own == {*left} - {*logs} and not any(path.stat().st_size for path in logs):
        shutil.rmtree(folder, ignore_errors=True)


def main() -> None:
    """Entry point. Errors a user can mend end with one message and exit code 1."""
    os.environ["HYDRA_FULL_ERROR"] = "1"  # Hydra passes errors on instead of printing them itself
    if "--version" in sys.argv[1:]:
        from footopt import __version__

        return print(f"footopt {__version__}")
    try:
        check_words(sys.argv[1:], CONF)
        check_own_yaml(sys.argv[1:])
        sys.argv[1:] = [with_files_quoted(word) for word in resumed(sys.argv[1:])]
        _job()
    except KeyboardInterrupt:
        sys.exit(STOPPED)
    except Exception as error:
        if _wants_traceback:
            raise
        sys.exit(f"footopt: error: {explain(unchosen(error, sys.argv[1:]))}")
    if Summary.failed:
        sys.exit(f"footopt: error: {Summary.failed} of the jobs failed; see the table above.")


def resumed(given: Sequence[str]) -> list[str]:
    """The command line with ``resume=FOLDER`` replaced by the settings of the run in that folder.

    The search itself does the rest: what its store holds is not walked again. New settings come
    after the saved ones and win.
    """
    from footopt.studies import RESUMABLE

    folders = [word.removeprefix("resume=") for word in given if word.startswith("resume=")]
    if not folders:
        return list(given)
    new = [word for word in given if not word.startswith("resume=")]
    folder = Path(folders[-1]).absolute()
    if (folder / "multirun.yaml").is_file():
        jobs = sorted(path.parent.name for path in folder.glob("*/.hydra"))
        left = [job for job in jobs if not (folder / job / "result.json").is_file()]
        raise SettingError(
            "resume",
            folders[-1],
            "the folder of one job of this multirun",
            f"Jobs without a result: {', '.join(left) or 'none'} (of {', '.join(jobs)}).",
        )
    for word in new:
        if word in ("-m", "--multirun") or word.partition("=")[0] in FIXED:
            raise SettingError("resume", folders[-1], f"given without {word}", "It goes on as it began.")
    try:
        texts = [read_yaml(folder / ".hydra" / f"{name}.yaml", "resume") for name in ("config", "overrides")]
        study = OmegaConf.create(texts[0]).study.name
        saved = OmegaConf.to_container(OmegaConf.create(texts[1]))
        if not (isinstance(saved, list) and all(isinstance(word, str) for word in saved)):
            raise ValueError("its overrides.yaml is no list of settings")
        if (began := folder / ".hydra" / "hydra.yaml").is_file():
            there = Path(OmegaConf.create(read_yaml(began, "resume")).hydra.runtime.cwd)
            saved = [with_files_of(there, word) for word in saved]
    except Exception as error:  # whatever can be wrong with a folder and its files
        gone = is_missing(folder / ".hydra" / "config.yaml")
        why = "it has no .hydra/config.yaml" if gone else str(error).partition("\n")[0]
        raise FileError(
            f"resume = {folders[-1]!r}: not the folder of a run ({why}). "
            "Give one with a .hydra folder in it, such as outputs/optimize/2026-01-31_12-00-00-000000."
        ) from None
    if study not in RESUMABLE:
        raise SettingError("resume", folders[-1], f"a run of study={', '.join(RESUMABLE)}, not {study}")
    check_longer(folder, OmegaConf.create(texts[0]), new)
    # Hydra would truncate the settings before it writes them: a kill then could lose them
    return [*map(str, saved), *new, f"hydra.run.dir={quoted(str(folder))}", "hydra.output_subdir=null"]


def check_longer(folder: Path, saved: Any, new: Sequence[str]) -> None:
    """Raise a `SettingError` for a resumed search that would be shorter than what its folder holds."""
    if not (folder / "result.json").is_file():
        return
    result = read_json_file(folder / "result.json", "run", "resume")
    before = result.get("evaluations") if isinstance(result, dict) else None
    if not isinstance(before, int):
        return
    solver = saved.solver
    given = {name: value for name, _, value in (word.partition("=") for word in new)}
    try:
        size, generations = (int(given.get(f"solver.{name}", solver[name])) for name in ("pop_size", "n_gen"))
    except ValueError:  # no numbers: told when they are read
        return
    check(
        solver.name == "exhaustive" or size * generations >= before,
        "solver.n_gen",
        generations,
        f"at least {math.ceil(before / max(size, 1))}: the run has {before} evaluations",
        "A shorter search is a run of its own: leave out resume.",
    )


def with_files_of(there: Path, word: str) -> str:
    """A setting of a run that began in the folder `there`, with its files where they are."""
    name = word.partition("=")[0].lstrip("+")
    if name not in READ or there == Path.cwd():
        return word
    value: Any = OverridesParser.create().parse_override(word).value()
    listed = isinstance(value, list)
    found = [str(there / v) if (there / v).exists() else v for v in (value if listed else [value]) if v]
    files = ",".join(map(quoted, found)) or "null"
    return f"{word.partition('=')[0]}=[{files}]" if listed else f"{word.partition('=')[0]}={files}"


def with_files_quoted(word: str) -> str:
    """A setting that names files or folders, with those names in quotes that Hydra could not read otherwise.

    ``run=FOLDER`` becomes the setting that it is short for, ``~`` the user's own folder.
    """
    name, equals, value = word.partition("=")
    if name == "run":
        return f"study.run={quoted(value)}"
    if name.lstrip("+") not in FILES:
        return word
    listed = value.startswith("[") and value.endswith("]")
    inner = value[1:-1] if listed else value
    if GRAMMAR.match(inner):
        return word
    parts = [os.path.expanduser(part.strip()) for part in inner.split(",")]  # jobs of a multirun, or a list
    plain = ",".join(part if PLAIN.fullmatch(part) else quoted(part) for part in parts)
    return f"{name}{equals}[{plain}]" if listed else f"{name}{equals}{plain}"


def quoted(text: str) -> str:
    """In quotes for Hydra, whatever is in it."""
    return "'{}'".format(text.replace("'", "\\'"))


def check_own_yaml(given: Sequence[str]) -> None:
    """Raise a `FileError` for a YAML file in a user's own ``--config-dir`` that Hydra could not load."""
    for top in folders_after(given, CONFIG_DIR):
        files = sorted(islice((path for end in ("*.yaml", "*/*.yaml") for path in top.glob(end)), OWN_FILES))
        for path in files:
            read_yaml(path, "--config-dir")


@contextmanager
def one_ctrl_c(last_words: str) -> Iterator[None]:
    """The first Ctrl-C ends a search with its report; the second ends the process, wherever it is.

    A second `KeyboardInterrupt` would break into what cleans up after the first, and could be lost or
    leave a lock behind. All that is known is in the store by then, and workers end with their parent.
    """
    heard = False

    def handle(signum: int, frame: FrameType | None) -> None:
        nonlocal heard
        if heard:
            os.write(2, f"{last_words}\n".encode())
            os._exit(STOPPED)
        heard = True
        raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():  # a launcher's: signals are not for it
        yield
        return
    before = signal.getsignal(signal.SIGINT)
    if before is signal.default_int_handler:  # not where whoever started this wants it ignored
        signal.signal(signal.SIGINT, handle)
    try:
        yield
    finally:
        if not heard and before is signal.default_int_handler:
            signal.signal(signal.SIGINT, before)


@contextmanager
def settings_kept(settings: DictConfig, folder: Path) -> Iterator[None]:
    """Write down what a resumed run goes on with; put the old settings back if it ends with an error."""
    here = HydraConfig.get()
    if here.output_subdir is not None:  # Hydra has written them: the run is a new one
        yield
        return
    from footopt.files.run import write_text

    texts = {
        folder / ".hydra" / "config.yaml": OmegaConf.to_yaml(settings),
        folder / ".hydra" / "overrides.yaml": OmegaConf.to_yaml(here.overrides.task),
    }
    before = {path: path.read_text(encoding="utf-8") for path in texts if path.is_file()}
    try:
        for path in before:
            write_text(path, texts[path])
        yield
    except Exception:
        with suppress(OSError):
            for path, text in before.items():
                write_text(path, text)
        raise


def unchosen(error: Exception, given: Sequence[str]) -> Exception:
    """What OmegaConf means when it cannot assign a setting of an effect that is not chosen."""
    words = [word for word in given if re.match(r"\+*effects\.\w+\.", word)]
    if not words or not isinstance(error, AssertionError):
        return error
    chosen = " ".join(word for word in given if re.match(r"\+*effects=", word))
    word = next((word for word in words if word.split(".")[1] not in chosen), words[0])
    setting, _, value = word.partition("=")
    effect = setting.split(".")[1]
    return SettingError(setting, value, "a setting of an effect that is chosen", f"Add effects={effect}.")


def explain(error: BaseException) -> str:
    """An error in the user's terms."""
    if isinstance(error, FootoptError):
        return str(error)
    if isinstance(error, OmegaConfBaseException):
        key = f"{error.full_key}: " if error.full_key else ""
        return one_line(f"{key}{str(error).splitlines()[0]}")
    if isinstance(error, HydraException):
        word = getattr(error, "override", None)  # that the grammar of overrides does not know
        said = str(error).partition("\nConfig search path:")[0].strip()
        lines = [f"{word}: {said}" if isinstance(word, str) else said]
        cause = error.__cause__
        if cause is not None and str(cause).splitlines():
            lines.append(str(cause).splitlines()[0])
        return "\n  ".join(one_line(line) for line in "\n".join(lines).splitlines()[:4])
    if type(error).__module__.partition(".")[0] in LAUNCHERS and Summary.folder:
        folder = shlex.quote(Summary.folder)
        return (
            f"a job of this multirun was lost ({str(error).partition(chr(10))[0]}). Others may still run. "
            f"`footopt resume={folder}` lists the jobs without a result, `footopt resume={folder}/NUMBER` "
            "goes on with one."
        )
    if isinstance(error, OSError):
        if error.errno in NO_ROOM:
            return f"a file cannot be written ({error.strerror}). Make room on the disk and run it again."
        words = f"{error.strerror or error}: {error.filename or ''}".rstrip(": ")
        blocked = error.errno in (errno.EACCES, errno.EROFS, errno.EPERM)
        return f"{words}. Write to another folder with hydra.run.dir=FOLDER." if blocked else words
    return (
        f"unexpected {type(error).__name__}: {error}\n"
        "This is a bug in footopt; HYDRA_FULL_ERROR=1 shows where."
    )
