"""Layers: the stress is the integral of the strength over depth."""

import math

import numpy as np
from every_effect import DOWN, LAYERS
from feet_in_sand import blade, force
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

import footopt as fo


class TestLayers:
    @given(st.floats(0.0, 0.12), st.floats(-1.5, 1.5), st.floats(0.0, math.pi), st.floats(0.2, 5.0))
    def test_stress_is_the_integral_of_zeta_over_depth(self, depth, beta, gamma, zeta):
        """A plate's force by quadrature of the plain law's growth with depth, as published."""
        along = np.searchsorted(LAYERS.depths, [0.0, 0.03, 0.06])
        assert list(along) == [0, 1, 2]
        factors = (1.0, *LAYERS.factors)
        integral, _ = quad(
            lambda d: zeta * factors[np.searchsorted(LAYERS.depths, d)], 0.0, depth, points=LAYERS.depths
        )
        ax, az = fo.stress.alpha(beta, gamma)
        vx, vz, area = math.cos(gamma), -math.sin(gamma), 0.016 * 0.016
        plate = blade(beta, parts=8)._replace(x=np.zeros((1, 8)), z=np.zeros((1, 8)))
        found = force(plate, DOWN, vx, vz, LAYERS, zeta=zeta, creep=1e-7, z=-depth)
        np.testing.assert_allclose(found, integral * area * np.array([-ax, az]), rtol=1e-9, atol=1e-8)
