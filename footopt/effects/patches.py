"""Patches of sand: strength that changes along the way."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from footopt.effects.base import EFFECTS, MOST, Array, Scale, numbers, register
from footopt.errors import check


class PatchesLaw(NamedTuple):
    """Begin and end of each patch (m), its zeta over the sand's less 1, and the blur (m)."""

    begins: tuple[float, ...] | Array
    ends: tuple[float, ...] | Array
    extra: tuple[float, ...] | Array
    blur: float


@dataclass(frozen=True)
class Patches:
    """Patches along the way: zeta changes with x, smoothly over a stated length.

    Source: footopt's own. Range: a plate feels the sand under itself only, so that a patch must be longer
    than the foot is deep.

    Parameters
    ----------
    begins, ends : tuple of float, m
        Of each patch, from where the hip starts.
    factors : tuple of float
        zeta of each patch over the sand's.
    blur : float, m
        Length of the change at either side; half of it is inside the patch.

    Raises
    ------
    SettingError
        A patch ends before it begins, patches overlap, or the tuples differ in length.
    """

    begins: tuple[float, ...] = (0.35,)
    ends: tuple[float, ...] = (0.95,)
    factors: tuple[float, ...] = (0.2,)
    blur: float = 0.05
    number = "change of strength along the way"

    def __post_init__(self) -> None:
        for name in ("begins", "ends", "factors"):
            object.__setattr__(self, name, tuple(map(float, getattr(self, name))))
        count = len(self.begins)
        check(
            1 <= count <= MOST
            and len(self.ends) == count
            and all(abs(at) <= 1e6 for at in (*self.begins, *self.ends)),
            "effects.patches.ends",
            list(self.ends),
            f"as many as effects.patches.begins ({count}), in m",
        )
        for begin, end in zip(self.begins, self.ends, strict=True):
            check(begin < end, "effects.patches.ends", end, f"beyond the patch's begin at {begin:g} m")
        places = sorted(zip(self.begins, self.ends, strict=True))
        for (_, end), (begin, _) in itertools.pairwise(places):
            hint = "Where patches overlap it is not said how strong the sand is: cut them at their edges."
            check(end <= begin, "effects.patches.begins", begin, f"at or beyond the end at {end:g} m", hint)
        check(
            len(self.factors) == count and all(1e-6 <= f <= 1e6 for f in self.factors),
            "effects.patches.factors",
            list(self.factors),
            f"{count} numbers > 0: zeta of each patch over the sand's",
        )
        check(1e-4 <= self.blur <= 1e3, "effects.patches.blur", self.blur, "a length from 1e-4 to 1000, in m")

    @property
    def law(self) -> PatchesLaw:
        """Begins, ends, factor - 1, blur."""
        extra = numbers([f - 1.0 for f in self.factors])
        return PatchesLaw(numbers(self.begins), numbers(self.ends), extra, float(self.blur))

    @property
    def nothing(self) -> bool:
        """Whether all patches are the same sand."""
        return all(f == 1.0 for f in self.factors)

    def estimate(self, scale: Scale) -> float:
        """Largest relative change of the stress on the way."""
        patches = zip(self.begins, self.ends, self.factors, strict=True)
        on_the_way = (abs(f - 1.0) for begin, end, f in patches if begin < scale.distance and end > 0.0)
        return max(on_the_way, default=0.0)


def patchy_load(law, state, depth, x):
    """Strength times 1 + sum of (factor - 1) inside each patch, with cubic steps at its sides."""
    load, by_depth, by_x = state
    strength, change = 1.0, 0.0
    for i in range(len(law.begins)):
        s = np.minimum(np.maximum((x - law.begins[i]) / law.blur + 0.5, 0.0), 1.0)
        r = np.minimum(np.maximum((x - law.ends[i]) / law.blur + 0.5, 0.0), 1.0)
        # the step down is that of the end, so that a patch narrower than the blur keeps its integral
        inside = s * s * (3.0 - 2.0 * s) - r * r * (3.0 - 2.0 * r)
        slope = (s * (1.0 - s) - r * (1.0 - r)) * 6.0 / law.blur
        strength = strength + law.extra[i] * inside
        change = change + law.extra[i] * slope
    return load * strength, by_depth * strength, by_x * strength + load * change


EFFECTS["patches"] = Patches
register(PatchesLaw, load=patchy_load)
