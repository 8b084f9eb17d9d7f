"""Feet and scenes that several test modules share."""

import signal

import pytest
from hypothesis import settings

import footopt as fo
from footopt.walk.reference import RAMP

# a shell that starts the tests in the background has them ignore Ctrl-C, and what they start inherits that
signal.signal(signal.SIGINT, signal.default_int_handler)

settings.register_profile("footopt", deadline=None, derandomize=True, database=None, max_examples=25)
settings.load_profile("footopt")


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
