"""Scenarios: variants of a scene that are drawn once and then the same for every foot, and laws of its sand.

A foot is made before the sand is known, and the walker never weighs or steps quite as planned. A
`Spread` says how far a scene's parameters lie apart, `draw` makes scenarios of it.
"""

import math
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import Any

import numpy as np

from footopt.arrays import Array
from footopt.effects import EFFECTS, Effect, name_of
from footopt.errors import check, check_kind, check_number, check_whole
from footopt.foot import Waypoints
from footopt.gait import Fourier, Gait
from footopt.sand import Sand
from footopt.walk import Scene, Simulator

DEFORMATION = 2  # harmonics, beside the mean, by which an angle differs from stride to stride


@dataclass(frozen=True)
class Scenario:
    """A variant of a scene.

    Parameters
    ----------
    name : str
        For tables and the reasons of failed walks.
    scene : Scene or Simulator
        The scene to simulate.
    ankle : (float, float), m
        Added to the ankle's place in the foot frame.
    """

    name: str
    scene: Any
    ankle: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        check_kind("scene", self.scene, Simulator, "Of a scenario; try fo.Scene(sand=fo.Sand(0.2)).")

    def space(self, space: Waypoints) -> Waypoints:
        """The same soles with the ankle as in this scenario."""
        x, z = space.ankle
        return replace(space, ankle=(x + self.ankle[0], z + self.ankle[1]))


@dataclass(frozen=True)
class Spread:
    """How far the parameters of a scene lie apart: one standard deviation of each.

    The defaults are chosen, not measured; the built-in gait is the mean stride of one subject and
    says nothing about how strides differ.

    Parameters
    ----------
    zeta : float
        Spread of the logarithm of the sand's zeta; the scene's own is the median.
    mass : float
        Spread of the logarithm of the walker's mass; the scene's own is the median.
    period : float
        Spread of the logarithm of the stride's period; the scene's own is the median.
    stride : float
        Spread of the swing of thigh and knee about their means, relative: longer or shorter steps.
    angles : float, deg
        Spread of thigh and knee at every phase of the stride, by a random mean and random first two
        harmonics, all with the same variance.
    ankle_x : float, m
        Spread of the ankle's place in the foot frame, forward.
    ankle_z : float, m
        Spread of the ankle's place in the foot frame, upward.

    Raises
    ------
    SettingError
        One is negative, or larger than 1 (`angles`: 30 deg).
    """

    zeta: float = 0.3
    mass: float = 0.1
    period: float = 0.05
    stride: float = 0.05
    angles: float = 2.0
    ankle_x: float = 0.005
    ankle_z: float = 0.005

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            most = 30.0 if name == "angles" else 1.0
            allowed = f"a standard deviation >= 0 and <= {most:g}"
            check_number(f"study.spread.{name}", value, 0, most, allowed)


#: The parameter that each standard normal variable of a scenario changes; an angle has one a coefficient.
COLUMNS = (
    *("zeta", "mass", "period", "stride", "ankle_x", "ankle_z"),
    *(joint for joint in ("thigh", "knee") for _ in range(1 + 2 * DEFORMATION)),
)


def sands(scene: Any) -> tuple[Scenario, ...]:
    """A scene on soft, regular and hard sand."""
    names = ("soft", "regular", "hard")
    return tuple(Scenario(name, replace(scene, sand=Sand.named(name))) for name in names)


def plausible_laws(scene: Any) -> tuple[Scenario, ...]:
    """A scene under the plain law, with each of the effects that may hold for any walk, and with both."""
    plausible: list[Effect] = [kind() for kind in EFFECTS.values() if kind.plausible]
    choices: dict[str, list[Effect]] = {
        "plain law": [],
        **{name_of(effect).replace("_", " "): [effect] for effect in plausible},
        "both": plausible,
    }
    others = [effect for effect in scene.effects if not effect.plausible]
    return tuple(Scenario(name, replace(scene, effects=(*others, *on))) for name, on in choices.items())


