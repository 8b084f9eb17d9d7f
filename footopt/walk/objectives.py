"""The objectives of a walk: the paper's five, its scalar J_W, and a few more by name.

Each objective is one function of the raw results of the compiled loop (`metrics.RAW`), in natural
signs: a distance is large when it is good, a power small. `FootProblem.minimised` turns them for solvers.
Other quantities are measured in plain Python, a foot or a whole walk at a time: `measure`.
"""

import math
from collections import ChainMap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

import numpy as np

from footopt.arrays import Array
from footopt.errors import check, check_free, is_number
from footopt.sand.law import EARTH
from footopt.walk.metrics import RAW
from footopt.walk.simulator import Simulator

Function = TypeVar("Function", bound=Callable[..., Any])

#: Floors of the factors in J_W's denominator for a walker of human size: 1 J, 1 W, 1e-3 m/s.
FLOORS = {"work": 1.0, "peak_power": 1.0, "speed_loss": 1e-3}
LENGTH = 1e-3  # m: errors of distance and height are relative to it at least, for a walker of human size
HUMAN = (60.0 * EARTH, 0.47 + 0.45, EARTH)  # weight, N, legs, m, gravity, m/s^2

#: The raw results of a batch by name (`metrics.RAW`), each (designs,).
Raw = Mapping[str, Array]


def by_name(raw: Array, quantities: Sequence[str] = RAW) -> Raw:
    """The columns of raw results (designs, quantities) by name."""
    return dict(zip(quantities, raw.T, strict=True))


@dataclass(frozen=True)
class Objective:
    """A number by which a walk is evaluated.

    Parameters
    ----------
    name, symbol, unit : for settings, figures and tables; the symbol is in matplotlib's mathtext.
    maximise : whether large is good.
    worst : a finite value, in natural sign, for a failed walk inside an optimiser.
    value : from the raw results (designs, ...) and the scene to (designs,); or from a `Foot` or a `Walk`
        to a number.
    of : "raw", "foot" or "walk": what `value` takes.
    least : the smallest possible value: no smaller limit can be kept.
    """

    name: str
    symbol: str
    unit: str
    maximise: bool
    worst: float
    value: Callable[..., Any]
    of: str = "raw"
    least: float = -math.inf

    @property
    def sign(self) -> float:
        """The factor that turns a value into one that is minimised: 1 or -1."""
        return -1.0 if self.maximise else 1.0

    def check_limit(self, setting: str, limit: Any) -> None:
        """Raise a `SettingError` for a limit that is no finite number, or that no walk could keep."""
        least = -math.inf if self.maximise else self.least
        number = float(limit) if is_number(limit) else math.nan
        allowed = "a number" + (f" >= {least:g}" if math.isfinite(least) else "")
        check(math.isfinite(number) and number >= least, setting, limit, allowed)

    @property
    def label(self) -> str:
        """Axis label with its unit."""
        return f"{self.name.replace('_', ' ')} {self.symbol}" + (f" ({self.unit})" if self.unit else "")


#: By name: those that cost nothing beside the walk, which every table shows.
OBJECTIVES: dict[str, Objective] = {}
#: By name: those that are measured in Python, only where they are asked for.
SLOW: dict[str, Objective] = {}
#: All of them.
MEASURES: Mapping[str, Objective] = ChainMap(SLOW, OBJECTIVES)


def measure(
    of: str, symbol: str, unit: str, maximise: bool, worst: float, least: float = -math.inf
) -> Callable[[Function], Function]:
    """Register a function as the measure of its name.

    A function of a `Foot` or a `Walk` is plain Python, and slow: one foot at a time, in one thread.

    Parameters
    ----------
    of : str
        "foot" or "walk", which the function takes; or "raw": raw results and the scene.
    symbol, unit, maximise, worst, least
        As in `Objective`.
    """
    check(of in ("raw", "foot", "walk"), "of", of, "one of raw, foot, walk")
    where = OBJECTIVES if of == "raw" else SLOW

    def register(value: Function) -> Function:
        check_free(value.__name__, (taken := MEASURES.get(value.__name__)) and taken.value, value)
        where[value.__name__] = Objective(value.__name__, symbol, unit, maximise, worst, value, of, least)
        return value

    return register


objective = partial(measure, "raw")


