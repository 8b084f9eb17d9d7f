"""Effects beyond the plain law: a scene names those it calls for, the others are not compiled.

An effect is a frozen dataclass with its parameters; its `law` holds them as plain numbers for the
compiled loop. A law changes the force on a plate at one or more of three places, by a small function
``hook(law, state, u, v) -> state`` that changes what the effects before it made:

- load, of depth (m) and x (m): the strength of the sand integrated over the depth, m (the plain law's is
  the depth itself), and its derivatives by depth and by x.
- gate, of into = n.v, the speed along the outward normal (m/s), and the creep speed (m/s): the share of
  the stress that the plate feels, and its derivative by into, s/m.
- push, of into and depth: a pressure against the outward normal, Pa, and its derivatives by both.

The same functions are compiled into the plate loop and, called with arrays, are the readable form
behind `Walk.plates`. `register` joins a law to its hooks; an effect of one's own needs nothing else.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numba import njit
from numba.extending import overload
from numpy.typing import NDArray

from footopt.errors import SettingError, check

Array = NDArray[np.float64]

FAST = {"contract", "reassoc", "arcp", "nsz"}  # see `walker.kernels`


class Effect(Protocol):
    """What a scene asks of an effect."""

    @property
    def law(self) -> Any:
        """Its numbers, a NamedTuple for which `register` was called; None if it changes no stress."""

    @property
    def nothing(self) -> bool:
        """Whether its parameters are such that it changes nothing: then it is left out."""


Hook = Callable[..., Any]

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


# --- which faces feel the sand ----------------------------------------------------------------------


class LeadingEdgeLaw(NamedTuple):
    """It has no parameters."""


MOST = 100  # layers, or patches: a walk looks at each


@dataclass(frozen=True)
class LeadingEdge:
    """Only faces that lead, n.v > 0, feel sand: what trails leaves a gap behind and is not pulled.

    Smoothed over the creep speed, so that implicit steps converge: all of the stress at n.v >= eps,
    none at n.v <= -eps.

    The leading-edge hypothesis of RFT in Agarwal, Goldman & Kamrin, PNAS 120 (2023), and of granular
    RFT codes before it; without it (the paper) a foot that is lifted out of the sand is pulled back.
    Valid for dry, cohesionless grains that do not close the gap during a step.
    """

    law = LeadingEdgeLaw()
    nothing = False


def leading_gate(law, state, into, creep):
    """A cubic step from 0 at n.v = -eps to 1 at n.v = eps."""
    share, bend = state
    s = np.minimum(np.maximum(into / creep, -1.0), 1.0)
    step, slope = 0.5 + s * (0.75 - 0.25 * s * s), 0.75 * (1.0 - s * s) / creep
    return share * step, bend * step + share * slope


register(LeadingEdgeLaw, gate=leading_gate)

# --- the grains' inertia ----------------------------------------------------------------------------


class InertiaLaw(NamedTuple):
    """lambda rho, kg/m^3."""

    density: float


@dataclass(frozen=True)
class Inertia:
    """The sand that a leading face throws aside: a traction -n lambda rho (n.v)^2 for n.v > 0.

    Dynamic RFT, Agarwal, Karsai, Goldman & Kamrin, Science Advances 7 (2021): in a drag test F = K |z|
    + lambda rho A v^2 with lambda 1.1 (plate .016 m long, 20-40 mm deep, .04-.64 m/s, rho 900 kg/m^3).
    A plate is wet from a depth of `SKIN` on, and in proportion above it.

    Parameters
    ----------
    factor : lambda, 1. rho : bulk density of the sand, kg/m^3 (quartz sand about 1600).
    """

    factor: float = 1.1
    rho: float = 1600.0

    def __post_init__(self) -> None:
        check(0 <= self.factor <= 1e3, "effects.inertia.factor", self.factor, "a number >= 0 and <= 1000")
        check(0 <= self.rho <= 1e5, "effects.inertia.rho", self.rho, "a density >= 0 and <= 1e5, in kg/m^3")

    @property
    def law(self) -> InertiaLaw:
        """lambda rho."""
        return InertiaLaw(self.factor * self.rho)

    @property
    def nothing(self) -> bool:
        """Whether lambda rho is 0."""
        return self.factor * self.rho == 0.0


SKIN = 1e-3  # m


def inertial_push(law, state, into, depth):
    """lambda rho (n.v)^2, times how wet the plate is."""
    push, stiff, sink = state
    speed = np.maximum(into, 0.0)
    wet = np.minimum(depth / SKIN, 1.0)
    growing = (depth < SKIN) / SKIN
    pressure = law.density * speed * speed
    return push + wet * pressure, stiff + 2.0 * law.density * wet * speed, sink + growing * pressure


register(InertiaLaw, push=inertial_push)

# --- an inclined plane ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Slope:
    """A plane inclined by an angle: gravity tilts in the frame of the plane, uphill is positive.

    x runs along the surface, z along its normal, and so do depth, angles of the gait, distance and
    height. The stress map is the level one, which holds well below the angle of repose.

    Parameters
    ----------
    angle : deg, between -25 and 25: dry sand slides at about 30.
    """

    angle: float = 5.0
    law = None

    def __post_init__(self) -> None:
        check(
            -25 <= self.angle <= 25,
            "effects.slope.angle",
            self.angle,
            "an angle from -25 to 25, in deg",
            "Dry sand itself slides at about 30 deg.",
        )

    @property
    def nothing(self) -> bool:
        """Whether the plane is level."""
        return self.angle == 0.0

    def gravity(self, g: float) -> tuple[float, float]:
        """g along the plane (negative when uphill) and against its normal, m/s^2."""
        angle = math.radians(self.angle)
        return -g * math.sin(angle), g * math.cos(angle)


# --- strength that changes with depth -----------------------------------------------------------------


class LayersLaw(NamedTuple):
    """Interfaces (m) and the jump of the strength at each, in units of the sand's zeta."""

    depths: tuple[float, ...]
    jumps: tuple[float, ...]


