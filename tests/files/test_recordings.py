"""Recordings drawn at random, of every kind that laboratories send, are read as what was walked."""

from dataclasses import replace

import numpy as np
import pytest
from motion_files import (
    HUMAN,
    OPENSIM,
    misfit,
    record,
    turned,
    write_c3d,
    write_mot,
    write_motive,
    write_nexus,
    write_trc,
)

import footopt as fo
from footopt.files.gaits import read_strides
from footopt.gait import Fourier

STANDING = replace(
    HUMAN, **{j: Fourier(a0, (0.0,), (0.0,)) for j, a0 in (("thigh", 2.0), ("knee", 4.0), ("foot", 0.0))}
)
UNITS = ((1000.0, "mm"), (100.0, "cm"), (1.0, "m"))


def another(rng):
    """The built-in gait as another person may walk it."""

    def varied(series, scale, more):
        a, b = (
            tuple(scale * c + rng.normal(0.0, (k + 1) ** -1.5) for k, c in enumerate(each))
            for each in (series.a, series.b)
        )
        return Fourier(series.a0 + more, a, b)

    bend = rng.uniform(0.8, 1.1)
    return replace(
        HUMAN,
        thigh=varied(HUMAN.thigh, rng.uniform(0.75, 1.2), rng.normal(0.0, 3.0)),
        knee=varied(HUMAN.knee, bend, (bend - 1.0) * HUMAN.knee.a0 + abs(rng.normal(0.0, 5.0))),
        period=rng.uniform(0.85, 1.6),
    )


def beside_standing(t, places, dialect, rate, speed, rng):
    """The same walk out of standing, and into it, each within 0.3 s."""
    _, still = record(STANDING, dialect, 1.0, rate, 0.0)
    before, after = (int(rate * s) for s in rng.uniform(0.5, 1.5, 2))
    s = np.linspace(0.0, 1.0, int(0.3 * rate))[:, None]
    w, found = s * s * (3.0 - 2.0 * s), {}
    for name, place in places.items():
        begin, end = still[name][0], still[name][0] + [speed * t[-1], 0.0, 0.0]
        into, out = (1 - w) * begin + w * place[0], (1 - w) * place[-1] + w * end
        found[name] = np.concatenate(
            [np.tile(begin, (before, 1)), into, place, out, np.tile(end, (after, 1))]
        )
    return np.arange(len(found[name])) / rate, found


def drawn(folder, seed):
    """A gait, its rate, and a file of two strides or more: of any direction, axes, unit, noise and ends."""
    rng = np.random.default_rng(seed)
    gait, rate, speed = another(rng), float(rng.choice([50, 60, 100, 120, 200])), float(rng.integers(2))
    strides, phase, form = rng.uniform(2.05, 6.0), rng.uniform(), rng.integers(5)
    if form == 0:
        return gait, rate, write_mot(
            folder / "walk.mot", gait, OPENSIM, knee_sign=rng.choice([-1, 1]), degrees=bool(rng.integers(2)),
            strides=strides, rate=rate, other=0.5, phase=lambda t: phase + t / gait.period,
        )  # fmt: skip
    dialect = str(rng.choice(["opensim", "plug_in_gait", "helen_hayes", "hbm", "bts", "ior"]))
    noise = rng.choice([0.0, 1e-3, 2e-3])
    t, places = record(gait, dialect, strides, rate, speed, noise, phase, seed)
    if strides > 3.0 and rng.random() < 0.5:
        t, places = beside_standing(t, places, dialect, rate, speed, rng)
    places = turned(places, rng.uniform(0.0, 360.0), str(rng.choice(["y", "z"])))
    order, signs = rng.permutation(3), rng.choice([-1.0, 1.0], 3)
    places = {name: (signs * place)[:, order] for name, place in places.items()}
    if form == 1:
        return gait, rate, write_trc(folder / "walk.trc", t, places, *UNITS[rng.integers(3)])
    write, ending = ((write_c3d, "c3d"), (write_nexus, "csv"), (write_motive, "csv"))[form - 2]
    return gait, rate, write(folder / f"walk.{ending}", t, places)


@pytest.mark.parametrize(
    "seed", [*range(6), *(pytest.param(s, marks=pytest.mark.slow) for s in range(6, 60))]
)
def test_its_period_is_right_to_half_a_row_and_its_angles_to_a_degree(tmp_path, seed):
    gait, rate, path = drawn(tmp_path, seed)
    found = fo.Gait.from_strides(read_strides(path))
    assert abs(found.period - gait.period) * rate < 0.5
    assert misfit(found, true=gait) < 1.0