@dataclass(frozen=True)
class Quantity:
    """A raw result as it is."""

    name: str

    def __call__(self, raw: Raw, scene: Simulator) -> Array:
        return raw[self.name]


def quantity(
    name: str, symbol: str, unit: str, maximise: bool, worst: float, least: float = -math.inf
) -> None:
    """Register a raw result as an objective; see `measure`."""
    OBJECTIVES[name] = Objective(name, symbol, unit, maximise, worst, Quantity(name), least=least)


# Forward travel of the COM, x(t_f) - x(0), m. The paper maximises x_COM(t_f) "for a certain period t_f"
# without giving t_f; the default here is two strides after the start (2.9 s), which shows the three switches
# that it names.
quantity("distance", r"$x_{\mathrm{COM}}(t_f)$", "m", maximise=True, worst=0.0)

# Mean height of the COM over [0, t_f], m: the paper's measure of sinkage. The height is above the
# undisturbed sand, with the stepper's own quadrature.
quantity("mean_height", r"$\bar z_{\mathrm{COM}}$", "m", maximise=True, worst=0.0)

# |W(t_f)|, W the time integral of sum f.v over all plates of both feet, J (the paper's eq. 7). The force is
# that of the sand on the plates, so W is negative: what the walker must compensate.
quantity("work", "$|W(t_f)|$", "J", maximise=False, worst=1e6, least=0.0)

# Largest |sum f.v| of one foot at any instant from the first heel strike to t_f, W. The paper says "during a
# single-stance walking phase" and sums over the plates of a foot; it leaves open whether the double stance
# counts. Here it does. Between steps the peak is that of a parabola through three samples.
quantity("peak_power", r"$p_{\max}$", "W", maximise=False, worst=1e6, least=0.0)

# Largest fall of the forward COM speed below its running maximum, m/s. From the first heel strike to t_f:
# max over s <= t of V_x(s) - V_x(t). The paper asks not to "lose too much forward velocity when the walker
# switches the stance legs" and gives no definition; this one has no inner window whose edge could set the
# value. Extremes between steps are those of the cubic Hermite interpolant.
quantity("speed_loss", r"$\Delta V_x$", "m/s", maximise=False, worst=1e3, least=0.0)


@objective("$J_W$", "", maximise=False, worst=0.0)
def efficiency(raw: Raw, scene: Simulator) -> Array:
    """J_W = -(distance * mean height) / (|W| p_max dV_x), the paper's eqs. 9-10; most negative is best.

    Factors of the denominator are floored (`floors`), so that a walk that loses nothing is not
    infinitely good. The unit is m^2 / (J W m/s), which the paper does not state.
    """
    cost = math.prod(np.maximum(raw[name], floor) for name, floor in floors(scene).items())
    return -(raw["distance"] * raw["mean_height"]) / cost


@objective("CoT", "", maximise=False, worst=1e6, least=0.0)
def cost_of_transport(raw: Raw, scene: Simulator) -> Array:
    """Work / (M g distance): the sand's |W| on massless legs, a robot's joint work.

    NaN for a walker that does not get forward.
    """
    forward = np.where(raw["distance"] > 1e-12, raw["distance"], np.nan)
    return raw[scene.transport] / (raw.get("weight", scene.weight) * forward)


# Positive work of the joints, J. Of massless legs the integral of the positive part of P_joint = -sum
# f.(v_plate - v_COM) of each leg, summed; of a robot that of torque times speed of each actuator.
quantity("joint_work", r"$W^+_{\mathrm{joint}}$", "J", maximise=False, worst=1e6, least=0.0)

# Depth of the sole's deepest point below the sand at any step, m.
quantity("maximum_sinkage", r"$z_{\max}$", "m", maximise=False, worst=1e3, least=0.0)

# Largest vertical force of both feet together, N; between steps that of a parabola, as for the power.
quantity("peak_vertical_force", r"$F_{z,\max}$", "N", maximise=False, worst=1e9, least=0.0)

# Root of the mean square by which a robot's servos miss their commands, over time and joints, rad.
quantity("tracking_error", r"$e_{\mathrm{track}}$", "rad", maximise=False, worst=1e3, least=0.0)

# Largest torque of any actuator of a robot at any step, N m (N of one that slides).
quantity("torque", r"$\tau_{\max}$", "N m", maximise=False, worst=1e9, least=0.0)

