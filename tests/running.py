"""footopt as a user types it: in this process or, where a process is the point, in one of its own.

Figures are made but not rendered, unless a run is to be `drawn`: that is most of a small run's time.
"""

import io
import logging
import os
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import matplotlib.figure
import pytest
from hydra.core.global_hydra import GlobalHydra
from unrendered.sitecustomize import INSTEAD

from footopt.cli import main as cli

UNRENDERED = Path(__file__).parent / "unrendered"
LIMIT = 300  # s, for a process


def footopt(*arguments, cwd, drawn=False):
    """footopt in this process: its exit code, and what it wrote to stdout and stderr."""
    root, out, err = logging.getLogger(), io.StringIO(), io.StringIO()
    handlers, level, code = list(root.handlers), root.level, 0
    GlobalHydra.instance().clear()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(err):
        patch.chdir(cwd)
        patch.setattr(sys, "argv", ["footopt", *arguments])
        patch.setenv("HYDRA_FULL_ERROR", "0")
        if not drawn:
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
            cli.Summary.failed = 0
    return subprocess.CompletedProcess(arguments, code, out.getvalue(), err.getvalue())


def unrender(monkeypatch):
    """No figure is rendered for the rest of a test."""
    for method, function in INSTEAD.items():
        monkeypatch.setattr(matplotlib.figure.Figure, method, function)


def environment(drawn=False, **more):
    """The variables of a process that footopt runs in, with its own workers and jobs; None removes one."""
    path = [*([] if drawn else [str(UNRENDERED)]), *filter(None, [os.environ.get("PYTHONPATH")])]
    own = {"HYDRA_FULL_ERROR": "0", "PYTHONPATH": os.pathsep.join(path) or None, **more}
    return {name: value for name, value in (os.environ | own).items() if value is not None}


def program(*arguments, cwd, drawn=False, **more):
    """footopt in a process of its own, where warnings are errors: what became of it."""
    return subprocess.run(
        [sys.executable, "-m", "footopt", *arguments],
        cwd=cwd,
        env=environment(drawn, PYTHONWARNINGS="error", **more),
        capture_output=True,
        text=True,
        timeout=LIMIT,
    )


def started(*arguments, cwd, drawn=False, **options):
    """footopt in the background; if it is told to abort it writes where it is."""
    return subprocess.Popen(
        [sys.executable, "-m", "footopt", *arguments],
        cwd=cwd,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment(drawn, PYTHONFAULTHANDLER="1"),
        **options,
    )
