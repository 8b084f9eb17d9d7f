"""The hard cases of study=stability: what is walked, and which judge decides."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

from footopt.effects import Effect, Footprints, Inertia, Layers, LeadingEdge, Patches, Rest, Shadowing, Slope
from footopt.foot import Foot
from footopt.gait import Fourier, Gait
from footopt.studies.stability_judges import (
    Measure,
    Setup,
    Trial,
    judge_long_walk,
    judge_rest,
    judge_set_down,
    judge_standing,
    judge_sunk,
    judge_walk,
)


class Case(NamedTuple):
    """A hard case.

    Parameters
    ----------
    name, asks : str
        For tables: what it is, and what must hold.
    build : callable
        From the settings' setup to the case's own.
    judge : callable
        The numbers that decide.
    """

    name: str
    asks: str
    build: Callable[[Setup], Setup]
    judge: Callable[[Trial], list[Measure]]


def walking(
    zeta: float | None = None, mass: float | None = None, t_f: float | None = None, steps: float = 1.0,
    **accuracy: Any,
) -> Callable[[Setup], Setup]:  # fmt: skip
    """The settings' walk with other sand, walker, duration or accuracy; `steps` multiplies the time step."""

    def change(base: Setup) -> Setup:
        scene = replace(base.scene, t_f=t_f)
        if mass is not None:
            scene = replace(scene, walker=replace(scene.walker, mass=mass))
        if zeta is not None:
            scene = replace(scene, sand=replace(scene.sand, zeta=zeta, name=f"zeta {zeta:g}"))
        finely = replace(base.accuracy, dt=steps * base.accuracy.dt, name="custom", **accuracy)
        if accuracy:
            finely = replace(finely, adapt=False)
        return replace(base, scene=scene, accuracy=finely)

    return change


def with_effects(zeta: float, *effects: Effect, period: float | None = None) -> Callable[[Setup], Setup]:
    """The settings' walk on a sand with effects, at another period of the stride."""

    def change(base: Setup) -> Setup:
        setup = walking(zeta)(base)
        gait = setup.scene.gait if period is None else replace(setup.scene.gait, period=period)
        return replace(setup, scene=replace(setup.scene, effects=effects, gait=gait))

    return change


def standing(zeta: float, **accuracy: Any) -> Callable[[Setup], Setup]:
    """Still for 10 s on a sand."""

    def change(base: Setup) -> Setup:
        setup = walking(zeta, t_f=10.0, **accuracy)(base)
        return replace(setup, scene=replace(setup.scene, gait=replace(setup.scene.gait, start=math.inf)))

    return change


def resting(zeta: float, *effects: Effect) -> Callable[[Setup], Setup]:
    """Still for a minute, on a sand and with effects."""

    def change(base: Setup) -> Setup:
        setup = standing(zeta)(base)
        return replace(setup, scene=replace(setup.scene, t_f=60.0, effects=effects))

    return change


def spiky(base: Setup) -> Setup:
    """A sole whose waypoints jump between the top and the bottom of the box."""
    spikes = Foot.from_waypoints([1, 10] * 5 + [1])
    return replace(base, foot=replace(spikes, name="spiky"), scene=replace(base.scene, t_f=None))


def stamping(base: Setup) -> Setup:
    """A march with bent knees and level feet that come down at about 3 m/s.

    Shanks mirror the thighs about the vertical, so that the ankle goes up and down below the hip;
    10 deg of swing carry the walker forward.
    """
    march = Gait(
        thigh=Fourier(35.0, (-10.0,), (20.0,)),
        knee=Fourier(70.0, (0.0,), (40.0,)),
        foot=Fourier(0.0, (0.0,), (0.0,)),
        period=0.7,
        pitch="measured",
        name="march",
    )
    return replace(base, scene=replace(base.scene, gait=march, t_f=None))


def comb(base: Setup) -> Setup:
    """A sole of 200 waypoints that jump between the top and the bottom of the box."""
    return replace(spiky(base), foot=replace(Foot.from_waypoints([1, 10] * 100), name="comb"))


def searched(base: Setup) -> Setup:
    """What a search for too small error estimates has found on zeta 20: the error is 0.56 of it."""
    foot = Foot.from_waypoints([2, 9, 7, 4, 6, 5, 6, 3, 5, 5, 6])
    return replace(walking(20.0)(base), foot=replace(foot, name="searched"))


