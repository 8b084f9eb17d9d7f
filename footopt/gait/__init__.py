"""The gait: joint angles over a stride as Fourier series, and the ankle path they imply.

Angles (the data in degrees, everything here in rad): thigh from the vertical, + knee ahead of the
hip; knee, + flexion; shank = thigh - knee; pitch of the foot, + toe up. With thigh length l1 and
shank length l2 the ankle, relative to the hip, is at

    x = l1 sin(thigh) + l2 sin(shank),   z = -l1 cos(thigh) - l2 cos(shank)

Phase 0 is the heel strike of the same leg; the other leg is half a stride ahead.

From standing to walking the phase starts at mid-stance and speeds up while the angles blend in (`ramp`).
A blend of the angles alone would drive the hip backwards; the phase ramp keeps it going forwards.
With r = T/2, S5(s) = 10 s^3 - 15 s^4 + 6 s^5 and I5 its integral,

    s = clip((t - t0)/r, 0, 1),  q = clip((t - t0)/(T/3), 0, 1)
    phase_left = 1/4 + I5(s)/2 until t = t0 + r, then 1/2 + (t - t0 - r)/T
    angles = (1 - w) standing + w cycle(phase),  w_left = S5(q), w_right = S5(s)

The left leg is in the cycle sooner because it carries the body; angles and rates are continuous for
every T. The paper's walker "first stands with the left leg steadily" and starts at 0.5 s.
"""

import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from footopt.arrays import Array
from footopt.errors import SettingError, check, check_kind, check_number, check_whole

Angle = tuple[Array, Array]  # and its rate

LEFT, RIGHT = 0, 1
HUMAN = Path(__file__).parent / "data" / "human_walk.json"
HARMONICS = 6  # of the series by default
JOINTS = ("thigh", "knee", "foot")
_LIFT = np.radians(20.0)
#: Thigh, shank and pitch (rad) when standing, each for the left and the right leg. The left leg is
#: straight; the right thigh and knee are bent by 20 deg: its foot is level and 2.8 cm higher.
STANDING = (np.array([0.0, _LIFT]), np.zeros(2), np.zeros(2))


