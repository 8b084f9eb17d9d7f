"""One run, from its settings to its end: Hydra has composed them, or a folder holds them."""

from __future__ import annotations

import _thread
import os
import shlex
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Any

from omegaconf import OmegaConf

from footopt import studies
from footopt.cli.elsewhere import in_the_world_of_its_run
from footopt.cli.paths import absolute, beside_their_files
from footopt.errors import EngineError, FootoptError
from footopt.files.identity import FILE
from footopt.studies.settings import Config

STOPPED = 130  # exit code after Ctrl-C, as of any program that a shell stops


def resolved(settings: Any, here: Any) -> dict[str, Any]:
    """The settings that Hydra composed as plain data, with files and the world of a run as they are meant.

    Parameters
    ----------
    settings : DictConfig
        All settings, without Hydra's own.
    here : HydraConfig
        Of what, and how.
    """
    plain: Any = OmegaConf.to_container(settings, resolve=True)
    return in_the_world_of_its_run(beside_their_files(plain, here), here)


def walk(
    settings: Mapping[str, Any],
    folder: Path,
    words: Sequence[str],
    resumed: bool = False,
    files: Mapping[str, str] | None = None,
) -> Any:
    """Run the study of some settings in a folder.

    Parameters
    ----------
    settings : dict
        All settings, resolved.
    folder : Path
        Where the run leaves what it finds.
    words : sequence of str
        What was given on the command line.
    resumed : bool
        Whether it goes on with what is in the folder.
    files : mapping of str to str, optional
        What YAML files of the user set, each with its file.

    Returns
    -------
    float or tuple, optional
        See `footopt.studies.run`.

    Raises
    ------
    KeyboardInterrupt
        It was stopped; how to go on has been said.
    """
    hint = f"; go on with: footopt resume={shlex.quote(str(folder))}"
    try:
        config: Any = OmegaConf.to_object(OmegaConf.merge(Config, settings))  # refuses what + has added
        with one_ctrl_c(f"footopt: stopped{hint}"):
            return studies.run(config, folder, absolute(settings), words, resumed, files)
    except EngineError as error:
        raise FootoptError(f"{error} All finished generations are in the store{hint}") from None
    except KeyboardInterrupt as stop:
        print(" ".join(["footopt: stopped", *map(str, stop.args)]) + hint, file=sys.stderr)
        raise


def tidier(folder: Path) -> Callable[[], None]:
    """What removes all that a run has made if it is refused: its settings, its folder, those above it.

    Nothing is removed that was there before, and nothing once the run has left anything else.
    """
    folder = folder.absolute()
    made = [path for path in (folder / FILE, folder, *folder.parents) if not path.exists()]
    before = {*folder.iterdir()} if folder.is_dir() else set()

    def tidy() -> None:
        if folder.is_dir() and {*folder.iterdir()} - before <= {folder / FILE}:
            with suppress(OSError):
                for path in made:
                    path.rmdir() if path.is_dir() else path.unlink(missing_ok=True)

    return tidy


@contextmanager
def one_ctrl_c(last_words: str) -> Iterator[None]:
    """The first Ctrl-C ends a search with its report; the second ends the process, wherever it is.

    A second `KeyboardInterrupt` would break into what cleans up after the first, and could be lost or
    leave a lock behind. All that is known is in the store by then, and workers end with their parent.
    The first waits for the end of an import: a library of compiled code that is half loaded ends the process
    in ways of its own.
    """
    heard = over = False

    def handle(signum: int, frame: FrameType | None) -> None:
        nonlocal heard
        if heard or over:
            os.write(2, f"{last_words}\n".encode())
            os._exit(STOPPED)
        heard = True
        if _imports(frame):
            threading.Timer(0.02, again).start()
        else:
            raise KeyboardInterrupt

    def again() -> None:
        nonlocal heard
        if not over:
            heard = False
            _thread.interrupt_main()

    def lost(what: Any) -> None:
        """Python has raised it where nobody can catch it, as in what garbage collection calls: try again."""
        if what.exc_type is KeyboardInterrupt:
            threading.Timer(0.05, again).start()
        else:
            unraisable(what)

    unraisable = sys.unraisablehook
    if threading.current_thread() is not threading.main_thread():  # a launcher's: signals are not for it
        yield
        return
    before = signal.getsignal(signal.SIGINT)
    if callable(before):  # not where whoever started this wants it ignored
        signal.signal(signal.SIGINT, handle)
        sys.unraisablehook = lost
    try:
        yield
        if heard:  # a library has caught what was raised, and lost it
            raise KeyboardInterrupt("when everything was done")
    finally:
        over = True
        sys.unraisablehook = unraisable
        if not heard and callable(before):
            signal.signal(signal.SIGINT, before)


def _imports(frame: FrameType | None) -> bool:
    """Whether a frame is at work for an import that a run has begun."""
    while frame is not None and frame.f_code is not walk.__code__:
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            return True
        frame = frame.f_back
    return False
