"""Feet and scenes that several test modules share."""

import gc
import json
import os
import signal
import sys
from functools import cache
from pathlib import Path

import pytest
from hypothesis import settings

import footopt as fo
from footopt.design.solvers import SINGLE, SOLVERS
from footopt.effects import EFFECTS
from footopt.files import io
from footopt.walk.objectives import OBJECTIVES, SLOW

# a shell that starts the tests in the background has them ignore Ctrl-C, and what they start inherits that
signal.signal(signal.SIGINT, signal.default_int_handler)

# where no byte code is kept, each of some hundred processes compiles all of footopt's modules again
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

settings.register_profile("footopt", deadline=None, derandomize=True, database=None, max_examples=25)
settings.load_profile("footopt")


def pytest_collection_modifyitems(items):
    """Walks first: they have the longest tests, for which no worker should be left alone at the end."""
    items.sort(key=lambda item: item.path.parent.name != "walk")


def pytest_collection_finish():
    """Modules and tests stay: looking for garbage among them is a tenth of the time of small tests."""
    gc.freeze()
    gc.set_threshold(100_000, 20, 20)


@pytest.fixture(scope="session")
def ramp_foot():
    return fo.Foot.from_waypoints([1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 8])


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
    return fo.simulate(ramp_foot, scene, fo.Accuracy("sdirk2", 2e-4, 400, 1e-5))


@pytest.fixture
def clean():
    """What plugins register is forgotten after the test, and so are their modules."""
    registries = (OBJECTIVES, SLOW, SOLVERS, EFFECTS)
    kept = [dict(registry) for registry in registries]
    single, modules, places = list(SINGLE), set(sys.modules), list(sys.path)
    yield
    for registry, before in zip(registries, kept, strict=True):
        registry.clear()
        registry.update(before)
    SINGLE[:], sys.path[:] = single, places
    for name in set(sys.modules) - modules:
        if "site-packages" not in str(getattr(sys.modules[name], "__file__", "")) and "." not in name:
            del sys.modules[name]


@cache
def schema():
    """What validates a result.json, and the studies that it is for."""
    from jsonschema import Draft202012Validator

    content = json.loads((Path(io.__file__).parent / "result.schema.json").read_text(encoding="utf-8"))
    return Draft202012Validator(content), content["properties"]["study"]["enum"]


@pytest.fixture(scope="session", autouse=True)
def every_result_json_is_as_its_schema_says():
    """Of all that these tests write in this process; studies of plugins have entries of their own."""
    text = io.json_text

    def validated(content):
        validator, studies = schema()
        if content.get("study") in studies and content.get("settings"):  # some tests write a part only
            validator.validate(io.plain(content))
        return text(content)

    io.json_text = validated
    yield
    io.json_text = text
