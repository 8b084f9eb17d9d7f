"""How finely a scene is simulated: numerical parameters (`Accuracy`), or an allowed error (`Tolerance`)."""

import math
from dataclasses import dataclass, replace
from typing import Any, Self, TypeAlias

from footopt.errors import check, check_number, check_whole
from footopt.foot.plates import RULES
from footopt.walk.steppers import STEPPERS

LEAST_DT = 1e-9  # s
LEAST = 1e-12  # m/s, of a creep speed and of a step's control
MOST_PLATES = 40_000  # 6.5 um each: the finest rung of a ladder, refined twice


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
        Name of the preset.
    rule : str
        How plates are laid, a name in `foot.plates.RULES`: "chord" as in the paper, or "arc", which
        needs fewer for the same error.
    control : float, m/s, optional
        The largest estimated error of the hip's velocity in one step: a step beyond it is halved, six
        times at most; dt is the longest step. None: all steps are equally long.
    tolerance : float, optional
        The relative error that these parameters were found for (`Tolerance`).

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
    tolerance: float | None = None

    def __post_init__(self) -> None:
        check(self.rule in RULES, "accuracy.rule", self.rule, f"one of {', '.join(RULES)}")
        steppers = f"one of {', '.join(STEPPERS)}"
        check(self.stepper in STEPPERS, "accuracy.stepper", self.stepper, steppers)
        check_number("accuracy.dt", self.dt, LEAST_DT, 1.0, "a time step from 1e-9 to 1, in s")
        check_whole("accuracy.plates", self.plates, 2, MOST_PLATES, "The paper's is 100.")
        speed, hint = "a speed from 1e-12 to 1, in m/s", "At zero speed the law is set-valued. Try 1e-4."
        check_number("accuracy.creep", self.creep, LEAST, 1.0, speed, hint)
        if self.control is not None:
            check_number("accuracy.control", self.control, LEAST, 1.0, f"null, or {speed}", "Try 1e-4.")

    def refined(self, times: int = 1) -> Self:
        """Half the time step (under control an eighth of it), twice the plates, half the creep speed.

        Parameters
        ----------
        times : int
            How many times.
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


@dataclass(frozen=True)
class Tolerance:
    """An accuracy as an allowed error: `footopt.walk.ladder` finds the parameters that each scene needs.

    Parameters
    ----------
    error : float
        Largest relative error of the worst objective. docs/evidence/accuracy.md has how often it is met.
    name : str
        Name of the preset.
    stepper, rule : str
        As in `Accuracy`.
    dt, plates, creep, control : optional
        Parameters of `Accuracy` that are set by hand; the others are found.
    refinements : int
        How many times the parameters that were found are refined (`Accuracy.refined`): twice for a reference.

    Raises
    ------
    SettingError
        A name is not known, or a number is not allowed.
    """

    error: float = 0.005
    name: str = "custom"
    stepper: str = "sdirk2"
    rule: str = "arc"
    dt: float | None = None
    plates: int | None = None
    creep: float | None = None
    control: float | None = None
    refinements: int = 0

    def __post_init__(self) -> None:
        hint = "Use accuracy=reference, or set dt, plates and creep by hand."
        check_number("accuracy.tolerance", self.error, 1e-5, 0.5, "a number from 1e-5 to 0.5", hint)
        Accuracy(self.stepper, rule=self.rule, **self.by_hand)  # which checks them

    @property
    def by_hand(self) -> dict[str, Any]:
        """The parameters that are set by hand."""
        names = ("dt", "plates", "creep", "control")
        return {name: value for name in names if (value := getattr(self, name)) is not None}


AnyAccuracy: TypeAlias = Accuracy | Tolerance

#: Cost of an evaluation of the contact without its plates, in plates.
EVALUATION = 50.0


def work(evaluations: Any, plates: Any) -> Any:
    """The cost of walks on any machine, in evaluations of a plate, from their counts."""
    return EVALUATION * evaluations + plates


#: Accuracies by name; "reference" is converged for every purpose but a study of convergence.
PRESETS: dict[str, Tolerance] = {
    "draft": Tolerance(0.02, "draft"),
    "standard": Tolerance(0.005, "standard"),
    "fine": Tolerance(0.0005, "fine"),
    "reference": Tolerance(0.0005, "reference", refinements=2),
}

FINER = "finer"

#: Tolerances of the presets that promise one.
TOLERANCES = {name: preset.error for name, preset in PRESETS.items() if not preset.refinements}


def resolve(accuracy: AnyAccuracy | str, setting: str = "accuracy") -> AnyAccuracy:
    """An accuracy, given itself or a preset's name; `setting` is what gave it."""
    if isinstance(accuracy, str):
        check(accuracy in PRESETS, setting, accuracy, f"one of {', '.join(PRESETS)}")
        return PRESETS[accuracy]
    kinds = "an Accuracy, a Tolerance, or a preset's name"
    check(isinstance(accuracy, (Accuracy, Tolerance)), setting, accuracy, kinds, 'Try "standard"')
    return accuracy


def confirming(name: str, accuracy: AnyAccuracy) -> AnyAccuracy:
    """The accuracy at which finalists are evaluated again: a preset by its name, or `FINER`.

    Finer is the preset with the next smaller tolerance, and "fine" for parameters set by hand.
    """
    if name != FINER:
        return resolve(name, "study.confirm")
    finer = [p for p in PRESETS.values() if isinstance(accuracy, Tolerance) and p.error < accuracy.error]
    return max(finer, key=lambda preset: preset.error, default=PRESETS["fine"])
