"""Footprints: the second foot and the second step meet sand that the first one moved."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from footopt.effects.base import EFFECTS, Effect, Scale
from footopt.effects.slope import Slope
from footopt.errors import check

MOST = 4096  # cells along a foot: more take too long


class Prints(NamedTuple):
    """What the loop over steps needs to know (`footopt.walk.ground`)."""

    cells: int  # along a foot
    rise: float  # slope by which the surface rises at most
    fall: float  # ... and by which it falls
    side: float  # ... and that of what slides off to the sides
    reaches: float  # when the right foot first reaches forward to come down, s; infinite for who stands
    period: float  # of a stride, s; the left foot reaches half of it later


@dataclass(frozen=True)
class Footprints:
    """The sand's surface is a height field along x, and a plate feels its depth below that surface.

    A print is as deep as the sole has been. What a sole displaces by moving along, the share v_x^2/|v|^2,
    goes to the next free sand that way; what it presses down goes to the nearest edge of the foot's
    rectangle, at an end or beside it. Slopes beyond the angle of repose slide, and so do heaps and prints
    whose sides cannot hold them. Area, with what has gone beside, is conserved to rounding.

    A foot feels the sand onto which it comes down: as it lies when the ankle reaches furthest forward, once a
    stride, with the print in which the other foot stands, and its own as far as it is out of the sand then.
    The law's coefficients are measured on plates that pile up sand as they move, and its sum over plates on
    legs and wheels that do.

    Source: height fields with displaced columns and a limited slope, Sumner, O'Brien & Hodgins, Computer
    Graphics Forum 18 (1999); under wheels, Krenn & Hirzinger, SCM, 11th European conference of the ISTVS
    (2009). Range: both feet come down on one line and swing past each other; sand in a print is as loose as
    it was, and does not flow back over a foot that it has closed over. So prints shallower than a foot is
    high. `Layers` lie below the moved surface.

    Parameters
    ----------
    repose : float, deg
        Angle of repose: dry sand lies at about 30.
    cells : int
        Cells of the field along a foot, a number of the numerics: the more there are, the smaller the error.

    Raises
    ------
    SettingError
        A number is out of its range.
    """

    repose: float = 30.0
    cells: int = 256
    law = None
    nothing = False
    number = "sand of the last print's rim in the next print / print"
    source = "Sumner et al. (1999); Krenn & Hirzinger (2009)"

    def __post_init__(self) -> None:
        check(
            1 <= self.repose <= 60, "effects.footprints.repose", self.repose, "an angle from 1 to 60, in deg"
        )
        check(
            8 <= self.cells <= MOST,
            "effects.footprints.cells",
            self.cells,
            f"a number from 8 to {MOST}",
            "Double it to see what it changes.",
        )

    def estimate(self, scale: Scale) -> float:
        """Area of the last print's rim that reaches into the next print, over that of a print.

        A print has the area z l; half of it lies ahead as a heap at the angle of repose against its wall.
        Where the step is shorter than the foot the prints themselves overlap.
        """
        steepness = math.tan(math.radians(self.repose))
        reach, gap = math.sqrt(scale.depth * scale.length / steepness), scale.step - scale.length
        rim = 0.5 * max(reach - max(gap, 0.0), 0.0) ** 2 * steepness / (scale.depth * scale.length)
        return min(1.0, rim + max(-gap, 0.0) / scale.length)


def finer_cells(effects: Sequence[Effect], times: int = 1) -> tuple[Effect, ...]:
    """A scene's effects, with the cells of its footprints doubled so many times, up to `MOST` of them."""
    return tuple(
        replace(e, cells=min(2**times * e.cells, MOST)) if isinstance(e, Footprints) else e for e in effects
    )


def prints_of(effects: Sequence[Effect], reaches: float, period: float) -> Prints | None:
    """A scene's footprints for the loop; None without them. On a slope, sand slides sooner downhill.

    Parameters
    ----------
    effects : sequence of Effect
        Of the scene.
    reaches, period : float, s
        As in `Prints`.

    Raises
    ------
    SettingError
        The slope is not below the angle of repose.
    """
    for effect in effects:
        if isinstance(effect, Footprints):
            slope = next((e.angle for e in effects if isinstance(e, Slope)), 0.0)
            check(
                abs(slope) < effect.repose,
                "effects.footprints.repose",
                effect.repose,
                f"more than the slope's {abs(slope):g} deg",
                "A plane as steep as that slides as a whole. Try a smaller effects.slope.angle.",
            )
            rise, fall, side = (math.tan(math.radians(effect.repose + turn)) for turn in (-slope, slope, 0.0))
            return Prints(int(effect.cells), rise, fall, side, reaches, period)
    return None


EFFECTS["footprints"] = Footprints
