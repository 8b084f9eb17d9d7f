"""Soles as a scan has them, with noise, walk within their tolerance: python benchmarks/scanned.py COUNT SEED

200 to 8,000 points, each off by a normal error of 0.01 to 0.3 mm, on sand of zeta 0.2 to 50. Each at
`standard`, against the parameters of `fine` refined once. With ``effects`` as a third argument, in scenes
with effects, and a quarter of the feet are closed.
"""

import sys
from dataclasses import replace

import numpy as np

import footopt as fo
from footopt.walk.accuracy import PRESETS
from footopt.walk.ladder import numerics
from footopt.walk.objectives import FIVE, sizes

EDGE = fo.LeadingEdge()
EFFECTS = (
    (EDGE,),
    (fo.Rest(),),
    (fo.Shadowing(),),
    (EDGE, fo.Shadowing()),
    (fo.Inertia(),),
    (EDGE, fo.Rest()),
)


def drawn(rng):
    """A sole, and the scene in which it walks."""
    points, noise, zeta = (
        np.exp(rng.uniform(*np.log(ends))) for ends in ((200, 8000), (1e-5, 3e-4), (0.2, 50))
    )
    x = np.linspace(-0.13, 0.13, int(points))
    z = -0.02 + 0.01 * np.cos(rng.uniform(1, 4) * np.pi * x / 0.13) + noise * rng.standard_normal(len(x))
    return fo.Foot(np.stack([x, z], axis=1)), fo.Scene(sand=fo.Sand(float(zeta)))


def main(count: int, seed: int, effects: bool) -> None:
    """Print each sole's plates, error and estimate, and how many are within the tolerance and covered."""
    rng, errors, covered = np.random.default_rng(seed), [], 0
    for i in range(count):
        foot, scene = drawn(rng)
        if effects:
            scene = replace(scene, effects=EFFECTS[i % len(EFFECTS)])
            foot = replace(foot, closed=i % 4 == 0, top=0.02)
        accuracy = numerics(PRESETS["standard"], scene, foot)
        found = fo.evaluate([foot], scene, accuracy, FIVE, errors=True)
        truth = fo.evaluate([foot], scene, numerics(PRESETS["fine"], scene, foot).refined(), FIVE).values
        error, estimate = (
            (np.abs(each) / sizes(truth, scene)).max() for each in (found.values - truth, found.errors)
        )
        errors.append(error)
        covered += error <= estimate
        print(f"{len(foot.contour)} points, {accuracy.plates} plates: {error:.3%}, estimate {estimate:.3%}")
    within = np.mean(np.array(errors) <= PRESETS["standard"].error)
    print(f"{within:.0%} of {count} within the tolerance, worst {max(errors):.2%}, {covered} covered")


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), "effects" in sys.argv)
