"""Where a search's evaluations come from: the store, or an engine that walks."""

from __future__ import annotations

import logging
from functools import partial

import numpy as np
from numpy.typing import NDArray

from footopt.design.engines import Local
from footopt.design.problem import FootProblem
from footopt.design.safely import evaluate_safely
from footopt.design.store import Evaluation, Store
from footopt.design.workers import Engine
from footopt.errors import FootoptError

Array = NDArray[np.float64]

log = logging.getLogger("footopt")


class Source:
    """Values of designs, each read from the store or walked and kept there.

    Attributes
    ----------
    reused : designs that were read.
    """

    def __init__(
        self, problem: FootProblem, store: Store | None = None, engine: Engine | None = None
    ) -> None:
        if store is not None and store.problem is not problem:
            raise ValueError("the store was opened for another problem than the one that is searched")
        self.problem, self.store, self.engine = problem, store, engine or Local()
        self.reused = 0
        self._works = False  # whether a design has been walked without breaking the program

    def __call__(self, k: NDArray[np.int64]) -> tuple[Array, NDArray[np.str_]]:
        """Recorded values (designs, record) and why each walk failed, or ""."""
        known: list[Evaluation | None] = [None] * len(k)
        if self.store is not None:
            known = self.store.get(k.tolist())
        unknown = [i for i, evaluation in enumerate(known) if evaluation is None]
        self.reused += len(k) - len(unknown)
        if unknown:
            walked = self._walk(k[unknown])
            if self.store is not None:
                self.store.add(k[unknown].tolist(), walked)
            for i, evaluation in zip(unknown, walked, strict=True):
                known[i] = evaluation
        found = [evaluation for evaluation in known if evaluation is not None]
        return np.array([e.values for e in found]), np.array([e.reason for e in found])

    def _walk(self, k: NDArray[np.int64]) -> list[Evaluation]:
        """Walk with designs; one that breaks the program has failed, with what it raised."""
        walk = partial(self.engine.walk, self.problem)
        values, reasons, messages = evaluate_safely(walk, k, len(self.problem.record))
        if len(messages) == len(k) and not (self._works or self.reused):
            raise FootoptError(
                f"All {len(k)} designs of the first generation break the program ({messages[0]}). "
                "The fault is not in one of them."
            )
        self._works = True
        for i, message in messages.items():
            log.warning("design %s has failed and is left out: %s", k[i].tolist(), message)
        return [
            Evaluation(v, str(reason), messages.get(i, ""))
            for i, (v, reason) in enumerate(zip(values, reasons, strict=True))
        ]
