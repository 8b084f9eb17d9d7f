"""Engines: where a search walks: in this process, in others on this machine, or on a dask cluster.

A design's result does not depend on its batch, so that all engines give the same, to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from footopt.design.cluster import Dask
from footopt.design.problem import FootProblem
from footopt.design.processes import Processes
from footopt.design.workers import Engine, Ints, Walked
from footopt.errors import SettingError, check


class Local(Engine):
    """This process, with its problem's threads."""

    def walk(self, problem: FootProblem, k: Ints) -> Walked:
        """Walk here."""
        return problem.walk(k)


#: Engines by name.
ENGINES: dict[str, Callable[..., Engine]] = {"local": Local, "processes": Processes, "dask": Dask}


def make_engine(
    name: str = "local", workers: int | None = None, address: str | None = None, timeout: float = 10.0
) -> Engine:
    """An engine by its name; what another one would need is refused. See the classes."""
    if name not in ENGINES:
        raise SettingError("engine.name", name, f"one of {', '.join(ENGINES)}")
    check(
        workers is None or (name != "local" and address is None),
        "engine.workers",
        workers,
        "null for engine=local and for a cluster that has its own",
        "engine.threads is the number of threads here.",
    )
    check(address is None or name == "dask", "engine.address", address, f"null for engine={name}")
    settings: dict[str, dict[str, Any]] = {
        "local": {},
        "processes": {"workers": workers},
        "dask": {"address": address, "workers": workers, "timeout": timeout},
    }
    return ENGINES[name](**settings[name])
