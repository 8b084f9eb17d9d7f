"""The hard cases of study=stability: what is walked, and which judge decides."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from footopt.effects import Effect, Inertia, Layers, LeadingEdge, Patches, Rest, Shadowing, Slope
from footopt.foot import Foot
from footopt.gait import Fourier, Gait
from footopt.studies.stability_judges import (
    Judge,
    judge_long_walk,
    judge_rest,
    judge_standing,
    judge_sunk,
    judge_walk,
)
from footopt.walk import Accuracy, Scene

Setup = tuple[Foot, Scene, Accuracy]


@dataclass(frozen=True)
class Case:
    """A hard case: how it differs from the settings, of which None leaves what they say."""

    name: str
    zeta: float | None = None  # of the sand
    mass: float | None = None  # of the walker, kg
    period: float | None = None  # of a stride, s
    t_f: float | None = None  # None: two strides after the start
    effects: tuple[Effect, ...] | None = None  # in place of the scene's
    stands: bool = False  # whether the walker stands still
    gait: Gait | None = None
    k: tuple[int, ...] | None = None  # heights of the sole
    steps: float = 1.0  # multiplies the time step
    accuracy: Mapping[str, Any] = field(default_factory=dict)  # parameters that are taken as they are
    judge: Judge = judge_walk  # from the walk to the numbers that decide

    def build(self, foot: Foot, scene: Scene, accuracy: Accuracy) -> Setup:
        """Return the foot, the scene and the accuracy of the case, from those of the settings."""
        gait, sand = self.gait or scene.gait, scene.sand
        gait = replace(gait, period=self.period or gait.period, start=math.inf if self.stands else gait.start)
        if self.zeta is not None:
            sand = replace(sand, zeta=self.zeta, name=f"zeta {self.zeta:g}")
        scene = replace(
            scene, sand=sand, gait=gait, t_f=self.t_f,
            walker=replace(scene.walker, mass=self.mass or scene.walker.mass),
            effects=scene.effects if self.effects is None else self.effects,
        )  # fmt: skip
        if self.k is not None:
            foot = replace(Foot.from_waypoints(self.k), name=self.name)
        adapt = accuracy.adapt and not self.accuracy
        step = self.steps * accuracy.dt
        return foot, scene, replace(accuracy, dt=step, name="custom", adapt=adapt, **self.accuracy)


#: With bent knees and level feet that come down at about 3 m/s. Shanks mirror the thighs about the vertical,
#: so that the ankle goes up and down below the hip; 10 deg of swing carry the walker forward.
MARCH = Gait(
    thigh=Fourier(35.0, (-10.0,), (20.0,)),
    knee=Fourier(70.0, (0.0,), (40.0,)),
    foot=Fourier(0.0, (0.0,), (0.0,)),
    period=0.7,
    pitch="measured",
    name="march",
)

#: Waypoints that jump between the top and the bottom of the box.
SPIKES, COMB = (1, 10) * 5 + (1,), (1, 10) * 100
#: What a search for too small error estimates has found on zeta 20: the error is 0.56 of it.
SEARCHED = (2, 9, 7, 4, 6, 5, 6, 3, 5, 5, 6)

#: Sand as it is hard to walk on, and all effects together.
PAN, CLIFF = Layers((0.03,), (1e6,)), Patches((0.5,), (9.0,), (1e3,), blur=1e-4)
STRIPES = Patches(
    tuple(0.1 + 0.02 * i for i in range(100)),
    tuple(0.101 + 0.02 * i for i in range(100)),
    (10.0,) * 100,
    1e-3,
)
ALL = (
    Layers((0.02, 0.05), (0.6, 1.5)), Patches((0.35, 1.2), (0.95, 1.6), (0.7, 1.5)),
    LeadingEdge(), Inertia(), Slope(3.0), Shadowing(),
)  # fmt: skip


def standing(name: str, zeta: float, accuracy: Mapping[str, Any] | None = None) -> Case:
    """Still for 10 s on a sand."""
    return Case(name, zeta, t_f=10.0, stands=True, accuracy=accuracy or {}, judge=judge_standing)


def resting(name: str, zeta: float, *effects: Effect) -> Case:
    """Still for a minute, on a sand and with effects."""
    return Case(name, zeta, t_f=60.0, stands=True, effects=effects, judge=judge_rest)


CASES = (
    *(standing(f"standing on zeta {zeta:g}", zeta) for zeta in (0.05, 0.2, 1.0, 5.0, 50.0, 500.0)),
    standing("standing with creep 1e-9", 5.0, {"creep": 1e-9}),
    resting("at rest by the plain law", 5.0),
    resting("at rest on zeta 0.05", 0.05, Rest(), Slope(5.0)),
    resting("at rest on zeta 5", 5.0, Rest(), Slope(15.0)),
    resting("at rest on zeta 500", 500.0, Rest(), Slope(5.0)),
    Case("2 kg", mass=2.0),
    Case("500 kg", mass=500.0),
    Case("zeta 100 under 2 kg", zeta=100.0, mass=2.0),
    Case("a step ten times larger", steps=10.0),
    Case("a foot set down at 3 m/s", gait=MARCH),
    Case("spiky soles", k=SPIKES),
    Case("a comb of 200 waypoints", k=COMB),
    Case("worst estimate of a search", zeta=20.0, k=SEARCHED),
    Case("leading edge on hard sand", 5.0, effects=(LeadingEdge(),)),
    Case("leading edge on zeta 200", 200.0, effects=(LeadingEdge(),)),
    Case("inertia in a brisk walk", 1.0, effects=(Inertia(),), period=0.9),
    Case("rest in a walk", 5.0, effects=(Rest(),)),
    Case("a hard pan under soft sand", 0.2, effects=(PAN,)),
    Case("a cliff from zeta 1 to 1000", 1.0, effects=(CLIFF,)),
    Case("100 hard patches of 1 mm", 1.0, effects=(STRIPES,)),
    Case("all effects", 1.0, effects=ALL),
    *(Case(f"{plates} plates", accuracy={"plates": plates}) for plates in (5, 50, 500, 5000)),
    *(Case(f"creep {c}", accuracy={"creep": float(c)}) for c in ("1e-9", "1e-7", "1e-5", "1e-3", "1e-2")),
    Case("creep 1e-9 on zeta 50", 50.0, accuracy={"creep": 1e-9}),
    Case("ten minutes of walking", t_f=600.0, judge=judge_long_walk),
    Case("sand that carries nobody", 1e-3, judge=judge_sunk),
    Case("sinking to the hip", 0.02, judge=judge_sunk),
)
