"""`Fourier`: a joint's angle over a stride."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Fourier(NamedTuple):
    """theta(p) = a0 + sum_k a[k-1] cos(2 pi k p) + b[k-1] sin(2 pi k p), in degrees; p in strides."""

    a0: float
    a: tuple[float, ...]
    b: tuple[float, ...]

    @classmethod
    def from_numbers(cls, joint: Mapping[str, Any]) -> Fourier:
        """The series of a0 and the lists a and b; raises Python's own errors where they are none."""
        a, b = (tuple(map(finite, joint[terms])) for terms in ("a", "b"))
        if len(a) != len(b):
            raise ValueError(f"it has {len(a)} terms a and {len(b)} terms b")
        return cls(finite(joint["a0"]), a, b)

    @classmethod
    def fit(cls, phase: Array, degrees: Array, harmonics: int) -> Fourier:
        """The least-squares series through a curve, at phases (n,) in strides and angles (n,) in degrees."""
        w = 2.0 * np.pi * np.outer(phase, np.arange(1, harmonics + 1))
        design = np.concatenate([np.ones((len(phase), 1)), np.cos(w), np.sin(w)], axis=1)
        solution, *_ = np.linalg.lstsq(design, degrees, rcond=None)
        a0, *ab = map(float, solution)
        return cls(a0, tuple(ab[:harmonics]), tuple(ab[harmonics:]))

    def at(self, phase: Array) -> tuple[Array, Array]:
        """Angle (rad) and its derivative in the phase (rad per stride)."""
        value, rate = np.full_like(phase, self.a0), np.zeros_like(phase)
        for k, (a, b) in enumerate(zip(self.a, self.b, strict=True), start=1):
            w = 2.0 * np.pi * k
            c, s = np.cos(w * phase), np.sin(w * phase)
            value += a * c + b * s
            rate += w * (b * c - a * s)
        return np.radians(value), np.radians(rate)


def finite(value: Any) -> float:
    """A number of JSON; raises `ValueError` for anything else, and for one that no angle or time has."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < 1e12:
        raise ValueError(f"{str(value)[:40]} is not a finite number")
    return float(value)
