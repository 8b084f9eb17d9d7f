"""What the tasks of a long study have found, in a file: a study that was stopped does none twice."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from threading import Lock
from typing import Any


class Tasks:
    """Findings in JSON's types, a line each with the task that it is of; threads may share it.

    Parameters
    ----------
    path : Path, optional
        Of the file; without one nothing is kept.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._path, self._done, self._lock = path, dict[str, Any](), Lock()
        for line in path.read_text().splitlines() if path is not None and path.exists() else ():
            with suppress(ValueError):  # torn by a kill
                task, found = json.loads(line)
                self._done[json.dumps(task)] = found

    def __call__(self, task: Sequence[Any], do: Callable[[], Any]) -> Any:
        """What a task has found, done unless it is in the file; the task in JSON's types."""
        name = json.dumps(task)
        if name not in self._done:
            found = do()
            with self._lock:
                self._done[name] = found
                if self._path is not None:
                    with open(self._path, "a") as file:
                        file.write(f"\n{json.dumps([task, found])}")
        return self._done[name]
