"""The examples that are Python programs, run small."""

import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from searching import QUICK

import footopt as fo

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


def test_foot_and_gait_together_are_no_worse_than_the_foot_alone():
    example = runpy.run_path(str(EXAMPLES / "codesign.py"))
    scene, space = fo.Scene(), fo.Waypoints(n=5, K=5)
    own = np.array([*space.random(1, seed=1, inside=True)[0], 3, 3, 3, 3])
    values = example["genes"](own[5:], 5)
    table = fo.evaluate([own[:5]], scene, QUICK, ("efficiency", "distance"), space)
    before, distance = table.values[0]
    given = fo.evaluate([own[:5]], replace(scene, gait=example["varied"](scene.gait, values)), QUICK,
                        ("efficiency",), space).values[0, 0]  # fmt: skip
    assert given == pytest.approx(before, rel=1e-6)
    problem = example["FootAndGait"](scene, space, QUICK, 0.99 * distance)
    found = example["together"](problem, own[:5], 2)
    assert found.F[0] < before
    assert found.G.max() <= 0.0
