"""What an effect is, and how the effects of a scene become compiled code: only those that are named.

An effect is a frozen dataclass with its parameters; its ``law`` holds them as plain numbers for the
compiled loop. A law changes the force on a plate at one or more of three places, by a small function
``hook(law, state, u, v) -> state`` that changes what the effects before it made:

- load, of depth (m) and x (m). The state is the strength of the sand integrated over the depth, m (the
  plain law's is the depth itself), and its derivatives by depth and by x.
- gate, of vn = n.v, the speed along the outward normal (m/s), and the speed over which it opens; where the
  scene has bristles (`rest`), of n.h and a width instead. The state is the share of the stress that the
  plate feels, and its derivative by vn.
- push, of vn and depth. The state is a pressure against the outward normal, Pa, and its derivatives by
  both.

The force on a plate of area dA is then zeta load share (a - M h) dA - push n dA. The same hooks are
compiled into the loop over plates and, called with arrays, are the readable form (`readable`). A new
effect is a file beside this one, or a user's own: a law, a dataclass, a hook, `register`, and an entry in
`EFFECTS` by which settings find it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, is_dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numba import njit
from numba.extending import overload
from numpy.typing import NDArray

from footopt.compiled import FAST, INLINE
from footopt.errors import SettingError, check

Array = NDArray[np.float64]
Hook = Callable[..., Any]

MOST = 100  # layers, or patches: a walk looks at each
FEW = 8  # numbers of a law's list that are compiled one by one, so that the loop over plates is vectorised


def numbers(values: Sequence[float]) -> tuple[float, ...] | Array:
    """A law's list of numbers: a few as a tuple, whose loop is unrolled, many as an array, whose is not."""
    return tuple(values) if len(values) <= FEW else np.array(values, dtype=np.float64)


class Effect(Protocol):
    """What a scene asks of an effect.

    Optional, for the table of what a scene calls for: ``estimate(scale) -> float``, the relative change of
    the force on a typical plate; ``number``, what that is in words; ``source``, of its parameters.
    """

    @property
    def law(self) -> Any:
        """Its numbers, a NamedTuple for which `register` was called; None if it changes no stress."""

    @property
    def nothing(self) -> bool:
        """Whether its parameters are such that it changes nothing: then it is left out."""


class Scale(NamedTuple):
    """Rough numbers of a scene, from which an effect estimates its size before anything walks."""

    stress: float  # zeta alpha_z of a level plate that moves down, N/m^3
    pull: float  # the same when it moves up, N/m^3: negative where sand holds it back
    depth: float  # to which a level foot sinks, m
    speed: float  # with which a foot is set down, m/s
    distance: float  # walked, m
    hollow: float = 0.01  # depth of the sole's grooves, m: of a typical one, where no foot is known
    sweep: float = 0.0  # fastest of a foot that is no higher over the other one than that has sunk, m/s


#: Effects by the names that settings give them, in the order in which they act.
EFFECTS: dict[str, type[Any]] = {}

#: Hooks by the type of their law.
LOADS: dict[type, Hook] = {}
GATES: dict[type, Hook] = {}
PUSHES: dict[type, Hook] = {}
HOOKS = (LOADS, GATES, PUSHES)


def register(law: type, load: Hook | None = None, gate: Hook | None = None, push: Hook | None = None) -> None:
    """Join the type of a law, a NamedTuple of numbers, to what it does; see the top of this module."""
    for hooks, function in zip(HOOKS, (load, gate, push), strict=True):
        if function is not None:
            hooks[law] = function


def name_of(effect: Effect) -> str:
    """An effect's name in settings and tables."""
    names = (name for name, kind in EFFECTS.items() if isinstance(effect, kind))
    return next(names, type(effect).__name__)


def parameters(effect: Effect) -> dict[str, Any]:
    """An effect's parameters by name."""
    return asdict(effect) if is_dataclass(effect) else {}


def ordered(effects: Sequence[Effect]) -> tuple[Effect, ...]:
    """The effects that do something, in the order in which they act; those not in `EFFECTS` come last.

    Raises
    ------
    SettingError
        They are no sequence of effects, or two are of one kind.
    """
    given = isinstance(effects, (list, tuple)) and all(
        hasattr(effect, "nothing") and not isinstance(effect, type) for effect in effects
    )
    check(given, "effects", effects, "a list of effects", "Try effects=[fo.Rest(), fo.LeadingEdge()]")
    kinds = [type(effect) for effect in effects]
    for kind in kinds:
        if kinds.count(kind) > 1:
            raise SettingError("effects", kind.__name__, "at most one effect of a kind")
    order = list(EFFECTS.values())
    active = [effect for effect in effects if not effect.nothing]
    return tuple(sorted(active, key=lambda e: order.index(type(e)) if type(e) in order else len(order)))


class Laws(NamedTuple):
    """The laws of a scene's effects by what they change, each a tuple of laws or None."""

    loads: Any
    gates: Any
    pushes: Any

    @property
    def directed(self) -> bool:
        """Whether plates must know their outward normal."""
        return self.gates is not None or self.pushes is not None


def laws(effects: Sequence[Effect]) -> Laws:
    """What the compiled loop gets of a scene's effects."""
    found = [effect.law for effect in effects if effect.law is not None]
    for law in found:
        if not any(type(law) in hooks for hooks in HOOKS):
            raise SettingError("effects", type(law).__name__, "a law for which effects.register was called")
    picked = (tuple(law for law in found if type(law) in hooks) for hooks in HOOKS)
    return Laws(*(chosen or None for chosen in picked))


def _through(hooks: dict[type, Hook]) -> Hook:
    """A function that takes a state through the hooks of a tuple of laws, one after the other.

    In compiled code the hooks are found by the laws' types when it is compiled.
    """
    options = INLINE | {"fastmath": FAST}

    def take(laws, state, u, v):
        for law in laws:
            state = hooks[type(law)](law, state, u, v)
        return state

    @overload(take, jit_options=options)
    def resolve(laws, state, u, v):
        if len(laws) == 0:
            return lambda laws, state, u, v: state
        first = njit(**options)(hooks[laws.types[0].instance_class])

        def go_on(laws, state, u, v):
            return take(laws[1:], first(laws[0], state, u, v), u, v)

        return go_on

    return take


#: load(laws, (depth, 1.0, 0.0), depth, x), gate(laws, (1.0, 0.0), vn, width) and
#: push(laws, (0.0, 0.0, 0.0), vn, depth): a plate's, with all effects of a scene.
load, gate, push = _through(LOADS), _through(GATES), _through(PUSHES)


def readable(
    effects: Sequence[Effect], depth: Array, x: Array, vn: Array, leads: Array, edge: float | Array
) -> tuple[Array, Array, Array]:
    """What effects make of plates: load (m), share of the stress, and pressure (Pa), as arrays.

    Parameters
    ----------
    effects : sequence of Effect
        Of the scene.
    depth, x : arrays, m
        Of each plate.
    vn : array, m/s
        Each plate's speed along its outward normal.
    leads : array
        n.v or n.h, by which a gate opens.
    edge : float or array
        Over which it opens: the creep speed, or its like for n.h.
    """
    loads, gates, pushes = laws(effects)
    none = np.zeros_like(depth)
    strength = depth if loads is None else load(loads, (depth, none + 1.0, none), depth, x)[0]
    share = none + 1.0 if gates is None else gate(gates, (none + 1.0, none), leads, edge)[0]
    pressure = none if pushes is None else push(pushes, (none, none, none), vn, depth)[0]
    return strength, share, pressure
