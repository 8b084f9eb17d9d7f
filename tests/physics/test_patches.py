"""Patches: the strength changes along the way."""

import numpy as np
import pytest
from every_effect import PATCHES
from feet_in_sand import HEIGHT, PITCH, RATE, SOLES, SPEED, feel, pose_of
from hypothesis import given
from hypothesis import strategies as st

from footopt.effects import Patches, laws
from footopt.effects import base as effects
from footopt.effects.dual import Dual


class TestPatches:
    @given(SOLES, HEIGHT, PITCH, RATE, SPEED, SPEED, st.sampled_from([(0.65, 0.7), (1.4, 1.5)]))
    def test_inside_a_patch_the_sand_is_its_own(self, foot, height, pitch, rate, vx, vz, inside):
        x, factor = inside
        state = foot.plates(40), pose_of(height, pitch, rate), vx, vz
        plain = feel(*state, zeta=factor)[0]
        scale = 1e-12 * np.abs(plain).max()
        np.testing.assert_allclose(feel(*state, PATCHES, x=x)[0], plain, rtol=1e-12, atol=scale)


class TestPatchesTogether:
    @given(
        st.lists(
            st.tuples(st.floats(0.0, 1.0), st.floats(1e-3, 1.0), st.floats(1e-3, 10.0)),
            min_size=1,
            max_size=8,
        )
    )
    def test_sand_is_never_weaker_than_its_weakest_patch(self, patches):
        """Also where patches adjoin, or are narrower than the blur; the strength has its derivative."""
        gaps, lengths, factors = (np.array(column) for column in zip(*patches, strict=True))
        begins = np.cumsum(gaps) + np.concatenate([[0.0], np.cumsum(lengths)[:-1]])
        law = laws([Patches(begins, begins + lengths * (1 - 1e-12), factors)]).loads
        if law is None:  # every factor is 1
            return
        x, d = np.linspace(-0.5, 9.0, 9001), 1e-7
        strength, _, slide = effects.load(law, Dual(1.0, 0.0, 0.0), Dual(x, 0.0, 1.0))
        assert strength.min() > min(1.0, factors.min()) - 1e-12
        assert strength.max() < max(1.0, factors.max()) + 1e-12
        ahead, behind = (effects.load(law, 1.0, x + s) for s in (d, -d))
        np.testing.assert_allclose((ahead - behind) / (2 * d), slide, rtol=0, atol=1e-3 * np.abs(slide).max())

    @pytest.mark.parametrize("width", [0.002, 0.02, 0.05, 0.3])
    def test_a_patch_keeps_its_integral_however_narrow_it_is(self, width):
        x = np.linspace(-0.5, 1.0, 150_001)
        law = laws([Patches((0.1,), (0.1 + width,), (10.0,), blur=0.05)]).loads
        strength = effects.load(law, 1.0, x)
        assert np.trapezoid(strength - 1.0, x) == pytest.approx(9.0 * width, rel=1e-6)

    def test_many_patches_are_a_table_that_acts_as_few_do(self):
        """A long list is not compiled one by one; patches that adjoin are one."""
        edges = tuple(np.linspace(0.35, 0.95, 13).tolist())
        one = Patches((0.35,), (0.95,), (0.4,), blur=0.02)
        many = Patches(edges[:-1], edges[1:], (0.4,) * 12, blur=0.02)
        assert isinstance(many.law.begins, np.ndarray)
        for x in (0.3, 0.5, 0.95):
            wide, cut = (effects.load(laws([on]).loads, 1.0, Dual(x, 0.0, 1.0)) for on in (one, many))
            np.testing.assert_allclose(cut, wide, rtol=1e-9, atol=1e-9)
