"""What did my runs find? Earlier runs side by side, wherever they are."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from glob import glob
from pathlib import Path

from footopt.errors import FileError, SettingError
from footopt.files import run as files
from footopt.files.reading import named
from footopt.report import summary, terminal
from footopt.studies.base import Study

SETTING = "study.runs"
TRY = "Try footopt study=compare 'study.runs=[outputs/optimize/*]'"


def run(study: Study) -> None:
    """A table of the runs of `study.runs`, as of a multirun's jobs: terminal, summary.csv and report.html."""
    config, folder, settings = study.config, study.folder, study.settings
    out, clock = study.console, terminal.clock()
    runs = list(folders_of(config.study.runs, folder))
    if not runs:
        raise SettingError(SETTING, config.study.runs, "folders of runs", TRY)
    summary.of_runs(folder, runs)
    files.write_json(
        folder / "result.json",
        {
            "study": "compare",
            "runs": [str(run) for run in runs],
            "settings": settings,
            "versions": files.versions(),
            "wall_time_s": clock(),
        },
    )
    terminal.everything_is_in(out, folder, clock())


def folders_of(patterns: Sequence[str], besides: Path) -> Iterator[Path]:
    """Folders of runs by name or pattern, each once, in order; `besides` the one that is running.

    A multirun's folder stands for its jobs.

    Raises
    ------
    FileError : there is no run of that name.
    """
    seen = {besides.resolve()}
    for pattern in patterns:
        multiruns = [Path(path).parent for path in glob(f"{pattern}/multirun.yaml", recursive=True)]
        jobs = [job for folder in multiruns for job in folder.iterdir() if job.name.isdecimal()]
        alone = [Path(path).parent for path in glob(f"{pattern}/result.json", recursive=True)]
        found = sorted({*alone, *jobs}, key=_in_order)
        if not found and not (Path(pattern) / ".hydra").is_dir():
            raise FileError(f"{named(pattern, SETTING)}: not the folder of a run. {TRY}")
        for path in found or [Path(pattern)]:
            if path.resolve() not in seen:
                seen.add(path.resolve())
                yield path


def _in_order(folder: Path) -> tuple[str, int, str]:
    """What to sort a run's folder by: job 10 of a multirun comes after job 9."""
    return str(folder.parent), int(folder.name) if folder.name.isdecimal() else -1, folder.name
