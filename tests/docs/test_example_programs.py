"""The examples that are Python programs, run small."""

import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from searching import QUICK

import footopt as fo

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.slow
def test_the_walker_of_gymnasium_walks_on_sand():
    pytest.importorskip("mujoco")
    pytest.importorskip("gymnasium")
    step = runpy.run_path(str(EXAMPLES / "public_robot" / "control.py"))["step"]
    model, feet = "pkg://gymnasium/envs/mujoco/assets/walker2d_v5.xml", ("foot", "foot_left")
    sand = fo.Sand.named("regular")
    robot = fo.mujoco.Robot(model, feet, step, sand, duration=3.0, after=1.0)
    table = fo.evaluate([fo.Foot.flat()], robot, fo.Accuracy(dt=1e-3, plates=32), "distance")
    assert table.feasible.all()
    assert table.values[0, 0] > 1.0


@pytest.mark.slow
def test_an_environment_of_gymnasium_stands_on_sand():
    for needed in ("mujoco", "imageio", "gymnasium"):
        pytest.importorskip(needed)
    import gymnasium

    wrapper = runpy.run_path(str(EXAMPLES / "mujoco" / "gym_on_sand.py"))["OnSand"]
    feet = dict.fromkeys(("foot", "foot_left"), fo.Foot.flat())
    env = wrapper(gymnasium.make("Walker2d-v5"), feet, fo.Sand.named("hard"))
    for seed in (1, 2):
        env.reset(seed=seed)
        for _ in range(10):
            *_, info = env.step(np.zeros(6))
        weight = 9.81 * env.unwrapped.model.body_mass.sum()
        assert sum(force[2] for force in info["sand_force"].values()) == pytest.approx(weight, rel=0.2)
    env.close()


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