# How long a robot walks before it falls, s: known of walks that fail, too.
quantity("survival", r"$t_{\mathrm{fall}}$", "s", maximise=True, worst=0.0)

#: The paper's objectives, in the order of every table.
FIVE = ("distance", "mean_height", "work", "peak_power", "speed_loss")


def sizes(values: Array, simulator: Simulator | None = None) -> Array:
    """Sizes that errors of the `FIVE` (walks, objectives) are relative to: `floors`, `shortest` at least."""
    least = floors(simulator) if simulator else FLOORS
    length = shortest(simulator) if simulator else LENGTH
    return np.maximum(np.abs(values), [least.get(name, length) for name in FIVE])


def shortest(simulator: Simulator) -> float:
    """`LENGTH`, m; of a walker smaller than a human in proportion to its legs."""
    return LENGTH * _part_of_human(simulator)[0]


def floors(simulator: Simulator) -> dict[str, float]:
    """`FLOORS`; where M g l, M g sqrt(g l) and sqrt(g l) are less than a human's, in proportion to them."""
    _, *parts = _part_of_human(simulator)
    return {name: floor * part for (name, floor), part in zip(FLOORS.items(), parts, strict=True)}


def _part_of_human(simulator: Simulator) -> list[float]:
    """Units of length, energy, power and speed of what walks over those of a human, 1 at most."""
    own, human = (
        (legs, weight * legs, weight * math.sqrt(g * legs), math.sqrt(g * legs))
        for weight, legs, g in ((simulator.weight, simulator.legs, simulator.g), HUMAN)
    )
    return [min(1.0, one / other) for one, other in zip(own, human, strict=True)]  # 1 where it is not known


def relative_change(values: Array, base: Array) -> Array:
    """values / base - 1, and 0 where both are equal: a walker that never brakes loses no speed in either."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(values == base, 0.0, values / base - 1.0)


def gain_shares(
    values: Mapping[str, float], base: Mapping[str, float], least: Mapping[str, float] = FLOORS
) -> dict[str, float]:
    """Each factor's share in the gain of J_W over a base design; they sum to 1.

    ln(J_W / J_W_base) is the sum of the factors' log gains. A negative share is a factor that got
    worse. NaN where there is no gain to share: J_W is no better than that of the base. `least`: `floors`.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        log, log_base = (
            np.log([max(one[n], least.get(n, -math.inf)) for n in FIVE]) for one in (values, base)
        )
    parts = (log_base - log) * [OBJECTIVES[name].sign for name in FIVE] + 0.0  # + 0.0 turns -0 into 0
    shares = parts / parts.sum() if parts.sum() > 0.0 else np.full(len(FIVE), np.nan)
    return dict(zip(FIVE, shares.tolist(), strict=True))


def offered(simulator: Simulator) -> tuple[str, ...]:
    """Names of the measures that a simulator's walks have: those whose quantities it gives."""
    return tuple(name for name, o in MEASURES.items() if not lacking(o, simulator))


def lacking(o: Objective, simulator: Simulator) -> str:
    """What a simulator does not give that an objective takes: a quantity, or a part such as its walker."""
    try:
        if o.of == "raw":
            shape = np.shape(o.value({name: np.ones(1) for name in simulator.quantities}, simulator))
            check(shape == (1,), o.name, f"of shape {shape}", "of shape (designs,)")
    except KeyError as why:
        return f"the quantity {why}"
    except Exception as why:  # of a user's own, too
        return f"{type(why).__name__}: {why}"
    return "a trace" if o.of == "walk" and type(simulator).trace is Simulator.trace else ""


def lookup(names: Sequence[str], simulator: Simulator | None = None) -> list[Objective]:
    """Objectives by name, in that order; of those that a simulator offers."""
    lacks = {
        name: lacking(MEASURES[name], simulator) if simulator else "" for name in names if name in MEASURES
    }
    if not names or any(lacks.get(name, name) for name in names):  # a list of all takes a millisecond
        known = tuple(MEASURES) if simulator is None else offered(simulator)
        check(names, "objective.names", list(names), f"one or more of {', '.join(known)}")
        for name in names:
            lack = f"{name} lacks {lacks[name]}" if lacks.get(name) else ""
            check(name in known, "objective.names", name, f"made of {', '.join(known)}", lack)
    check(len(set(names)) == len(names), "objective.names", list(names), "free of repetitions")
    return [MEASURES[name] for name in names]
