"""What the benchmarks compare gives the same result, so that their ratios compare like with like."""

from dataclasses import replace

import against_numpy
import numpy as np
import numpy_walk
import plate_loop
import pytest
import solvers
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


@pytest.mark.slow
def test_the_c_loop_gives_the_same_sums(tmp_path):
    library = plate_loop.build(tmp_path)
    if isinstance(library, str):
        pytest.skip(library)
    ours, theirs = plate_loop.compiled(64, True)(10), plate_loop.by_hand(library, 64, True)(10)
    np.testing.assert_allclose(ours, theirs, rtol=1e-10)


def test_expected_walks_are_those_of_searches_begun_anew():
    improved = solvers.improvements([-1.0, -1.0, -3.0, -3.0])
    assert improved == "1:-1.0 3:-3.0"
    assert [solvers.of_best(improved, -3.0, walks)[0] for walks in (2, 3)] == [None, 3]
    assert solvers.of_best(improved, -4.0, 4) == (None, 0.25)
    assert solvers.expected([3, None, 5], 100) == 54.0
    assert solvers.expected([None], 100) == 200.0
