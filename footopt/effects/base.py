"""The base of all effects, and how the effects of a scene become compiled code: only those that are named.

An effect is a frozen dataclass with its parameters, on top of `Effect`, which says what a walk asks of it.
One that changes the force on a plate has a ``law``: a NamedTuple with its parameters as plain numbers, and
with one or more of three methods, which are compiled into the loop over plates:

- ``load(self, load, depth, x)``: the strength of the sand integrated over the depth, m, from that of the
  effects before it (the plain law's is the depth itself), at a depth (m) and a place (m).
- ``gate(self, lead, depth)``: the share of the stress that a plate feels, from how far it leads: n.v over
  the speeds along the normal within the plate; where the scene has bristles, n.h over
  `footopt.walk.contact.EDGE`, of robots `footopt.mujoco.faces.EDGE`. At 1 and above, the whole plate leads;
  at -1 and below, it trails.
- ``push(self, vn, depth)``: a pressure against the outward normal, Pa, at a speed n.v along it, m/s.

The force on a plate of area dA is then zeta load share (a - M h) dA - push n dA. The arguments of the
methods are dual numbers (`footopt.effects.dual`), which carry derivatives: write a law with + - * / and the
functions of that module. A new effect is a file beside this one, or a user's own: a law, and a dataclass
with a name by which settings find it, ``class Mine(Effect, name="mine")``. Every parameter has a default, and
a numpydoc section *Parameters* is its help. Load and push are called for plates in the air, too, and have to
be 0 at a depth of 0; a push is continuous in n.v, which is about 1e-4 m/s for a walker that stands.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, is_dataclass
from functools import cache, reduce
from inspect import getmembers, isfunction
from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.extending import overload, register_jitable

from footopt.arrays import Array
from footopt.compiled import FAST, INLINE
from footopt.effects.dual import value
from footopt.errors import SettingError, check, check_free, is_number

Reshape = Callable[[Array], Array]  # of soles (designs, points, 2), m

MOST = 100  # layers, or patches: every plate evaluates each of them
FEW = 8  # longest list of numbers whose loop is unrolled, so that the loop over plates is vectorised
HOOKS = ("load", "gate", "push")  # of a law
BRISTLE_LENGTH = 1e-6  # m: the delta of bristles where none is given


def numbers(values: Sequence[float]) -> tuple[float, ...] | Array:
    """A law's list of numbers: a few as a tuple, whose loop is unrolled, many as an array, whose is not."""
    return tuple(values) if len(values) <= FEW else np.array(values, dtype=np.float64)


def as_floats(effect: Effect, name: str) -> tuple[float, ...]:
    """A parameter of several numbers, which becomes a tuple of floats."""
    given = getattr(effect, name)
    good = np.ndim(given) == 1 and all(map(is_number, given))
    check(good, f"effects.{name_of(effect)}.{name}", given, "a list of numbers")
    object.__setattr__(effect, name, tuple(map(float, given)))
    return getattr(effect, name)


def check_factors(setting: str, factors: Sequence[float], count: int, allowed: str) -> None:
    """Raise unless there are as many factors of a strength as wanted."""
    good = len(factors) == count and all(1e-6 <= factor <= 1e6 for factor in factors)
    check(good, setting, list(factors), allowed)


#: Effects by the names that settings give them, in the order in which they act.
EFFECTS: dict[str, type[Any]] = {}


class Effect:
    """What a walk asks of an effect; the answers here are those of an effect that changes nothing.

    ``literature`` says whether its default parameters hold for sand in general: `effects=auto` tries those.
    """

    literature = False
    plausible = False  # whether it may hold for any walk: best feet are evaluated with it and without it
    is_inertia = False  # whether its push is due to the momentum of the sand
    in_page = False  # whether the simulation in report.html has it, too (`contact.js`)

    law: Any = None  # its numbers as a NamedTuple with the methods that are compiled; None without any
    bristle_length: Any = None  # m, over which the sand under a plate yields elastically; None: it does not
    #: Stretches of x, and of depth, with another sand: begin and end, m, and its zeta over that of the scene.
    zones: Any = ()
    strata: Any = ()

    def __init_subclass__(cls, name: str = "") -> None:
        for claim in ("literature", "plausible", "in_page"):  # each class makes its own
            if claim not in vars(cls):
                setattr(cls, claim, False)
        if name:
            check_free(name, EFFECTS.get(name), cls)
            EFFECTS[name] = cls

    def gravity(self, g: float) -> tuple[float, float]:
        """Gravity along the surface (negative uphill) and against its normal, m/s^2, from g."""
        return 0.0, g

    def reshape(self, points: Array) -> Array:
        """Soles (designs, points, 2), m, as plates are to be cut from them."""
        return points


def name_of(effect: Effect) -> str:
    """An effect's name in settings and tables."""
    return next((name for name, kind in EFFECTS.items() if type(effect) is kind), type(effect).__name__)


def parameters(effect: Any) -> dict[str, Any]:
    """An effect's parameters by name."""
    return asdict(effect)


