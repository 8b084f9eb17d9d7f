"""`Evaluator`: values of designs, from the store or walked; it finds the design that breaks the program."""

from __future__ import annotations

import logging
from collections.abc import Callable
from concurrent.futures import Executor

import numpy as np

from footopt.design.executor import Chunks, Failed, Walked, attempt
from footopt.design.problem import Array, FootProblem, Ints, Words
from footopt.design.store import ERROR, Evaluation, Store
from footopt.errors import FootoptError
from footopt.foot.waypoints import written

log = logging.getLogger("footopt")

#: From a batch (designs, n) to what became of which of its designs.
Batch = Callable[[Ints], list[tuple[Ints, Walked | Failed]]]


def walk_safely(batch: Batch, k: Ints, columns: int) -> tuple[Array, Words, dict[int, str]]:
    """Walk with all designs that can be: what failed is halved, down to the designs that are the cause.

    A design's result does not depend on its batch. One whose worker has died is tried once more, alone:
    that need not have been its doing. Returns values (designs, columns), reasons (designs,), and what was
    raised by the places of the designs whose reason is "error".
    """
    values = np.full((len(k), columns), np.nan)
    reasons = np.full(len(k), ERROR, dtype=object)
    messages: dict[int, str] = {}
    waiting = [(np.arange(len(k)), False)]
    while waiting:
        places, again = waiting.pop()
        for part, outcome in batch(k[places]):
            where = places[part]
            if isinstance(outcome, Walked):
                values[where], reasons[where] = outcome.values, outcome.reasons
            elif len(where) > 1:
                waiting += [(half, False) for half in np.array_split(where, 2)]
            elif outcome.died and not again:
                waiting.append((where, True))
            else:
                messages[int(where[0])] = outcome.message
    return values, reasons.astype(np.str_), messages


class Evaluator:
    """Recorded values and reasons of designs, each read from the store, or walked and kept there.

    Parameters
    ----------
    problem : FootProblem
        Whose designs they are.
    store : Store, optional
        Of the same problem; `ValueError` if it is of another one.
    executor : Executor, optional
        Who walks; by default this process.

    Attributes
    ----------
    reused : int
        Designs that were read. One that had broken the program is walked again.
    """

    def __init__(
        self, problem: FootProblem, store: Store | None = None, executor: Executor | None = None
    ) -> None:
        if store is not None and store.problem is not problem:
            raise ValueError("the store was opened for another problem than the one that is searched")
        self.problem, self.store, self.executor, self.reused = problem, store, executor, 0
        self._batch: Batch = self._here if executor is None else Chunks(problem, executor)
        self._works = False  # whether a design has been walked without breaking the program

    def __call__(self, k: Ints) -> tuple[Array, Words]:
        """Recorded values (designs, record) and why each walk failed, or "", of designs (designs, n)."""
        known = [None] * len(k) if self.store is None else self.store.get(k.tolist())
        found = {i: e for i, e in enumerate(known) if e is not None and e.reason != ERROR}
        self.reused += len(found)
        if unknown := [i for i in range(len(k)) if i not in found]:
            walked = self._walk(k[unknown])
            if self.store is not None:
                self.store.add(k[unknown].tolist(), walked)
            found |= zip(unknown, walked, strict=True)
        return np.array([found[i].values for i in range(len(k))]), np.array(
            [found[i].reason for i in range(len(k))]
        )

    def _here(self, k: Ints) -> list[tuple[Ints, Walked | Failed]]:
        return [(np.arange(len(k)), attempt(self.problem, k))]

    def _walk(self, k: Ints) -> list[Evaluation]:
        values, reasons, messages = walk_safely(self._batch, k, len(self.problem.record))
        if len(messages) == len(k) and not (self._works or self.reused):
            raise FootoptError(
                f"All {len(k)} designs of the first generation break the program ({messages[0]}). "
                "The fault is not in one of them."
            )
        self._works = True
        values[np.isnan(values)] = np.nan  # one NaN: a store keeps no other
        for i, message in messages.items():
            log.warning("design %s has failed and is left out: %s", written(k[i]), message)
        return [
            Evaluation(v, str(reason), messages.get(i, ""))
            for i, (v, reason) in enumerate(zip(values, reasons, strict=True))
        ]
