"""An effect of one's own: a file, and nothing else."""

import importlib.util
import sys
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import pytest
from numba.core.caching import NullCache

import footopt as fo
from footopt.effects import Effect, base, laws
from footopt.effects.base import Laws
from footopt.effects.dual import clipped
from footopt.errors import SettingError
from footopt.mujoco import callback
from footopt.walk.loop import walk_designs
from footopt.walk.own_code import compiled_for
from footopt.walk.steppers import STEPPERS

OWN = """
from dataclasses import dataclass
from typing import NamedTuple

from footopt.effects import Effect
from footopt.effects.dual import clipped

BIAS = 1.0

class DampLaw(NamedTuple):
    rate: float
    cohesion: float

    def push(self, vn, depth):
        return BIAS * (self.cohesion + self.rate * vn) * clipped(depth / 1e-6, 0.0, 1.0)

@dataclass(frozen=True)
class Damp(Effect):
    rate: float = 2000.0  # N s/m^3, a pressure per speed into the sand
    cohesion: float = 3000.0  # Pa

    @property
    def law(self):
        return DampLaw(self.rate, self.cohesion)
"""


def pressing(pressure):
    """An effect whose law closes over a pressure, Pa."""

    class PressLaw(NamedTuple):
        share: float

        def push(self, vn, depth):
            return self.share * pressure * clipped(depth / 1e-3, 0.0, 1.0)

    @dataclass(frozen=True)
    class Press(Effect):
        share: float = 1.0

        @property
        def law(self):
            return PressLaw(self.share)

    return Press()


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    path = tmp_path_factory.mktemp("own") / "own_effect.py"
    path.write_text(OWN)
    spec = importlib.util.spec_from_file_location("own_effect", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules["own_effect"] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules["own_effect"]


class TestAnEffectOfOnesOwn:
    def test_that_reshapes_soles_into_fewer_points_is_refused(self, flat_foot):
        @dataclass(frozen=True)
        class Halved(Effect):
            def reshape(self, points):
                return points[:, ::2]

        with pytest.raises(SettingError, match=r"reshape.*shape that it is given"):
            fo.simulate(flat_foot, fo.Scene(effects=[Halved()]))

    @pytest.mark.slow  # of compiling
    def test_acts_in_a_walk_as_an_exact_pressure(self, own, flat_foot):
        """Plates feel the law and (cohesion + rate v_n) dA, by the trace; at first that is the weight."""
        scene = fo.Scene(effects=(own.Damp(),), t_f=0.2)
        walk = fo.simulate(flat_foot, scene, fo.Accuracy("explicit_euler", 1e-3))
        states = walk.plates(np.arange(len(walk.t)))
        np.testing.assert_allclose(
            states.force.sum(axis=2), walk.force, rtol=0, atol=1e-9 * np.abs(walk.force).max()
        )
        plain = replace(walk, scene=fo.Scene(t_f=0.2)).plates(np.arange(len(walk.t)))
        wet = np.clip(-states.position[..., 1] / 1e-6, 0.0, 1.0)
        pressure = 3000.0 - 2000.0 * states.velocity[..., 1]
        pressed = np.sum(pressure * wet, axis=-1) * 0.026 / states.force.shape[2]
        added = states.force.sum(axis=2)[..., 1] - plain.force.sum(axis=2)[..., 1]
        np.testing.assert_allclose(added, pressed, rtol=0, atol=1e-9 * np.abs(pressed).max())
        sole = walk.start[1] + walk.pose([0]).z[0, 0] + flat_foot.contour[0, 1]
        assert 0.026 * (3000.0 - 5e6 * sole) == pytest.approx(scene.weight, rel=1e-9)  # at 1 nm/s

    def test_is_never_kept_on_disk(self, own):
        """Compiled code there cannot outlive an effect that was edited, nor reach a process without it."""
        stepper = STEPPERS["sdirk2"].parameters
        kept, not_kept = (compiled_for(walk_designs, on, stepper) for on in ((), (own.Damp().law,)))
        assert isinstance(not_kept._cache, NullCache)
        assert not isinstance(kept._cache, NullCache)

    def test_is_compiled_again_where_what_its_law_reads_has_changed(self, own, monkeypatch):
        stepper, law = STEPPERS["sdirk2"].parameters, own.Damp().law
        monkeypatch.setattr(callback, "entry", lambda *given, **named: object())
        found = []
        for bias in (1.0, 2.0, 1.0):
            own.BIAS = bias
            acting = Laws(None, None, (law,))
            found.append((compiled_for(walk_designs, (law,), stepper), callback.with_effects(acting)))
        assert found[0] == found[2]
        assert all(one is not other for one, other in zip(*found[:2], strict=True))

    def test_does_not_inherit_what_a_built_in_effect_claims(self, monkeypatch):
        monkeypatch.setattr(base, "EFFECTS", dict(base.EFFECTS))

        @dataclass(frozen=True)
        class Soft(fo.LeadingEdge, name="soft_edge"):
            """A gate of one's own."""

        assert base.name_of(Soft()) == "soft_edge"
        assert base.name_of(fo.LeadingEdge()) == "leading_edge"
        assert [Soft.plausible, Soft.literature, Soft.in_page] == [False] * 3

    @pytest.mark.parametrize("load", ["load + 0.02", "load * load / load"])
    def test_that_acts_in_the_air_is_refused(self, own, load):
        names = {}
        exec(f"def acts(self, load, depth, x): return {load}", names)
        law = type("AirLaw", (own.DampLaw,), {"load": names["acts"], "__module__": "mine"})(1.0, 1.0)

        class Airy(own.Damp):
            pass

        Airy.law = law
        with pytest.raises(SettingError, match=r"AirLaw\.load.*0 at a depth of 0"):
            laws((Airy(),))

    def test_whose_law_has_a_method_that_nothing_calls_is_refused(self, own):
        law = type("PushyLaw", (own.DampLaw,), {"pish": lambda self, vn, depth: 0.0})(1.0, 1.0)

        class Pushy(own.Damp):
            pass

        Pushy.law = law
        with pytest.raises(SettingError, match=r"'PushyLaw'.*load, gate, push.*pish, push"):
            laws((Pushy(),))

    @pytest.mark.slow  # of compiling
    def test_classes_of_one_function_differ_by_what_they_close_over(self, flat_foot):
        works = {}
        for order in ((0.0, 2e4), (2e4, 0.0)):  # a class made anew has the same name and fields
            for pressure in order:
                scene = fo.Scene(effects=(pressing(pressure),), t_f=0.8)
                work = fo.simulate(flat_foot, scene, fo.Accuracy()).objectives["work"]
                assert works.setdefault(pressure, work) == work
        assert works[0.0] != works[2e4]

    def test_a_law_that_changes_nothing_is_refused(self, own):
        class Loose(own.Damp):
            law = (1.0,)

        with pytest.raises(SettingError, match=r"effects = 'tuple'.*load, gate, push"):
            laws((Loose(),))