@dataclass(frozen=True)
class Layers:
    """Layers: the stress is the integral of zeta over depth, so that it is continuous at an interface.

    The first layer, from the surface to the first interface, is the scene's sand; `factors` give zeta
    of those below it as multiples of the sand's. With one sand the integral is zeta |z|. A superposition
    of the depth-linear law, exact for what the sand above weighs on a failure surface at the plate; a
    plate does not feel an interface before it gets there (measured: about one plate width ahead).

    Parameters
    ----------
    depths : interfaces below the surface, increasing, m. factors : zeta of the layer under each over
        that of the sand.
    """

    depths: tuple[float, ...] = (0.03,)
    factors: tuple[float, ...] = (0.3,)

    def __post_init__(self) -> None:
        depths, factors = tuple(map(float, self.depths)), tuple(map(float, self.factors))
        object.__setattr__(self, "depths", depths)
        object.__setattr__(self, "factors", factors)
        rising = all(a < b for a, b in zip((0.0, *depths), (*depths, math.inf), strict=True))
        check(
            rising and 1 <= len(depths) <= MOST,
            "effects.layers.depths",
            list(depths),
            f"1 to {MOST} increasing depths > 0, in m",
        )
        check(
            len(factors) == len(depths) and all(1e-6 <= f <= 1e6 for f in factors),
            "effects.layers.factors",
            list(factors),
            f"{len(depths)} numbers > 0: zeta under each interface over the sand's",
        )

    @property
    def law(self) -> LayersLaw:
        """Interfaces and jumps."""
        return LayersLaw(self.depths, tuple(np.diff((1.0, *self.factors)).tolist()))

    @property
    def nothing(self) -> bool:
        """Whether all layers are the same sand."""
        return all(f == 1.0 for f in self.factors)


def layered_load(law, state, depth, x):
    """The integral of zeta over depth: each interface adds its jump times the depth below it."""
    load, grow, slide = state
    for i in range(len(law.depths)):
        beyond = depth - law.depths[i]
        load = load + law.jumps[i] * np.maximum(beyond, 0.0)
        grow = grow + law.jumps[i] * (beyond > 0.0)
    return load, grow, slide


register(LayersLaw, load=layered_load)

# --- strength that changes along the way --------------------------------------------------------------


class PatchesLaw(NamedTuple):
    """Begin and end of each patch (m), its zeta over the sand's less 1, and the blur (m)."""

    begins: tuple[float, ...]
    ends: tuple[float, ...]
    extra: tuple[float, ...]
    blur: float


