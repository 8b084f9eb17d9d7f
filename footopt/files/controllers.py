"""Controllers of robots in files: a table of commands, or a function of your own."""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from footopt.errors import SettingError, check
from footopt.mujoco.controllers import Commands, FunctionController

TIMES = ("t", "time", "time_s", "t_s")


def read_controller(path: str) -> Commands | FunctionController:
    """Read a controller.

    Parameters
    ----------
    path : str
        ``FILE.py:FUNCTION``, which is called with (model, data) before each step; or a CSV whose first line
        has the names of actuators and of a column of time (`TIMES`), s.

    Raises
    ------
    SettingError
        There is no such file or function, or the table is none.
    """
    file, _, function = path.rpartition(":") if ".py:" in path else (path, "", "")
    check(Path(file).is_file(), "robot.controller", path, "FILE.py:FUNCTION, or a CSV file that is there")
    return _function(Path(file), function) if function else _table(Path(file))


def _function(file: Path, name: str) -> FunctionController:
    if str(file.parent.absolute()) not in sys.path:
        sys.path.append(str(file.parent.absolute()))  # which worker processes are given, too
    found: Any = getattr(import_module(file.stem), name, None)
    check(callable(found), "robot.controller", f"{file}:{name}", f"a function of {file.name}")
    return FunctionController(found)


def _table(file: Path) -> Commands:
    import pandas

    try:
        table = pandas.read_csv(file, comment="#", skipinitialspace=True)
    except ValueError as error:  # pandas' own are ValueErrors
        raise SettingError("robot.controller", str(file), f"a CSV table ({error})") from None
    table.columns = [str(name).strip() for name in table.columns]
    times = [name for name in table.columns if name in TIMES]
    check(len(times) == 1, "robot.controller", str(file), f"with one column of time: {', '.join(TIMES)}")
    numbers = all(np.issubdtype(kind, np.number) for kind in table.dtypes)
    check(numbers, "robot.controller", str(file), "a table of numbers")
    t = table.pop(times[0]).to_numpy(float)
    return Commands(t - t[0], {name: table[name].to_numpy(float) for name in table.columns})
