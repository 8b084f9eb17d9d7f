"""How finely a scene is simulated: `Accuracy`, the presets, and the table that they are chosen from."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from footopt.errors import SettingError, check, check_kind, check_whole
from footopt.foot.plates import RULES
from footopt.walk.steppers import STEPPERS

LEAST_DT = 1e-9  # s
LEAST = 1e-12  # m/s, of a creep speed and of a step's control
MOST_PLATES = 20_000  # 13 um each; beyond 1000 no objective changes by 1e-5


@dataclass(frozen=True)
class Accuracy:
    """How finely a scene is simulated.

    Parameters
    ----------
    stepper : str
        The method of integration, a name in `footopt.walk.steppers.STEPPERS`.
    dt : float, s
        Largest time step of the walk (`footopt.walk.discretize.time_grid`).
    plates : int
        N, plates along the sole.
    creep : float, m/s
        eps: h = v / sqrt(|v|^2 + eps^2) smooths the law's jump at v = 0.
    name : str
        Of the preset, for tables.
    rule : str
        How plates are laid, a name in `foot.plates.RULES`: "chord" as in the paper, or "arc", which
        needs fewer for the same error.
    control : float, m/s, optional
        The largest estimated error of the hip's velocity in one step: a step beyond it is halved, three
        times at most, and dt is the longest. None: all steps are as long.
    adapt : bool
        Whether these numbers are for the paper's walk and others are to follow from a scene
        (`footopt.walk.adapt`): so it is of the presets.

    Raises
    ------
    SettingError
        A name is not known, or a number is not allowed.
    """

    stepper: str = "sdirk2"
    dt: float = 5e-3
    plates: int = 64
    creep: float = 1e-4
    name: str = "custom"
    rule: str = "arc"
    control: float | None = None
    adapt: bool = False

    def __post_init__(self) -> None:
        if self.rule not in RULES:
            raise SettingError("accuracy.rule", self.rule, f"one of {', '.join(RULES)}")
        if self.stepper not in STEPPERS:
            raise SettingError("accuracy.stepper", self.stepper, f"one of {', '.join(STEPPERS)}")
        check(LEAST_DT <= self.dt <= 1.0, "accuracy.dt", self.dt, "a time step from 1e-9 to 1, in s")
        check_whole(self.plates, "accuracy.plates", 2, MOST_PLATES, "The paper's is 100.")
        check(
            LEAST <= self.creep <= 1.0,
            "accuracy.creep",
            self.creep,
            "a speed from 1e-12 to 1, in m/s",
            "At zero speed the law is set-valued; 1e-4 changes the distance by 0.002 %.",
        )
        check(
            self.control is None or LEAST <= self.control <= 1.0,
            "accuracy.control",
            self.control,
            "null, or a speed from 1e-12 to 1, in m/s",
            "Try 1e-4.",
        )

    @classmethod
    def named(cls, name: str) -> Accuracy:
        """One of `PRESETS`."""
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
        tolerance : float
            Relative error of the worst objective for 95 % of random feet inside the box, on soft,
            regular and hard sand, against the limit of small steps and many plates.
        """
        table = [row for row in measured_settings() if row["control"] is not None]
        rows = [row for row in table if row["error"] <= MARGIN * tolerance]
        if not rows:
            best = math.ceil(1e6 * min(row["error"] for row in table) / MARGIN) / 1e6
            raise SettingError(
                "accuracy.tolerance",
                tolerance,
                f"at least {best:g}, the best that was measured",
                "Use accuracy=reference, or set dt and plates by hand.",
            )
        row = min(rows, key=work)
        setting = {name: row[name] for name in ("stepper", "dt", "plates", "creep", "rule", "control")}
        return cls(**setting, name=f"within {tolerance:g}", adapt=True)

    def refined(self, times: int = 1) -> Accuracy:
        """Half the time step (under control an eighth of it), twice the plates, half the creep speed.

        Parameters
        ----------
        times : int
            How often.
        """
        half = 0.5**times
        return replace(
            self,
            dt=max(half * self.dt, LEAST_DT),
            control=None if self.control is None else max(half**3 * self.control, LEAST),
            plates=min(2**times * self.plates, MOST_PLATES),
            creep=max(half * self.creep, LEAST),
            name="refined",
        )

    def steps(self, t_f: float) -> int:
        """Number of equal steps from 0 to t_f."""
        return max(1, math.ceil(t_f / self.dt - 1e-9))


#: Every setting's error, the largest on soft, regular and hard sand, and its cost, as once measured.
TABLE = Path(__file__).parent / "accuracy.csv"
TABLE_COLUMNS = (
    "stepper", "rule", "dt", "control", "plates", "creep", "error", "evaluations", "plate_evaluations", "ms",
)  # fmt: skip
#: Plates that take as long as what else is in an evaluation of the contact; the study measures it.
EVALUATION = 50.0


def work(row: Mapping[str, Any]) -> float:
    """The cost of a setting on any machine, in evaluations of a plate for each design.

    Parameters
    ----------
    row : mapping
        Of `measured_settings`.
    """
    return float(EVALUATION * row["evaluations"] + row["plate_evaluations"])


@lru_cache
def measured_settings() -> tuple[dict[str, Any], ...]:
    """Rows of the accuracy study: a setting, its error (a fraction), its work and ms per design and core."""
    kinds: tuple[Callable[[str], Any], ...]
    kinds = (str, str, float, lambda text: float(text) if text else None, int, *5 * (float,))
    with open(TABLE, newline="", encoding="utf-8") as file:
        return tuple(
            {name: kind(row[name]) for name, kind in zip(TABLE_COLUMNS, kinds, strict=True)}
            for row in csv.DictReader(file)
        )


#: The part of a tolerance that a setting may use: other feet of the same kind give another 95 %.
MARGIN = 0.7

#: Tolerances of the presets that are chosen from the table.
TOLERANCES = {"draft": 0.02, "standard": 0.005, "fine": 0.0005}

#: Accuracies by name; "reference" is converged for every purpose but a study of convergence.
PRESETS: dict[str, Accuracy] = {
    **{name: replace(Accuracy.within(value), name=name) for name, value in TOLERANCES.items()},
    "reference": Accuracy("sdirk2", 2e-4, 400, 1e-5, "reference", adapt=True),
}


def resolve(accuracy: Accuracy | str) -> Accuracy:
    """An accuracy, given itself or a preset's name."""
    found = Accuracy.named(accuracy) if isinstance(accuracy, str) else accuracy
    check_kind(found, Accuracy, "accuracy", 'Try "standard"')
    return found
