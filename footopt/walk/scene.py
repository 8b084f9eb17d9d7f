"""What is simulated and how finely: `Walker`, `Scene` and `Accuracy`, plain frozen data."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from footopt.effects.base import Effect, Slope, ordered
from footopt.errors import SettingError, check, check_kind
from footopt.foot.plates import RULES
from footopt.gait import Gait
from footopt.sand import Sand
from footopt.walk.steppers import STEPPERS

MOST_PLATES = 20_000  # 13 um each; beyond 1000 no objective changes by 1e-5

#: What a walker can be, with room for limits that are taken on purpose; beyond it numbers overflow.
WALKERS = {
    "mass": ("kg", 1e-9, 1e9),
    "l1": ("m", 1e-4, 1e3),
    "l2": ("m", 1e-4, 1e3),
    "g": ("m/s^2", 1e-6, 1e6),
}


@dataclass(frozen=True)
class Walker:
    """A biped with all its mass at the hip and massless legs (the paper's table 1).

    Parameters
    ----------
    mass : M, kg. l1, l2 : thigh and shank, m. g : gravity, m/s^2.
    """

    mass: float = 60.0
    l1: float = 0.47
    l2: float = 0.45
    g: float = 9.81

    def __post_init__(self) -> None:
        for name, (unit, low, high) in WALKERS.items():
            value = getattr(self, name)
            check(
                low <= value <= high,
                f"walker.{name}",
                value,
                f"a number > 0, from {low:g} to {high:g}, in {unit}",
            )

    @property
    def weight(self) -> float:
        """M g, N."""
        return self.mass * self.g


@dataclass(frozen=True)
class Scene:
    """The physics of a walk: which sand, which gait, which walker, how long.

    Parameters
    ----------
    t_f : end of the walk, s; by default two strides after the start (2.9 s for the paper's walk).
    effects : what the scene calls for beyond the plain law (`footopt.effects.base`); those that change
        nothing are dropped.
    """

    sand: Sand = field(default_factory=lambda: Sand.named("hard"))
    gait: Gait = field(default_factory=Gait.human)
    walker: Walker = field(default_factory=Walker)
    t_f: float | None = None
    effects: tuple[Effect, ...] = ()

    def __post_init__(self) -> None:
        check_kind(self.sand, Sand, "sand", 'Try fo.Sand.named("hard")')
        check_kind(self.gait, Gait, "gait", "Try fo.Gait.human() or fo.Gait.from_file(path)")
        check_kind(self.walker, Walker, "walker", "Try fo.Walker(mass=60)")
        object.__setattr__(self, "effects", ordered(self.effects))
        if self.t_f is None:
            if math.isinf(self.gait.start):
                raise SettingError(
                    "scene.t_f",
                    None,
                    "given, in s, for a walker who stands still",
                    "Try scene.t_f=10, or a finite gait.start.",
                )
        else:
            check(0 < self.t_f <= 1e5, "scene.t_f", self.t_f, "a time > 0 and <= 1e5, in s")

    @property
    def duration(self) -> float:
        """t_f, s."""
        return self.gait.start + 2.0 * self.gait.period if self.t_f is None else self.t_f

    @property
    def gravity(self) -> tuple[float | None, float]:
        """Gravity along the surface (None if it is level) and against its normal, m/s^2."""
        for effect in self.effects:
            if isinstance(effect, Slope):
                return effect.gravity(self.walker.g)
        return None, self.walker.g

    def need_heel_strike(self) -> None:
        """Raise unless the walk has a heel strike: without one p_max and dV_x are not defined."""
        if math.isinf(self.gait.start):
            raise SettingError(
                "gait.start",
                self.gait.start,
                "finite to compare feet: this walker stands still",
                "It can be simulated (study=simulate), not searched over.",
            )
        check(
            self.duration > self.gait.heel_strike,
            "scene.t_f",
            self.duration,
            f"later than the first heel strike at {self.gait.heel_strike:g} s to compare feet",
            "A shorter scene can be simulated (study=simulate), not searched over.",
        )


@dataclass(frozen=True)
class Accuracy:
    """How finely a scene is simulated.

    Parameters
    ----------
    stepper : a name in `footopt.walk.steppers.STEPPERS`.
    dt : largest time step of the walk, s (`simulate.time_grid`).
    plates : N, plates along the sole. rule : how they are laid, a name in `foot.plates.RULES`:
        "chord" as in the paper, or "arc", which needs fewer for the same error.
    creep : eps, m/s: h = v / sqrt(|v|^2 + eps^2) smooths the law's jump at v = 0.
    name : of the preset, for tables.
    control : the largest estimated error of the hip's velocity in one step, m/s: a step beyond it is
        halved, three times at most, and dt is the longest. None: all steps are as long.
    """

    stepper: str = "sdirk2"
    dt: float = 5e-3
    plates: int = 64
    creep: float = 1e-4
    name: str = "custom"
    rule: str = "arc"
    control: float | None = None

    def __post_init__(self) -> None:
        if self.rule not in RULES:
            raise SettingError("accuracy.rule", self.rule, f"one of {', '.join(RULES)}")
        if self.stepper not in STEPPERS:
            raise SettingError("accuracy.stepper", self.stepper, f"one of {', '.join(STEPPERS)}")
        check(1e-9 <= self.dt <= 1.0, "accuracy.dt", self.dt, "a time step from 1e-9 to 1, in s")
        check(
            isinstance(self.plates, int) and 2 <= self.plates <= MOST_PLATES,
            "accuracy.plates",
            self.plates,
            f"a whole number from 2 to {MOST_PLATES}",
            "The paper's is 100.",
        )
        check(
            1e-12 <= self.creep <= 1.0,
            "accuracy.creep",
            self.creep,
            "a speed from 1e-12 to 1, in m/s",
            "At zero speed the law is set-valued; 1e-4 changes the distance by .002 %.",
        )
        check(
            self.control is None or 1e-12 <= self.control <= 1.0,
            "accuracy.control",
            self.control,
            "null, or a speed from 1e-12 to 1, in m/s",
            "Try 1e-4.",
        )

    @classmethod
    def named(cls, name: str) -> Accuracy:
        """A preset of `PRESETS` by its name."""
        if name not in PRESETS:
            raise SettingError("accuracy", name, f"one of {', '.join(PRESETS)}")
        return PRESETS[name]

    @classmethod
    def within(cls, tolerance: float) -> Accuracy:
        """The cheapest setting of the accuracy study whose error is within a tolerance.

        Of those whose steps are under control: the table knows three sands, and where another scene
        is harder, such a walk takes shorter steps instead of a larger error.

        Parameters
        ----------
        tolerance : relative error of the worst objective for 95 % of random feet inside the box, on
            soft, regular and hard sand, against the limit of small steps and many plates.
        """
        table = [row for row in measured_settings() if row["control"] is not None]
        rows = [row for row in table if row["error"] <= MARGIN * tolerance]
        if not rows:
            best = min(row["error"] for row in table) / MARGIN
            raise SettingError(
                "accuracy.tolerance",
                tolerance,
                f"at least {best:g}, the best that was measured",
                "Use accuracy=reference, or set dt and plates by hand.",
            )
        row = min(rows, key=lambda row: row["ms"])
        setting = {name: row[name] for name in ("stepper", "dt", "plates", "creep", "rule", "control")}
        return cls(**setting, name=f"within {tolerance:g}")

    def steps(self, t_f: float) -> int:
        """Number of equal steps from 0 to t_f."""
        return max(1, math.ceil(t_f / self.dt - 1e-9))


#: The table that `footopt study=accuracy` wrote: every setting's error and cost.
TABLE = Path(__file__).parent / "accuracy.csv"
TABLE_COLUMNS = ("stepper", "rule", "dt", "control", "plates", "creep", "error", "ms")


@lru_cache
def measured_settings() -> tuple[dict[str, Any], ...]:
    """Rows of the accuracy study: a setting, its error (a fraction) and ms per design and core."""
    kinds: tuple[Callable[[str], Any], ...]
    kinds = (str, str, float, lambda text: float(text) if text else None, int, float, float, float)
    with open(TABLE, newline="", encoding="utf-8") as file:
        return tuple(
            {name: kind(row[name]) for name, kind in zip(TABLE_COLUMNS, kinds, strict=True)}
            for row in csv.DictReader(file)
        )


#: What a setting may use of a tolerance: other feet of the same kind give another 95 %.
MARGIN = 0.8

#: Tolerances of the presets that are chosen from the table.
TOLERANCES = {"draft": 0.02, "standard": 0.005, "fine": 0.0005}

#: Accuracies by name; "reference" is converged for every purpose but a study of convergence.
PRESETS: dict[str, Accuracy] = {
    **{name: replace(Accuracy.within(value), name=name) for name, value in TOLERANCES.items()},
    "reference": Accuracy("sdirk2", 2e-4, 400, 1e-5, "reference"),
}
