"""Is everything as it should be? Versions, processor, compiled code, extras, and the published numbers."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version

import numpy as np
from rich.table import Table
from rich.text import Text

from footopt.compiled import active, kept, processor
from footopt.errors import FileError, FootoptError
from footopt.files import run as files
from footopt.foot import Waypoints
from footopt.report import terminal
from footopt.sand import Sand
from footopt.studies.base import Study
from footopt.studies.settings import Config
from footopt.walk import FIVE, STEPPERS, Scene, evaluate
from footopt.walk.audit import own_time
from footopt.walk.loop import compiled
from footopt.walk.reference import LIMITS, PUBLISHED, RAMP, SAME_PLATES
from footopt.walk.simulate import available_threads

#: Packages that footopt works without: the extra that brings them, and what for.
EXTRAS = {
    "cadquery-ocp-novtk": ("cad", "soles as STEP files"),
    "pandas": ("pandas", "to_frame()"),
    "xarray": ("xarray", "to_dataset()"),
    "distributed": ("dask", "engine=dask"),
    "hydra-joblib-launcher": ("joblib", "hydra/launcher=joblib"),
    "hydra-optuna-sweeper": ("optuna", "hydra/sweeper=optuna"),
    "hydra-submitit-launcher": ("submitit", "hydra/launcher=submitit_slurm"),
}
SLOW = 10.0  # ms per design and core at accuracy standard; compiled code takes about 0.3
FEET = 200  # that the speed is measured with
FAILED = "FAILED"


@dataclass(frozen=True)
class Finding:
    """What was found; `good` is None where there is nothing to judge, `advice` what to do if it is not."""

    what: str
    found: str
    good: bool | None = None
    advice: str = ""

    @property
    def verdict(self) -> str:
        """For the table."""
        return {None: "", True: "ok", False: FAILED}[self.good]


def run(study: Study) -> None:
    """Look at everything, say what is wrong and what to do about it."""
    found = [*libraries(), *guarded(machine, study.config)]
    with study.compiling():
        for ask in (compiled_code, self_test):
            found += guarded(ask, study.config)
    found += extras()
    bad = [f for f in found if f.good is False]
    wrong = [f"{f.what}: {f.found}. {f.advice}" for f in bad]
    try:
        study.conclude(
            f"{len(bad)} of {len(found)} findings {FAILED}" if bad else "Is all as it should be?",
            [table(found)],
            {"findings": [asdict(f) for f in found]},
            said=[] if bad else ["All is as it should be."],
            warnings=wrong,
        )
    except FileError as error:
        advice = "Choose a folder that can be written: hydra.run.dir=..."
        found.append(Finding("results", str(error), False, advice))
        wrong.append(f"results: {error}. {advice}")
        study.say(table(found))
    if wrong:
        raise FootoptError(f"study=doctor: {len(wrong)} of {len(found)} findings {FAILED}: {' '.join(wrong)}")


def table(found: Sequence[Finding]) -> Table:
    """Findings for the terminal and the page."""
    words = ("", "found", "verdict")
    shown = terminal.table(words, words)
    for f in found:
        shown.add_row(f.what, f.found, Text(FAILED, style="bold red") if f.good is False else f.verdict)
    return shown


def guarded(ask: Callable[[Config], Iterator[Finding]], config: Config) -> Iterator[Finding]:
    """What was found, or that the question itself breaks the program."""
    try:
        yield from ask(config)
    except Exception as error:  # whatever a broken installation may raise
        said = f"{type(error).__name__}: {str(error).partition(chr(10))[0]}"
        yield Finding(ask.__name__.replace("_", " "), said, False, "Try to install footopt anew.")


def libraries() -> Iterator[Finding]:
    """Versions of what footopt cannot do without."""
    for name, number in files.versions().items():
        yield Finding(name, number)


def extras() -> Iterator[Finding]:
    """What is there of the packages that footopt can do without."""
    for name, (extra, purpose) in EXTRAS.items():
        try:
            yield Finding(name, f"{version(name)}, for {purpose}")
        except PackageNotFoundError:
            yield Finding(name, f'not installed; only for {purpose}: pip install "footopt[{extra}]"')


def machine(config: Config) -> Iterator[Finding]:
    """What it runs on."""
    name, bits = processor()
    yield Finding("processor", f"{name}, vectors of {bits} bits")
    yield Finding("processors", f"{available_threads()} of {os.cpu_count()} for this process")


def compiled_code(config: Config) -> Iterator[Finding]:
    """Whether compiled code is active, kept on disk, and as quick as it ought to be."""
    if not active():
        advice = "Unset NUMBA_DISABLE_JIT, or set it to 0."
        yield Finding("compiled code", "switched off by NUMBA_DISABLE_JIT", False, advice)
        return
    feet, scene = Waypoints().random(FEET, seed=1), Scene()
    started = time.perf_counter()
    evaluate(feet[:1], scene, threads=1)
    first = time.perf_counter() - started
    path, loaded = kept(compiled(STEPPERS["sdirk2"].parameters))
    advice = "Set NUMBA_CACHE_DIR to a folder that can be written."
    yield Finding("cache folder", path or "none that can be written", path is not None, advice)
    warm = "loaded from the cache folder" if loaded else "compiled now"
    yield Finding("compiled code", f"{warm}; the first walk took {first:.2g} s", True)

    started = own_time()
    evaluate(feet, scene, threads=1)
    ms = 1e3 * (own_time() - started) / FEET
    found = f"{ms:.2g} ms per design and core at accuracy standard"
    advice = f"Compiled code takes about 0.3, and less than {SLOW:g} on any machine: is something emulated?"
    yield Finding("speed", found, ms < SLOW, advice)
    threads = config.engine.threads or available_threads()
    seconds = []
    for count in (1, threads):
        started = time.perf_counter()
        evaluate(np.repeat(feet, 4, axis=0), scene, threads=count)
        seconds.append(time.perf_counter() - started)
    yield Finding("threads", f"{threads} used, {seconds[0] / seconds[1]:.2g} times as fast as one")


def self_test(config: Config) -> Iterator[Finding]:
    """The walk that an independent program computed, at three accuracies on three sands."""
    if not active():
        yield Finding("self-test", "skipped: it needs compiled code")
        return
    started, walks = time.perf_counter(), 0
    for accuracy in ("standard", "reference", SAME_PLATES):
        name = accuracy if isinstance(accuracy, str) else accuracy.name
        for published in PUBLISHED:
            walked = evaluate([RAMP], Scene(sand=Sand.named(published.sand)), accuracy, threads=1)
            walks += 1
            difference = np.abs(walked.values[0] / np.array(published.objectives) - 1.0)
            worst, limit = float(difference.max()), LIMITS[name]
            where = FIVE[int(difference.argmax())].replace("_", " ")
            yield Finding(
                f"{published.sand} sand, {name}",
                f"differs by up to {100 * worst:.2g} % ({where}); {100 * limit:.2g} % are allowed",
                worst <= limit,
                "Results cannot be trusted: install numba and numpy anew, clear the cache folder, or "
                "report it with result.json.",
            )
    yield Finding("self-test", f"{walks} walks in {time.perf_counter() - started:.2g} s")
