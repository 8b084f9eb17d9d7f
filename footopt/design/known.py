"""`Known`: which designs there are and where, for millions of them in little memory."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]

NEWEST = 32_768  # designs that are kept apart, so that most additions move little


class Known:
    """Designs, found by their heights, with their places in the order in which they were added.

    They are sorted: a design takes its heights as bytes and a place, a tenth of an entry of a dictionary.

    Parameters
    ----------
    K : int
        The largest height.
    """

    def __init__(self, K: int) -> None:
        self._type, self.count = np.min_scalar_type(K), 0
        self._parts: list[tuple[NDArray[Any], Ints]] = []  # sorted keys, and places: old, and new

    def places(self, k: Ints) -> Ints:
        """The place of each of some designs (designs, n), -1 where there is none."""
        keys, found = self._keys(k), np.full(len(k), -1)
        for known, places in self._parts:
            at = np.minimum(np.searchsorted(known, keys), len(known) - 1)
            found = np.where(known[at] == keys, places[at], found)
        return found

    def fresh(self, k: Ints) -> Ints:
        """The rows of those of some designs (designs, n) that are not known, each once, in their order."""
        first = np.sort(np.unique(self._keys(k), return_index=True)[1])
        new: Ints = first[self.places(k[first]) < 0]
        return new

    def add(self, k: Ints) -> None:
        """Add designs (designs, n) that are `fresh`."""
        if not len(k):
            return
        keys = self._keys(k)
        order = np.argsort(keys)
        newest = keys[order], self.count + order
        if len(self._parts) == 2:
            newest = _merged(self._parts.pop(), newest)
        if self._parts and len(newest[0]) > NEWEST:
            newest = _merged(self._parts.pop(), newest)
        self._parts.append(newest)
        self.count += len(k)

    def __len__(self) -> int:
        return self.count

    def _keys(self, k: Ints) -> NDArray[Any]:
        """Heights as bytes of one length, (designs,)."""
        small = np.ascontiguousarray(np.atleast_2d(k).astype(self._type))
        return small.view(f"S{small.itemsize * small.shape[1]}").ravel()


def _merged(one: tuple[NDArray[Any], Ints], other: tuple[NDArray[Any], Ints]) -> tuple[NDArray[Any], Ints]:
    """Two sorted parts as one."""
    at = np.searchsorted(one[0], other[0])
    return np.insert(one[0], at, other[0]), np.insert(one[1], at, other[1])
