"""An accuracy as a scene and a sole need it: presets are stated for the paper's walker, feet and sands.

Some things make a walk harder than those, and each is a rule here:

- A smaller walker takes shorter strides at lower speeds. The time step is in proportion to the stride's
  period, the control and the creep speed to the legs' length over it, and never larger than the preset's.
- A sole with more waypoints or corners needs more plates, at `standard` `EACH` a waypoint.
- No plate is to be longer than the narrowest patch of sand.
- The harder the sand under a light walker, the shorter the part of the sole that carries it. At least
  `TOUCHING` plates are to touch the sand when it stands, whatever the pitch of its foot, and `PIECE` in each
  piece of a sole that touches it in several, as a comb does.
- Where the force depends on the plates' normals, or bristles remember their motion, a plate's mean is of a
  lower order: such an effect says how many times more plates there are to be (`Effect.plates_factor`).
- A foot that sticks creeps. Over a stride it is to creep by at most `CREPT` of the depth to which it sinks.
- A foot that is kept level strikes with its whole sole at once, and no turn of it smooths the direction of
  motion. It has `EVENLY` times more plates and half the creep speed; with bristles, shorter steps, too.
- Effects that change the force on a plate make impacts short, as hard sand does, and bristles bend within
  them. Where there are such, or more plates than the preset's, steps are half as long and held to a quarter
  of the control.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.compiled import cached_njit
from footopt.effects import base as effects
from footopt.effects import bristle_length, laws, reshaping
from footopt.effects.dual import Dual
from footopt.errors import SettingError
from footopt.foot import Foot, Plates, Waypoints
from footopt.foot.foot import points_of
from footopt.foot.plates import CORNER
from footopt.gait import Gait
from footopt.walk.accuracy import MOST_PLATES, Accuracy
from footopt.walk.own_code import compiled_for
from footopt.walk.scene import Scene, Walker
from footopt.walk.state import LANES

Array = NDArray[np.float64]

PERIOD, LEG = 1.2, Walker().l1 + Walker().l2  # of the walk that presets are measured with
STATED = 56  # plates along a sole, of which the next three are stated; a preset with more has more of them
STATED_CREEP = 1e-4  # m/s, of which `CREPT` is stated
EACH = 5  # plates a waypoint, or a straight side between two corners
BEND = 0.2  # rad by which a sole turns within a plate: five a waypoint of a rough sole
TOUCHING, PIECE = 8, 4  # plates in the sand under a standing walker, and in each piece of its sole there
SLOWEST = 0.05  # times the creep speed, at least: evaluations double where it is a fifth and feet are level
CREPT = 0.03  # of the depth to which a level foot sinks: on hard sand so much at `standard`
SHORTER, CLOSER = 0.5, 0.25  # times the step, and its control, where impacts are short
LEVEL = 0.1  # rad by which a foot's pitch changes in a stride, at most, if it is kept level
EVENLY, SLOWER = 1.5, 0.5  # times more plates, and times the creep speed, of such a foot
SETTLING = 0.125  # times the control once more, in half the step again, where bristles hold such a foot
MOST = 32  # times the preset's plates

PHASES = 32  # of a stride, at which a foot's pitch is looked at
PROBES = 3  # random soles that stand for a space
PITCHES = np.radians([-20.0, -10.0, 0.0, 10.0, 20.0])
POINTS = 200  # along a sole that stands
PLACES = 64  # on the walker's way, of which the one with the strongest sand counts
DEEPEST, NEARLY = 10.0, 1e-8  # m: how deep a sole may stand, and how exactly that is found


def adapted(accuracy: Accuracy, scene: Scene, sole: Foot | Waypoints) -> Accuracy:
    """An accuracy that is to follow the scene (`Accuracy.adapt`) as numbers; any other as it is.

    Parameters
    ----------
    accuracy : Accuracy
        A preset, or one within a tolerance.
    scene : Scene
        The walker, its gait and the sand.
    sole : Foot or Waypoints
        One foot, or the space of all feet: these share a number of plates.
    """
    return _each(accuracy, scene, [sole])[0]


def accuracies(
    feet: Any, scene: Scene, accuracy: Accuracy, space: Waypoints | None
) -> dict[Accuracy, list[int]]:
    """The numbers that an accuracy comes to (`adapted`), each with the places of the feet that have them."""
    if isinstance(feet, Plates):
        return {replace(accuracy, adapt=False): list(range(len(feet.x)))}
    if len(feet) == 0:
        raise SettingError("feet", "[]", "at least one foot")
    if not isinstance(feet[0], Foot):
        return {adapted(accuracy, scene, space or Waypoints(n=len(feet[0]))): list(range(len(feet)))}
    found: dict[Accuracy, list[int]] = {}
    for i, own in enumerate(_each(accuracy, scene, feet)):
        found.setdefault(own, []).append(i)
    return found


def _each(accuracy: Accuracy, scene: Scene, soles: Sequence[Foot | Waypoints]) -> list[Accuracy]:
    """The numbers that an accuracy comes to for each of some soles."""
    if not accuracy.adapt:
        return [accuracy] * len(soles)
    period = scene.gait.period / PERIOD
    legs = (scene.walker.l1 + scene.walker.l2) / LEG
    slower, shorter = min(legs / period, 1.0), min(period, 1.0)
    level, bristles = _keeps_level(scene.gait), bristle_length(scene.effects) is not None
    slip, evenly = (SLOWER, EVENLY) if level else (1.0, 1.0)
    impacts = bristles or any(laws(scene.effects))
    finer, weight = _finer(scene), scene.walker.mass * scene.gravity[1]

    @cache
    def numbers(needed: float, area: float) -> Accuracy:
        # the share of the creep speed at which `standard` creeps by `CREPT` of a foot's depth in a stride
        crept = CREPT * (weight / area) / (STATED_CREEP * scene.gait.period)
        step, held = (SHORTER, CLOSER) if needed > 1.0 or impacts else (1.0, 1.0)
        if level and bristles:
            step, held = SHORTER * step, SETTLING * held
        return replace(
            accuracy,
            dt=step * shorter * accuracy.dt,
            control=None if accuracy.control is None else held * slower * accuracy.control,
            creep=accuracy.creep * max(min(slower, crept) * slip, SLOWEST),
            plates=_blocks(accuracy.plates, min(finer * needed, MOST)),
            adapt=False,
        )

    bodies = [getattr(sole, "space", None) or sole for sole in soles]
    distinct = list(dict.fromkeys(bodies))
    found = {}
    for sole, standing in zip(distinct, _standing(scene, distinct), strict=True):
        bends, length = _outline(sole)
        needed = min(max(1.0, max(bends, standing, _narrow(scene, length)) / STATED), MOST)
        found[sole] = numbers(needed * evenly, scene.scale.stress * length * sole.width)
    return [found[sole] for sole in bodies]


@lru_cache(maxsize=64)
def _keeps_level(gait: Gait) -> bool:
    """Whether a foot hardly turns in a stride."""
    walks = replace(gait, start=0.0)
    t = walks.heel_strike + walks.period * np.arange(PHASES) / PHASES
    return bool(np.ptp(walks.pose(t, LEG / 2, LEG / 2).pitch[:, 0]) < LEVEL)


def _blocks(preset: int, times: float) -> int:
    """So many times a preset's plates, a whole number of blocks if more."""
    if times <= 1.0:
        return preset
    return min(LANES * math.ceil(times * preset / LANES - 1e-9), MOST_PLATES)


