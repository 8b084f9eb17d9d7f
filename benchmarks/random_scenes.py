"""Scenes and feet as users may have them, drawn at random: what promises about accuracy are held to.

A scene is drawn by its number alone, so that a sample of any size begins alike. What is drawn:

- gait: human (a third), the human one with swing x 0.8 to 1.2 and random changes of 1 to 4 deg in its mean
  and its first two harmonics (a third), or fitted to angles of a made-up machine: a thigh that swings by 12
  to 28 deg, a knee that bends by 15 to 60 deg in swing (a third). The foot's pitch is that of the shank, as
  measured, or level.
- walker: legs of 0.15 to 1.1 m, 0.5 to 200 kg, on the Earth (70 %), Mars or the Moon; a stride takes 0.8 to
  1.5 times what the human one does at that size and gravity.
- sand: zeta from 0.05 to 500, log-uniform, the measured media among them, by the generic map (80 %), or with
  coefficients that differ by up to 20 %; the walker sinks by 0.1 mm at least and half of his shank at most.
- effects: none (a fifth), or one of `EFFECTS`.
- feet: random soles of a space with 5, 11 or 21 waypoints (rough), soles of 21 with a smooth contour, the
  paper's shapes, or a comb; as long as fits the leg. A third of the feet in scenes with the leading edge are
  closed.
- duration: two strides after the start, or between 0.02 and 4 strides after the first heel strike.

``python benchmarks/random_scenes.py FIRST LAST OUT.csv`` judges two feet of each scene from FIRST up to LAST,
a row a foot and preset (80 scenes take a quarter of an hour of one core). It continues an OUT.csv that is
there, stops after the seconds that a fourth argument says, and prints tables for docs/evidence/accuracy.md.
Without OUT.csv it judges J_W at `standard` with all feet of the scenes.
"""

import csv
import itertools
import math
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

import footopt as fo
from footopt.design.scenarios import deformed
from footopt.errors import FootoptError
from footopt.foot import as_feet
from footopt.sand import MEDIA
from footopt.walk.accuracy import PRESETS, TOLERANCES, work
from footopt.walk.ladder import numerics
from footopt.walk.objectives import FIVE, sizes

FEET = 16  # of a scene whose feet are waypoints


class Drawn(NamedTuple):
    """A scene and who walks through it: heights in a space, or feet."""

    scene: fo.Scene
    feet: object
    space: fo.Waypoints | None
    about: dict[str, object]

    def foot(self, i):
        """One of them."""
        return self.feet[i] if self.space is None else fo.Foot.from_waypoints(self.feet[i], self.space)


def _layers(rng, size):
    """Two interfaces near where feet get to; a factor beyond 10 is a hard pan."""
    depths = np.sort(rng.uniform(0.2, 2.5, 2)) * size
    return fo.Layers((depths[0], depths[1] + 1e-6), tuple(10.0 ** rng.uniform(-1.0, 2.0, 2)))


def _sheets(rng, size):
    """Fifty layers, each up to twice as strong as the one above."""
    return fo.Layers(tuple(0.05 * size * np.arange(1, 51)), tuple(2.0 ** rng.uniform(-1.0, 1.0, 50)))


def _patches(rng, leg):
    """Two patches under the walker's way, with edges from sharp to wide."""
    edges = np.sort(rng.uniform(-0.2, 2.5, 4)) * leg
    factors, blur = 10.0 ** rng.uniform(-0.7, 0.7, 2), 10.0 ** rng.uniform(-3.0, -1.0)
    return fo.Patches(tuple(edges[::2]), tuple(edges[1::2]), tuple(factors), blur=max(blur * leg, 1e-4))


def _slope(rng):
    return fo.Slope(rng.uniform(-12.0, 12.0))


#: Effects of a scene by name, from the random generator, the depth to which a foot sinks and the leg, m.
EFFECTS = {
    "slope": lambda rng, size, leg: (_slope(rng),),
    "leading edge": lambda rng, size, leg: (fo.LeadingEdge(),),
    "inertia": lambda rng, size, leg: (fo.Inertia(),),
    "leading edge, inertia": lambda rng, size, leg: (fo.LeadingEdge(), fo.Inertia()),
    "leading edge, shadowing": lambda rng, size, leg: (fo.LeadingEdge(), fo.Shadowing()),
    "layers": lambda rng, size, leg: (_layers(rng, size),),
    "sheets": lambda rng, size, leg: (_sheets(rng, size),),
    "patches": lambda rng, size, leg: (_patches(rng, leg),),
    "rest": lambda rng, size, leg: (fo.Rest(),),
    "rest, leading edge": lambda rng, size, leg: (fo.Rest(), fo.LeadingEdge()),
    "all": lambda rng, size, leg: (
        _layers(rng, size), _patches(rng, leg), fo.LeadingEdge(), fo.Inertia(), _slope(rng), fo.Shadowing()
    ),
}  # fmt: skip