def ordered(effects: Sequence[Effect]) -> tuple[Effect, ...]:
    """Effects in the order in which they act; those not in `EFFECTS` come last.

    Raises
    ------
    SettingError
        They are no sequence of effects, or two are of one kind.
    """
    given = isinstance(effects, (list, tuple)) and all(isinstance(effect, Effect) for effect in effects)
    check(given, "effects", effects, "a list of effects", "Try effects=[fo.Rest(), fo.LeadingEdge()]")
    kinds, hint = [type(effect) for effect in effects], "Decorate it: @dataclass(frozen=True)"
    for effect, kind in zip(effects, kinds, strict=True):
        check(kinds.count(kind) == 1, "effects", kind.__name__, "at most one effect of a kind")
        check(is_dataclass(effect), "effects", kind.__name__, "a dataclass", hint)
        try:
            hash(effect)
        except TypeError as why:
            raise SettingError("effects", kind.__name__, f"frozen, of numbers and tuples ({why})") from None
    order = list(EFFECTS.values())
    return tuple(sorted(effects, key=lambda e: order.index(type(e)) if type(e) in order else len(order)))


def bristle_length(effects: Sequence[Effect]) -> float | None:
    """The delta of a scene's bristles, m; None without them."""
    return next((e.bristle_length for e in effects if e.bristle_length is not None), None)


def reshaping(effects: Sequence[Effect]) -> Reshape | None:
    """How a scene's effects change soles before plates are cut from them; None where they do not."""
    own = [e for e in effects if type(e).reshape is not Effect.reshape]
    return (lambda points: reduce(_reshaped, own, points)) if own else None


def _reshaped(points: Array, effect: Effect) -> Array:
    """Soles as an effect changes them, checked."""
    found, allowed = np.asarray(effect.reshape(points)), f"of the shape that it is given, {points.shape}"
    check(found.shape == points.shape, f"effects.{name_of(effect)}.reshape", found.shape, allowed)
    return found


def gravity(effects: Sequence[Effect], g: float) -> tuple[float, float]:
    """Gravity along a scene's surface (negative uphill) and against its normal, m/s^2."""
    found = [effect.gravity(g) for effect in effects if type(effect).gravity is not Effect.gravity]
    check(len(found) < 2, "effects", [*map(name_of, effects)], "at most one that changes gravity")
    return found[0] if found else (0.0, g)


class Laws(NamedTuple):
    """The laws of a scene's effects by what they change, each a tuple of laws or None."""

    loads: Any
    gates: Any
    pushes: Any

    @property
    def all(self) -> tuple[Any, ...]:
        """Every law, once for each of its methods."""
        return tuple(law for laws in self for law in laws or ())


def laws(effects: Sequence[Effect]) -> Laws:
    """The laws of a scene's effects, as the compiled loop takes them."""
    found = [effect.law for effect in effects if effect.law is not None]
    for law in found:
        kind: Any = type(law)
        _check_methods(kind)
        if not kind.__module__.startswith("footopt."):
            _check_at_surface(law)
    return Laws(*(tuple(law for law in found if hasattr(law, hook)) or None for hook in HOOKS))


@cache
def _check_methods(kind: type) -> None:
    """Raise unless a law's methods are hooks."""
    methods = {name for name, _ in getmembers(kind, isfunction) if name[0] != "_"}
    hint = f"It has {', '.join(sorted(methods)) or 'none'}."
    allowed = f"a law with methods {', '.join(HOOKS)}"
    check(bool(methods) and methods <= {*HOOKS}, "effects", kind.__name__, allowed, hint)


def _check_at_surface(law: Any) -> None:
    """Raise unless a user's law gives 0 at a depth of 0, where plates in the air are taken to be."""
    for hook, *given in (("load", 0.0, 0.0, 0.3), ("push", 1.0, 0.0), ("push", -1.0, 0.0)):
        if hasattr(law, hook):
            try:
                found = value(getattr(law, hook)(*given))
            except ZeroDivisionError:
                found = np.nan
            except Exception:  # of what only compiled code can do
                continue
            name, allowed = f"effects.{type(law).__name__}.{hook}", "0 at a depth of 0, as in the air"
            check(found == 0.0, name, float(found), allowed)


def _over(hook: str, none: Callable[..., Any], join: Callable[..., Any]) -> Callable[..., Any]:
    """A function that calls a hook of each law in a tuple (or None) with two numbers, and joins the results.

    In compiled code the hooks are found by the laws' types when it is compiled.
    """
    options = INLINE | {"fastmath": FAST}
    joined = register_jitable(**options)(join)

    def through(laws, u, v):
        found = none(laws, u, v)
        for law in laws or ():
            found = join(getattr(type(law), hook), law, found, u, v)
        return found

    @overload(through, jit_options=options)
    def resolve(laws, u, v):
        if isinstance(laws, types.NoneType) or len(laws) == 0:
            return none
        last = njit(**options)(getattr(laws.types[-1].instance_class, hook))
        return lambda laws, u, v: joined(last, laws[-1], through(laws[:-1], u, v), u, v)

    return through


#: load(laws, depth, x): strength of the sand integrated over a plate's depth, m, with all effects of a scene.
load = _over("load", lambda laws, u, v: u, lambda hook, law, found, u, v: hook(law, found, u, v))
#: gate(laws, lead, depth): share of the stress that a plate feels.
gate = _over("gate", lambda laws, u, v: 1.0, lambda hook, law, found, u, v: found * hook(law, u, v))
#: push(laws, vn, depth): pressure against a plate's outward normal, Pa.
push = _over("push", lambda laws, u, v: 0.0, lambda hook, law, found, u, v: found + hook(law, u, v))
