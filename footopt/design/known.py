"""`Known`: which designs there are, and where."""

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]


class Known:
    """Designs by their heights, with their places in the order in which they were added."""

    def __init__(self) -> None:
        self._place: dict[bytes, int] = {}

    def places(self, k: Ints) -> Ints:
        """The place of each of some designs (designs, n), -1 where there is none."""
        return np.array([self._place.get(key, -1) for key in _keys(k)], np.int64)

    def fresh(self, k: Ints) -> Ints:
        """The rows of those of some designs (designs, n) that are not known, each once, in their order."""
        seen: set[bytes] = set()
        found = []
        for i, key in enumerate(_keys(k)):
            if key not in self._place and key not in seen:
                seen.add(key)
                found.append(i)
        return np.array(found, np.int64)

    def add(self, k: Ints) -> None:
        """Add designs (designs, n) that are `fresh`."""
        for key in _keys(k):
            self._place[key] = len(self._place)

    def __len__(self) -> int:
        return len(self._place)


def _keys(k: Ints) -> list[bytes]:
    """Heights as bytes, a row each."""
    return [row.tobytes() for row in np.atleast_2d(k).astype(np.int32)]
