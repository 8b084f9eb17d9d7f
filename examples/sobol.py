"""What do the objectives of a foot depend on? Total Sobol indices by SALib: `pip install SALib`.

`python examples/sobol.py` varies sand, walker, gait and the ankle's place about the hard scene as far as
`footopt.Spread` says, and prints the share of each objective's variance in which each parameter takes part
(Saltelli et al. 2010), with half its 95 % interval. `python examples/sobol.py 512` takes 512 samples of
Sobol's sequence, a power of two, where the default is 64. Each costs a walk for every parameter and two more.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from SALib.analyze import sobol as analysis
from SALib.sample import sobol as sampling
from scipy.special import ndtri

import footopt as fo
from footopt.design.scenarios import COLUMNS, vary

FOOT = (2, 6, 6, 2, 1, 1, 1, 1, 3, 4, 1)  # heights of the best known on hard sand
NAMES = ("distance", "work", "peak_power", "efficiency")
PARAMETERS = tuple(dict.fromkeys(COLUMNS))  # an angle has several columns

Array = NDArray[np.float64]


def walk(normals: Array) -> Array:
    """Objectives (NAMES,) of the foot in the scene that standard normal variables (COLUMNS,) make."""
    scenario = vary(fo.Scene(), fo.Spread(), normals)
    return fo.evaluate([FOOT], scenario.scene, "standard", NAMES, scenario.space(fo.Waypoints())).values[0]


def total_indices(model: Callable[[Array], Array], samples: int, seed: int = 1) -> tuple[Array, Array]:
    """Total indices of a model's values and half their intervals, (parameters, values) each."""
    problem = {
        "num_vars": len(COLUMNS),
        "names": [f"{name} {i}" for i, name in enumerate(COLUMNS)],
        "groups": list(COLUMNS),
        "bounds": [[0.0, 1.0]] * len(COLUMNS),
    }
    quantiles = sampling.sample(problem, samples, calc_second_order=False, seed=seed)
    values = np.array([model(row) for row in ndtri(np.clip(quantiles, 1e-6, 1.0 - 1e-6))])
    found = [analysis.analyze(problem, v, calc_second_order=False, seed=seed) for v in values.T]
    return np.stack([f["ST"] for f in found], 1), np.stack([f["ST_conf"] for f in found], 1)


if __name__ == "__main__":
    total, half = total_indices(walk, int(sys.argv[1]) if len(sys.argv) > 1 else 64)
    print("parameter ", *(f"{name:>14}" for name in NAMES))
    for parameter, t, h in zip(PARAMETERS, total, half, strict=True):
        print(f"{parameter:10}", *(f"{a:7.2f} ± {b:.2f}" for a, b in zip(t, h, strict=True)))
    if half.max() > 0.2:
        print(f"An index is uncertain by ± {half.max():.2g}: take more samples.")
