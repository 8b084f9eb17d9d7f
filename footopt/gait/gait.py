"""The gait: joint angles over a stride as Fourier series, and the ankle path they imply.

Angles (the data in degrees, everything here in rad): thigh from the vertical, + knee ahead of the
hip; knee, + flexion; shank = thigh - knee; pitch of the foot, + toe up. With thigh length l1 and
shank length l2 the ankle, relative to the hip, is at

    x = l1 sin(thigh) + l2 sin(shank),   z = -l1 cos(thigh) - l2 cos(shank)

Phase 0 is the heel strike of the same leg; the other leg is half a stride ahead.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from footopt.errors import SettingError, check, one_line
from footopt.files.gaits import Coefficients, read_json, read_strides, write_json
from footopt.files.io import Unusable, naming
from footopt.files.strides import Strides, average, check_angles, check_period, cut
from footopt.gait import start
from footopt.gait.fourier import Fourier

Array = NDArray[np.float64]

LEFT, RIGHT = 0, 1
HUMAN = Path(__file__).parent / "data" / "human_walk.json"
MISFIT = 10.0  # deg; a larger one anywhere means that a curve jumps or is not one period
HARMONICS = 6  # of the series, where nothing else is asked for
ANGLES = "angles"  # what messages call a gait that is from no file
PHASES = 200  # of a stride, at which the angles of a series are checked


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
        object.__setattr__(self, "name", one_line(self.name))
        check(1e-3 <= self.period <= 1e3, "gait.period", self.period, "a time from 0.001 to 1000, in s")
        check(
            0 <= self.start <= 1e5 or self.start == math.inf,
            "gait.start",
            self.start,
            "a time >= 0 and <= 1e5, in s (.inf: stand still)",
        )
        check(self.pitch in ("shank", "measured"), "gait.pitch", self.pitch, "shank or measured")
        if self.pitch == "measured" and self.foot is None:
            raise SettingError("gait.pitch", "measured", "shank: this gait has no measured pitch of the foot")
        for joint in (self.thigh, self.knee, self.foot):
            if joint is not None and not np.isfinite([joint.a0, *joint.a, *joint.b]).all():
                raise SettingError("gait", self.name, "made of finite coefficients")

    @classmethod
    def human(
        cls, period: float = 1.2, harmonics: int = HARMONICS, pitch: str = "shank", start: float = 0.5
    ) -> Gait:
        """Human walking at 1.03 m/s: Fukuchi, Fukuchi & Duarte, PeerJ 6:e4640 (2018), CC BY 4.0."""
        gait = cls._from_json(HUMAN, harmonics)
        return replace(gait, name="human", period=period, pitch=pitch, start=start)

    @classmethod
    def from_file(
        cls,
        path: str | Path,
        harmonics: int | None = None,
        names: Mapping[str, str] | None = None,
        side: str | None = None,
        units: str | None = None,
        window: tuple[float, float] | None = None,
    ) -> Gait:
        """The gait in a file of coefficients (JSON) or of a leg's angles (CSV, MOT, STO).

        Parameters
        ----------
        path : str or Path
            The file; its ending says which format it has.
        harmonics : int, optional
            Harmonics of the series; by default 6, or all that a file of coefficients has.
        names : mapping, optional
            The file's own names of columns (time, thigh, hip, knee, foot, ankle, pelvis).
        side : str, optional
            "right" or "left" leg; by default the right one, or the left one if it is the only one.
        units : str, optional
            Unit of angles, deg or rad; by default what the file says.
        window : (float, float), optional, s
            The stride, from a heel strike to the next of the same leg; by default the mean of all strides, of
            which the period is found.

        Raises
        ------
        FileError
            The file cannot be read, or does not hold a walk.
        SettingError
            Another argument cannot be used.
        """
        if Path(path).suffix.lower() == ".json":
            return cls._from_json(path, harmonics)
        return cls.from_strides(read_strides(path, names, side, units, window), harmonics)

    @classmethod
    def from_angles(
        cls,
        times: ArrayLike,
        thigh: ArrayLike,
        knee: ArrayLike,
        foot: ArrayLike | None = None,
        harmonics: int | None = None,
    ) -> Gait:
        """The gait of a leg's angles over time: one stride from heel strike to heel strike, or several.

        What holds of a file of angles holds of them, too.

        Parameters
        ----------
        times : (n,), s
            Increasing.
        thigh : (n,), deg
            From the vertical, + knee ahead of the hip.
        knee : (n,), deg
            Flexion.
        foot : (n,), deg, optional
            Pitch of the foot, + toe up.
        harmonics : int, optional
            Harmonics of the series; by default 6.

        Raises
        ------
        SettingError
            They are not as many angles as times.
        FileError
            They are no walk.
        """
        rows = [np.asarray(row, float) for row in (times, thigh, knee, foot) if row is not None]
        shapes = [row.shape for row in rows]
        check(len(set(shapes)) == 1 and len(shapes[0]) == 1, "angles", shapes, "as many angles as times")
        with naming(ANGLES, "gait"):
            strides = cut(rows[0], dict(zip(("thigh", "knee", "foot"), rows[1:], strict=False)))
        return replace(cls.from_strides(strides._replace(source=ANGLES), harmonics), source="")

    @classmethod
    def from_strides(cls, strides: Strides, harmonics: int | None = None) -> Gait:
        """The gait fitted to the mean of some strides; its residual is against that mean, as measured.

        Raises
        ------
        FileError
            The strides have too few rows, or no periodic curve follows them.
        """
        harmonics = HARMONICS if harmonics is None else harmonics
        check(harmonics >= 1, "gait.harmonics", harmonics, "a whole number >= 1")
        with naming(strides.source, "gait.path"):
            if len(strides.phase) < 2 * harmonics + 2:
                raise Unusable(
                    f"needs at least {2 * harmonics + 2} rows for {harmonics} harmonics, "
                    "from one heel strike to the next."
                )
            fits = {}
            for joint in strides.curves:
                try:
                    fits[joint] = _fitted(joint, strides, harmonics)
                except Unusable:
                    if joint != "foot":  # which follows the shank unless its pitch is asked for
                        raise
        return cls(
            thigh=fits["thigh"][0],
            knee=fits["knee"][0],
            foot=fits["foot"][0] if "foot" in fits else None,
            period=strides.period,
            name=Path(strides.source).stem,
            source=strides.source,
            residual=tuple((joint, rms) for joint, (_, rms) in fits.items()),
        )

    @classmethod
    def _from_json(cls, path: str | Path, harmonics: int | None) -> Gait:
        """The gait in a file of Fourier coefficients, up to some harmonic."""
        read = read_json(path)
        many = [len(a) for _, a, _ in read.series.values()]
        allowed = f"a whole number from 1 to {min(many)}, the harmonics in {Path(path).name}"
        check(harmonics is None or 1 <= harmonics <= min(many), "gait.harmonics", harmonics, allowed)
        harmonics = max(many) if harmonics is None else harmonics
        joints = {name: Fourier(*series).truncated(harmonics) for name, series in read.series.items()}
        phase = np.arange(PHASES) / PHASES
        with naming(path, "gait.path"):
            check_angles({name: np.degrees(joint.at(phase)[0]) for name, joint in joints.items()})
            check_period(read.period)
        return cls(
            thigh=joints["thigh"],
            knee=joints["knee"],
            foot=joints.get("foot"),
            period=read.period,
            name=Path(path).stem,
            source=read.source,
            residual=tuple(read.residual.get(str(harmonics), {}).items()),
        )

    def to_file(self, path: str | Path) -> None:
        """Write the series and the period to a file of coefficients (JSON), which `from_file` reads back.

        Both are the same, to the last bit. How the foot turns and when the walk starts are no part of it.

        Raises
        ------
        SettingError
            The file does not end in .json.
        FileError
            It cannot be written.
        """
        check(Path(path).suffix.lower() == ".json", "path", str(path), "a file that ends in .json")
        joints = {"thigh": self.thigh, "knee": self.knee, "foot": self.foot}
        series = {name: joint for name, joint in joints.items() if joint is not None}
        many = str(max(len(joint.a) for joint in series.values()))
        write_json(path, Coefficients(series, self.period, self.source, {many: dict(self.residual)}))

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

    def cycle(self, phase: ArrayLike) -> tuple[tuple[Array, Array], tuple[Array, Array], tuple[Array, Array]]:
        """Thigh, shank and pitch of the steady walk: each an angle (rad) and its rate (rad/stride)."""
        p = np.asarray(phase, float)
        (thigh, thigh_rate), (knee, knee_rate) = self.thigh.at(p), self.knee.at(p)
        shank = thigh - knee, thigh_rate - knee_rate
        if self.pitch == "measured" and self.foot is not None:
            return (thigh, thigh_rate), shank, self.foot.at(p)
        return (thigh, thigh_rate), shank, shank

    def angles(self, t: ArrayLike) -> tuple[tuple[Array, Array], tuple[Array, Array], tuple[Array, Array]]:
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


def _fitted(joint: str, strides: Strides, harmonics: int) -> tuple[Fourier, float]:
    """The series through the closed mean of a joint's strides, and its rms misfit of the mean itself, deg."""
    phase, closed, mean = strides.phase, average(strides)[joint], strides.curves[joint].mean(axis=0)
    series = Fourier.fit(phase[:-1], closed[:-1], harmonics)  # the last point is the first one again
    misfit = np.degrees(series.at(phase)[0]) - mean
    if abs(misfit).max() > MISFIT:
        raise Unusable(
            f"{joint} misses its periodic fit by up to {abs(misfit).max():.0f} deg. The curve jumps or is "
            "not one whole stride; give one heel strike to the next of one leg, or several strides."
        )
    return series, float(np.sqrt(np.mean(misfit**2)))


def ankle(
    thigh: Array, thigh_rate: Array, shank: Array, shank_rate: Array, l1: float, l2: float
) -> tuple[Array, Array, Array, Array]:
    """Position (m) and velocity (m/s) of the ankle relative to the hip: x, z, vx, vz.

    Angles are in rad, their rates in rad/s, and the leg's segments l1 and l2 in m.
    """
    st, ct, ss, cs = np.sin(thigh), np.cos(thigh), np.sin(shank), np.cos(shank)
    return (
        l1 * st + l2 * ss,
        -l1 * ct - l2 * cs,
        l1 * ct * thigh_rate + l2 * cs * shank_rate,
        l1 * st * thigh_rate + l2 * ss * shank_rate,
    )