def _finer(scene: Scene) -> float:
    """How many times more plates the effects of a scene need."""
    return max((effect.plates_factor for effect in scene.effects), default=1.0)


def _outline(sole: Foot | Waypoints) -> tuple[float, float]:
    """Plates that the outline of a sole needs, however soft the sand, and its length, m."""
    if isinstance(sole, Waypoints):
        return EACH * (sole.n - 1), 2.0 * sole.L
    bends, length = outline_of(sole.contour, sole.arc_and_turns[1])
    return bends, length


@cached_njit(nogil=True, error_model="numpy")
def outline_of(contour, turns):
    """Plates for the sides of a contour between corners and for the bends of each, and its length, m."""
    bends = 1.0 * EACH
    for turn in np.abs(turns):
        bends += EACH if turn > CORNER else turn / BEND
    return bends, contour[:, 0].max() - contour[:, 0].min()


def _narrow(scene: Scene, length: float) -> float:
    """Plates of a sole (m) that are no longer than the least length over which the sand changes."""
    return length / min((effect.narrowest for effect in scene.effects), default=math.inf)


def _standing(scene: Scene, soles: Sequence[Foot | Waypoints]) -> list[float]:
    """Plates of which enough are in the sand under a walker that stands on one foot, by sole."""
    feet = [sole for sole in soles if isinstance(sole, Foot)]
    drawn = iter(_under_feet(scene, feet) if feet else ())
    return [next(drawn) if isinstance(sole, Foot) else _of_space(scene, sole) for sole in soles]


