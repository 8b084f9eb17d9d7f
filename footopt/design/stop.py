"""`Stop`: when a search ends before its last generation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from numbers import Integral, Real

from footopt.design.result import Generation
from footopt.errors import check
from footopt.kinds import says_kinds

GAIN = 1e-3  # a smaller one is below the error of walks at the accuracy `standard`


@says_kinds
@dataclass(frozen=True)
class Stop:
    """When a search ends before its last generation; what is None never ends it.

    It is looked at after each generation, which is finished first.

    Parameters
    ----------
    seconds : float, s, optional
        So long after it began.
    walks : int, optional
        Once so many different designs are known.
    stall : int, optional
        After so many generations in which the best design, or the hypervolume, became better by less than
        0.1 %.

    Raises
    ------
    SettingError
        A number is not above 0, or not whole where it counts.
    """

    seconds: float | None = None
    walks: int | None = None
    stall: int | None = None

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            kind, what = (Real, "number") if field.name == "seconds" else (Integral, "whole number")
            good = value is None or (isinstance(value, kind) and float(value) > 0)
            check(good, f"stop.{field.name}", value, f"null, or a {what} > 0")

    def reason(self, history: Sequence[Generation], walks: int) -> str:
        """Why to end now; "" to go on."""
        now = history[-1]
        if self.seconds is not None and now.seconds >= self.seconds:
            return f"after {self.seconds:g} s"
        if self.walks is not None and walks >= self.walks:
            return f"after {walks} walks"
        if self.stall is not None and len(history) > self.stall:
            before = history[-1 - self.stall]
            values = [g.hypervolume if math.isnan(g.best) else g.best for g in (before, now)]
            if abs(values[1] - values[0]) <= GAIN * abs(values[0]):
                return f"better by less than {100 * GAIN:g} % in {self.stall} generations"
        return ""
