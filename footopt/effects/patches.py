"""Patches of sand: strength that changes along the way."""

import itertools
from dataclasses import dataclass
from typing import NamedTuple

from footopt.arrays import Array
from footopt.effects.base import MOST, Effect, as_floats, check_factors, numbers
from footopt.effects.dual import clipped
from footopt.errors import check, check_number


class PatchesLaw(NamedTuple):
    """Begin and end of each patch (m), its zeta over the sand's less 1, and the blur (m)."""

    begins: tuple[float, ...] | Array
    ends: tuple[float, ...] | Array
    extra: tuple[float, ...] | Array
    blur: float

    def load(self, load, depth, x):
        """Strength times 1 + sum of (factor - 1) inside each patch, with cubic steps at its sides."""
        total = load
        for i in range(len(self.begins)):
            s = clipped((x - self.begins[i]) / self.blur + 0.5, 0.0, 1.0)
            r = clipped((x - self.ends[i]) / self.blur + 0.5, 0.0, 1.0)
            # the step down is that of the end, so that a patch narrower than the blur keeps its integral
            inside = s * s * (3.0 - 2.0 * s) - r * r * (3.0 - 2.0 * r)
            total = total + load * (self.extra[i] * inside)
        return total


@dataclass(frozen=True)
class Patches(Effect, name="patches"):
    """Patches along the way: zeta changes with x, smoothly over a stated length.

    Source: footopt's own. Range: a plate feels the sand under itself only, so that a patch must be longer
    than the foot is deep.

    Parameters
    ----------
    begins, ends : tuple of float, m
        Of each patch, measured from where the hip starts.
    factors : tuple of float
        zeta of each patch, divided by the sand's.
    blur : float, m
        Length over which zeta changes at either end; half of it is inside the patch.

    Raises
    ------
    SettingError
        A patch ends before it begins, patches overlap, or the tuples differ in length.
    """

    begins: tuple[float, ...] = (0.35,)
    ends: tuple[float, ...] = (0.95,)
    factors: tuple[float, ...] = (0.2,)
    blur: float = 0.05
    in_page = True

    def __post_init__(self) -> None:
        begins, ends, count = as_floats(self, "begins"), as_floats(self, "ends"), len(self.begins)
        check(1 <= count <= MOST, "effects.patches.begins", list(begins), f"1 to {MOST} places, in m")
        good = len(ends) == count and all(abs(at) <= 1e6 for at in (*begins, *ends))
        allowed = f"as many as effects.patches.begins ({count}), all from -1e6 to 1e6, in m"
        check(good, "effects.patches.ends", list(ends), allowed)
        places = sorted(zip(begins, ends, strict=True))
        for begin, end in places:
            check(begin < end, "effects.patches.ends", end, f"beyond the patch's begin at {begin:g} m")
        for (_, end), (begin, _) in itertools.pairwise(places):
            hint = "Where patches overlap it is not said how strong the sand is: cut them at their edges."
            check(end <= begin, "effects.patches.begins", begin, f"at or beyond the end at {end:g} m", hint)
        allowed = f"{count} numbers > 0: zeta of each patch over the sand's"
        check_factors("effects.patches.factors", as_floats(self, "factors"), count, allowed)
        check_number("effects.patches.blur", self.blur, 1e-4, 1e3, "a length from 1e-4 to 1000, in m")

    @property
    def law(self) -> PatchesLaw:
        """Begins, ends, factor - 1, blur."""
        extra = numbers([f - 1.0 for f in self.factors])
        return PatchesLaw(numbers(self.begins), numbers(self.ends), extra, float(self.blur))

    @property
    def zones(self) -> tuple[tuple[float, float, float], ...]:
        """Each patch: begin and end, m, and its factor."""
        return tuple(zip(self.begins, self.ends, self.factors, strict=True))