def _machine(rng, human):
    """A gait fitted to angles that somebody made up."""
    t = np.linspace(0.0, 1.2, 101)
    swing, bend, lift = rng.uniform(12.0, 28.0), rng.uniform(15.0, 60.0), rng.uniform(4.0, 12.0)
    thigh = rng.uniform(0.0, 10.0) + swing * np.cos(2 * np.pi * t / 1.2)
    knee = lift + bend * np.exp(-(((t / 1.2 - 0.72) / rng.uniform(0.09, 0.14)) ** 2))
    knee[-1] = knee[0]
    gait = fo.fit_gait(t, thigh, knee, harmonics=int(rng.integers(3, 9)))
    return replace(gait, foot=human.foot, name="machine")


def _gait(rng, stretch):
    human = fo.Gait.human()
    kind = rng.choice(["human", "deformed", "machine"])
    gait = human
    if kind == "deformed":
        changes = rng.normal(0.0, rng.uniform(0.5, 2.0), (2, 5))
        gait = replace(deformed(human, rng.uniform(0.8, 1.2), *changes), name="deformed")
    elif kind == "machine":
        gait = _machine(rng, human)
    pitch = rng.choice(["shank", "shank", "measured", "level"])
    if pitch == "level":
        gait = replace(gait, foot=type(human.thigh)(0.0, (0.0,), (0.0,)))
    period = 1.2 * stretch * rng.uniform(0.8, 1.5)
    return replace(gait, period=period, pitch="shank" if pitch == "shank" else "measured"), kind, pitch


def _feet(rng, leg, closed):
    """Heights and their space, or feet."""
    length = 0.26 * leg / 0.92 * rng.uniform(0.4, 1.5)
    width = length * rng.uniform(0.2, 0.5)
    ankle = (rng.uniform(-0.3, 0.2) * length, rng.uniform(0.0, 0.2) * length)
    kind = rng.choice(["rough", "rough", "rough", "smooth", "shapes", "comb"])
    if kind == "shapes":
        names = ("ellipse", "rectangle", "circle", "reversed_l", "reversed_triangle")
        feet = [fo.Foot.shape(n, length, width=width, ankle=ankle, closed=closed) for n in names]
        return feet, None, kind
    if kind == "comb":
        teeth = int(rng.integers(5, 30))
        x = np.linspace(-0.5, 0.5, 2 * teeth + 1) * length
        z = -0.1 * length * (np.arange(2 * teeth + 1) % 2) * rng.uniform(0.2, 1.0)
        return [fo.Foot(np.stack([x, z], axis=1), width, ankle, "comb", closed=closed)], None, kind
    n = int(rng.choice([5, 11, 11, 21])) if kind == "rough" else 21
    space = fo.Waypoints(n, int(rng.choice([5, 10, 50])), length / 2, length * rng.uniform(0.06, 0.15), width,
                         ankle, closed=closed)  # fmt: skip
    if kind == "rough":
        return rng.integers(1, space.K + 1, (FEET, n)), space, kind
    u, waves = np.linspace(0.0, 1.0, n), np.arange(1, 5)
    heights = rng.normal(0.0, 1.0 / waves, (FEET, 4)) @ np.sin(np.pi * waves[:, None] * u)
    heights = (heights - heights.min(axis=1, keepdims=True)) / np.ptp(heights, axis=1, keepdims=True)
    return 1 + np.round(heights * (space.K - 1)).astype(int), space, kind


