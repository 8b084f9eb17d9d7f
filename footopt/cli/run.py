"""`run`: from Python, what the command line does."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hydra import compose, initialize_config_dir
from omegaconf import open_dict

from footopt.cli.compose import CONF, read, resolved
from footopt.cli.job import tidier, walk
from footopt.cli.messages import translate
from footopt.cli.resume import resume
from footopt.errors import FootoptError, check
from footopt.files.identity import Occupied
from footopt.studies.runs import Run, load


def run(words: Sequence[str] = (), folder: str | Path | None = None) -> Run:
    """Do what ``footopt WORDS`` does, in this process, and return the run.

    Parameters
    ----------
    words : sequence of str
        Settings as on the command line, such as ``["sand=soft", "solver=nsga2"]``; with ``resume=FOLDER``
        that run goes on.
    folder : str or Path, optional
        Where a new run leaves what it finds; by default as on the command line, below outputs/.

    Returns
    -------
    Run
        As `load` returns it.

    Raises
    ------
    FootoptError
        What the command line ends with: it names the setting and says what is allowed.
    """
    if isinstance(words, str):
        raise FootoptError(f"words = {words!r}: must be a list, such as [{words!r}].")
    given = [str(word) for word in words]
    if resumed := [word.partition("=")[2] for word in given if word.startswith("resume=")]:
        place = Path(resumed[-1]).expanduser()
        check(folder is None, "folder", folder, "left out with resume=FOLDER, where the run goes on")
        several = (place / "multirun.yaml").is_file()
        hint = "Finish it with `footopt resume=...`, and read it with fo.load_all."
        check(not several, "resume", str(place), "the folder of one run, not of a multirun", hint)
        resume(given)
        return load(place)
    tidy = None
    try:
        with initialize_config_dir(str(CONF), version_base="1.3"):
            settings = compose("config", read(given), return_hydra_config=True)
            place = Path(folder or settings.hydra.run.dir).expanduser().absolute()
            with open_dict(settings):
                del settings["hydra"]
            plain = resolved(settings, given)
        tidy = tidier(place)
        walk(plain, place, [word for word in read(given) if not word.startswith("hydra.")])
    except Exception as error:
        if tidy and not isinstance(error, Occupied):  # the folder is another's then
            tidy()
        raise translate(error, given) or error from None
    return load(place, trust=True)
