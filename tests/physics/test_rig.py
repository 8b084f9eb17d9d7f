"""The rig of plates and wheels is the walk's law, and what is laid on sand sinks until it is carried."""

import numpy as np
import pytest
from feet_in_sand import force, pose_of
from hypothesis import given
from hypothesis import strategies as st

import footopt as fo
from footopt.effects import EFFECTS
from footopt.studies.validate import rig


@pytest.mark.parametrize("law", [(), ("leading_edge",)], ids=str)
def test_a_wheel_feels_what_the_compiled_contact_says(law):
    foot, effects = fo.Foot.shape("circle", length=0.2, width=0.06), [EFFECTS[name]() for name in law]
    for height, vx, vz, rate in ((0.05, 0.4, 0.0, -16.0), (0.03, 1.0, -0.2, 0.0), (0.01, 0.1, 0.3, -2.0)):
        place, velocity = np.array([height]), np.array([[vx, vz]])
        mine = rig.body(foot, fo.Scene(fo.Sand(0.6), effects=effects), 64)(place, velocity, np.array([rate]))[
            0
        ]
        plates, pose = foot.plates(64, "chord"), pose_of(height, 0.0, rate)
        walked = force(plates, pose, vx, vz, *effects, zeta=0.6, creep=rig.CREEP)
        np.testing.assert_allclose(mine, walked, rtol=1e-9, atol=1e-9)


@given(st.floats(0.2, 5.0), st.floats(5.0, 200.0))
def test_a_level_plate_sinks_until_it_carries_the_load(zeta, load):
    foot, down = fo.Foot(np.array([[-0.05, 0.0], [0.05, 0.0]]), 0.1), np.array([[0.0, -1.0]])
    sinkage, found = rig.balanced(foot, fo.Scene(fo.Sand(zeta)), 8, np.array([load]), down, np.zeros(1), 1.0)
    assert sinkage[0] == pytest.approx(load / (zeta * 1e6 * 0.01), rel=1e-6)
    assert found[0, 1] == pytest.approx(load, rel=1e-6)