def draw(number):
    """The scene of a number."""
    for attempt in itertools.count():
        rng = np.random.default_rng([20260, number, attempt])
        leg, g = np.exp(rng.uniform(np.log(0.15), np.log(1.1))), rng.choice([9.81] * 7 + [3.71, 3.71, 1.62])
        split = rng.uniform(0.4, 0.6)
        mass = np.exp(rng.uniform(np.log(0.5), np.log(200.0)))
        walker = fo.Walker(mass, split * leg, (1.0 - split) * leg, g)
        zeta = rng.choice(list(MEDIA.values())) if rng.random() < 0.2 else 10.0 ** rng.uniform(-1.3, 2.7)
        coefficients = fo.StressMap()
        if rng.random() < 0.2:
            changed = {n: c * rng.uniform(0.8, 1.2) for n, c in vars(coefficients).items()}
            coefficients = fo.StressMap(**changed)
        gait, kind, pitch = _gait(rng, math.sqrt(leg / 0.92 * 9.81 / g))
        on = "none" if rng.random() < 0.2 else str(rng.choice(list(EFFECTS)))
        closed = "leading edge" in on and rng.random() < 1 / 3
        feet, space, sole = _feet(rng, leg, closed)
        foot = Drawn(None, feet, space, {}).foot(0)
        stress = 1e6 * zeta * g / 9.81
        depth = mass * g / (stress * np.ptp(foot.contour[:, 0]) * foot.width)
        if not 1e-4 < depth < 0.25 * leg:
            continue
        late = gait.heel_strike + gait.period * rng.choice([1.5, rng.uniform(0.02, 4.0)], p=[0.7, 0.3])
        try:
            chosen = EFFECTS[on](rng, depth, leg) if on != "none" else ()
            scene = fo.Scene(fo.Sand(zeta, coefficients), gait, walker, float(late), chosen)
        except FootoptError:
            continue
        about = {"gait": kind, "pitch": str(pitch), "effects": on, "feet": sole, "closed": bool(closed),
                 "zeta": float(zeta), "mass": float(mass), "leg": float(leg), "g": float(g),
                 "depth": float(depth), "n": space.n if space else 0, "t_f": float(late)}  # fmt: skip
        return Drawn(scene, feet, space, about)


LEAST = 2e-5  # relative: the truth's own error; a smaller one of a walk is not known
SHOWN = ("gait", "pitch", "effects", "feet", "closed", "n", "zeta", "mass", "leg", "g", "depth", "t_f")


class Judged(NamedTuple):
    """Of a foot in a scene: relative errors of the objectives, their estimates, how walks ended, the cost."""

    error: np.ndarray
    estimate: np.ndarray
    reason: str
    truth: str
    work: float  # evaluations of plates, those that take as long as what else is in a walk among them


def truth_of(feet, scene, space=None, refined=False):
    """Objectives and reasons by much finer plates, creep speed and steps; refined: for `fine`."""
    own = numerics(PRESETS["standard"], scene, as_feet(feet, space))
    period, speed = scene.gait.period / 1.2, (scene.walker.l1 + scene.walker.l2) / scene.gait.period
    plates = min(max(1024, 8 * own.plates), 16_000)
    creep = min(2.6e-6 * speed, own.creep / 8)
    finest = fo.Accuracy("sdirk2", 4e-4 * period, plates, creep, "truth", control=1.3e-7 * speed)
    if refined:
        finest = replace(finest.refined(), creep=creep / 4)
    table = fo.evaluate(feet, scene, finest, space=space)
    return table.values, table.reasons


def judge(feet, scene, accuracy="standard", space=None, truth=None):
    """Each foot's `Judged`; truth: as `truth_of` has it."""
    own = fo.evaluate(feet, scene, accuracy, space=space, errors=True)
    values, reasons = truth or truth_of(feet, scene, space)
    size = sizes(values, scene)
    error, estimate = np.abs(own.values - values) / size, own.errors / size
    return [Judged(*row) for row in zip(error, estimate, own.reasons, reasons, work_of(own), strict=True)]


def work_of(table):
    """What each walk of a table takes on any machine, in evaluations of a plate."""
    return work(table.evaluations, table.counts["plates"])


def promises(found, tolerance=0.005):
    """Shares of judged feet, and worst cases, of those that walk: what docs/evidence/accuracy.md has."""
    walked = [one for one in found if not one.truth and not one.reason]
    error, estimate = (np.array([getattr(one, name) for one in walked]) for name in ("error", "estimate"))
    worst, said = error.max(axis=1), estimate.max(axis=1)
    ratio = said / np.maximum(worst, LEAST)
    return {
        "feet": len(found),
        "walked": len(walked),
        "another outcome": sum(one.reason != one.truth for one in found),
        "no estimate": int((~np.isfinite(said)).sum()),
        "within the tolerance": float((worst <= tolerance).mean()),
        "95 % of feet": float(np.percentile(worst, 95)),
        "largest error": float(worst.max()),
        "covered": float((np.maximum(said, LEAST) >= worst).mean()),
        "smallest estimate over error": float(np.nanmin(ratio)),
        "at most 5 times": float((ratio <= 5.0).mean()),
        "each covered": float((np.maximum(estimate, LEAST) >= error).mean()),
        "work of a walk": float(np.median([one.work for one in walked])),
    }