def possible_laws(scene: Any, spread: float) -> tuple[Scenario, ...]:
    """A scene as it is, under the laws that may hold instead of its own, and with other values of zeta.

    zeta is one standard deviation of its logarithm, `spread`, lower and higher, unless that is 0. A scene
    without sand has no other law.
    """
    own = Scenario("own law", scene)
    if scene.sand is None:
        return (own,)
    others = (law for law in plausible_laws(scene) if law.scene != scene)
    factors = (math.exp(-spread), math.exp(spread)) if spread else ()
    zetas = (Scenario(f"zeta x {factor:.2g}", scale_zeta(scene, factor)) for factor in factors)
    return (own, *others, *zetas)


def scale_zeta(scene: Any, factor: float) -> Any:
    """A scene with `factor` times its zeta, within the range of a `Sand`."""
    return replace(scene, sand=replace(scene.sand, zeta=min(max(scene.sand.zeta * factor, 1e-6), 1e6)))


def draw(scene: Any, spread: Spread, count: int, seed: int = 1) -> tuple[Scenario, ...]:
    """Equally probable scenarios about a scene, by Latin hypercube sampling.

    Parameters
    ----------
    scene : Scene or Simulator
        The median of all. A robot that tracks a gait keeps its mass.
    spread : Spread
        How far they lie apart.
    count : int
        How many are drawn.
    seed : int
        Of the draw. Every parameter has random numbers of its own, whether it is spread or not: the sand
        of a scenario does not change when the mass becomes uncertain.

    Raises
    ------
    SettingError
        `count` is not from 1 to 10,000, or a robot tracks no gait.
    """
    from scipy.special import ndtri

    check_whole("study.draws", count, 1, 10_000)
    check_whole("seed", seed, 0, 2**32 - 1)
    tracks = getattr(scene, "gait", None) is not None
    check(tracks, "study.scenarios", "drawn", "sands or laws for a robot that tracks no gait")
    rng = np.random.default_rng(seed)
    strata = np.stack([rng.permutation(count) for _ in COLUMNS], axis=1)
    normals = ndtri((strata + rng.random(strata.shape)) / count)
    return tuple(vary(scene, spread, row, f"draw {i}") for i, row in enumerate(normals, start=1))


def vary(scene: Any, spread: Spread, normals: Array, name: str = "varied") -> Scenario:
    """A scene moved by standard normal variables, one for each of `COLUMNS`."""
    zeta, mass, period, stride, ankle_x, ankle_z, *angles = normals.tolist()
    # a cosine and a sine of equal variance add up to that variance at every phase
    thigh, knee = np.split(spread.angles / math.sqrt(1 + DEFORMATION) * np.array(angles), 2)
    gait = deformed(scene.gait, 1.0 + spread.stride * stride, thigh, knee)
    gait = replace(gait, period=gait.period * math.exp(spread.period * period))
    if isinstance(scene, Scene):
        walker = replace(scene.walker, mass=scene.walker.mass * math.exp(spread.mass * mass))
        moved: Any = replace(scene, walker=walker, gait=gait)
    else:
        moved = scene.tracking(gait)
    ankle = spread.ankle_x * ankle_x, spread.ankle_z * ankle_z
    return Scenario(name, scale_zeta(moved, math.exp(spread.zeta * zeta)), ankle)


def deformed(gait: Gait, swing: float, thigh: Array, knee: Array) -> Gait:
    """A gait with `swing` times its angles' deviations from their means, plus changes of thigh and knee.

    A change is the coefficients of a series, deg: the mean, the cosines, the sines. The shank turns
    with both joints, and a measured pitch of the foot with the shank.
    """
    return replace(
        gait,
        thigh=_moved(gait.thigh, swing, thigh),
        knee=_moved(gait.knee, swing, knee),
        foot=None if gait.foot is None else _moved(gait.foot, swing, thigh - knee),
    )


def _moved(angle: Fourier, swing: float, change: Array) -> Fourier:
    cosines, sines = np.split(change[1:], 2)
    return Fourier(
        angle.a0 + float(change[0]),
        tuple(swing * c + float(d) for c, d in zip_longest(angle.a, cosines, fillvalue=0.0)),
        tuple(swing * c + float(d) for c, d in zip_longest(angle.b, sines, fillvalue=0.0)),
    )
