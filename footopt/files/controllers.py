"""Controllers of robots in files: a table of commands, or a function of your own."""

from pathlib import Path
from typing import Any

from footopt.errors import Unusable, check, naming
from footopt.files.io import load_module, numbers, parse_table, read_text
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
        There is no such file or function.
    FileError
        The table is none of numbers, or has no time.
    """
    file, _, function = path.rpartition(":") if ".py:" in path else (path, "", "")
    check(Path(file).is_file(), "robot.controller", path, "FILE.py:FUNCTION, or a CSV file that is there")
    if function:
        found: Any = getattr(load_module(file, "robot.controller"), function, None)
        check(callable(found), "robot.controller", path, f"a function of {Path(file).name}")
        return FunctionController(found)
    with naming(file, "robot.controller"):
        table = parse_table(read_text(file, "robot.controller"))
        columns = {name: numbers(table, name) for name in table}
        if len(times := columns.keys() & set(TIMES)) != 1:
            raise Unusable(f"must have one column of time: {', '.join(TIMES)}.")
    t = columns.pop(times.pop())
    return Commands(t - t[0], columns)
