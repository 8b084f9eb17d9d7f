"""A sand from a table of stresses, and a robot's controller from a table of commands or a function."""

from pathlib import Path
from typing import Any

from footopt.errors import Unusable, check, naming
from footopt.files.io import load_module, numbers, parse_table, read_columns, read_text
from footopt.mujoco.controllers import Commands, FunctionController
from footopt.sand import Sand, fit_stress_map

STRESSES = {"beta": "deg", "gamma": "deg", "alpha_x": "N/cm^3", "alpha_z": "N/cm^3"}
TIMES = ("t", "time", "time_s", "t_s")


def read_sand(path: str | Path, zeta: float = 1.0) -> Sand:
    """Read a table of stresses, and fit a stress map to it, which zeta scales.

    The CSV file has the columns ``beta``, ``gamma`` (degrees, signs as in `footopt.sand.law.alpha`),
    ``alpha_x``, ``alpha_z`` (N/cm^3); others are ignored. The sand has the error of the fit.

    Raises
    ------
    FileError
        The file cannot be read, lacks a column, holds something that is not a number, has too few
        different angles to determine nine coefficients, or no sand can have such stresses.
    """
    columns, *_ = read_columns(path, "sand.table", STRESSES)
    with naming(path, "sand.table"):
        stress_map, error = fit_stress_map(*(columns[name] for name in STRESSES))
    return Sand(zeta=zeta, stress_map=stress_map, name=Path(path).stem, fit_error=error)


def read_controller(path: str) -> Commands | FunctionController:
    """A controller from ``FILE.py:FUNCTION``, which is called with (model, data) before each step, or a CSV.

    The first line of the CSV has the names of actuators and of a column of time (`TIMES`), s.
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
