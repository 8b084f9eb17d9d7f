"""What the benchmarks compare gives the same result, so that their ratios compare like with like."""

from dataclasses import replace

import against_numpy
import large_search
import numpy as np
import numpy_walk
import overhead
import plate_loop
import pytest
import solvers
from measure import feet, scene

import footopt as fo


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """The plate loop that is written by hand in C."""
    found = plate_loop.build(tmp_path_factory.mktemp("plate_loop"))
    return pytest.skip(found) if isinstance(found, str) else found


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
@pytest.mark.parametrize("jacobian", [False, True])
def test_the_c_loop_gives_the_same_sums(library, jacobian):
    ours, theirs = plate_loop.compiled(64, jacobian)(10), plate_loop.by_hand(library, 64, jacobian)(10)
    np.testing.assert_allclose(ours, theirs, rtol=1e-10)


@pytest.mark.parametrize("name", ["memetic", "ga", "pymoo_de"])
def test_a_search_has_its_walks_and_no_more(name):
    problem = fo.FootProblem(accuracy=fo.Accuracy(dt=1e-2, plates=20))
    bests = solvers.searched(name, problem, 60, 1)
    few = 30 if name == "ga" else 60  # it counts soles outside their box, too
    assert few <= len(bests) <= 60
    assert bests == sorted(bests, reverse=True)


def test_expected_walks_are_those_of_searches_begun_anew():
    improved = solvers.improvements([-1.0, -1.0, -3.0, -3.0])
    assert improved == "1:-1.0 3:-3.0"
    assert [solvers.of_best(improved, -3.0, walks)[0] for walks in (2, 3)] == [None, 3]
    assert solvers.of_best(improved, -4.0, 4) == (None, 0.25)
    assert solvers.expected([3, None, 5], 100) == 54.0
    assert solvers.expected([None], 100) == 200.0


def test_the_shares_of_a_search_add_up():
    shares, _ = overhead.search_shares(1, 6, 2)
    assert sum(shares.values()) == pytest.approx(1.0)
    assert all(share > -0.01 for share in shares.values())


def test_a_large_search_leaves_what_is_measured(tmp_path):
    found = large_search.measured(400, tmp_path)
    assert 300 < found["designs"] <= 400
    assert found["before"] <= found["searched"] <= found["written"]
    assert (tmp_path / "designs.csv").read_text().count("\n") == found["designs"] + 1
