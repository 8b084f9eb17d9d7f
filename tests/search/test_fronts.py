"""Large fronts: what is kept of them, how their hypervolume is followed, and that a search stays linear."""

import numpy as np
import pytest
from moocore import filter_dominated, hypervolume
from searching import SMALL, problem

import footopt as fo
from footopt.design.archive import Archive
from footopt.design.fronts import EXACT, REFERENCE, SHARE, Volume, reached, thinned
from footopt.design.known import Known
from footopt.design.solvers import memetic
from footopt.report.terminal import describe_search


def sphere(count, objectives, seed=1):
    """A front on a sphere about the worst corner, minimised, -1 to 0."""
    drawn = np.abs(np.random.default_rng(seed).normal(size=(count, objectives)))
    return -drawn / np.linalg.norm(drawn, axis=1, keepdims=True)


@pytest.mark.parametrize("objectives", [2, 3, 5])
@pytest.mark.parametrize("most", [200, 800])
def test_a_thinned_front_keeps_its_ends_and_says_what_of_its_hypervolume(objectives, most):
    """Half of its designs have a neighbour that is nearly the same."""
    f = sphere(400, objectives)
    f = np.concatenate([f, 0.9999 * f])
    few, share, error = thinned(f, most)
    assert len(few) == len(set(few)) <= min(most, 700)
    assert set(f.argmin(axis=0)) <= set(few)
    kept, whole = (hypervolume(part, ref=np.full(objectives, 0.1)) for part in (f[few], f))
    assert error < 2e-3
    assert kept / whole == pytest.approx(share, abs=4.0 * error + 1e-4)
    assert share > 0.998 or len(few) == most


@pytest.mark.parametrize("objectives", [2, 3, 4, 5])
@pytest.mark.parametrize("power", [0.5, 1.0, 3.0])
def test_a_thinned_front_keeps_so_much_of_its_exact_hypervolume(objectives, power):
    """Round, flat and hollow fronts of random designs, denser at their ends, in units of their own."""
    f = -((sphere(4000, objectives) ** 2) ** power) * 10.0 ** np.arange(objectives)
    few, share, error = thinned(f, len(f))
    inward = (f - f.min(axis=0)) / np.ptp(f, axis=0)
    kept, whole = (hypervolume(part, ref=np.full(objectives, REFERENCE)) for part in (inward[few], inward))
    assert kept / whole > SHARE
    assert share - 2.0 * error > SHARE
    assert kept / whole == pytest.approx(share, abs=5.0 * error + 1e-4)
    assert len(few) < len(f)


def test_a_very_large_front_is_thinned_to_so_many():
    f = sphere(200_000, 3)
    few, share, _ = thinned(f, 1000)
    assert len(few) == len(set(few)) == 1000
    assert 0.95 < share < SHARE


@pytest.mark.parametrize("kind", [float, np.float32])
def test_how_far_a_front_reaches_is_that_of_its_farthest_design(kind):
    """Designs beyond the corner reach nowhere; most are not looked at."""
    inward, rays = sphere(3000, 4, seed=2) + 0.9, -sphere(2000, 4)
    inward, rays = inward.astype(kind), rays.astype(kind)
    far, which = reached(inward, rays)
    each = np.maximum((inward[:, None] / rays).min(axis=2), 0.0)
    np.testing.assert_allclose(far, each.max(axis=0), rtol=10 * np.finfo(kind).eps)
    np.testing.assert_allclose(each[which, np.arange(len(rays))], far, rtol=10 * np.finfo(kind).eps)


