"""The hard cases of study=stability: how each differs from the settings."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from footopt.effects import Effect, Inertia, Layers, LeadingEdge, Patches, Rest, Shadowing, Slope
from footopt.foot import Foot
from footopt.gait import Fourier, Gait
from footopt.walk import Scene


@dataclass(frozen=True)
class Case:
    """A hard case: how it differs from the settings."""

    name: str
    changes: Mapping[str, Any] = field(default_factory=dict)  # values of the scene: {"walker.mass": 2.0}
    foot: Callable[[], Foot] | None = None  # makes one in place of the settings'
    steps: float = 1.0  # multiplies the time step
    accuracy: Mapping[str, Any] = field(default_factory=dict)  # parameters that are given, to the truth, too

    def scene(self, scene: Scene) -> Scene:
        """Return the scene of the case, from that of the settings."""
        for name, value in self.changes.items():
            group, _, parameter = name.rpartition(".")
            changed = replace(getattr(scene, group), **{parameter: value}) if group else value
            scene = replace(scene, **{group or name: changed})
        return scene


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
LEVEL = replace(Gait.human(), foot=MARCH.foot, pitch="measured", name="level")

#: Waypoints that jump between the top and the bottom of the box.
SPIKES, COMB = (1, 10) * 5 + (1,), (1, 10) * 100
#: Found by a search for too small error estimates on zeta 20: the error is 0.56 of the estimate.
SEARCHED = (2, 9, 7, 4, 6, 5, 6, 3, 5, 5, 6)


def noisy(points: int = 5000, noise: float = 1e-4) -> Foot:
    """A flat sole as a bad scan has it: so many points, each off by a normal error (m)."""
    x = np.linspace(-0.13, 0.13, points)
    z = -0.03 + np.random.default_rng(1).normal(0.0, noise, points)
    return Foot(np.stack([x, z], axis=1), name="noisy")


#: Sand as it is hard to walk on, and all effects together.
PAN, CLIFF = Layers((0.03,), (1e6,)), Patches((0.5,), (9.0,), (1e3,), blur=1e-4)
STRIPES = Patches(
    tuple(0.1 + 0.2 * i for i in range(10)), tuple(0.101 + 0.2 * i for i in range(10)), (10.0,) * 10, 1e-3
)
ALL = (
    Layers((0.02, 0.05), (0.6, 1.5)), Patches((0.35, 1.2), (0.95, 1.6), (0.7, 1.5)),
    LeadingEdge(), Inertia(), Slope(3.0), Shadowing(),
)  # fmt: skip


def on_sand(zeta: float, *effects: Effect) -> dict[str, Any]:
    """Changes of a scene to a sand, and to effects where some are given."""
    return {"sand.zeta": zeta, **({"effects": effects} if effects else {})}


def standing(zeta: float, *effects: Effect, seconds: float = 10.0) -> dict[str, Any]:
    """Changes of a scene to standing still on a sand."""
    return on_sand(zeta, *effects) | {"t_f": seconds, "gait.start": math.inf}


def sole(k: Sequence[int], **space: Any) -> Callable[[], Foot]:
    """A function that makes a sole: its compiled code is loaded when the case is run."""
    return partial(Foot.from_waypoints, k, **space)


CASES = (
    *(Case(f"standing on zeta {zeta:g}", standing(zeta)) for zeta in (0.05, 0.2, 1.0, 5.0, 50.0, 500.0)),
    Case("standing with creep 1e-9", standing(5.0), accuracy={"creep": 1e-9}),
    Case("a minute by the plain law", standing(5.0, seconds=60.0) | {"effects": ()}),
    Case("at rest on zeta 0.05", standing(0.05, Rest(), Slope(5.0))),
    Case("at rest on zeta 5", standing(5.0, Rest(), Slope(15.0))),
    Case("at rest on zeta 500", standing(500.0, Rest(), Slope(5.0))),
    Case("2 kg", {"walker.mass": 2.0}),
    Case("500 kg", {"walker.mass": 500.0}),
    Case("1 mg", {"walker.mass": 1e-6, "t_f": 1.7}),
    Case("zeta 100 under 2 kg", on_sand(100.0) | {"walker.mass": 2.0}),
    Case("gravity 1e4", {"walker.g": 1e4}),
    Case("a step ten times larger", steps=10.0),
    Case("a foot set down at 3 m/s", {"gait": MARCH}),
    Case("level feet with rest on zeta 500", on_sand(500.0, Rest()) | {"gait": LEVEL}),
    Case("spiky soles", foot=sole(SPIKES)),
    Case("a comb of 200 waypoints", foot=sole(COMB)),
    Case("200 waypoints of one level", foot=sole((1,) * 200, K=1)),
    Case("a noisy contour of 5000 points", foot=noisy),
    Case("worst estimate of a search", on_sand(20.0), sole(SEARCHED)),
    Case("leading edge on hard sand", on_sand(5.0, LeadingEdge())),
    Case("leading edge on zeta 200", on_sand(200.0, LeadingEdge())),
    Case("inertia in a brisk walk", on_sand(1.0, Inertia()) | {"gait.period": 0.9}),
    Case("rest in a walk", on_sand(5.0, Rest())),
    Case("a hard pan under soft sand", on_sand(0.2, PAN)),
    Case("a cliff from zeta 1 to 1000", on_sand(1.0, CLIFF)),
    Case("ten hard patches of 1 mm", on_sand(1.0, STRIPES)),
    Case("all effects", on_sand(1.0, *ALL)),
    *(Case(f"{plates} plates", accuracy={"plates": plates}) for plates in (5, 50, 500, 5000)),
    *(Case(f"creep {c}", accuracy={"creep": float(c)}) for c in ("1e-9", "1e-7", "1e-5", "1e-3", "1e-2")),
    Case("creep 1e-9 on zeta 50", on_sand(50.0), accuracy={"creep": 1e-9}),
    Case("a minute of walking", {"t_f": 60.0}),
    Case("sand that cannot carry the walker", on_sand(1e-3)),
    Case("sinking to the hip", on_sand(0.02)),
)
