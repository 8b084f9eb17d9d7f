"""The run's constants for the page's own walk; and where it cannot walk, why not."""

from dataclasses import asdict
from typing import Any

from footopt.design.scenarios import possible_laws
from footopt.effects import name_of
from footopt.foot import Foot, Waypoints
from footopt.foot.plates import CORNER, RULES
from footopt.foot.waypoints import FINE, slope_matrix
from footopt.gait import STANDING
from footopt.report.page.file import packed
from footopt.report.stage import ARROWS
from footopt.sand.law import EARTH, PER_CM3
from footopt.walk import Accuracy, Scene, discretize, newton
from footopt.walk.accuracy import AnyAccuracy
from footopt.walk.checks import WHY
from footopt.walk.contact import BENT, EXPOSED, TURN
from footopt.walk.ladder import numerics
from footopt.walk.loop import MAX_REPEATS, NEAR_PEAK, PEAK
from footopt.walk.objectives import FLOORS
from footopt.walk.steppers import STEPPERS

STEPPER = "sdirk2"
ROWS = 200_000  # poses, at most, of a walk that a browser is to tabulate: 22 MB


def physics(
    scene: Scene, accuracy: AnyAccuracy, foot: Foot | Waypoints, spread: float = 0.0
) -> dict[str, Any]:
    """The constants, in SI units, of the page's walks: of its one foot, or of all soles of a space.

    `spread` is a standard deviation of the logarithm of zeta, by which other laws of sand differ. Where the
    page cannot walk, only the reason, as "refusal".
    """
    accuracy = numerics(accuracy, scene, foot)
    if why := refusal(scene, accuracy, foot):
        return {"refusal": why}
    gait, walker, (tilt, g) = scene.gait, scene.walker, scene.gravity
    foot_pitch = gait.foot if gait.pitch == "measured" else None
    parts = RULES[accuracy.rule]
    return {
        "sand": {
            "zeta": scene.sand.zeta,
            "gravity": walker.g / EARTH,
            "unit": PER_CM3,
            "law": scene.sand.stress_map.law._asdict(),
        },
        "walker": asdict(walker),
        "gravity": {"g": g, "tilt": tilt},
        "gait": {
            "thigh": gait.thigh._asdict(),
            "knee": gait.knee._asdict(),
            "pitch": None if foot_pitch is None else foot_pitch._asdict(),
            "start": gait.start,
            "period": gait.period,
            "standing": STANDING,
        },
        "end": scene.duration,
        "strike": gait.heel_strike,
        "accuracy": {
            **asdict(accuracy),
            "parts": parts,
            "gamma": STEPPERS[STEPPER].parameters.gamma,
            "rest": discretize.REST,
            "halvings": discretize.HALVINGS,
            "newton": newton.NEWTON,
            "most": newton.MAX_NEWTON,
            "shortest": newton.SHORTEST,
            "inside": newton.INSIDE,
            "gated": newton.SMOOTH_STEP,
            "turn": TURN,
            "exposed": EXPOSED,
            "bent": BENT,
            "corner": CORNER,
            "near": NEAR_PEAK,
            "peak": PEAK,
            "repeats": MAX_REPEATS,
        },
        "arrows": ARROWS,
        "effects": _laws(scene),
        "others": [
            {
                "law": other.name,
                "zeta": other.scene.sand.zeta / scene.sand.zeta,
                "effects": _laws(other.scene),
            }
            for other in possible_laws(scene, spread)[1:]
            if all(e.in_page for e in other.scene.effects)
        ],
        "why": [WHY[name] for name in ("depth of the sole", "depth of the ankle")],
        "floors": FLOORS,
        "foot": {"ankle": foot.ankle, "width": foot.width},
        # of a sole without waypoints
        "points": packed(foot.points(accuracy.plates, parts), double=True)
        if isinstance(foot, Foot) and foot.k is None
        else None,
    }


def _laws(scene: Scene) -> dict[str, Any]:
    """The laws of effects by their names."""
    return {name_of(e): e.law._asdict() for e in scene.effects if e.law is not None}


def spline(space: Waypoints) -> dict[str, Any]:
    """The constants of the splines through waypoints."""
    return {**asdict(space), "fine": FINE, "slopes": slope_matrix(space.n)}


def refusal(scene: Scene, accuracy: Accuracy, foot: Foot | Waypoints) -> str:
    """The reason for which the page cannot walk by itself, or ""."""
    if others := [name_of(e) for e in scene.effects if not e.in_page]:
        return f"effects={', '.join(others)} of this run is not in the page's own walk"
    if accuracy.stepper != STEPPER:
        return f"accuracy.stepper={accuracy.stepper} of this run is not in the page's own walk"
    if foot.closed:
        return "foot.closed=true of this run is not in the page's own walk"
    if discretize.pose_rows(scene.path, accuracy) > ROWS:
        return "the walk of this run is too long, or its steps are too short, to be made while one waits"
    return ""
