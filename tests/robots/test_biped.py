"""The example of a biped: it walks, its joints follow the gait, and both feet carry it in turn."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import footopt as fo

pytest.importorskip("mujoco")
EXAMPLE = Path(__file__).parents[2] / "examples" / "mujoco" / "biped.py"


@pytest.mark.slow
def test_biped_walks_on_sand_as_its_gait_says():
    biped = runpy.run_path(str(EXAMPLE))
    loads = []
    watch = lambda model, data: loads.append(data.qfrc_passive[1])  # noqa: E731
    found = biped["walk"](fo.Foot.flat(), fo.Sand.named("hard"), 2.9, watch=watch)
    assert found["failures"] == 0
    assert found["distance"] == pytest.approx(2.1, rel=0.1)  # as the walker's, whose mass is at the hip
    assert found["tracking"] < 5.0  # deg
    assert np.mean(loads) == pytest.approx(60 * 9.81, rel=0.05)


def test_its_sinkage_is_that_of_the_deepest_point_of_a_sole():
    walk = fo.simulate(fo.Foot.flat(), fo.mujoco.Robot(duration=1.4), "draft")
    pose, (x, z) = walk.pose(np.arange(len(walk.t))), (walk.foot.contour - walk.foot.ankle).T
    under = pose.z[..., None] + np.sin(pose.pitch)[..., None] * x + np.cos(pose.pitch)[..., None] * z
    assert walk.totals["maximum_sinkage"] == pytest.approx(-(walk.com[:, 1, None, None] + under).min())


def test_its_size_is_the_height_of_its_centre_of_mass_over_its_feet():
    assert fo.mujoco.Robot().legs == pytest.approx(0.98, abs=0.02)  # m: legs of 0.92 m, and a torso
