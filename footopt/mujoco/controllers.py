"""Controllers of a robot: a gait that servos follow, a table of commands over time, or a function."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any, ClassVar, TypeAlias

import numpy as np

from footopt.arrays import Array
from footopt.errors import check
from footopt.gait import Gait

#: Joints of a leg in `Gait.angles`: hip, knee and ankle turn by the angles between their links.
JOINTS = ("hip", "knee", "ankle")
SIDES = ("left", "right")
#: Names of joints by side; those of the biped that comes with footopt are the same.
LEGS = tuple(f"{side}_{joint}" for side, joint in product(SIDES, JOINTS))


@dataclass(frozen=True)
class Tracker:
    """Servos whose joints follow a gait.

    Every joint needs one position servo, an actuator with a gain and a bias of -gain times its angle
    (MuJoCo's ``position``, with a gear of 1). The command of a servo with damping is corrected for the rate
    of the gait, so that it damps only the rate of the error.

    Parameters
    ----------
    gait : Gait
        Its first stance begins at `Gait.start`, before which the robot stands.
    joints : mapping of str to str
        By name of the model's joint: "left_hip", "right_knee" and so on, with a minus before it where the
        joint turns the other way (a hip is positive forward, a knee bent backward is negative, an ankle
        is positive toe up). Actuators of joints that are left out get the command 0.

    Raises
    ------
    SettingError
        A joint is not one of `LEGS`.
    """

    gait: Gait = field(default_factory=Gait.human)
    joints: Mapping[str, str] = field(default_factory=lambda: dict(zip(LEGS, LEGS, strict=True)), hash=False)

    def __post_init__(self) -> None:
        for name, angle in self.joints.items():
            check(angle.removeprefix("-") in LEGS, f"robot.joints.{name}", angle, f"one of {', '.join(LEGS)}")

    @property
    def duration(self) -> float:
        """Two strides after the start, s."""
        return self.gait.start + 2.0 * self.gait.period

    def angles(self, name: str, t: Array) -> tuple[Array, Array]:
        """A joint's angles, rad, and their rates, rad/s, at times t (T,)."""
        (thigh, thigh_rate), (shank, shank_rate), (pitch, pitch_rate) = self.gait.angles(t)
        angle = self.joints[name]
        side, joint = angle.removeprefix("-").split("_")
        links, rates = (0.0, thigh, shank, pitch), (0.0, thigh_rate, shank_rate, pitch_rate)
        i, foot, sign = JOINTS.index(joint), SIDES.index(side), -1.0 if angle.startswith("-") else 1.0
        turned, rate = (sign * np.asarray(of[i + 1] - of[i])[:, foot] for of in (links, rates))
        return turned, rate

    def joints_of(self, model: Any) -> dict[int, str]:
        """The names of the joints, by the number of the actuator that turns each."""
        found, names = {}, [model.joint(i).name for i in range(model.njnt)]
        for name in self.joints:
            check(name in names, "robot.joints", name, f"a joint of the model: {', '.join(names)}")
            own = (model.actuator_trntype == 0) & (model.actuator_trnid[:, 0] == names.index(name))
            acts = np.flatnonzero(own)
            stiffness = (model.actuator_gainprm[i, 0] + model.actuator_biasprm[i, 1] for i in acts)
            kinds = zip(model.actuator_biastype[acts], model.actuator_gear[acts, 0], stiffness, strict=True)
            allowed = "turned by one position servo with a gear of 1"
            check([*kinds] == [(1, 1, 0)], "robot.joints", name, allowed, "Or take a controller of your own.")
            found[int(acts[0])] = name
        return found

    def commands(self, model: Any, t: Array) -> Array:
        """Commands to the actuators at times t, (T, nu)."""
        table = np.zeros((len(t), model.nu))
        for act, name in self.joints_of(model).items():
            angle, rate = self.angles(name, t)
            gain, damping = model.actuator_gainprm[act, 0], -model.actuator_biasprm[act, 2]
            table[:, act] = angle + damping / gain * rate
        return table

    def targets(self, model: Any, t: Array) -> dict[int, Array]:
        """Where joints should be at times t, rad, (T,) each, by actuator."""
        return {act: self.angles(name, t)[0] for act, name in self.joints_of(model).items()}


@dataclass(frozen=True, eq=False)
class Commands:
    """A table of commands to actuators over time, linear between its rows and repeated after the last.

    Parameters
    ----------
    t : (T,), s
        From 0 on.
    table : mapping of str to (T,)
        By name of the actuator. Actuators that are not in it get the command 0.
    """

    t: Array
    table: Mapping[str, Array]

    def __post_init__(self) -> None:
        t = np.asarray(self.t, float)
        rising = t.ndim == 1 and len(t) > 1 and t[0] == 0.0 and bool(np.all(np.diff(t) > 0.0))
        check(rising, "commands.t", self.t, "two times or more that rise from 0, in s")
        object.__setattr__(self, "t", t)
        object.__setattr__(self, "table", {n: np.asarray(v, float) for n, v in self.table.items()})
        for name, values in self.table.items():
            good = values.shape == t.shape and bool(np.isfinite(values).all())
            check(good, f"commands.{name}", values, f"{len(t)} finite numbers, one for each time")

    @property
    def duration(self) -> float:
        """Until the table's end, s."""
        return float(self.t[-1])

    def commands(self, model: Any, t: Array) -> Array:
        """Commands to the actuators at times t, (T, nu)."""
        names, table = [model.actuator(i).name for i in range(model.nu)], np.zeros((len(t), model.nu))
        for name, values in self.table.items():
            check(name in names, "commands", name, f"an actuator of the model: {', '.join(names)}")
            table[:, names.index(name)] = np.interp(t % self.t[-1], self.t, values)
        return table


@dataclass(frozen=True, eq=False)
class FunctionController:
    """A function of (model, data) that sets ``data.ctrl`` once in each time step of the model.

    It is slow, as all Python. Walks on several threads call it, and it may keep nothing between calls.
    """

    function: Callable[[Any, Any], object] = field(compare=False)  # a store keeps its name and its source
    name: str = field(default="", init=False)
    duration: ClassVar[float | None] = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", getattr(self.function, "__qualname__", repr(self.function)))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FunctionController) and self.function == other.function

    def __hash__(self) -> int:
        return hash(self.function)


Controller: TypeAlias = Tracker | Commands | FunctionController
