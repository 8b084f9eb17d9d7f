"""Coarse walks by which a solver chooses the designs that are worth a dear one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext

import numpy as np

from footopt.design.evaluator import Evaluator
from footopt.design.problem import Array, FootProblem, Ints
from footopt.design.store import Store


class Coarse:
    """F and G (designs, ...) of designs (designs, n) as a problem's coarse walks have them, each made once.

    Parameters
    ----------
    evaluator : Evaluator
        Of the coarser problem.
    """

    def __init__(self, evaluator: Evaluator) -> None:
        self._walk, self._known = evaluator, dict[bytes, Array]()

    def __len__(self) -> int:
        """Designs that have walked."""
        return len(self._known)

    def __call__(self, k: Ints) -> tuple[Array, Array]:
        problem, keys = self._walk.problem, [row.tobytes() for row in k]
        new = k[[*{key: i for i, key in enumerate(keys) if key not in self._known}.values()]]
        if len(new):
            values, reasons = self._walk(new)
            G = problem.constraints(values, reasons, problem.space.box_violation(new))
            both = np.concatenate([problem.minimised(values), G], axis=1)
            self._known |= zip((row.tobytes() for row in new), both, strict=True)
        found = np.array([self._known[key] for key in keys])
        return found[:, : problem.n_obj], found[:, problem.n_obj :]


@contextmanager
def coarse_walks(problem: FootProblem, evaluator: Evaluator) -> Iterator[Coarse]:
    """Coarse walks of a problem's designs, by the same executor, and kept in the same file, as the others.

    Raises
    ------
    SettingError
        The problem's own walks are as coarse.
    """
    coarser, store = problem.coarser(), evaluator.store
    with nullcontext() if store is None else Store(store.path, coarser) as kept:
        yield Coarse(Evaluator(coarser, kept, evaluator.executor))
