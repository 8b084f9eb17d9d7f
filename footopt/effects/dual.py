"""Dual numbers: a value with its derivatives by the hip's velocity, so that no law is differentiated by hand.

`Dual` knows + - * / with itself and with plain numbers, and -x, compiled and in Python. The functions below
take plain numbers, arrays and dual numbers; with plain numbers nothing of the derivatives is computed.
"""

import operator
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import overload, register_jitable

from footopt.compiled import FAST, INLINE

VALUE = INLINE | {"fastmath": FAST}
#: A derivative that is zero by its structure may be left out, as if no factor could be NaN: values, by which
#: a walk that diverges is seen, are computed without that.
DERIVATIVE = INLINE | {"fastmath": FAST | {"nnan"}}


class Dual(NamedTuple):
    """A value and its derivatives by V_x and V_z (or by two other variables of the caller's choice)."""

    value: Any
    dx: Any
    dz: Any


def is_dual(kind: Any) -> bool:
    """Whether one of numba's types is that of a `Dual`."""
    return isinstance(kind, types.BaseNamedTuple) and kind.instance_class is Dual


def dual(stage: Any, number: Any, dx: Any, dz: Any) -> Any:
    """A number with its derivatives; where there is no implicit stage (None) the number alone."""
    return number if stage is None else Dual(number, dx, dz)


@overload(dual, jit_options=VALUE)
def _dual(stage, number, dx, dz):
    if isinstance(stage, types.NoneType):
        return lambda stage, number, dx, dz: number
    return lambda stage, number, dx, dz: Dual(number, dx, dz)


def _by_kind(of_dual: Any, of_number: Any, options: Any = VALUE) -> Any:
    """A function with one definition for a `Dual` and one for any other number, compiled and in Python."""

    def given(x, *rest):
        return of_dual(x, *rest) if isinstance(x, Dual) else of_number(x, *rest)

    overload(given, strict=False, jit_options=options)(lambda x, *rest: of_dual if is_dual(x) else of_number)
    return given


#: value(x): the value of a `Dual`; a plain number as it is.
value = _by_kind(lambda x: x.value, lambda x: x)
#: lift(x): a number as a `Dual`; a plain one is a constant.
lift = _by_kind(lambda x: x, lambda x: Dual(x, 0.0, 0.0))
#: chain(x, f, slope): a function of x, from its value and its derivative at x, by the chain rule.
chain = _by_kind(lambda x, f, slope: Dual(f, slope * x.dx, slope * x.dz), lambda x, f, slope: f, DERIVATIVE)


@register_jitable(**DERIVATIVE)
def combined(a, da, b, db):
    """a da + b db"""
    return a * da + b * db


@register_jitable(**DERIVATIVE)
def placed(stage, number, by_x, by_z):
    """A number with its derivatives by the hip's place, which changes by `stage`, s, times its velocity."""
    follows = 0.0 if stage is None else stage
    return dual(stage, number, follows * by_x, follows * by_z)


def _add(a, b):
    a, b = lift(a), lift(b)
    return Dual(a.value + b.value, a.dx + b.dx, a.dz + b.dz)


def _subtract(a, b):
    a, b = lift(a), lift(b)
    return Dual(a.value - b.value, a.dx - b.dx, a.dz - b.dz)


def _multiply(a, b):
    a, b = lift(a), lift(b)
    u, v = a.value, b.value
    return Dual(u * v, combined(v, a.dx, u, b.dx), combined(v, a.dz, u, b.dz))


def _divide(a, b):
    a, b = lift(a), lift(b)
    ratio, inverse = a.value / b.value, 1.0 / b.value
    slope = -ratio * inverse
    return Dual(ratio, combined(inverse, a.dx, slope, b.dx), combined(inverse, a.dz, slope, b.dz))


def _negative(x):
    return Dual(-x.value, -x.dx, -x.dz)


def _offer(symbol: Callable[..., Any], rule: Callable[..., Any]) -> None:
    """Define an operator by a rule where one of its operands is a `Dual`, compiled and in Python."""

    def resolve(a, b):
        return rule if is_dual(a) or is_dual(b) else None

    overload(symbol, jit_options=VALUE)(resolve)
    setattr(Dual, f"__{symbol.__name__}__", rule)
    setattr(Dual, f"__r{symbol.__name__}__", lambda b, a: rule(a, b))


setattr(Dual, "__array_ufunc__", None)  # noqa: B010  an array on the left leaves the operation to the number
for _rule, *_symbols in (
    (_add, operator.add, operator.iadd), (_subtract, operator.sub, operator.isub),
    (_multiply, operator.mul, operator.imul), (_divide, operator.truediv, operator.itruediv),
):  # fmt: skip
    for _symbol in _symbols:
        _offer(_symbol, _rule)
setattr(Dual, "__neg__", _negative)  # noqa: B010
overload(operator.neg, jit_options=VALUE)(lambda x: _negative if is_dual(x) else None)


@register_jitable(**VALUE)
def positive(x):
    """max(x, 0)"""
    v = value(x)
    return chain(x, np.maximum(v, 0.0), 1.0 * (v > 0.0))


@register_jitable(**VALUE)
def clipped(x, low, high):
    """X, but no less than `low` and no more than `high`."""
    v = value(x)
    return chain(x, np.minimum(np.maximum(v, low), high), 1.0 * ((v > low) & (v < high)))


@register_jitable(**VALUE)
def smooth_step(x):
    """From 0 at x = -1 to 1 at x = 1, a cubic."""
    s = np.minimum(np.maximum(value(x), -1.0), 1.0)
    return chain(x, 0.5 + s * (0.75 - 0.25 * s * s), 0.75 * (1.0 - s * s))


@register_jitable(**VALUE)
def exp(x):
    """e^x"""
    grown = np.exp(value(x))
    return chain(x, grown, grown)
