"""What a scene does not name costs nothing: compiled code has no operation of an absent effect."""

import math
import re
from collections import Counter

import numpy as np
import pytest
from every_effect import ALL
from feet_in_sand import PITCH, RATE, SOLES, SPEED, feel, pose_of
from hypothesis import given
from hypothesis import strategies as st
from numba import njit

import footopt as fo
from footopt.compiled import FAST
from footopt.effects.dual import placed, positive
from footopt.walk.contact import direction, foot_force, kinematics, resistance
from footopt.walk.discretize import sole_of
from footopt.walk.state import LANES, Ankle, plates_between

#: Floating-point instructions of LLVM, and calls of its mathematical functions.
OPERATION = re.compile(r"= (?:tail )?(fadd|fsub|fmul|fdiv|fneg|fcmp|select|call[^@]*@llvm\.\w+)\b")


@njit(error_model="numpy", fastmath=FAST)
def bare_force(world, part, ankle, stage):
    """The law of one foot as if there were no effects: f = (a - M h) |z| dA, added up."""
    x = z = power = xx = xz = zx = zz = 0.0
    cos2, sin2 = ankle.cos * ankle.cos - ankle.sin * ankle.sin, 2.0 * ankle.sin * ankle.cos
    for i in range(len(part.x)):
        motion = kinematics(ankle, part.x[i], part.z[i])
        h = direction(motion, world.creep, ankle.rate * part.span, None, i)
        c, s = part.c2[i] * cos2 - part.s2[i] * sin2, part.s2[i] * cos2 + part.c2[i] * sin2
        pull = part.area[i] * positive(placed(stage, -motion.z, 0.0, -1.0))
        fx, fz = resistance(world.law, c, s, h, pull, stage)
        x, z, power = x + fx.value, z + fz.value, power + (fx.value * motion.vx + fz.value * motion.vz)
        xx, xz, zx, zz = xx + fx.dx, xz + fx.dz, zx + fz.dx, zz + fz.dz
    return x, z, power, xx, xz, zx, zz


@njit(error_model="numpy", fastmath=FAST)
def whole_force(world, part, ankle, stage):
    return foot_force(world.law, world.effects, part, ankle, world.creep, stage, None)


def operations(compiled, *on):
    """How often each floating-point operation is in a function's optimised form; and what it returns."""
    scene = fo.Scene(effects=on)
    plates = fo.Foot.from_waypoints([3, 5] * 5 + [3]).plates(64)
    ankle = Ankle(0.1, -0.1, 0.3, -0.2, math.cos(0.1), math.sin(0.1), 0.5)
    sole = sole_of(plates)
    part = plates_between(sole, True if on else None, 0, sole.plates.shape[1])
    arguments = scene.constants(fo.Accuracy()), part, ankle, 1e-3
    result = compiled(*arguments)
    *_, text = compiled.inspect_llvm().values()
    assert "fmul" in text
    return Counter(OPERATION.findall(text)), np.array(result)


class TestNothingForNothing:
    @pytest.mark.slow  # of compiling
    def test_the_contact_without_effects_has_the_operations_of_the_law_alone(self):
        (bare, law), (whole, force) = operations(bare_force), operations(whole_force)
        assert whole.total() <= 1.02 * bare.total()  # the compiler orders sums as it likes
        np.testing.assert_allclose(force, [*law, 0.0, 0.0], rtol=1e-12)

    @pytest.mark.slow
    def test_effects_that_are_named_have_more(self):
        bare, found = operations(whole_force)[0], operations(whole_force, *ALL)[0]
        assert found.total() > 1.2 * bare.total()

    @pytest.mark.parametrize("on", [(), ALL], ids=["bare", "all effects"])
    @given(foot=SOLES, height=st.floats(-0.1, 0.25), pitch=PITCH, rate=RATE, vx=SPEED, vz=SPEED)
    def test_plates_are_evaluated_in_whole_blocks_that_reach_the_sand(
        self, on, foot, height, pitch, rate, vx, vz
    ):
        """Blocks from the first to the last whose circle reaches below the surface; a foot above, none."""
        plates = foot.plates(100)
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
