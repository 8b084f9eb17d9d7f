"""`Simulator`: the interface between simulations and everything that searches, compares and draws them."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, NamedTuple

import numpy as np

from footopt.arrays import Array, Ints, Words
from footopt.effects.base import Effect
from footopt.errors import FootoptError, SettingError, check
from footopt.foot import Foot, Waypoints
from footopt.sand import Sand
from footopt.sand.law import EARTH
from footopt.walk.accuracy import Accuracy, Tolerance
from footopt.walk.own_code import own_code


class Walked(NamedTuple):
    """Feet that have walked, a row each."""

    raw: Array  # (feet, quantities), NaN for a walk that failed, except for what is known of it nevertheless
    reasons: Words  # why a walk failed, or ""
    evaluations: Ints  # of the contact
    counts: Mapping[str, Ints] = {}  # of anything else


class Simulator(ABC):
    """What walks with a foot: the planar walker of a `Scene`, a robot, or a function.

    `footopt.simulate`, `footopt.evaluate`, `FootProblem` and everything built on them accept any. A class
    that inherits from it is a frozen dataclass; the fields that it compares are part of a store's key.
    """

    #: The quantity that `cost_of_transport` counts, J.
    transport: ClassVar[str] = "joint_work"
    #: The sand that it walks on and effects, where it has any.
    sand: Sand | None = None
    effects: Sequence[Effect] = ()

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of what `walk` measures; objectives are functions of these (`footopt.walk.objectives`)."""
        return ()

    @property
    def weight(self) -> float:
        """Weight of what walks, N."""
        return math.nan

    @property
    def g(self) -> float:
        """Gravity, m/s^2."""
        return EARTH

    @property
    def legs(self) -> float:
        """Length of the legs, m, or the height of a robot's centre of mass: with the weight its size."""
        return math.nan

    @abstractmethod
    def walk(
        self, feet: Sequence[Foot], accuracy: Accuracy, threads: int | None = None, names: Sequence[str] = ()
    ) -> Walked:
        """Walk with some feet.

        Parameters
        ----------
        feet : sequence of Foot
            A walk's result does not depend on the others.
        accuracy : Accuracy
            The numerical parameters that `ladder` found.
        threads : int, optional
            How many to use; by default as many as the process may run on.
        names : sequence of str
            The objectives that are asked for: what only others need may be NaN.
        """

    def too_long(self, accuracy: Accuracy) -> bool:
        """Whether a walk has more steps at an accuracy than can be made."""
        return False

    def trace(self, foot: Foot, accuracy: Accuracy) -> Any:
        """Walk with one foot, keeping full traces: a `footopt.Walk`."""
        raise SettingError("simulator", self.title, "one that keeps traces of a walk", "Try fo.evaluate.")

    def ladder(self, of: Tolerance, soles: Waypoints | tuple[Foot, ...]) -> Any:
        """The numerical parameters for a tolerance, and a `ladder.Found`; None if it has none to choose.

        Parameters
        ----------
        of : Tolerance
            The error that is allowed.
        soles : Waypoints or tuple of Foot
            The space whose soles walk, or a few of the soles that do.
        """
        return None

    def own(self) -> tuple[Any, ...]:
        """Functions and types that determine a walk, a user's own among them: its classes and effects."""
        kinds, laws = type(self).__mro__, [e.law for e in self.effects if e.law is not None]
        return (*kinds[: kinds.index(Simulator)], *map(type, self.effects), *own_code(laws))

    @property
    def title(self) -> str:
        """The simulator in a few words, such as "hard sand"."""
        return type(self).__name__

    @property
    def about(self) -> str:
        """What walks, in one line."""
        return f"Simulator: {self.title}"

    def entry(self) -> dict[str, Any]:
        """What it is, for result.json."""
        return {"simulator": self.title}

    def check_comparable(self) -> None:
        """Raise a `SettingError` if its walks cannot be compared: by default they can."""
        return


@dataclass(frozen=True)
class FunctionSimulator(Simulator):
    """A function of a foot as a simulator.

    Parameters
    ----------
    function : callable
        From a `Foot` to what it measures by name, or to the reason why it does not walk. It has to be in a
        module for processes to find it. One thread calls it.
    quantities : sequence of str
        Names of these values: objectives of `footopt.walk.objectives`, the paper's five or others.
    """

    function: Callable[[Foot], Mapping[str, float] | str] = field(compare=False)
    quantities: tuple[str, ...] = ()
    title: str = ""

    def __post_init__(self) -> None:
        check(callable(self.function), "function", self.function, "a function of a Foot")
        check(not isinstance(self.quantities, str), "quantities", self.quantities, "a list of names")
        inner = getattr(self.function, "func", self.function)  # of a partial function
        name = getattr(inner, "__qualname__", type(inner).__qualname__)
        object.__setattr__(self, "title", name.replace("_", " "))
        object.__setattr__(self, "quantities", tuple(self.quantities))

    def walk(
        self, feet: Sequence[Foot], accuracy: Accuracy, threads: int | None = None, names: Sequence[str] = ()
    ) -> Walked:
        """Call the function for each foot."""
        raw, reasons = np.full((len(feet), len(self.quantities)), np.nan), []
        for row, foot in zip(raw, feet, strict=True):
            try:
                found = self.function(foot)
            except FootoptError as error:  # of a foot that it made of this one
                found = str(error)
            if isinstance(found, str):
                reasons.append(found or "failed")
                continue
            if not isinstance(found, Mapping):  # of one foot, perhaps: a search leaves it out
                raise TypeError(f"{self.title} returned {found!r}, not values by name, or a reason")
            if lacking := [name for name in self.quantities if name not in found]:
                raise SettingError("quantities", ", ".join(lacking), f"made of {', '.join(found)}")
            row[:] = [found[name] for name in self.quantities]
            reasons.append("" if np.isfinite(row).all() else "a value is not finite")
        return Walked(raw, np.array(reasons, np.str_), np.ones(len(feet), np.int64))

    def own(self) -> tuple[Any, ...]:
        """The function."""
        return (self.function,)
