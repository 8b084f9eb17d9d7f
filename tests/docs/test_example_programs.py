"""The examples that are Python programs, run small."""

import runpy
from pathlib import Path

import numpy as np

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_sobol_indices_of_a_linear_model_are_those_of_its_coefficients():
    """10 + 3 zeta - 4 mass, in standard deviations: a variance of 25, of which 9 and 16 are theirs."""
    example = runpy.run_path(str(EXAMPLES / "sobol.py"))
    zeta, mass = (example["COLUMNS"].index(name) for name in ("zeta", "mass"))
    total, half = example["total_indices"](lambda x: np.array([10.0 + 3.0 * x[zeta] - 4.0 * x[mass]]), 256)
    expected = {"zeta": 9 / 25, "mass": 16 / 25}
    for name, index, error in zip(example["PARAMETERS"], total[:, 0], half[:, 0], strict=True):
        assert abs(index - expected.get(name, 0.0)) <= 1.5 * error + 1e-9
    walked = example["walk"](np.zeros(len(example["COLUMNS"])))
    assert np.isfinite(walked).all()
    assert walked[-1] < -2e-4
