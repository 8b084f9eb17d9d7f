"""What it takes to start: processes of their own, with warm and with empty caches."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

from measure import interleaved

import footopt

PACKAGE = Path(footopt.__file__).parent
#: The statement that is timed with nothing compiled, and one that compiles a small function only.
FIRST = "import footopt as fo; table = fo.evaluate([[5] * 11, [6] * 11])"

SMALL = "from footopt.foot import as_feet, as_plates; as_plates(as_feet([[5] * 11, [6] * 11]), 20, 'arc')"

#: Statements whose cost is that of an interpreter of their own, less that of an empty one.
WARM = {
    "an empty interpreter": ["-c", "pass"],
    "import footopt": ["-c", "import footopt"],
    "from footopt import evaluate": ["-c", "from footopt import evaluate"],
    "import numba": ["-c", "import numba"],
    "first evaluation": ["-c", FIRST],
    "footopt --help": ["-m", "footopt", "--help"],
}


def run(arguments: list[str], folder: Path | None = None, **environment: str) -> float:
    """Wall time of a process of this interpreter, s."""
    env = {**os.environ, **environment}
    start = time.perf_counter()
    subprocess.run(
        [sys.executable, *arguments], check=True, capture_output=True, cwd=folder, env=env, timeout=600
    )
    return time.perf_counter() - start


def warm(names: tuple[str, ...] = tuple(WARM), repeats: int = 7) -> Mapping[str, float]:
    """Wall time of whole processes with warm caches, s."""
    return interleaved({name: (lambda name=name: run(WARM[name])) for name in names}, repeats)


def first_compilation(code: str = FIRST) -> tuple[float, float]:
    """Wall time of a first evaluation with an empty cache of compiled code, and of the next one, s."""
    with tempfile.TemporaryDirectory() as cache:
        first, again = (run(["-c", code], NUMBA_CACHE_DIR=cache) for _ in range(2))
    return first, again


def read_only(home_writable: bool = True, code: str = FIRST) -> tuple[float, float, list[str]] | str:
    """Two starts from a package next to which nothing can be written.

    Files in the place of the `__pycache__` folders keep everyone, root too, from writing there.

    Returns
    -------
    first, second : wall time, s. where : folders that hold compiled code afterwards; or the error.
    """
    with tempfile.TemporaryDirectory() as name:
        root = Path(name)
        shutil.copytree(PACKAGE, root / "footopt", ignore=shutil.ignore_patterns("__pycache__"))
        for folder in [root / "footopt", *(p for p in (root / "footopt").rglob("*") if p.is_dir())]:
            (folder / "__pycache__").write_text("")
        home = root / "home"
        if home_writable:
            home.mkdir()
        else:
            home.write_text("")
        environment = {"HOME": str(home), "XDG_CACHE_HOME": str(home / ".cache"), "NUMBA_CACHE_DIR": ""}
        try:
            times = [run(["-c", code], root, PYTHONPATH=str(root), **environment) for _ in range(2)]
        except subprocess.CalledProcessError as error:
            return str(error.stderr.decode().strip().splitlines()[-1])
        found = sorted({str(p.parent.relative_to(root)) for p in root.rglob("*.nbc")})
        return times[0], times[1], found