@pytest.mark.parametrize("objectives", [2, 5])
def test_the_hypervolume_of_a_front_that_grows_is_exact_and_then_close(objectives):
    f, volume, found = sphere(3 * EXACT, objectives), Volume(), []
    for size in range(EXACT // 2, len(f) + 1, EXACT // 2):
        exact = hypervolume(f[:size], ref=np.zeros(objectives))
        found.append(volume(f[:size], np.arange(size) >= size - EXACT // 2))
        assert found[-1] == pytest.approx(exact, rel=1e-12 if size <= EXACT else 0.01)
    assert found == sorted(found)
    assert volume(f, np.zeros(len(f), bool)) == found[-1], "a generation that adds nothing changes nothing"


def test_an_archive_keeps_what_it_is_given_in_its_order():
    """Its table grows in steps, and reasons may become longer."""
    p, words = problem("pareto", space=fo.Waypoints(n=5, K=4)), ["", "sunk", "a reason that is long"]
    draw, given = np.random.default_rng(1), []

    def walk(k):
        given.append((k, draw.normal(size=(len(k), len(p.record))), np.array(words)[k[:, 0] % 3]))
        return given[-1][1:]

    archive = Archive(p, walk)
    for _ in range(8):
        k = SMALL.random(60, seed=int(draw.integers(1000)))
        f, g = archive.evaluate(k)
        archive.close_generation(0.0)
        assert len(f) == len(g) == 60
    k, values, reasons = (np.concatenate(parts) for parts in zip(*given, strict=True))
    designs = archive.designs
    np.testing.assert_array_equal(designs.k, k)
    np.testing.assert_array_equal(designs.values, values)
    assert designs.reasons.tolist() == reasons.tolist()
    assert len(np.unique(k, axis=0)) == len(k)
    f = p.minimised(values)[(p.constraints(values, reasons, p.space.box_violation(k)) <= 0).all(axis=1)]
    assert archive.history[-1].front == len(filter_dominated(f))


def test_the_default_solver_remembers_only_so_many(monkeypatch):
    """The newest and the best designs for its model, and parents that are far apart; none is asked twice."""
    monkeypatch.setattr(memetic, "REMEMBERED", 40)
    found, advance = [], memetic.Archive._advance

    def noted(self, infills=None, **kwargs):
        advance(self, infills, **kwargs)
        found.append((self.told, len(self.front)))

    monkeypatch.setattr(memetic.Archive, "_advance", noted)
    result = fo.search(problem("pareto"), "archive", pop_size=30, n_gen=12, seed=1)
    assert len(result.front) > 60
    assert max(told for told, _ in found) <= 40 + memetic.TRAINED // 2
    assert min(front for _, front in found[-4:]) >= 20
    assert max(front for _, front in found) <= 40
    assert result.designs == 360 == len(np.unique(result.k, axis=0))


def test_a_large_front_is_shown_in_part(monkeypatch):
    for name in ("WHOLE", "SHOWN"):
        monkeypatch.setattr(f"footopt.design.result.{name}", 20)
    result = fo.search(problem("pareto"), "nsga2", pop_size=60, n_gen=3, seed=1)
    assert len(result.front) > 25
    assert len(result.shown) < len(result.front)
    assert result.shown[0] == result.best
    assert set(result.shown) < set(result.front)
    assert len(fo.design.confirm(result, "draft").designs) == len(result.shown) <= 20
    share, error = result.shown_share
    words = f"{len(result.front)} on the front (shown by {len(result.shown)}, the most that are, with"
    words += f" {100 * share:.1f} +-"
    assert 0.5 < share < 1.0
    assert 0.0 < error < 0.02
    assert words in describe_search(result)


@pytest.mark.parametrize("K", [4, 300, 70_000])
def test_known_designs_have_their_places(monkeypatch, K):
    """As a dictionary would have it; heights may have more than a byte, and end in 256."""
    monkeypatch.setattr("footopt.design.known.NEWEST", 40)
    draw, known, places = np.random.default_rng(K), Known(K), {}
    for size in (0, 30, 1, 50, 200):
        k = np.maximum(draw.choice([1, 2, 3, K, min(K, 256)], size=(size, 4)), 1)
        rows = [tuple(row) for row in k.tolist()]
        new = [i for i, row in enumerate(rows) if row not in rows[:i] and row not in places]
        assert known.fresh(k).tolist() == new
        known.add(k[new])
        for i in new:
            places[rows[i]] = len(places)
        assert known.places(k).tolist() == [places[row] for row in rows]
    assert len(known) == len(places)
    assert known.places(np.full((2, 4), K - 1)).tolist() == [places.get((K - 1,) * 4, -1)] * 2
