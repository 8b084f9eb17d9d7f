"""One run, from its settings to its end: Hydra has composed them, or a folder holds them."""

from __future__ import annotations

import shlex
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from omegaconf import OmegaConf

from footopt import studies
from footopt.cli.compose import absolute
from footopt.errors import EngineError, FootoptError
from footopt.files.identity import FILE
from footopt.studies.settings import Config

STOPPED = 130  # exit code after Ctrl-C, as of any program that a shell stops


def walk(settings: Mapping[str, Any], folder: Path, words: Sequence[str], resumed: bool = False) -> Any:
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
        with one_ctrl_c():
            return studies.run(config, folder, absolute(settings), words, resumed)
    except EngineError as error:
        raise FootoptError(f"{error} All finished generations are in the store{hint}") from None
    except KeyboardInterrupt as stop:
        print(" ".join(["footopt: stopped", *map(str, stop.args)]) + hint, file=sys.stderr)
        raise


@contextmanager
def one_ctrl_c() -> Iterator[None]:
    """The first Ctrl-C ends a search with its report; the second ends the process, wherever it is.

    All that is known is in the store by then, and workers end with their parent.
    """

    def first(*of: Any) -> None:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        raise KeyboardInterrupt

    before = signal.getsignal(signal.SIGINT)
    heard = before != signal.SIG_IGN and threading.current_thread() is threading.main_thread()
    if heard:  # no thread of a launcher hears of signals
        signal.signal(signal.SIGINT, first)
    try:
        yield
    finally:
        if heard:
            signal.signal(signal.SIGINT, before)


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