class Fourier(NamedTuple):
    """theta(p) = a0 + sum_k a[k-1] cos(2 pi k p) + b[k-1] sin(2 pi k p), in degrees; p in strides."""

    a0: float
    a: tuple[float, ...]
    b: tuple[float, ...]

    @classmethod
    def fit(cls, phase: Array, degrees: Array, harmonics: int) -> Self:
        """The least-squares series through a curve, at phases (n,) in strides and angles (n,) in degrees."""
        w = 2.0 * np.pi * np.outer(phase, np.arange(1, harmonics + 1))
        design = np.concatenate([np.ones((len(phase), 1)), np.cos(w), np.sin(w)], axis=1)
        solution, *_ = np.linalg.lstsq(design, degrees, rcond=None)
        a0, *ab = map(float, solution)
        return cls(a0, tuple(ab[:harmonics]), tuple(ab[harmonics:]))

    def at(self, phase: Array, waves: list[tuple[Array, Array]] | None = None) -> Angle:
        """Angle (rad) and its derivative in the phase (rad per stride); `waves` keep what series share.

        These are the cosines and sines of multiples of 2 pi p, each by addition theorems from the one before.
        """
        value, rate, kept = np.full_like(phase, self.a0), np.zeros_like(phase), [] if waves is None else waves
        if not kept:
            kept.append((np.cos(2.0 * np.pi * phase), np.sin(2.0 * np.pi * phase)))
        for k, (a, b) in enumerate(zip(self.a, self.b, strict=True)):
            if k == len(kept):
                (c1, s1), (c, s) = kept[0], kept[-1]
                kept.append((c * c1 - s * s1, s * c1 + c * s1))
            c, s = kept[k]
            value += a * c + b * s
            rate += 2.0 * np.pi * (k + 1) * (b * c - a * s)
        return np.radians(value), np.radians(rate)


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
    """A walk from standing: cyclic joint angles and how they begin (`ramp`).

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
        check_number("gait.period", self.period, 1e-3, 1e3, "a time from 0.001 to 1000, in s")
        allowed = "a time >= 0 and <= 1e5, in s (.inf: stand still)"
        check(0 <= self.start <= 1e5 or self.start == math.inf, "gait.start", self.start, allowed)
        check(self.pitch in ("shank", "measured"), "gait.pitch", self.pitch, "shank or measured")
        if self.pitch == "measured" and self.foot is None:
            raise SettingError("gait.pitch", "measured", "shank: this gait has no measured pitch of the foot")
        check_kind("gait.thigh", self.thigh, Fourier, "fo.fit_gait makes a gait of angles.")
        check_kind("gait.knee", self.knee, Fourier, "fo.fit_gait makes a gait of angles.")
        for name, s in self.series.items():
            check(len(s.a) == len(s.b), f"gait.{name}", s, "a series with as many a as b")
            object.__setattr__(self, name, Fourier(s.a0, tuple(s.a), tuple(s.b)))
        finite = all(np.isfinite([s.a0, *s.a, *s.b]).all() for s in self.series.values())
        check(finite, "gait", self.name, "made of finite coefficients")

    @classmethod
    def human(
        cls, period: float = 1.2, harmonics: int = HARMONICS, pitch: str = "shank", start: float = 0.5
    ) -> Self:
        """Human walking at 1.03 m/s: Fukuchi, Fukuchi & Duarte, PeerJ 6:e4640 (2018), CC BY 4.0."""
        data = json.loads(HUMAN.read_text(encoding="utf-8"))
        most = len(data["thigh"]["a"])
        check_whole("gait.harmonics", harmonics, 1, most, "These are the harmonics of the data.")
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
        p, waves = np.asarray(phase, float), list[tuple[Array, Array]]()
        (thigh, thigh_rate), (knee, knee_rate) = self.thigh.at(p, waves), self.knee.at(p, waves)
        shank = thigh - knee, thigh_rate - knee_rate
        if self.pitch == "measured" and self.foot is not None:
            return (thigh, thigh_rate), shank, self.foot.at(p, waves)
        return (thigh, thigh_rate), shank, shank

    def angles(self, t: ArrayLike) -> tuple[Angle, Angle, Angle]:
        """Thigh, shank and pitch at times t (T,): each angles (T, 2 feet), rad, and rates, rad/s."""
        phase, phase_rate, w, w_rate = ramp(np.asarray(t, float), self.start, self.period)
        joints = []
        for stand, (angle, rate) in zip(STANDING, self.cycle(phase), strict=True):
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


def smooth_step(s: Array) -> tuple[Array, Array]:
    """S5 and its derivative: from 0 to 1 with two flat derivatives at each end."""
    return s**3 * (10.0 - 15.0 * s + 6.0 * s * s), 30.0 * s * s * (1.0 - s) ** 2


def ramp(t: Array, t0: float, period: float) -> tuple[Array, Array, Array, Array]:
    """Phase (strides), its rate, weight of the cycle and its rate at times t (T,), s, each (T, 2 feet).

    The walk starts at t0, s, infinity for standing still; a stride takes the period, s.
    """
    r = period / 2.0
    since = t - t0
    s, q = np.clip(since / r, 0.0, 1.0), np.clip(since / (period / 3.0), 0.0, 1.0)
    phase = 0.25 + 0.5 * s**4 * (2.5 - 3.0 * s + s * s) + np.maximum(since - r, 0.0) / period
    (w_right, right_rate), (w_left, left_rate) = smooth_step(s), smooth_step(q)
    phase_rate = w_right / period
    return (
        np.stack([phase, phase + 0.5], axis=-1),
        np.stack([phase_rate, phase_rate], axis=-1),
        np.stack([w_left, w_right], axis=-1),
        np.stack([left_rate / (period / 3.0), right_rate / r], axis=-1),
    )