@dataclass(frozen=True)
class Patches:
    """Patches along the way: zeta changes with x, smoothly over a stated length.

    Parameters
    ----------
    begins, ends : of each patch, m, from where the hip starts. factors : its zeta over the sand's.
    blur : the length of the change at either side, m; half of it is inside the patch.
    """

    begins: tuple[float, ...] = (0.35,)
    ends: tuple[float, ...] = (0.95,)
    factors: tuple[float, ...] = (0.2,)
    blur: float = 0.05

    def __post_init__(self) -> None:
        for name in ("begins", "ends", "factors"):
            object.__setattr__(self, name, tuple(map(float, getattr(self, name))))
        count = len(self.begins)
        check(
            1 <= count <= MOST
            and len(self.ends) == count
            and all(abs(at) <= 1e6 for at in (*self.begins, *self.ends)),
            "effects.patches.ends",
            list(self.ends),
            f"as many as effects.patches.begins ({count}), in m",
        )
        for begin, end in zip(self.begins, self.ends, strict=True):
            check(begin < end, "effects.patches.ends", end, f"beyond the patch's begin at {begin:g} m")
        check(
            len(self.factors) == count and all(1e-6 <= f <= 1e6 for f in self.factors),
            "effects.patches.factors",
            list(self.factors),
            f"{count} numbers > 0: zeta of each patch over the sand's",
        )
        check(1e-4 <= self.blur <= 1e3, "effects.patches.blur", self.blur, "a length from 1e-4 to 1000, in m")

    @property
    def law(self) -> PatchesLaw:
        """Begins, ends, factor - 1, blur."""
        return PatchesLaw(self.begins, self.ends, tuple(f - 1.0 for f in self.factors), float(self.blur))

    @property
    def nothing(self) -> bool:
        """Whether all patches are the same sand."""
        return all(f == 1.0 for f in self.factors)


def patchy_load(law, state, depth, x):
    """Strength times 1 + sum of (factor - 1) inside each patch, with cubic steps at its sides."""
    load, grow, slide = state
    strength, change = 1.0, 0.0
    for i in range(len(law.begins)):
        s = np.minimum(np.maximum((x - law.begins[i]) / law.blur + 0.5, 0.0), 1.0)
        r = np.minimum(np.maximum((law.ends[i] - x) / law.blur + 0.5, 0.0), 1.0)
        enter, leave = s * s * (3.0 - 2.0 * s), r * r * (3.0 - 2.0 * r)
        slope = (s * (1.0 - s) * leave - r * (1.0 - r) * enter) * 6.0 / law.blur
        strength = strength + law.extra[i] * enter * leave
        change = change + law.extra[i] * slope
    return load * strength, grow * strength, slide * strength + load * change


register(PatchesLaw, load=patchy_load)

# --- a scene's effects --------------------------------------------------------------------------------

#: Effects by name, in the order in which they act.
EFFECTS: dict[str, type[Any]] = {
    "layers": Layers,
    "patches": Patches,
    "leading_edge": LeadingEdge,
    "inertia": Inertia,
    "slope": Slope,
}


def ordered(effects: Sequence[Effect]) -> tuple[Effect, ...]:
    """The effects that do something, in the order in which they act; own ones come last.

    Raises
    ------
    SettingError : two effects of a kind.
    """
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


INLINE = {"fastmath": FAST, "error_model": "numpy", "forceinline": True}


def _through(hooks: dict[type, Hook]) -> Hook:
    """A function that takes a state through the hooks of a tuple of laws, one after the other.

    In compiled code the hooks are found by the laws' types when it is compiled.
    """

    def take(laws, state, u, v):
        for law in laws:
            state = hooks[type(law)](law, state, u, v)
        return state

    @overload(take, jit_options=INLINE)
    def resolve(laws, state, u, v):
        if len(laws) == 0:
            return lambda laws, state, u, v: state
        first = njit(**INLINE)(hooks[laws.types[0].instance_class])

        def go_on(laws, state, u, v):
            return take(laws[1:], first(laws[0], state, u, v), u, v)

        return go_on

    return take


#: load(laws, (depth, 1.0, 0.0), depth, x), gate(laws, (1.0, 0.0), into, creep) and
#: push(laws, (0.0, 0.0, 0.0), into, depth): a plate's, with all effects of a scene.
load, gate, push = _through(LOADS), _through(GATES), _through(PUSHES)


def readable(
    effects: Sequence[Effect], depth: Array, x: Array, into: Array, creep: float
) -> tuple[Array, Array, Array]:
    """What effects make of plates: load (m), share of the stress, and pressure (Pa), as arrays.

    The force on a plate of area dA is then zeta load share (a - M h) dA - push n dA.

    Parameters
    ----------
    depth, x : of each plate, m. into : its speed along its outward normal, m/s. creep : m/s
    """
    loads, gates, pushes = laws(effects)
    none = np.zeros_like(depth)
    strength = depth if loads is None else load(loads, (depth, none + 1.0, none), depth, x)[0]
    share = none + 1.0 if gates is None else gate(gates, (none + 1.0, none), into, creep)[0]
    pressure = none if pushes is None else push(pushes, (none, none, none), into, depth)[0]
    return strength, share, pressure
