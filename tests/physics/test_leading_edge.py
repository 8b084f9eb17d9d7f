"""The leading edge: faces that lead feel the whole law, faces that trail nothing."""

import math

import numpy as np
import pytest
from every_effect import difference
from feet_in_sand import blade, force, pose_of
from hypothesis import given
from hypothesis import strategies as st

import footopt as fo
from footopt.effects import LeadingEdge, laws
from footopt.effects import base as effects
from footopt.effects.dual import Dual


class TestLeadingEdge:
    def test_a_walker_stands_on_a_flat_sole_as_without_it(self, flat_foot):
        starts = [
            fo.simulate(flat_foot, fo.Scene(effects=on, t_f=0.1), fo.Accuracy()).start[1]
            for on in ((), (LeadingEdge(),), (LeadingEdge(), fo.Inertia()))
        ]
        assert starts == pytest.approx([starts[0]] * 3, rel=1e-14)

    @given(st.floats(-3.1, 3.1), st.floats(-math.pi, math.pi), st.floats(0.05, 2.0))
    def test_a_face_that_leads_feels_the_whole_law_and_one_that_trails_nothing(self, beta, angle, speed):
        creep = 1e-2
        plate, vx, vz = blade(beta), speed * math.cos(angle), speed * math.sin(angle)
        vn = vx * math.sin(beta) - vz * math.cos(beta)
        pose = pose_of(-0.1, 0.0, 0.0)
        found = force(plate, pose, vx, vz, LeadingEdge(), creep=creep)
        if vn > creep:
            np.testing.assert_allclose(found, force(plate, pose, vx, vz, creep=creep), rtol=1e-12, atol=1e-12)
        elif vn < -creep:
            assert (found == 0.0).all()

    def test_the_share_rises_smoothly(self):
        lead = Dual(np.linspace(-1.5, 1.5, 301), 1.0, 0.0)
        share, bend, _ = effects.gate(laws([LeadingEdge()]).gates, lead, 0.1)
        assert (np.diff(share) >= 0.0).all()
        assert (share[0], share[150], share[-1]) == (0.0, pytest.approx(0.5), 1.0)
        assert np.abs(np.diff(bend)).max() < 0.05 * bend.max()  # no jump in the derivative either

    @given(st.floats(-3.0, 3.0))
    def test_gate_has_its_derivative(self, s):
        found = laws([LeadingEdge()]).gates
        slope = difference(lambda d: effects.gate(found, s + d, 0.1))
        assert effects.gate(found, Dual(s, 1.0, 0.0), 0.1).dx == pytest.approx(slope, abs=1e-6)