#: Sand as it is hard to walk on, and all effects together.
PAN, CLIFF = Layers((0.03,), (1e6,)), Patches((0.5,), (9.0,), (1e3,), blur=1e-4)
STRIPES = Patches(
    tuple(0.1 + 0.02 * i for i in range(100)),
    tuple(0.101 + 0.02 * i for i in range(100)),
    (10.0,) * 100,
    1e-3,
)
ALL = (Layers((0.02, 0.05), (0.6, 1.5)), Patches(), LeadingEdge(), Inertia(), Slope(3.0), Shadowing())

STANDS = "10 s: at rest, the weight carried without chatter, no drift, no work, energy adds up"
WALKS = "right within 10 % of a walk in finer steps, with finer plates and creep speed; energy adds up"
RESTS = "a minute on a slope: nothing moves, wherever the time step and delta (or the creep speed) put him"
LASTS = "the last minute as fast as the second, energy adds up"
FAILS = "infeasible, because he sank"

CASES = tuple(
    Case(*row)
    for row in (
        ("standing, zeta 0.05", STANDS, standing(0.05), judge_standing),
        ("standing, zeta 0.2", STANDS, standing(0.2), judge_standing),
        ("standing, zeta 1", STANDS, standing(1.0), judge_standing),
        ("standing, zeta 5", STANDS, standing(5.0), judge_standing),
        ("standing, zeta 50", STANDS, standing(50.0), judge_standing),
        ("standing, zeta 500", STANDS, standing(500.0), judge_standing),
        ("standing, creep 1e-9", STANDS, standing(5.0, creep=1e-9), judge_standing),
        ("at rest by the plain law", RESTS, resting(5.0), judge_rest),
        ("at rest on zeta 0.05", RESTS, resting(0.05, Rest(), Slope(5.0)), judge_rest),
        ("at rest on zeta 5", RESTS, resting(5.0, Rest(), Slope(15.0)), judge_rest),
        ("at rest on zeta 500", RESTS, resting(500.0, Rest(), Slope(5.0)), judge_rest),
        ("2 kg", WALKS, walking(mass=2.0), judge_walk),
        ("500 kg", WALKS, walking(mass=500.0), judge_walk),
        ("zeta 100 under 2 kg", WALKS, walking(zeta=100.0, mass=2.0), judge_walk),
        ("a step ten times larger", WALKS, walking(steps=10.0), judge_walk),
        ("a foot set down at 3 m/s", WALKS, stamping, judge_set_down),
        ("spiky soles", WALKS, spiky, judge_walk),
        ("a comb of 200 waypoints", WALKS, comb, judge_walk),
        ("worst estimate of a search", WALKS, searched, judge_walk),
        ("leading edge on hard sand", WALKS, with_effects(5.0, LeadingEdge()), judge_walk),
        ("leading edge, zeta 200", WALKS, with_effects(200.0, LeadingEdge()), judge_walk),
        ("inertia in a brisk walk", WALKS, with_effects(1.0, Inertia(), period=0.9), judge_walk),
        ("footprints on regular sand", WALKS, with_effects(1.0, Footprints()), judge_walk),
        ("rest in a walk", WALKS, with_effects(5.0, Rest()), judge_walk),
        ("a hard pan under soft sand", WALKS, with_effects(0.2, PAN), judge_walk),
        ("a cliff from zeta 1 to 1000", WALKS, with_effects(1.0, CLIFF), judge_walk),
        ("100 hard patches of 1 mm", WALKS, with_effects(1.0, STRIPES), judge_walk),
        ("all effects", WALKS, with_effects(1.0, *ALL), judge_walk),
        ("5 plates", WALKS, walking(plates=5), judge_walk),
        ("50 plates", WALKS, walking(plates=50), judge_walk),
        ("500 plates", WALKS, walking(plates=500), judge_walk),
        ("5000 plates", WALKS, walking(plates=5000), judge_walk),
        ("creep 1e-9", WALKS, walking(creep=1e-9), judge_walk),
        ("creep 1e-7", WALKS, walking(creep=1e-7), judge_walk),
        ("creep 1e-5", WALKS, walking(creep=1e-5), judge_walk),
        ("creep 1e-3", WALKS, walking(creep=1e-3), judge_walk),
        ("creep 1e-2", WALKS, walking(creep=1e-2), judge_walk),
        ("creep 1e-9 on zeta 50", WALKS, walking(zeta=50.0, creep=1e-9), judge_walk),
        ("ten minutes of walking", LASTS, walking(t_f=600.0), judge_long_walk),
        ("sand that carries nobody", FAILS, walking(zeta=1e-3), judge_sunk),
        ("sinking to the hip", FAILS, walking(zeta=0.02), judge_sunk),
    )
)
