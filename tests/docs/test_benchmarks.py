"""Contenders in groups, for `pytest tests/docs/test_benchmarks.py --benchmark-enable`.

The columns in brackets compare the members of a group. Without that option every test runs once, on
a small case, and checks that what is compared gives the same result. `report.py` measures the
ratios, with interleaved repeats.
"""

import sys
from dataclasses import replace

import against_numpy
import effects
import engines
import equal_accuracy
import growth
import numpy as np
import numpy_walk
import other_optimisers
import overhead
import plate_loop
import pytest
import startup
from measure import SANDS, error, feet, scene

import footopt as fo


@pytest.fixture
def full(benchmark):
    """Whether times are measured."""
    return not benchmark.disabled


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    found = plate_loop.build(tmp_path_factory.mktemp("plate_loop"))
    return pytest.skip(found) if isinstance(found, str) else found


# the baseline: the same walk, then the time of one design


def test_the_numpy_baseline_is_the_compiled_explicit_euler():
    k, paper = feet(1), replace(scene("soft"), t_f=1.2)
    dt = 2e-4  # large steps on hard sand chatter, and amplify rounding
    values, trace = numpy_walk.walk(numpy_walk.chords(k, fo.Waypoints()), paper, dt)
    accuracy = fo.Accuracy("explicit_euler", dt, numpy_walk.PLATES, numpy_walk.CREEP, rule="chord")
    walk = fo.simulate(fo.Foot.from_waypoints(k[0]), paper, accuracy)
    np.testing.assert_allclose(trace[0, 1:], np.hstack([walk.com, walk.velocity]), rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(values[0], against_numpy.twin(k[0], paper, dt), rtol=1e-8)


@pytest.mark.parametrize("sand", SANDS)
@pytest.mark.parametrize("method", ["footopt", "numpy"])
def test_one_design(benchmark, full, sand, method):
    benchmark.group = f"one design on {sand} sand, one core"
    paper, k = (scene(sand) if full else replace(scene(sand), t_f=1.12)), feet(1)
    sole = numpy_walk.chords(k, fo.Waypoints())
    if method == "footopt":
        benchmark(fo.evaluate, k, paper, threads=1)
    else:
        benchmark.pedantic(numpy_walk.walk, (sole, paper, 1e-4 if full else 1e-2), rounds=3 if full else 1)


# explicit Euler and the default stepper at equal accuracy


@pytest.mark.parametrize("target", [0.5, 0.05])
@pytest.mark.parametrize("stepper", ["sdirk2", "explicit_euler"])
def test_equal_accuracy(benchmark, full, stepper, target):
    benchmark.group = f"hard sand, error {target} %"
    hard = scene("hard")
    k = feet(30 if full else 3)
    wanted = target if full else 20.0 * target
    accuracy = equal_accuracy.cheapest(stepper, k, hard, wanted, halvings=5 if full else 2)
    table = benchmark(fo.evaluate, k, hard, accuracy, threads=1)
    assert error(table.values, equal_accuracy.converged(k, hard, accuracy.plates)) <= wanted


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("sand", SANDS)
def test_standard(benchmark, full, sand, threads):
    benchmark.group = "320 designs at standard"
    benchmark(fo.evaluate, feet(320 if full else 20), scene(sand), threads=threads)


# the plate loop and the C loop


@pytest.mark.parametrize("jacobian", [False, True])
def test_the_c_loop_gives_the_same_sums(library, jacobian):
    ours, theirs = plate_loop.compiled(64, jacobian)(10), plate_loop.by_hand(library, 64, jacobian)(10)
    np.testing.assert_allclose(ours, theirs, rtol=1e-10)


@pytest.mark.parametrize("jacobian", [False, True])
@pytest.mark.parametrize("loop", ["compiled", "by hand"])
def test_plate_loop(benchmark, full, library, loop, jacobian):
    benchmark.group = f"10,000 x 64 submerged plates, {'with' if jacobian else 'without'} Jacobian"
    job = (
        plate_loop.compiled(64, jacobian) if loop == "compiled" else plate_loop.by_hand(library, 64, jacobian)
    )
    job(1)
    benchmark(job, 10_000 if full else 10)


# growth


@pytest.mark.parametrize(
    ("measure", "sizes", "few"),
    [
        (growth.in_designs, growth.DESIGNS, (10, 20)),
        (growth.in_plates, growth.PLATES, (32, 64)),
        (growth.in_duration, growth.DURATION, (1.7, 2.9)),
    ],
)
def test_growth(benchmark, full, measure, sizes, few):
    benchmark.group = "growth"
    options = {} if measure is growth.in_designs or full else {"designs": 4}
    power, _ = benchmark.pedantic(
        measure, (sizes if full else few,), {"repeats": 5 if full else 1, **options}
    )
    benchmark.extra_info["power"] = power
    assert np.isfinite(power)


def test_many_designs_in_one_call_need_little_memory(benchmark, full):
    if not full:
        pytest.skip("a process of its own: run with --benchmark-enable")
    benchmark.group = "memory"
    found = benchmark.pedantic(growth.large_call, (100_000,))
    benchmark.extra_info.update(found)
    assert found["peak"] < 1000.0  # MB


# start-up


@pytest.mark.parametrize("name", startup.WARM)
def test_start(benchmark, full, name):
    benchmark.group = "start-up, warm caches"
    if not full and name != "import footopt":
        pytest.skip("a process of its own: run with --benchmark-enable")
    benchmark.pedantic(startup.run, (startup.WARM[name],), rounds=5 if full else 1)


def test_first_compilation(benchmark, full):
    if not full:
        pytest.skip("compiles everything: run with --benchmark-enable")
    benchmark.group = "start-up, nothing compiled"
    benchmark.extra_info["next"] = benchmark.pedantic(startup.first_compilation)[1]


def test_compiled_code_is_kept_when_the_package_is_read_only(benchmark, full):
    if not full:
        pytest.skip("compiles everything: run with --benchmark-enable")
    benchmark.group = "start-up, read-only package"
    found = benchmark.pedantic(startup.read_only)
    assert not isinstance(found, str), found
    assert found[2], "no compiled code was kept"


# other optimisers


@pytest.mark.filterwarnings("ignore")  # the other libraries' own
@pytest.mark.parametrize("name", other_optimisers.RUNS)
def test_an_optimiser_spends_its_evaluations_and_repeats_itself(monkeypatch, name):
    for library in ("cma", "nevergrad", "pygmo"):
        if name.startswith(library):
            pytest.importorskip(library)
    problem = other_optimisers.Remembering(accuracy=fo.Accuracy(dt=1e-2, plates=20))
    first = other_optimisers.RUNS[name](problem, 1, other_optimisers.QUICK_BUDGET)
    asked = len(problem.known)
    assert 100 < asked <= 300
    assert np.isfinite(first)
    assert other_optimisers.RUNS[name](problem, 1, other_optimisers.QUICK_BUDGET) == first
    assert len(problem.known) == asked


def test_a_missing_library_is_named_with_the_way_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "pygmo", None)
    monkeypatch.setattr(sys, "argv", ["other_optimisers.py"])
    with pytest.raises(SystemExit, match=r"pygmo.* not installed: pip install -e '\.\[benchmark\]'"):
        other_optimisers.main()


# overhead


def test_the_shares_of_a_search_add_up(benchmark, full):
    benchmark.group = "a GA run"
    shares, wall = benchmark.pedantic(overhead.search_shares, (1, *((100, 100) if full else (6, 2))))
    benchmark.extra_info.update(shares, wall=wall)
    assert sum(shares.values()) == pytest.approx(1.0)
    assert all(share > -0.01 for share in shares.values())


# effects


@pytest.fixture(scope="module")
def loops(tmp_path_factory):
    folder = tmp_path_factory.mktemp("deleted")
    effects.write(folder)
    return effects.load(folder)


@pytest.mark.parametrize("name", [effects.DELETED, effects.COPY, *effects.SETS])
def test_effects(benchmark, full, loops, name):
    if not full:
        pytest.skip("compiles a walk for each: run with --benchmark-enable")
    benchmark.group = "30 designs on regular sand, one thread"
    job = effects.jobs("regular", 30, loops)[name]
    job()
    benchmark(job)


def test_little_goes_over_the_wire():
    out, back, problem = engines.wire()
    assert 8 * 11 <= out < 110
    assert 8 * 6 <= back < 90
    assert problem < 10_000
