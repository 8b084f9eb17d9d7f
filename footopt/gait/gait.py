"""The gait: joint angles over a stride as Fourier series, and the ankle path they imply.

Angles (the data in degrees, everything here in rad): thigh from the vertical, + knee ahead of the
hip; knee, + flexion; shank = thigh - knee; pitch of the foot, + toe up. With thigh length l1 and
shank length l2 the ankle, relative to the hip, is at

    x = l1 sin(thigh) + l2 sin(shank),   z = -l1 cos(thigh) - l2 cos(shank)

Phase 0 is the heel strike of the same leg; the other leg is half a stride ahead.
"""

import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from footopt.arrays import Array
from footopt.errors import SettingError, check, check_whole
from footopt.gait import start
from footopt.gait.fourier import Fourier

Angle = tuple[Array, Array]  # and its rate

LEFT, RIGHT = 0, 1
HUMAN = Path(__file__).parent / "data" / "human_walk.json"
HARMONICS = 6  # of the series by default
JOINTS = ("thigh", "knee", "foot")


class Pose(NamedTuple):
    """Where both feet are relative to the hip; every array is (times, 2 feet), left foot first."""

    x: Array  # of the ankle, forwards, m
    z: Array  # of the ankle, upwards, m
    vx: Array  # m/s
    vz: Array  # m/s
    pitch: Array  # of the foot, rad
    rate: Array  # of the pitch, rad/s

    def table(self) -> Array:
        """The pose as the kernels read it: (times, 2, 7) = x, z, vx, vz, cos, sin, rate."""
        columns = (self.x, self.z, self.vx, self.vz, np.cos(self.pitch), np.sin(self.pitch), self.rate)
        return np.ascontiguousarray(np.stack(columns, axis=-1))


@dataclass(frozen=True)
class Gait:
    """A walk from standing: cyclic joint angles and how they begin (`footopt.gait.start`).

    Parameters
    ----------
    thigh : Fourier
        Angle over a stride from the vertical, + knee ahead of the hip.
    knee : Fourier
        Flexion over a stride.
    foot : Fourier, optional
        Measured pitch of the foot, + toe up.
    period : float, s
        Duration of a stride.
    pitch : str
        "shank" (the foot turns with the shank, as in the paper) or "measured".
    start : float, s
        Time at which the walker begins to move; infinity for standing still.
    name : str
        For tables and figures.
    source : str
        Where the data come from.
    residual : tuple of (str, float), deg
        By joint, the rms misfit of the series against the curve it was fitted to.
    """

    thigh: Fourier = field(repr=False)
    knee: Fourier = field(repr=False)
    foot: Fourier | None = field(default=None, repr=False)
    period: float = 1.2
    pitch: str = "shank"
    start: float = 0.5
    name: str = "custom"
    source: str = field(default="", compare=False)  # where a file lies changes no walk
    residual: tuple[tuple[str, float], ...] = ()

    def __post_init__(self) -> None:
        check(1e-3 <= self.period <= 1e3, "gait.period", self.period, "a time from 0.001 to 1000, in s")
        allowed = "a time >= 0 and <= 1e5, in s (.inf: stand still)"
        check(0 <= self.start <= 1e5 or self.start == math.inf, "gait.start", self.start, allowed)
        check(self.pitch in ("shank", "measured"), "gait.pitch", self.pitch, "shank or measured")
        if self.pitch == "measured" and self.foot is None:
            raise SettingError("gait.pitch", "measured", "shank: this gait has no measured pitch of the foot")
        finite = all(np.isfinite([s.a0, *s.a, *s.b]).all() for s in self.series.values())
        check(finite, "gait", self.name, "made of finite coefficients")

    @classmethod
    def human(
        cls, period: float = 1.2, harmonics: int = HARMONICS, pitch: str = "shank", start: float = 0.5
    ) -> Self:
        """Human walking at 1.03 m/s: Fukuchi, Fukuchi & Duarte, PeerJ 6:e4640 (2018), CC BY 4.0."""
        data = json.loads(HUMAN.read_text(encoding="utf-8"))
        most = len(data["thigh"]["a"])
        check_whole(harmonics, "gait.harmonics", 1, most, "These are the harmonics of the data.")
        thigh, knee, foot = (
            Fourier(data[j]["a0"], *(tuple(data[j][terms][:harmonics]) for terms in "ab")) for j in JOINTS
        )
        misfit = data["rms_residual_deg_by_harmonics"].get(str(harmonics), {})
        source, residual = data["source"], tuple(misfit.items())
        return cls(thigh, knee, foot, period, pitch, start, "human", source, residual)

    @property
    def series(self) -> dict[str, Fourier]:
        """The joints' series by name: thigh, knee and perhaps foot."""
        return {name: joint for name in JOINTS if (joint := getattr(self, name)) is not None}

    @property
    def heel_strike(self) -> float:
        """Time of the first heel strike (the right foot's), s; infinite when standing still."""
        return self.start + self.period / 2.0

    def heel_strikes(self, t_f: float) -> Array:
        """Times of all heel strikes up to t_f, right foot first, s."""
        if self.heel_strike > t_f:
            return np.empty(0)
        steps = math.floor((t_f - self.heel_strike) / (self.period / 2.0) + 1e-9) + 1
        return self.heel_strike + np.arange(steps, dtype=np.float64) * (self.period / 2.0)

    def cycle(self, phase: ArrayLike) -> tuple[Angle, Angle, Angle]:
        """Thigh, shank and pitch of the steady walk: each an angle (rad) and its rate (rad/stride)."""
        p = np.asarray(phase, float)
        (thigh, thigh_rate), (knee, knee_rate) = self.thigh.at(p), self.knee.at(p)
        shank = thigh - knee, thigh_rate - knee_rate
        if self.pitch == "measured" and self.foot is not None:
            return (thigh, thigh_rate), shank, self.foot.at(p)
        return (thigh, thigh_rate), shank, shank

    def angles(self, t: ArrayLike) -> tuple[Angle, Angle, Angle]:
        """Thigh, shank and pitch at times t (T,): each angles (T, 2 feet), rad, and rates, rad/s."""
        phase, phase_rate, w, w_rate = start.ramp(np.asarray(t, float), self.start, self.period)
        joints = []
        for stand, (angle, rate) in zip(start.STANDING, self.cycle(phase), strict=True):
            joints.append(((1.0 - w) * stand + w * angle, w_rate * (angle - stand) + w * rate * phase_rate))
        return joints[0], joints[1], joints[2]

    def pose(self, t: ArrayLike, l1: float, l2: float) -> Pose:
        """Both feet relative to the hip at times t (T,), for leg segments l1, l2 (m)."""
        (thigh, thigh_rate), (shank, shank_rate), (pitch, rate) = self.angles(t)
        return Pose(*ankle(thigh, thigh_rate, shank, shank_rate, l1, l2), pitch, rate)


def ankle(
    thigh: Array, thigh_rate: Array, shank: Array, shank_rate: Array, l1: float, l2: float
) -> tuple[Array, Array, Array, Array]:
    """Position (m) and velocity (m/s) of the ankle relative to the hip: x, z, vx, vz.

    Angles are in rad, their rates in rad/s, and the leg's segments l1 and l2 in m.
    """
    st, ct, ss, cs = np.sin(thigh), np.cos(thigh), np.sin(shank), np.cos(shank)
    x, z = l1 * st + l2 * ss, -l1 * ct - l2 * cs
    return x, z, l1 * ct * thigh_rate + l2 * cs * shank_rate, l1 * st * thigh_rate + l2 * ss * shank_rate