def _of_space(scene: Scene, space: Waypoints) -> float:
    """The most plates that a few random soles of a space need."""
    try:
        return _probed(scene, space)
    except TypeError:  # an effect of a user's own that cannot be hashed
        return _probed.__wrapped__(scene, space)


@lru_cache(maxsize=256)
def _probed(scene: Scene, space: Waypoints) -> float:
    heights = np.random.default_rng(0).integers(1, space.K + 1, (PROBES, space.n))
    return max(_under_feet(scene, [Foot.from_waypoints(k, space) for k in heights]))


def _under_feet(scene: Scene, feet: Sequence[Foot]) -> list[float]:
    """`_standing` of feet."""
    points, fill = points_of(feet, POINTS), reshaping(scene.effects)
    points = points if fill is None else fill(points)
    scale, loads, place = scene.scale, laws(scene.effects).loads, 0.0
    if loads is not None:  # where the sand is strongest on the way
        way = np.linspace(0.0, scale.distance, PLACES)
        place = float(way[np.argmax(effects.load(loads, np.full(PLACES, scale.depth), way))])
    area = scene.walker.mass * scene.gravity[1] / (scale.stress * np.array([foot.width for foot in feet]))
    found: list[float] = compiled_for(standing_plates, loads or ())(points, area, loads, place).tolist()
    return found


def standing_plates(points, area, loads, place):
    """Plates that soles (designs, m, 2), m, need at whichever of `PITCHES` the most, (designs,).

    A sole stands so deep that its lengths times the sand's strengths there sum to `area` (designs,), m^2.
    """
    designs, m = len(points), points.shape[1] - 1
    found, rise, length = np.zeros(designs), np.empty(m), np.empty(m)
    for d in range(designs):
        for pitch in PITCHES:
            sin, cos, lowest, whole = np.sin(pitch), np.cos(pitch), np.inf, 0.0
            for i in range(m):
                ax, az, bx, bz = points[d, i, 0], points[d, i, 1], points[d, i + 1, 0], points[d, i + 1, 1]
                rise[i] = sin * 0.5 * (ax + bx) + cos * 0.5 * (az + bz)
                length[i] = np.sqrt((bx - ax) ** 2 + (bz - az) ** 2)
                lowest, whole = min(lowest, rise[i]), whole + length[i]
            for i in range(m):
                rise[i] -= lowest
            low, high, depth = 0.0, DEEPEST, area[d] / whole
            while high - low > NEARLY:
                carried, slope = 0.0, 0.0
                for i in range(m):
                    if depth > rise[i]:
                        strength = effects.load(loads, Dual(depth - rise[i], 1.0, 0.0), place)
                        carried += length[i] * strength.value
                        slope += length[i] * strength.dx
                low, high = (low, depth) if carried >= area[d] else (depth, high)
                step = (area[d] - carried) / slope
                if abs(step) < NEARLY:
                    break
                depth = depth + step if low < depth + step < high else 0.5 * (low + high)
            high = depth
            touching, pieces = 0.0, 0
            for i in range(m):
                if high > rise[i]:
                    touching += length[i]
                    pieces += i == 0 or high <= rise[i - 1]
            found[d] = max(found[d], max(TOUCHING, PIECE * pieces) * whole / touching)
    return found
