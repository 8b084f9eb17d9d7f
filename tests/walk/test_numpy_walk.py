"""What the benchmarks compare gives the same result, so that their ratios compare like with like."""

from dataclasses import replace

import against_numpy
import numpy as np
import numpy_walk
import pytest
from measure import feet, scene

import footopt as fo


@pytest.mark.slow
def test_the_numpy_baseline_is_the_compiled_explicit_euler():
    k, paper = feet(1), replace(scene("soft"), t_f=1.2)
    dt = 2e-4  # large steps on hard sand chatter, and amplify rounding
    values, trace = numpy_walk.walk(numpy_walk.chords(k, fo.Waypoints()), paper, dt)
    accuracy = fo.Accuracy("explicit_euler", dt, numpy_walk.PLATES, numpy_walk.CREEP, rule="chord")
    walk = fo.simulate(fo.Foot.from_waypoints(k[0]), paper, accuracy)
    np.testing.assert_allclose(trace[0, 1:], np.hstack([walk.com, walk.velocity]), rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(values[0], against_numpy.twin(k[0], paper, dt), rtol=1e-8)
