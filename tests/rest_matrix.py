"""Who stands on sand for a minute: how far he moves, and where numerics put him.

``python tests/rest_matrix.py OUT.csv`` stands on six sands and three slopes, by the presets, at three time
steps and at a tenth of delta, a row each. It continues an OUT.csv that is there, and prints the table of
docs/effects.md.
"""

import csv
import itertools
import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import footopt as fo
from footopt.walk.accuracy import resolve
from footopt.walk.batch import REASONS, Options, walk_batch
from footopt.walk.ladder import numerics as numbers_of
from footopt.walk.metrics import Sample

FOOT = fo.Foot.from_waypoints([1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 8])
HOLLOW = fo.Foot.from_waypoints([8, 8, 4, 1, 1, 1, 1, 1, 4, 8, 8])
STILL = fo.Gait.human(start=math.inf)
LEVEL = replace(STILL, foot=type(STILL.thigh)(0.0, (0.0,), (0.0,)), pitch="measured")
ZETAS = (0.05, 0.2, 1.0, 5.0, 50.0, 500.0)
SLOPES = (0.0, 5.0, 15.0)  # deg; a level sole slides for ever from 19.9 on
DELTA = 1e-6  # m
BY_HAND = (("dt 1e-2", 1e-2, DELTA), ("dt 1e-2, delta/10", 1e-2, DELTA / 10), ("dt 1e-3", 1e-3, DELTA),
           ("dt 1e-4", 1e-4, DELTA))  # fmt: skip
#: Accuracies and delta by name; `reference` and steps of 0.1 ms take minutes, and come last.
NUMERICS = {
    **{name: (name, DELTA) for name in ("draft", "standard", "fine")},
    **{name: (fo.Accuracy(dt=dt, plates=56), delta) for name, dt, delta in BY_HAND},
    "reference": ("reference", DELTA),
}
COLUMNS = ("numerics", "slope", "zeta", "reason", "drift", "x", "z", "load")


def stand(zeta, slope, numerics, t_f=60.0, foot=FOOT, gait=STILL):
    """A row: drift over the second half and last place of the hip (m), and the load's error as a share."""
    accuracy, delta = NUMERICS[numerics]
    effects = (fo.Rest(delta), *((fo.Slope(slope),) if slope else ()))
    scene = fo.Scene(sand=fo.Sand(zeta), gait=gait, t_f=t_f, effects=effects)
    accuracy = numbers_of(resolve(accuracy), scene, foot)
    # `fo.simulate` would keep what each plate remembers at every step: at `reference` up to 40 GB
    asked = Options(sink=False, threads=1, traced=True, remembers=False)
    walked = walk_batch(foot.plates(accuracy.plates, accuracy.rule), scene, accuracy, asked)
    c = Sample(*walked.trace[np.isfinite(walked.trace).all(axis=1)].T)
    com = np.stack([c.x, c.z], axis=1)
    late, carries = com[c.t > 0.5 * t_f], scene.walker.mass * scene.gravity[1]
    load = abs((c.fz_left[-1] + c.fz_right[-1]) / carries - 1.0)
    reason = REASONS[int(walked.status[0])]
    return numerics, slope, zeta, reason, float(np.hypot(*np.ptp(late, axis=0))), *com[-1], load


def spread(places):
    """How far apart places (x, z), m, are at most along both directions."""
    return float(np.hypot(*np.ptp(np.array(places, float), axis=0)))


def table(rows):
    """For each slope how far apart numerics put him on each sand, and the largest drift, as Markdown."""
    yield "| slope | " + " | ".join(f"zeta {zeta:g}" for zeta in ZETAS) + " | largest drift |"
    for slope in SLOPES:
        here = [row for row in rows if float(row["slope"]) == slope and not row["reason"]]
        apart = [
            spread([(row["x"], row["z"]) for row in here if float(row["zeta"]) == zeta]) for zeta in ZETAS
        ]
        cells = " | ".join(f"{1e6 * value:.2g} um" for value in apart)
        yield f"| {slope:g} deg | {cells} | {1e6 * max(float(row['drift']) for row in here):.1g} um |"


def run(path, *how):
    """Stand where a table has no row yet."""
    path, there = Path(path), set()
    who = {"foot": HOLLOW if "hollow" in how else FOOT, "gait": LEVEL if "level" in how else STILL}
    if path.exists():
        with open(path, newline="") as file:
            there = {
                (row["numerics"], float(row["slope"]), float(row["zeta"])) for row in csv.DictReader(file)
            }
    with open(path, "a", newline="") as file:
        writer = csv.writer(file)
        if not there:
            writer.writerow(COLUMNS)
        for numerics, slope, zeta in itertools.product(NUMERICS, SLOPES, ZETAS):
            if (numerics, slope, zeta) not in there:
                writer.writerow(stand(zeta, slope, numerics, **who))
                file.flush()
    with open(path, newline="") as file:
        print("\n".join(table(list(csv.DictReader(file)))))


if __name__ == "__main__":
    run(*sys.argv[1:])
