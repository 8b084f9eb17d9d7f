"""What determines a design's result to the last bit, in JSON's types: what stores and workers compare."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import sys
from collections.abc import Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from footopt.design.problem import FootProblem
from footopt.files.identity import flat
from footopt.walk.objectives import MEASURES
from footopt.walk.sources import is_users, meaning, text_of, users_own
from footopt.walk.steppers import STEPPERS

PACKAGE = Path(__file__).parent.parent
#: The sources that a stored value depends on: rooms and files.
SOURCES = (
    "compiled.py", "sand", "effects", "foot", "gait", "walk",
    *(f"design/{name}.py" for name in ("problem", "robust", "evaluator", "executor")),
)  # fmt: skip
#: Of a context, what no setting says: the same settings may be walked by other code, on another machine.
CODE = ("own", "sources", "versions", "machine")
_CANONICAL = json.JSONEncoder(sort_keys=True, separators=(",", ":"))
SHOWN = 4  # differences between two contexts that a message names


def context(problem: FootProblem) -> dict[str, Any]:
    """All that determines what is recorded of a design.

    The box's tolerance and the choice of objectives are not in it: they judge what is recorded.
    """
    space = plain(problem.space)
    del space["box_tolerance"]
    stepper = STEPPERS[problem.accuracy.stepper].parameters
    laws = [effect.law for effect in problem.scene.effects if effect.law is not None]
    kinds = type(problem).__mro__
    judges = [MEASURES[name].value for name in problem.record if name in MEASURES]
    return {
        "problem": type(problem).__name__,
        **{name: plain(value) for name, value in problem.conditions.items()},
        "accuracy": plain(problem.accuracy),
        "space": space,
        "record": plain(problem.record),
        "own": {  # a user's objectives, stepper and effects; the kind of problem
            f"{_module(thing)}.{thing.__qualname__}": hashlib.sha256(meaning(text_of(thing))).hexdigest()
            for thing in (
                *filter(is_users, judges),
                *(thing for thing in users_own(stepper, laws) if not isinstance(thing, type)),
                *kinds[: kinds.index(FootProblem)],
            )
        },
        "sources": _sources(),
        "versions": {name: version(name) for name in ("numpy", "scipy", "numba", "llvmlite")}
        | {"python": "{}.{}".format(*sys.version_info)},
        "machine": machine(),
    }


def _module(thing: Any) -> str:
    """Where a thing is from; what a script defines is elsewhere in its workers."""
    return "__main__" if thing.__module__ == "__mp_main__" else str(thing.__module__)


@cache
def machine() -> dict[str, str]:
    """What numba compiles for: results are the same, bit for bit, only where this is."""
    from numba.core.registry import cpu_target

    system, processor, features = cpu_target.target_context.codegen().magic_tuple()
    return {
        "system": system,
        "processor": processor,
        "features": hashlib.sha256(features.encode()).hexdigest(),
    }


@cache
def _sources() -> str:
    """A digest of every source that a stored value depends on, as it is compiled."""
    found = hashlib.sha256()
    for name in SOURCES:
        path = PACKAGE / name
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            found.update(meaning(file.read_bytes()))
    return found.hexdigest()


def plain(value: Any) -> Any:
    """Frozen data in JSON's types, with its class, by the fields that it is compared by; arrays, scalars."""
    if dataclasses.is_dataclass(value):
        names = [field.name for field in dataclasses.fields(value) if field.compare]
        return {"class": type(value).__name__} | {name: plain(getattr(value, name)) for name in names}
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return {"class": type(value).__name__} | plain(value._asdict())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        kind = f"ndarray {value.dtype}"
        return {"class": kind, "shape": list(value.shape), "items": value.ravel().tolist()}
    if isinstance(value, np.generic):
        return plain(value.item())
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"a {type(value).__name__} cannot be part of a store's context")


def canonical(content: Any) -> str:
    """The one JSON text of some content; floats by their shortest digits that read back exactly."""
    return _CANONICAL.encode(content)


def digest(content: Any) -> str:
    """SHA-256 of the canonical JSON."""
    return hashlib.sha256(canonical(content).encode()).hexdigest()


def differences(there: Any, here: Any) -> list[str]:
    """What differs between two contexts, each with both values."""
    one, other = flat(there), flat(here)
    names = [name for name in sorted(one | other) if one.get(name) != other.get(name)]
    return [f"{n} ({_short(one.get(n))} there, {_short(other.get(n))} here)" for n in names]


def listed(found: Sequence[str]) -> str:
    """The first few of many differences."""
    more = f" and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
    return f"{', '.join(found[:SHOWN])}{more}"


def _short(value: object) -> str:
    text = str(value)
    return text if len(text) <= 20 else text[:8] + "..."
