"""An accuracy as a scene and a sole need it: presets are stated for the paper's walker, feet and sands.

Some things make a walk harder than those, and each is a rule here:

- A smaller walker takes shorter strides at lower speeds. The time step is in proportion to the stride's
  period, the control and the creep speed to the legs' length over it, and never larger than the preset's.
- A sole with more waypoints or corners needs more plates, at `standard` `EACH` a waypoint.
- No plate is to be longer than the narrowest patch of sand.
- The harder the sand under a light walker, the shorter the part of the sole that carries him. At least
  `TOUCHING` plates are to touch the sand when he stands, whatever the pitch of his foot, and `PIECE` in each
  piece of a sole that touches it in several, as a comb does.
- Where effects ask for the plates' normals, or bristles remember their motion, a plate's mean is of a lower
  order: there are `NORMAL` times more plates, and `LEADING` times where only faces that lead feel sand.
- A foot that sticks creeps. Over a stride it is to creep by at most `CREPT` of the depth to which it sinks.
- A foot that is kept level strikes with its whole sole at once, and no turn of it smooths the direction of
  motion. It has `EVENLY` times more plates and half the creep speed; with bristles, shorter steps, too.
- Effects that change the force on a plate make blows short, as hard sand does, and bristles bend within them.
  Where there are such, or more plates than the preset's, steps are half as long and held to a quarter of the
  control.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.effects import LeadingEdge, Patches, Rest, laws
from footopt.effects import base as effects
from footopt.effects.shadowing import filler
from footopt.errors import SettingError
from footopt.foot import Foot, Plates, Waypoints
from footopt.foot.plates import corners, turns_of
from footopt.gait import Gait
from footopt.walk.accuracy import MOST_PLATES, Accuracy
from footopt.walk.scene import Scene, Walker
from footopt.walk.state import LANES

Array = NDArray[np.float64]

PERIOD, LEG = 1.2, Walker().l1 + Walker().l2  # of the walk that presets are measured with
STATED = 56  # plates along a sole, of which the next three are stated; a preset with more has more of them
STATED_CREEP = 1e-4  # m/s, of which `CREPT` is stated
EACH = 5  # plates a waypoint, or a straight side between two corners
BEND = 0.2  # rad by which a sole turns within a plate: five a waypoint of a rough sole
TOUCHING, PIECE = 8, 4  # plates in the sand under who stands, and in each piece of the sole there
LEADING = 4.0  # times more plates where only faces that lead feel sand
NORMAL = 2.0  # ... where the force depends on their normals , or bristles hold them
SLOWEST = 0.05  # times the creep speed, at least: evaluations double where it is a fifth and feet are level
CREPT = 0.03  # of the depth to which a level foot sinks: on hard sand so much at `standard`
SHORTER, CLOSER = 0.5, 0.25  # times the step, and its control, where blows are short
LEVEL = 0.1  # rad by which a foot's pitch changes in a stride, at most, if it is kept level
EVENLY, SLOWER = 1.5, 0.5  # times more plates, and times the creep speed, of such a foot
SETTLING = 0.125  # times the control once more, in half the step again, where bristles hold such a foot
MOST = 32  # times the preset's plates

PHASES = 32  # of a stride, at which a foot's pitch is looked at
PROBES = 3  # random soles that stand for a space
PITCHES = np.radians([-20.0, -10.0, 0.0, 10.0, 20.0])
POINTS = 200  # along a sole that stands
PLACES = 64  # on the walker's way, of which the one with the strongest sand counts
DEEPEST, HALVES = 10.0, 30  # m, and halvings of it: to 10 nm


def adapted(accuracy: Accuracy, scene: Scene, sole: Foot | Waypoints) -> Accuracy:
    """An accuracy that is to follow the scene (`Accuracy.adapt`) as numbers; any other as it is.

    Parameters
    ----------
    accuracy : Accuracy
        A preset, or one within a tolerance.
    scene : Scene
        Who walks, and on what.
    sole : Foot or Waypoints
        One foot, or the space of all feet: these share a number of plates.
    """
    if not accuracy.adapt:
        return accuracy
    if isinstance(sole, Foot) and sole.space is not None:
        sole = sole.space
    period = scene.gait.period / PERIOD
    legs = (scene.walker.l1 + scene.walker.l2) / LEG
    slower, shorter = min(legs / period, 1.0), min(period, 1.0)
    level, control = _keeps_level(scene.gait), accuracy.control
    needed = _needed(scene, sole) * (EVENLY if level else 1.0)
    kinds = {type(effect) for effect in scene.effects}
    slip = SLOWER if level else 1.0
    blows = needed > 1.0 or Rest in kinds or any(laws(scene.effects))
    step, held = (SHORTER, CLOSER) if blows else (1.0, 1.0)
    if level and Rest in kinds:
        step, held = SHORTER * step, SETTLING * held
    return replace(
        accuracy,
        dt=step * shorter * accuracy.dt,
        control=None if control is None else held * slower * control,
        creep=accuracy.creep * max(min(slower, _crept(scene, sole)) * slip, SLOWEST),
        plates=_blocks(accuracy.plates, min(_finer(scene) * needed, MOST)),
        adapt=False,
    )


def accuracies(
    feet: Any, scene: Scene, accuracy: Accuracy, space: Waypoints | None
) -> dict[Accuracy, list[int]]:
    """The numbers that an accuracy comes to (`adapted`), each with the places of the feet that have them."""
    if isinstance(feet, Plates):
        return {replace(accuracy, adapt=False): list(range(len(feet.x)))}
    if len(feet) == 0:
        raise SettingError("feet", "[]", "at least one foot")
    found: dict[Accuracy, list[int]] = {}
    if isinstance(feet[0], Foot):
        for i, foot in enumerate(feet):
            found.setdefault(adapted(accuracy, scene, foot), []).append(i)
        return found
    return {adapted(accuracy, scene, space or Waypoints(n=len(feet[0]))): list(range(len(feet)))}


@lru_cache(maxsize=64)
def _keeps_level(gait: Gait) -> bool:
    """Whether a foot hardly turns in a stride."""
    walks = replace(gait, start=0.0)
    t = walks.heel_strike + walks.period * np.arange(PHASES) / PHASES
    return bool(np.ptp(walks.pose(t, LEG / 2, LEG / 2).pitch[:, 0]) < LEVEL)


def _needed(scene: Scene, sole: Foot | Waypoints) -> float:
    """How many times more plates the shape of a sole and the hardness of the sand need."""
    needed = max(_bends(sole), _touching(scene, sole), _narrow(scene, sole)) / STATED
    return min(max(1.0, needed), MOST)


def _blocks(preset: int, times: float) -> int:
    """So many times a preset's plates, a whole number of blocks if more."""
    if times <= 1.0:
        return preset
    return min(LANES * math.ceil(times * preset / LANES - 1e-9), MOST_PLATES)


