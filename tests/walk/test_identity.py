"""Walks are the same, to the last bit, as those of the release before.

`identity.csv` holds what random feet do in every sand, effect, preset and stepper. On the processor and
with the libraries that wrote it, walks agree bit for bit; elsewhere within the rounding of others.
A change of the compiled arithmetic writes the file again and says so: ``python tests/walk/test_identity.py``.
"""

import csv
import hashlib
from dataclasses import replace
from pathlib import Path

import llvmlite
import numba
import numpy as np
import pytest

import footopt as fo
from footopt.compiled import target

FILE = Path(__file__).with_name("identity.csv")
SANDS = ("soft", "regular", "hard", "poppy_loose", "poppy_close", "glass_beads", "medium_sand",
         "mars_simulant")  # fmt: skip
EFFECTS = {
    "plain": (),
    "leading edge": (fo.LeadingEdge(),),
    "slope": (fo.Slope(),),
    "all": (  # as many interfaces and patches as in `every_effect`: another number is compiled again
        fo.Layers((0.02, 0.05), (0.6, 1.5)),
        fo.Patches((0.35, 1.2), (0.95, 1.6), (0.7, 1.5)),
        fo.LeadingEdge(),
        fo.Inertia(),
        fo.Slope(),
        fo.Shadowing(),
    ),
}
#: Effects that are walked in three sands, at two presets, by fewer feet.
FEWER = {"rest": (fo.Rest(),), "shadowing": (fo.Shadowing(),)}
#: Sands differ in numbers, effects in code, and so does reference, which controls no step. So one effect is
#: walked in the first three sands, these in all sands, and plain ones at reference in the first three.
EVERYWHERE = ("plain", "all")
#: How many of the 200 feet walk at each preset: the finer, the fewer.
FEET = {"draft": 200, "standard": 200, "fine": 40, "reference": 2}
STEPPERS = {
    "explicit_euler": 1e-3,
    "semi_implicit_euler": 1e-3,
    "heun": 1e-3,
    "rk4": 1e-3,
    "implicit_euler": 5e-3,
    "sdirk2": 5e-3,
}
OBJECTIVES = (
    "distance", "mean_height", "work", "peak_power", "speed_loss", "efficiency", "cost_of_transport",
    "joint_work", "maximum_sinkage", "peak_vertical_force",
)  # fmt: skip
#: Relative, of the means of the objectives: what another processor's rounding may change in half of them, and
#: in any. Explicit steps chatter, and with effects that turn forces off some peaks hang on the last digit.
ROUNDING, LAST_DIGIT = 1e-5, 1e-3


#: The presets' numbers when the file was begun: walks are compared, whatever a ladder finds.
NUMBERS = {
    "draft": fo.Accuracy("sdirk2", 0.0125, 32, 1e-4, control=3e-3),
    "standard": fo.Accuracy("sdirk2", 0.01, 56, 1e-4, control=2e-3),
    "fine": fo.Accuracy("sdirk2", 0.01, 192, 2e-5, control=1e-4),
    "reference": fo.Accuracy("sdirk2", 2e-4, 400, 1e-5),
}


def cases():
    """Name of a case, its feet, scene and accuracy."""
    feet = fo.Waypoints().random(200, seed=2026)
    for sand in SANDS:
        scene = fo.Scene(sand=fo.Sand.named(sand))
        for effects, chosen in EFFECTS.items():
            for preset, count in FEET.items():
                if preset == "reference" and (effects != "plain" or sand not in SANDS[:3]):
                    continue
                if effects not in EVERYWHERE and sand not in SANDS[:3]:
                    continue
                yield f"{sand}, {effects}, {preset}", feet[:count], replace(scene, effects=chosen), preset
    for sand in SANDS[:3]:
        scene = fo.Scene(sand=fo.Sand.named(sand))
        for stepper, dt in STEPPERS.items():
            yield f"{sand}, {stepper}", feet[:40], scene, fo.Accuracy(stepper, dt, 64)
        measured = replace(scene, gait=fo.Gait.human(pitch="measured", period=1.1))
        yield f"{sand}, measured pitch", feet[:40], measured, "standard"
        light = replace(scene, walker=fo.Walker(mass=5.0, l1=0.2, l2=0.15, g=3.7), t_f=5.0)
        yield f"{sand}, a light walker", feet[:40], light, "standard"
        closed = fo.Foot.shape("circle", closed=True)
        yield f"{sand}, a closed circle", [closed], replace(scene, effects=(fo.LeadingEdge(),)), "standard"
        for effects, chosen in FEWER.items():
            for preset in ("draft", "standard"):
                yield f"{sand}, {effects}, {preset}", feet[:40], replace(scene, effects=chosen), preset


def measured(feet, scene, accuracy):
    """What is kept of a case: counts, a digest of every bit, and the objectives' means."""
    table = fo.evaluate(feet, scene, NUMBERS.get(accuracy, accuracy), OBJECTIVES)
    digest = hashlib.sha256(np.ascontiguousarray(table.values).tobytes())
    digest.update(table.evaluations.tobytes())
    digest.update(table.counts["plates"].tobytes())
    means = table.values[table.feasible].mean(axis=0) if table.feasible.any() else np.zeros(len(OBJECTIVES))
    counts = [int(table.feasible.sum()), int(table.evaluations.sum()), int(table.counts["plates"].sum())]
    return [*counts, digest.hexdigest()[:16], *map(repr, map(float, means))]


def machine():
    """What the last bit depends on."""
    versions = f"numba {numba.__version__}, llvmlite {llvmlite.__version__}, numpy {np.__version__}"
    return f"{target()['processor']}, {versions}"


def kept():
    """Every case's row of the file, and the machine that wrote it."""
    with open(FILE, newline="", encoding="utf-8") as file:
        first = next(csv.reader(file))[0]
        return first, {row[0]: row[1:] for row in csv.reader(file)}


def compare(wanted):
    """Walk the cases that are wanted, and hold them against the file."""
    where, rows = kept()
    for name, *case in cases():
        if not wanted(name):
            continue
        found, before = measured(*case), rows[name]
        if where == machine():
            assert list(map(str, found)) == before, name
        else:
            assert abs(found[0] - int(before[0])) <= 1, name
            off = np.abs(np.array(found[4:], float) / np.array(before[4:], float) - 1.0)
            assert np.median(off) < ROUNDING, name
            assert off.max() < LAST_DIGIT, name


def test_plain_walks_are_bit_for_bit_those_of_before():
    compare(lambda name: name.endswith("plain, standard") or name.endswith("plain, draft"))


def test_walks_with_every_stepper_are_bit_for_bit_those_of_before():
    compare(lambda name: name.rpartition(", ")[2] in STEPPERS)


@pytest.mark.slow
def test_walks_with_every_effect_preset_and_stepper_are_bit_for_bit_those_of_before():
    compare(lambda name: True)


if __name__ == "__main__":
    with open(FILE, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([machine()])
        for name, *case in cases():
            writer.writerow([name, *measured(*case)])
