"""What settings are made of: fields with a default and a meaning, and the names of all of them."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from dataclasses import field, fields, is_dataclass
from typing import Any


def default(function: Callable[..., Any], name: str) -> Any:
    """The default of a function's parameter."""
    return inspect.signature(function).parameters[name].default


def setting(value: Any, meaning: str | type) -> Any:
    """A field of settings.

    Parameters
    ----------
    value : object
        Its default; a class stands for an object of it.
    meaning : str or type
        What it means, or the class of the library whose docstring says so.
    """
    told = {"meaning": meaning}
    if isinstance(value, type):
        return field(default_factory=value, metadata=told)
    if isinstance(value, tuple | list):  # a list can be changed, as OmegaConf has it
        return field(default_factory=lambda: list(value), metadata=told)
    return field(default=value, metadata=told)


def leaves(group: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Full names and values of all settings of a group, in their order."""
    for each in fields(group):
        value, path = getattr(group, each.name), f"{name}{each.name}"
        if is_dataclass(value) and fields(value):
            yield from leaves(value, f"{path}.")
        else:
            yield path, value
