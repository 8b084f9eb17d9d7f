"""footopt as a user types it: in this process or, where a process is the point, in one of its own.

Figures are made but not rendered in this process: that is most of a small run's time.
"""

import io
import json
import logging
import os
import sqlite3
import subprocess
import sys
import time
from contextlib import closing, redirect_stderr, redirect_stdout

import matplotlib.figure
import pytest
from hydra import compose, initialize_config_dir
from hydra.core.global_hydra import GlobalHydra
from omegaconf import OmegaConf

from footopt.cli import main as cli
from footopt.cli.compose import CONF, register, resolved

LIMIT = 300  # s, for a process


def tries(few):
    """How often a fault is made: FOOTOPT_TRIES times, or the few that always are."""
    return int(os.environ.get("FOOTOPT_TRIES") or few)


#: A search that is over at once.
QUICK = ["accuracy=draft", "solver.pop_size=10", "solver.n_gen=3"]
#: About a second of search, so that a signal has something to hit.
BRIEF = ["accuracy=custom", "accuracy.dt=1e-3", "study.confirm=null", "foot.n=7", "engine.threads=1",
         "solver.pop_size=16", "solver.n_gen=25"]  # fmt: skip
TIMES = ("wall_time_s", "search_time_s", "reused")  # what a resumed run may have otherwise


def composed(*overrides):
    """The settings that a command line composes."""
    register(overrides)
    with initialize_config_dir(str(CONF), version_base="1.3"):
        return OmegaConf.to_object(resolved(compose("config", list(overrides)), overrides))


def footopt(*arguments, cwd):
    """footopt in this process: its exit code, and what it wrote to stdout and stderr."""
    root, out, err = logging.getLogger(), io.StringIO(), io.StringIO()
    handlers, level, code = list(root.handlers), root.level, 0
    GlobalHydra.instance().clear()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(err):
        patch.chdir(cwd)
        patch.setattr(sys, "argv", ["footopt", *arguments])
        patch.setenv("HYDRA_FULL_ERROR", "0")
        patch.setenv("COLUMNS", "80")
        # Hydra composes everything once more to see whether hydra.mode is set, which no test does
        patch.setattr("hydra._internal.hydra.Hydra.get_mode", lambda *_, **__: None)
        unrender(patch)
        try:
            cli.main()
        except SystemExit as end:
            code = end.code or 0
            if isinstance(code, str):  # as Python ends with a message
                print(code, file=err)
                code = 1
        finally:
            for handler in set(root.handlers) - set(handlers):
                handler.close()
            root.handlers[:] = handlers
            root.setLevel(level)
            cli.Multirun.failed = 0
    assert "…" not in out.getvalue(), "a table is cut at 80 columns"
    return subprocess.CompletedProcess(arguments, code, out.getvalue(), err.getvalue())


def unrender(monkeypatch):
    """No figure is rendered for the rest of a test."""
    figure = matplotlib.figure.Figure
    monkeypatch.setattr(figure, "savefig", lambda figure, path, **_: path.write_bytes(b""))
    for method in ("draw_without_rendering", "get_layout_engine"):
        monkeypatch.setattr(figure, method, lambda figure: None)


def program(*arguments, cwd):
    """footopt in a process of its own, where warnings are errors: what became of it."""
    return subprocess.run(
        [sys.executable, "-m", "footopt", *arguments],
        cwd=cwd,
        env=os.environ | {"HYDRA_FULL_ERROR": "0", "PYTHONWARNINGS": "error"},
        capture_output=True,
        text=True,
        timeout=LIMIT,
    )


def started(*arguments, cwd):
    """footopt in the background."""
    return subprocess.Popen(
        [sys.executable, "-m", "footopt", *arguments],
        cwd=cwd,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"HYDRA_FULL_ERROR": "0"},
    )


def only_folder(root):
    """The folder of the one run below a folder."""
    (result,) = root.rglob("result.json")
    return result.parent


def stored(folder):
    """How many designs the store of a run in that folder holds already."""
    try:
        with closing(sqlite3.connect(f"file:{folder / 'designs.sqlite'}?mode=ro", uri=True)) as store:
            return store.execute("SELECT count(*) FROM design").fetchone()[0]
    except sqlite3.OperationalError:  # not there yet, or just being made
        return 0


def wait_for_designs(run, folder, count):
    """Let a run search until its store holds so many designs."""
    end = time.monotonic() + 120
    while stored(folder) < count:
        assert run.poll() is None, run.stderr.read()
        assert time.monotonic() < end
        time.sleep(0.02)


def outcome(folder):
    """All that a run has found, without how long it took."""
    result = json.loads((folder / "result.json").read_text())
    found = {name: value for name, value in result.items() if name not in TIMES}
    return found, *((folder / name).read_bytes() for name in ("designs.csv", "walk.nc", "contour.csv"))
