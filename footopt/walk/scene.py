"""The input of a simulation: `Walker` and `Scene`, plain frozen data."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from footopt.effects import base as effects
from footopt.effects.base import Effect, ordered
from footopt.errors import check, check_kind
from footopt.gait import Gait
from footopt.sand import Sand
from footopt.sand.law import EARTH

#: Units and ranges of a walker's numbers, from an insect to an excavator that walks.
WALKERS = {
    "mass": ("kg", 1e-9, 1e9),
    "l1": ("m", 1e-4, 100.0),
    "l2": ("m", 1e-4, 100.0),
    "g": ("m/s^2", 1e-6, 1e6),
}


@dataclass(frozen=True)
class Walker:
    """A biped with all its mass at the hip and massless legs (the paper's table 1).

    Parameters
    ----------
    mass : float, kg
        Of the whole walker, M.
    l1 : float, m
        Length of a thigh.
    l2 : float, m
        Length of a shank.
    g : float, m/s^2
        Gravity. The sand's strength is in proportion to it: see `Scene.zeta`.

    Raises
    ------
    SettingError
        A number is not in `WALKERS`' range.
    """

    mass: float = 60.0
    l1: float = 0.47
    l2: float = 0.45
    g: float = EARTH

    def __post_init__(self) -> None:
        for name, (unit, low, high) in WALKERS.items():
            value = getattr(self, name)
            allowed = f"a number > 0, from {low:g} to {high:g}, in {unit}"
            check(low <= value <= high, f"walker.{name}", value, allowed)

    @property
    def weight(self) -> float:
        """M g, N."""
        return self.mass * self.g


@dataclass(frozen=True)
class Scene:
    """The physics of a walk: which sand, which gait, which walker, how long.

    Parameters
    ----------
    sand : Sand
        The hard one by default.
    gait : Gait
        Human walking by default.
    walker : Walker
        The paper's by default.
    t_f : float, s, optional
        End of the walk; by default two strides after the start (2.9 s for the paper's walk).
    effects : tuple of Effect
        Beyond the plain law (`footopt.effects`); those that change nothing are
        dropped.

    Raises
    ------
    SettingError
        t_f is not allowed, or missing for a walker that stands still; two effects are of one kind.
    """

    sand: Sand = field(default_factory=lambda: Sand.named("hard"))
    gait: Gait = field(default_factory=Gait.human)
    walker: Walker = field(default_factory=Walker)
    t_f: float | None = None
    effects: tuple[Effect, ...] = ()

    def __post_init__(self) -> None:
        check_kind(self.sand, Sand, "sand", 'Try fo.Sand.named("hard")')
        check_kind(self.gait, Gait, "gait", "Try fo.Gait.human() or fo.read_gait(path)")
        check_kind(self.walker, Walker, "walker", "Try fo.Walker(mass=60)")
        object.__setattr__(self, "effects", ordered(self.effects))
        allowed, hint = (
            "given, in s, for a walker that stands still",
            "Try scene.t_f=10, or a finite gait.start.",
        )
        check(self.t_f is not None or math.isfinite(self.gait.start), "scene.t_f", None, allowed, hint)
        check(self.t_f is None or 0 < self.t_f <= 1e5, "scene.t_f", self.t_f, "a time > 0 and <= 1e5, in s")

    @property
    def duration(self) -> float:
        """t_f, s."""
        return self.gait.start + 2.0 * self.gait.period if self.t_f is None else self.t_f

    #: The quantity that `cost_of_transport` counts: joints of massless legs spend what the sand takes.
    transport: ClassVar[str] = "work"

    @property
    def weight(self) -> float:
        """M g, N."""
        return self.walker.weight

    @property
    def title(self) -> str:
        """Its sand in a few words."""
        return f"{self.sand.name} sand"

    @property
    def about(self) -> str:
        """What walks, in a line."""
        walker, gait = self.walker, self.gait
        return (
            f"Walker: {walker.mass:g} kg, legs {walker.l1:g} + {walker.l2:g} m, g {walker.g:g} m/s^2; "
            f"gait {gait.name}, stride {gait.period:.4g} s"
        )

    def entry(self) -> dict[str, Any]:
        """What it is, for result.json."""
        g = self.gait
        about = {"name": g.name, "period_s": g.period, "pitch": g.pitch, "source": g.source}
        gait = {**about, "fit_residual_deg": dict(g.residual)}
        return {"gait": gait, "walker": asdict(self.walker), "t_f_s": self.duration}

    @property
    def g(self) -> float:
        """Gravity, m/s^2."""
        return self.walker.g

    @property
    def stride(self) -> float:
        """Duration of a stride, s."""
        return self.gait.period

    @property
    def strikes(self) -> NDArray[np.float64]:
        """Times of all heel strikes, the right foot's first, s."""
        return self.gait.heel_strikes(self.duration)

    @property
    def holds(self) -> bool:
        """Whether its sand holds what stands, by bristles, in place of letting it creep."""
        return effects.bristle_length(self.effects) is not None

    @property
    def zeta(self) -> float:
        """The sand's zeta times g over the Earth's: its strength under the gravity of this scene.

        Dry grains resist by friction, under the pressure of the weight of those above them. Stress per
        depth is then in proportion to rho g: Slonaker et al., Physical Review E 95, 052901 (2017), from
        RFT, from plasticity with friction, and in discrete elements under several gravities. Bodies settle
        to the same depth at 0.4 to 1.2 g (Altshuler et al., Geophysical Research Letters 41, 2014).
        Cohesion does not scale with g and is not in the law.
        """
        return self.sand.zeta * (self.walker.g / EARTH)

    @property
    def gravity(self) -> tuple[float, float]:
        """Gravity along the surface (negative uphill, 0 if it is level) and against its normal, m/s^2."""
        return effects.gravity(self.effects, self.walker.g)

    def need_heel_strike(self) -> None:
        """Raise unless the walk has a heel strike: without one p_max and dV_x are not defined."""
        start, strike = self.gait.start, self.gait.heel_strike
        hint = "It can be simulated (study=simulate), not searched over."
        allowed = "finite to compare feet: this walker stands still"
        check(math.isfinite(start), "gait.start", start, allowed, hint)
        allowed = f"later than the first heel strike at {strike:g} s to compare feet"
        check(self.duration > strike, "scene.t_f", self.duration, allowed, hint)
