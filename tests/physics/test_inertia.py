"""The grains' inertia: the drag test of dynamic RFT."""

import math

import numpy as np
import pytest
from every_effect import DOWN, difference
from feet_in_sand import blade, force
from hypothesis import assume, given
from hypothesis import strategies as st

import footopt as fo
from footopt.effects import Inertia, laws
from footopt.effects import base as effects
from footopt.effects.dual import Dual


class TestInertia:
    SPEEDS = np.array([0.04, 0.08, 0.16, 0.32, 0.64])

    @pytest.mark.parametrize("depth", [0.02, 0.03, 0.04])
    def test_drag_is_k_depth_and_lambda_rho_area_v2(self, depth):
        """The drag test of dynamic RFT, for a plate of .016 m: F = K |z| + lambda rho A v^2."""
        area, creep = 0.016 * 0.016, 1e-9
        drag = [
            -force(blade(math.pi / 2), DOWN, v, 0.0, Inertia(1.1, 900.0), creep=creep, z=-depth)[0]
            for v in self.SPEEDS
        ]
        slope, at_rest = np.polyfit(self.SPEEDS**2, drag, 1)
        assert slope == pytest.approx(1.1 * 900.0 * area, rel=1e-9)
        ax, _ = fo.stress.alpha(math.pi / 2, 0.0)
        assert at_rest == pytest.approx(float(ax) * depth * area, rel=1e-9)

    def test_a_face_that_trails_throws_nothing_aside(self):
        for speed in self.SPEEDS:
            state = blade(-math.pi / 2), DOWN, speed, 0.0
            np.testing.assert_allclose(force(*state, Inertia(), z=-0.03), force(*state, z=-0.03), rtol=1e-12)

    @given(st.floats(0.0, 2.0))
    def test_a_plate_gets_wet_in_proportion_to_its_depth(self, skins):
        """A level plate moving down: beyond the law's own force, lambda rho A v^2 times the share."""
        speed, area, z = 0.5, 0.016 * 0.016, -skins * fo.Inertia.skin
        state = blade(0.0), DOWN, 0.0, -speed
        thrown = force(*state, Inertia(1.1, 900.0), z=z) - force(*state, z=z)
        expected = [0.0, 990.0 * area * speed**2 * min(skins, 1.0)]
        np.testing.assert_allclose(thrown, expected, rtol=0, atol=1e-9)

    @given(st.floats(-2.0, 2.0), st.floats(1e-6, 3e-3))
    def test_push_has_its_derivatives(self, vn, depth):
        assume(abs(depth - fo.Inertia.skin) > 1e-6)
        found = laws([Inertia()]).pushes

        def push(du, dd):
            return effects.push(found, vn + du, depth + dd)

        _, stiff, sink = effects.push(found, Dual(vn, 1.0, 0.0), Dual(depth, 0.0, 1.0))
        assert stiff == pytest.approx(difference(lambda d: push(d, 0.0)), abs=1e-3)
        assert sink == pytest.approx(difference(lambda d: push(0.0, d)), rel=1e-6, abs=1e-2)
