"""study=compare: earlier runs side by side, wherever they are."""

from collections.abc import Sequence
from pathlib import Path

from footopt.errors import FileError, check, named
from footopt.files import identity
from footopt.report import summary
from footopt.studies.runs import Study

SETTING = "study.runs"
TRY = "Try footopt study=compare 'study.runs=[outputs/optimize/*]'"


def run(study: Study) -> None:
    """Show the runs of `study.runs` as those of a multirun: a table, summary.csv and report.html."""
    runs = run_folders(study.options.runs, study.folder)
    check(runs, SETTING, study.options.runs, "folders of runs", TRY)
    if not any(summary.read(folder).objectives for folder in runs):
        hint = "Give runs of study=optimize, simulate or robust."
        raise FileError(f"{SETTING}: none of the {len(runs)} folders has a foot to compare. {hint}")
    summary.compare(study.folder, runs)
    study.write_result({"runs": [str(run) for run in runs]})
    study.close()


def run_folders(patterns: Sequence[str], own: Path) -> list[Path]:
    """Folders of runs by name or pattern, each once, without `own`; a folder stands for all below it."""
    found: dict[Path, Path] = {}
    for pattern in patterns:
        if not (runs := identity.runs(pattern)):
            raise FileError(f"{named(pattern, SETTING)}: not the folder of a run. {TRY}")
        for path in runs:
            found.setdefault(path.resolve(), path)
    found.pop(own.resolve(), None)
    return list(found.values())