SCENE = ("scene", "foot", "preset", *SHOWN)
NUMBERS = (*FIVE, *(f"{name} estimate" for name in FIVE), "cost")


def judged_rows(number, drawn, count=2):
    """Rows of the table: of the first feet of a scene, at each preset."""
    feet, about = drawn.feet[:count], [drawn.about[name] for name in SHOWN]
    truth = truth_of(feet, drawn.scene, drawn.space, refined=True)
    for preset in TOLERANCES:
        for i, one in enumerate(judge(feet, drawn.scene, preset, drawn.space, truth)):
            numbers = [f"{value:.5g}" for value in (*one.error, *one.estimate, one.work)]
            yield [number, i, preset, *about, one.reason, one.truth, *numbers]


def read_rows(path):
    """Rows of a table that is there, by column."""
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def judged_of(row):
    """The `Judged` of a row."""
    numbers = [float(row[name]) for name in NUMBERS]
    return Judged(np.array(numbers[:5]), np.array(numbers[5:10]), row["reason"], row["truth"], numbers[10])


def tables(rows):
    """What docs/evidence/accuracy.md has of a sample, as lines of Markdown."""
    judged = {name: [(row, judged_of(row)) for row in rows if row["preset"] == name] for name in TOLERANCES}
    told = [promises([one for _, one in judged[name]], TOLERANCES[name]) for name in TOLERANCES]
    yield f"| | {' | '.join(TOLERANCES)} |"
    yield from (f"| {key} | {' | '.join(f'{one[key]:.4g}' for one in told)} |" for key in told[0])
    for column in ("pitch", "effects", "feet", "gait"):
        for kind in sorted({row[column] for row in rows}):
            cells = []
            for name, tolerance in TOLERANCES.items():
                walked = [
                    one for row, one in judged[name] if row[column] == kind and not one.reason + one.truth
                ]
                cells.append(f"{sum(one.error.max() <= tolerance for one in walked)} of {len(walked)}")
            yield f"| {kind} | {' | '.join(cells)} |"
    yield "| quantity | least | 10 % | median | 90 % | largest |"
    for name in ("zeta", "mass", "leg", "g", "depth", "t_f"):
        parts = np.percentile([float(row[name]) for row in rows if row["foot"] == "0"], (0, 10, 50, 90, 100))
        yield f"| {name} | " + " | ".join(f"{value:.3g}" for value in parts) + " |"


def run(first, last, path, seconds=math.inf):
    """Judge the scenes that a table lacks, a scene's rows at a time, and print what docs have of it."""
    begun, path = time.monotonic(), Path(path)
    there = {int(row["scene"]) for row in read_rows(path)} if path.exists() else set()
    with open(path, "a", newline="") as file:
        table = csv.writer(file)
        if not there:
            table.writerow([*SCENE, "reason", "truth", *NUMBERS])
        for number in sorted(set(range(first, last)) - there):
            if time.monotonic() - begun > seconds:
                break
            table.writerows(list(judged_rows(number, draw(number))))
            file.flush()
    print("\n".join(tables(read_rows(path))))


def quotients(first, last):
    """Print how many feet of scenes have all five objectives, and J_W, within 0.5 % at `standard`.

    Against walks at 0.1 %.
    """
    errors, names = [], (*FIVE, "efficiency")
    for number in range(first, last):
        drawn = draw(number)
        walked, truth = (
            fo.evaluate(drawn.feet, drawn.scene, accuracy, names, drawn.space).values
            for accuracy in ("standard", fo.Tolerance(1e-3))
        )
        five = np.abs(walked - truth)[:, :5] / sizes(truth[:, :5], drawn.scene)
        quotient = np.abs(walked - truth)[:, 5] / np.abs(truth[:, 5])
        errors += [
            [*pair] for pair in zip(five.max(axis=1), quotient, strict=True) if np.isfinite(pair).all()
        ]
    for name, column in zip(("the five", "J_W"), np.transpose(errors), strict=True):
        shares = ", ".join(f"{(column <= limit).mean():.1%} within {limit:.1%}" for limit in (0.005, 0.01))
        print(f"{name} of {len(column)} feet: {shares}, worst {column.max():.2%}", flush=True)


if __name__ == "__main__":
    if len(sys.argv) == 3:
        quotients(int(sys.argv[1]), int(sys.argv[2]))
    else:
        run(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3], *map(float, sys.argv[4:]))
