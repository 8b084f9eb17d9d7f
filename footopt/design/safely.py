"""Failures of the program itself: a design that breaks its batch is found by halving, the rest walk on."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from footopt.errors import FootoptError

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Designs (designs, n) to their recorded values (designs, record) and why each walk failed, or "".
Batch = Callable[[Ints], tuple[Array, NDArray[np.str_]]]

ERROR = "error"  # the reason of a design that breaks the program


def evaluate_safely(batch: Batch, k: Ints, columns: int) -> tuple[Array, NDArray[np.str_], dict[int, str]]:
    """A batch in one call; if that raises, its halves, down to the designs that are the cause.

    Any engine will do: a design's result does not depend on its batch. One whose workers can die has
    to raise when one does, and to be ready for the next call.

    Parameters
    ----------
    batch : evaluates designs. k : (designs, n). columns : of the values that it returns.

    Returns
    -------
    values : (designs, columns), NaN for a failed walk.
    reasons : (designs,), as `batch` gives them, and "error" where it raised.
    messages : what was raised, by the design's place in the batch.

    Raises
    ------
    FootoptError : passed on: then a setting is wrong, not a design.
    """
    values = np.full((len(k), columns), np.nan)
    reasons = np.full(len(k), ERROR, dtype=object)
    messages: dict[int, str] = {}
    waiting = [slice(0, len(k))]
    while waiting:
        part = waiting.pop()
        try:
            values[part], reasons[part] = batch(k[part])
        except FootoptError:
            raise
        except Exception as error:
            if part.stop - part.start == 1:
                messages[part.start] = f"{type(error).__name__}: {error}"
            else:
                middle = (part.start + part.stop) // 2
                waiting += [slice(middle, part.stop), slice(part.start, middle)]
    return values, reasons.astype(np.str_), messages
