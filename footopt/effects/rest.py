"""Rest: sand that holds what stands on it, by bristles in place of the creep speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from footopt.effects.base import EFFECTS, Effect, Scale
from footopt.errors import check


@dataclass(frozen=True)
class Rest:
    """Bristles."""

    length: float = 1e-5
    law = None

    def __post_init__(self) -> None:
        check(
            1e-9 <= self.length <= 1e-2,
            "effects.rest.length",
            self.length,
            "a length from 1e-9 to 0.01, in m",
        )

    @property
    def nothing(self) -> bool:
        """Never."""
        return False

    def estimate(self, scale: Scale) -> float:
        """delta / depth."""
        return self.length / scale.depth


def rest_length(effects: Sequence[Effect]) -> float | None:
    """delta, m; None where bristles are not asked for."""
    for effect in effects:
        if isinstance(effect, Rest):
            return float(effect.length)
    return None


EFFECTS["rest"] = Rest
