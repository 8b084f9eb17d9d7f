"""Does study=calibrate warn of forces that do not grow with depth, and not of those that do?

    python benchmarks/calibration.py

prints for each power of depth the share of 640 random files of which the run says that the law does not hold,
and that they are no test of it.
"""

from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from footopt.studies.calibrate import calibrate

ENDS, REPEATS, NOISES = ((4, 40), (18, 50)), ((1, 10), (2, 10), (2, 30), (4, 12)), ("its size", "the largest")
SEEDS, NOISE, AREA = 40, 0.03, 25.0  # noise over the force itself, or over the largest; cm^2


def warnings(
    path: Path, power: float, ends: tuple[int, int], repeats: int, rows: int, of: str, seed: int
) -> str:
    """What the study says of one file of tests."""
    rng, (low, high) = np.random.default_rng(seed), ends
    depth = np.tile(np.linspace(low, high, rows), repeats)
    sand = np.repeat(np.exp(0.1 * rng.standard_normal(repeats)), rows)
    force = sand * 1e-1 * AREA * depth * (depth / high) ** (power - 1.0)
    noise = NOISE * rng.standard_normal(len(force))
    force += noise * (force if of == "its size" else 1e-1 * AREA * high)
    table = np.stack([depth, force, np.full(len(force), AREA), np.repeat(np.arange(repeats), rows)], axis=1)
    np.savetxt(path, table, delimiter=",", header="depth_mm,force_N,area_cm2,repeat", comments="")
    return " ".join(calibrate(path).warnings)


with TemporaryDirectory() as folder:
    for power in (0.0, 0.5, 1.0, 1.4, 2.0):
        said = [
            warnings(Path(folder) / "tests.csv", power, ends, *size, of, seed)
            for ends, size, of, seed in product(ENDS, REPEATS, NOISES, range(SEEDS))
        ]
        shares = [
            np.mean([words in one for one in said]) for words in ("does not hold", "no test of the law")
        ]
        either = np.mean(["does not hold" in one or "no test of the law" in one for one in said])
        print(
            f"depth^{power}: {shares[0]:.1%} law does not hold, {shares[1]:.1%} no test, {either:.1%} either"
        )
