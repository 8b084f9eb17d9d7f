"""Feet and scenes that several test modules share."""

import pytest
from hypothesis import settings

import footopt as fo

settings.register_profile("footopt", deadline=None, derandomize=True, database=None, max_examples=50)
settings.load_profile("footopt")

#: The foot whose walk an independent program computed (see test_walker.REFERENCE).
RAMP = (1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 8)


@pytest.fixture(scope="session")
def ramp_foot():
    return fo.Foot.from_waypoints(RAMP)


@pytest.fixture(scope="session")
def flat_foot():
    return fo.Foot.flat()


@pytest.fixture(scope="session", params=["soft", "regular", "hard"])
def scene(request):
    return fo.Scene(sand=fo.Sand.named(request.param))


@pytest.fixture(scope="session")
def regular():
    return fo.Scene(sand=fo.Sand.named("regular"))


@pytest.fixture(scope="session")
def walk(scene, ramp_foot):
    return fo.simulate(ramp_foot, scene)


@pytest.fixture(scope="session")
def fine_walk(scene, ramp_foot):
    return fo.simulate(ramp_foot, scene, "reference")
