"""The walks that claims are measured on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from footopt.studies.paper.readings import Readings, read, switch_losses
from footopt.walk import Walk

SANDS = ("soft", "regular", "hard")


@dataclass(frozen=True, eq=False)
class Evidence:
    """The walks that claims are measured on.

    Parameters
    ----------
    shapes : dict of Walk
        Walks of the five shapes, by name.
    optima : dict of Walk
        Walks of the best foot of each sand on that sand, by sand.
    crossed : Walk
        The best foot for regular sand, on hard sand.
    filled : Walk
        The best foot for hard sand with its hollow filled up, on hard sand.
    readings : Readings
        How p_max and dV_x are read.
    """

    shapes: Mapping[str, Walk]
    optima: Mapping[str, Walk]
    crossed: Walk
    filled: Walk
    readings: Readings

    @property
    def hard(self) -> Walk:
        """The walk of the best foot for hard sand on hard sand."""
        return self.optima["hard"]

    def value(self, walk: Walk, name: str) -> float:
        """Return an objective of a walk, as it is read; NaN if the walk failed."""
        return read(walk, self.readings).objectives[name]

    def of_shapes(self, what: str | Callable[[Walk], float]) -> dict[str, float]:
        """Return an objective, as it is read, or another number of the five shapes' walks."""
        return self._numbers(self.shapes, what)

    def of_optima(self, what: str | Callable[[Walk], float]) -> dict[str, float]:
        """Return an objective, as it is read, or another number of the best feet's walks."""
        return self._numbers(self.optima, what)

    def _numbers(self, walks: Mapping[str, Walk], what: str | Callable[[Walk], float]) -> dict[str, float]:
        return {
            name: self.value(walk, what) if isinstance(what, str) else what(walk)
            for name, walk in walks.items()
        }

    @cached_property
    def losses(self) -> dict[str, NDArray[np.float64]]:
        """Speed lost at the three switches by every shape and best foot, each (3,), m/s."""
        walks = {**self.shapes, **self.optima}
        return {name: switch_losses(walk, self.readings) for name, walk in walks.items()}
