"""What a scene does not name costs nothing: compiled code has no operation of an absent effect."""

import math
import re
import runpy
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from every_effect import ALL
from feet_in_sand import PITCH, RATE, SOLES, SPEED, feel, pose_of
from hypothesis import given
from hypothesis import strategies as st
from numba import njit

import footopt as fo
from footopt.effects import laws
from footopt.walk import loop
from footopt.walk.prepare import sole, world
from footopt.walk.state import LANES, Contact, Force, Pose

DELETED = runpy.run_path(str(Path(fo.__file__).parents[1] / "benchmarks" / "deleted.py"))

#: Floating-point instructions of LLVM, and calls of its mathematical functions.
OPERATION = re.compile(r"= (?:tail )?(fadd|fsub|fmul|fdiv|fneg|fcmp|select|call[^@]*@llvm\.\w+)\b")


def part(loop, name):
    """A module beside a loop."""
    return sys.modules[f"{loop.__package__}.{name}"]


def operations(compiled):
    """How often each floating-point operation is in a function's optimised intermediate form."""
    (text,) = compiled.inspect_llvm().values()
    assert "fmul" in text
    return Counter(OPERATION.findall(text))


def step(loop, *on):
    """Operations of what effects change of a step, compiled here for a scene: plates and acceleration."""
    foot_force, acceleration = part(loop, "contact").foot_force, part(loop, "steppers").acceleration
    scene = fo.Scene(effects=on)

    @njit(error_model="numpy")
    def both(sole, world, ankle, at):
        force = foot_force(
            sole, world.law, world.loads, world.gates, world.pushes, sole.tangent, 0,
            len(sole.x), ankle, world.creep, 1e-3, None,
        )  # fmt: skip
        return force, acceleration(world, at)

    plates = fo.Foot.flat().plates(64, directed=laws(scene.effects).directed)
    none = Force(*[0.0] * 7)
    ankle = Pose(0.1, -0.1, 0.3, -0.2, 0.9, 0.1, 0.5)
    both(sole(plates), world(scene, fo.Accuracy()), ankle, Contact(none, none))
    return operations(both)


@pytest.fixture(scope="module")
def deleted(tmp_path_factory):
    folder = tmp_path_factory.mktemp("deleted")
    DELETED["write"](folder)
    return DELETED["load"](folder)


@pytest.fixture(scope="module")
def bare(deleted):
    return step(deleted)


class TestNothingForNothing:
    def test_the_deleted_source_knows_no_effect(self, deleted):
        """What is compared with is really without: no hook, no normal, no tilt is computed."""
        here, there = (Path(part(p, "contact").__file__).read_text() for p in (loop, deleted))
        for trace in ("effects.load(", "effects.gate(", "effects.push(", "nx", "vn", "slides"):
            assert trace in here
            assert trace not in there.split("def foot_force")[1]
        tilt = Path(part(deleted, "contact").__file__).with_name("slope.py").read_text()
        assert "time * tilt" not in tilt.split("def tilted")[1]

    def test_a_bare_step_has_the_operations_of_the_deleted_source(self, bare):
        assert step(loop) == bare

    @pytest.mark.slow
    def test_effects_that_are_named_have_more(self, bare):
        found = step(loop, *ALL)
        assert found.total() > bare.total()
        assert not bare - found

    @pytest.mark.slow
    def test_a_whole_bare_walk_has_the_operations_of_the_deleted_source(self, deleted, tmp_path, regular):
        DELETED["write"](tmp_path, "footopt_copy", delete=False)
        copy = DELETED["load"](tmp_path, "footopt_copy")
        found = []
        for package in (copy, deleted):
            with DELETED["walking"](package):
                table = fo.evaluate([[5] * 11], regular)
            found.append(
                (operations(package.compiled(part(package, "steppers").sdirk2.SDIRK2())), table.raw.tobytes())
            )
        assert found[0] == found[1]

    @pytest.mark.parametrize("on", [(), ALL], ids=["bare", "all effects"])
    @given(foot=SOLES, height=st.floats(-0.1, 0.25), pitch=PITCH, rate=RATE, vx=SPEED, vz=SPEED)
    def test_plates_are_evaluated_in_whole_blocks_that_reach_the_sand(
        self, on, foot, height, pitch, rate, vx, vz
    ):
        """Blocks from the first to the last whose circle reaches below the surface; a foot above, none."""
        plates = foot.plates(100, directed=True)
        low = height + math.sin(pitch) * plates.x[0] + math.cos(pitch) * plates.z[0]
        in_sand = np.flatnonzero(low < 0.0) // LANES
        found, counts = feel(plates, pose_of(height, pitch, rate), vx, vz, *on)
        assert counts["evaluations"] == 1
        assert counts["plates"] % LANES == 0
        if len(in_sand) == 0:
            assert (found == 0.0).all()
        else:
            assert counts["plates"] >= LANES * (in_sand[-1] - in_sand[0] + 1)
        reach = 0.03  # m, more than a block's diameter: 8 of 100 plates of a sole that is < .36 m long
        near = np.flatnonzero(low < reach) // LANES
        assert counts["plates"] <= (LANES * (near[-1] - near[0] + 1) if len(near) else 0)
