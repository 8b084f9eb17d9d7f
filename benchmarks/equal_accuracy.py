"""What a method costs at a given error: its cheapest time step, or step control, found by bisection."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from measure import error, interleaved
from numpy.typing import NDArray

import footopt as fo
from footopt.walk.accuracy import PRESETS

Array = NDArray[np.float64]

COARSEST = 0.05  # s
LONGEST = (2e-2, 1e-2, 5e-3)  # s, steps under control
CONTROLS = (1e-1, 1e-7)  # m/s, from the loosest to the tightest


def converged(k: Array, scene: fo.Scene, plates: int) -> Array:
    """The five objectives in the limit of small steps, with the same plates and creep speed."""
    return fo.evaluate(k, scene, fo.Accuracy("sdirk2", 1e-4, plates)).values


def cheapest(
    stepper: str, k: Array, scene: fo.Scene, target: float, plates: int = 64, halvings: int = 5
) -> fo.Accuracy:
    """The largest time step whose error (see `measure.error`) is at most the target, in %.

    Steps are quartered until one meets the target; the last factor of four is then bisected in the
    logarithm. A step that meets it by luck above one that does not can be missed.
    """
    exact = converged(k, scene, plates)

    def meets(steps: int) -> bool:
        accuracy = replace(start, dt=scene.duration / steps)
        return error(fo.evaluate(k, scene, accuracy).values, exact) <= target

    start = fo.Accuracy(stepper, COARSEST, plates)
    few = many = start.steps(scene.duration)
    while not meets(many):
        few, many = many, 4 * many
        if many > 4_000_000:
            raise RuntimeError(f"{stepper} does not reach {target} %")
    for _ in range(halvings):
        middle = round(np.sqrt(few * many))
        few, many = (few, middle) if meets(middle) else (middle, many)
    return replace(start, dt=scene.duration / many)


def controlled(k: Array, scene: fo.Scene, target: float, plates: int = 64, halvings: int = 5) -> fo.Accuracy:
    """The default stepper under the step control that meets the target (%) with the fewest evaluations."""
    exact = converged(k, scene, plates)
    found: list[tuple[float, fo.Accuracy]] = []
    for dt in LONGEST:
        loose, tight = CONTROLS
        for _ in range(halvings + 3):
            middle = float(np.sqrt(loose * tight))
            accuracy = fo.Accuracy(dt=dt, plates=plates, control=middle)
            table = fo.evaluate(k, scene, accuracy)
            if error(table.values, exact) <= target:
                tight = middle
                found.append((float(table.evaluations.mean()), accuracy))
            else:
                loose = middle
    return min(found, key=lambda pair: pair[0])[1]


def compare(
    sand_scene: fo.Scene, k: Array, target: float, repeats: int = 5, halvings: int = 5
) -> tuple[dict[str, fo.Accuracy], dict[str, float]]:
    """Explicit Euler, the default stepper, and that one under control, at one target error (%).

    Returns
    -------
    settings, and s per design, by method: "explicit", "fixed" and "controlled".
    """
    default = PRESETS["standard"].stepper
    found = {
        name: cheapest(stepper, k, sand_scene, target, halvings=halvings)
        for name, stepper in (("explicit", "explicit_euler"), ("fixed", default))
    }
    found["controlled"] = controlled(k, sand_scene, target, halvings=halvings)
    jobs = {
        name: (lambda accuracy=accuracy: fo.evaluate(k, sand_scene, accuracy, threads=1))
        for name, accuracy in found.items()
    }
    times = interleaved(jobs, repeats)
    return found, {name: value / len(k) for name, value in times.items()}
