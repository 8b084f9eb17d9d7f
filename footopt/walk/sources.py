"""A user's own types and functions among those that a walk needs, and the sources that they are in."""

from __future__ import annotations

import hashlib
import inspect
import marshal
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from footopt.effects import base as effects
from footopt.walk import steppers

#: Where types and functions come from that every process can import.
HOME = ("footopt.", __name__.rpartition(".")[0] + ".")


def is_users(thing: Any) -> bool:
    """Whether a type or function is a user's, not footopt's."""
    return not thing.__module__.startswith(HOME)


def users_own(stepper: Any, laws: Sequence[Any]) -> tuple[Any, ...]:
    """A user's own types and functions among those that a walk needs."""
    hooks = [hooks[type(law)] for law in laws for hooks in effects.HOOKS if type(law) in hooks]
    needed = (type(stepper), steppers.STEPS[type(stepper)], *map(type, laws), *hooks)
    return tuple(filter(is_users, needed))


def source(stepper: Any, laws: Sequence[Any]) -> str:
    """A digest of a user's own functions that a walk needs: one that was edited is compiled again."""
    return digest_of(tuple(thing for thing in users_own(stepper, laws) if not isinstance(thing, type)))


@lru_cache(maxsize=8)
def digest_of(functions: tuple[Any, ...]) -> str:
    """A digest of the sources of functions."""
    return hashlib.sha256(b"".join(map(text_of, functions))).hexdigest()


def text_of(thing: Any) -> bytes:
    """The file that a function or type is in, with what it may call; its code if typed into a session."""
    try:
        return Path(inspect.getfile(thing)).read_bytes()
    except (OSError, TypeError):
        parts = vars(thing).values() if isinstance(thing, type) else [thing]
        return b"".join(marshal.dumps(part.__code__) for part in parts if hasattr(part, "__code__"))
