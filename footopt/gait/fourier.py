"""`Fourier`: a joint's angle over a stride."""

from typing import NamedTuple, Self

import numpy as np

from footopt.arrays import Array


class Fourier(NamedTuple):
    """theta(p) = a0 + sum_k a[k-1] cos(2 pi k p) + b[k-1] sin(2 pi k p), in degrees; p in strides."""

    a0: float
    a: tuple[float, ...]
    b: tuple[float, ...]

    @classmethod
    def fit(cls, phase: Array, degrees: Array, harmonics: int) -> Self:
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