def _finer(scene: Scene) -> float:
    """How many times more plates the effects of a scene need."""
    kinds = {type(effect) for effect in scene.effects}
    if LeadingEdge in kinds:
        return LEADING
    return NORMAL if Rest in kinds or laws(scene.effects).pushes else 1.0


def _crept(scene: Scene, sole: Foot | Waypoints) -> float:
    """The share of the creep speed at which `standard` creeps by `CREPT` of a foot's depth in a stride."""
    depth = scene.walker.mass * scene.gravity[1] / (scene.scale.stress * _length(sole) * sole.width)
    return CREPT * depth / (STATED_CREEP * scene.gait.period)


def _length(sole: Foot | Waypoints) -> float:
    """Of the sole, m."""
    return 2.0 * sole.L if isinstance(sole, Waypoints) else float(np.ptp(sole.contour[:, 0]))


def _bends(sole: Foot | Waypoints) -> float:
    """Plates that the contour needs, however soft the sand."""
    if isinstance(sole, Waypoints):
        return EACH * (sole.n - 1)
    sharp = corners(sole.contour)
    turns = np.abs(turns_of(sole.contour[None])[0])
    turns[sharp] = 0.0
    return EACH * (len(sharp) + 1) + float(turns.sum()) / BEND


def _narrow(scene: Scene, sole: Foot | Waypoints) -> float:
    """Plates that are no longer than the narrowest patch, or gap between two."""
    patches = next((effect for effect in scene.effects if isinstance(effect, Patches)), None)
    if patches is None:
        return 0.0
    edges = np.unique([*patches.begins, *patches.ends])
    return _length(sole) / max(float(np.diff(edges).min()), patches.blur / 2)


def _touching(scene: Scene, sole: Foot | Waypoints) -> float:
    """Plates of which enough are in the sand under a walker who stands on one foot."""
    if isinstance(sole, Foot):
        return _standing(scene, sole.points(POINTS)[None], sole.width)
    try:
        return _of_space(scene, sole)
    except TypeError:  # an effect of a user's own that cannot be hashed
        return _of_space.__wrapped__(scene, sole)


@lru_cache(maxsize=256)
def _of_space(scene: Scene, space: Waypoints) -> float:
    heights = np.random.default_rng(0).integers(1, space.K + 1, (PROBES, space.n))
    return _standing(scene, space.points(heights, POINTS), space.width)


def _standing(scene: Scene, points: Array, width: float) -> float:
    """Plates that soles (designs, m, 2), m, need at whichever of `PITCHES` the most."""
    fill = filler(scene.effects)
    points = points if fill is None else fill(points)
    middle = 0.5 * (points[:, 1:] + points[:, :-1])
    length = np.linalg.norm(np.diff(points, axis=1), axis=2)
    sin, cos = np.sin(PITCHES)[:, None, None], np.cos(PITCHES)[:, None, None]
    rise = sin * middle[..., 0] + cos * middle[..., 1]
    rise -= rise.min(axis=2, keepdims=True)
    scale, loads, place = scene.scale, laws(scene.effects).loads, np.zeros(1)
    if loads is not None:  # where the sand is strongest on the way
        way = np.linspace(0.0, scale.distance, PLACES)
        place = way[np.argmax(_strength(loads, np.full(PLACES, scale.depth), way))]
    low, high = np.zeros((len(PITCHES), len(points), 1)), np.full((len(PITCHES), len(points), 1), DEEPEST)
    for _ in range(HALVES):
        middle_depth = 0.5 * (low + high)
        strength = _strength(loads, np.maximum(middle_depth - rise, 0.0), place)
        carried = scale.stress * width * (strength * length).sum(axis=2, keepdims=True)
        enough = carried >= scene.walker.mass * scene.gravity[1]
        low, high = np.where(enough, low, middle_depth), np.where(enough, middle_depth, high)
    touches = high > rise
    share = (touches * length).sum(axis=2) / length.sum(axis=1)
    pieces = touches[..., 0] + (touches[..., 1:] & ~touches[..., :-1]).sum(axis=2)
    return float((np.maximum(TOUCHING, PIECE * pieces) / share).max())


def _strength(loads: Any, depth: Array, place: Array) -> Array:
    """Strength of the sand integrated over depth, m."""
    if loads is None:
        return depth
    none = np.zeros_like(depth)
    return np.asarray(effects.load(loads, (depth, none + 1.0, none), depth, none + place)[0])
