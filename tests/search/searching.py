"""Small searches that tests share: a space of 4^5 soles, walked coarsely, in a second or less."""

import dataclasses

import numpy as np

import footopt as fo
from footopt.design import SINGLE

QUICK = fo.Accuracy(dt=1e-2, plates=20)
SMALL = fo.Waypoints(n=5, K=4)


def problem(objective="efficiency", zeta=5.0, space=SMALL, accuracy=QUICK, kind=fo.FootProblem, **scene):
    """A problem on sand of some hardness, MN/m^3."""
    return kind(fo.Scene(sand=fo.Sand(zeta), **scene), objective, space, accuracy)


def objective_of(solver):
    """What a solver is for."""
    return "efficiency" if solver in SINGLE else "pareto"


def stop_after(generations):
    """A search's progress that interrupts it after so many generations, as Ctrl-C does."""

    def progress(generation):
        if generation.generation == generations:
            raise KeyboardInterrupt

    return progress


def assert_same(a, b):
    """Two results agree to the last bit in all but the time they took."""
    for field in dataclasses.fields(a):
        if field.name not in ("problem", "solver", "history", "seconds", "reused", "interrupted"):
            np.testing.assert_array_equal(getattr(a, field.name), getattr(b, field.name), err_msg=field.name)
    assert a.values.tobytes() == b.values.tobytes()
    timeless = [[dataclasses.astuple(dataclasses.replace(g, seconds=0.0)) for g in r.history] for r in (a, b)]
    np.testing.assert_equal(*timeless)
