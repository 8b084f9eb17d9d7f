"""Large fronts: what is kept of them, and how their hypervolume is followed."""

import numpy as np
import pytest
from moocore import filter_dominated, hypervolume
from searching import SMALL, problem

import footopt as fo
from footopt.design.archive import Archive, Designs
from footopt.design.fronts import EXACT, Volume
from footopt.design.solvers import memetic, model


def sphere(count, objectives, seed=1):
    """A front on a sphere about the worst corner, minimised, -1 to 0."""
    drawn = np.abs(np.random.default_rng(seed).normal(size=(count, objectives)))
    return -drawn / np.linalg.norm(drawn, axis=1, keepdims=True)


@pytest.mark.parametrize("objectives", [2, 5])
def test_the_hypervolume_of_a_front_that_grows_is_exact_and_then_close(objectives):
    f, volume, found = sphere(3 * EXACT, objectives), Volume(), []
    for size in range(EXACT // 2, len(f) + 1, EXACT // 2):
        exact = hypervolume(f[:size], ref=np.zeros(objectives))
        found.append(volume(f[:size]))
        assert found[-1] == pytest.approx(exact, rel=1e-12 if size <= EXACT else 0.01)
    assert found == sorted(found)


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
    designs = Designs.joined(archive.found)
    np.testing.assert_array_equal(designs.k, k)
    np.testing.assert_array_equal(designs.values, values)
    assert designs.reasons.tolist() == reasons.tolist()
    assert len(np.unique(k, axis=0)) == len(k)
    f = p.minimised(values)[(p.constraints(values, reasons, p.space.box_violation(k)) <= 0).all(axis=1)]
    assert archive.history[-1].front == len(filter_dominated(f))


def test_the_default_solver_remembers_only_so_many(monkeypatch):
    """The newest and the best designs for its model, and parents that are far apart; none is asked twice."""
    monkeypatch.setattr(memetic, "REMEMBERED", 40)
    monkeypatch.setattr(model, "TRAINED", 20)
    found, advance = [], memetic.Archive._advance

    def noted(self, infills=None, **kwargs):
        advance(self, infills, **kwargs)
        found.append((len(self.memory.X), len(self.front.X)))

    monkeypatch.setattr(memetic.Archive, "_advance", noted)
    result = fo.search(problem("pareto"), "archive", pop_size=30, n_gen=12, seed=1)
    assert len(result.front) > 60
    assert max(kept for kept, _ in found) <= 10 + 5 * 20
    assert min(front for _, front in found[-4:]) >= 20
    assert max(front for _, front in found) <= 40
    assert result.designs == 360 == len(np.unique(result.k, axis=0))
