"""Sands from files: a measured table of stresses (CSV)."""

from pathlib import Path

from footopt.errors import naming
from footopt.files.io import read_columns
from footopt.sand import Sand, fit_stress_map

COLUMNS = {"beta": "deg", "gamma": "deg", "alpha_x": "N/cm^3", "alpha_z": "N/cm^3"}


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
    columns, _ = read_columns(path, "sand.table", COLUMNS)
    with naming(path, "sand.table"):
        stress_map, error = fit_stress_map(*(columns[name] for name in COLUMNS))
    return Sand(zeta=zeta, stress_map=stress_map, name=Path(path).stem, fit_error=error)
