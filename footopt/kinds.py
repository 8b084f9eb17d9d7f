"""Which argument of a call is of another kind than it is declared as, in the user's terms."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Mapping, Sequence
from functools import wraps
from inspect import Parameter
from numbers import Integral, Real
from types import NoneType, UnionType
from typing import Any, TypeVar, cast, get_args, get_origin, get_type_hints

from footopt.errors import FootoptError, SettingError

#: What a value of a kind is called in messages, and what it may be.
KINDS: dict[Any, tuple[str, type]] = {
    float: ("a number", Real),
    int: ("a whole number", Integral),
    str: ("a text", str),
    bool: ("true or false", bool),
}
T = TypeVar("T")


def says_kinds(what: T) -> T:
    """A function or a class that says which of its parameters is of another kind than it is declared as.

    It is only looked for where the call has failed, so that whatever works goes on working.
    """
    whole = cast(Any, what)
    function = whole.__init__ if inspect.isclass(whole) else whole

    @wraps(function)
    def called(*given: Any, **named: Any) -> Any:
        try:
            return function(*given, **named)
        except (AttributeError, TypeError, ValueError) as error:
            if isinstance(error, FootoptError) or (wrong := _of_another_kind(whole, given, named)) is None:
                raise
            raise wrong from error

    if isinstance(what, type):
        whole.__init__ = called
        return what
    return cast(T, called)


def _of_another_kind(what: Any, given: Sequence[Any], named: Mapping[str, Any]) -> SettingError | None:
    """The refusal of the first argument that is of another kind than it is declared as."""
    function = what.__init__ if inspect.isclass(what) else what
    try:
        asked = inspect.signature(function)
        values = asked.bind(*given, **named).arguments
        declared = get_type_hints(function)
    except (NameError, TypeError):  # a name that only a type checker knows; too few arguments, or too many
        return None
    for name, value in values.items():
        several = asked.parameters[name].kind in (Parameter.VAR_KEYWORD, Parameter.VAR_POSITIONAL)
        kind = Any if several else declared.get(name, Any)
        kinds = get_args(kind) if isinstance(kind, UnionType) else (kind,)
        if not any(_is(value, kind) for kind in kinds):
            said = dict.fromkeys(_called(kind) for kind in kinds if kind is not NoneType)
            return SettingError(f"{what.__name__}.{name}", value, " or ".join(said))
    return None


def _is(value: object, kind: Any) -> bool:
    """Whether a value may be of a kind, as far as that can be known."""
    origin = get_origin(kind) or kind
    if kind in KINDS:
        return isinstance(value, KINDS[kind][1])
    if kind is Any or not isinstance(origin, type) or getattr(origin, "_is_protocol", False):
        return True
    if _listed(origin):
        if not hasattr(value, "__len__") or isinstance(value, (str, bytes, Mapping)):
            return False
        each = cast(Iterable[Any], value)
        if not issubclass(origin, Sequence):  # an array: of numbers, or of arrays as long as each other
            numbers = all(isinstance(v, Real) for v in each)
            return numbers or (all(_is(v, kind) for v in each) and len({len(v) for v in each}) == 1)
        return all(any(_is(v, k) for k in get_args(kind) or (Any,) if k is not ...) for v in each)
    return isinstance(value, origin)


def _listed(origin: type) -> bool:
    return issubclass(origin, Sequence) or origin.__name__ == "ndarray"


def _called(kind: Any) -> str:
    """What a kind is called in messages."""
    origin = get_origin(kind) or kind
    if kind in KINDS:
        return KINDS[kind][0]
    if _listed(origin):
        return "a list"
    if issubclass(origin, Mapping):
        return "a mapping"
    return f"{'an' if origin.__name__[0] in 'AEIOU' else 'a'} {origin.__name__}"
