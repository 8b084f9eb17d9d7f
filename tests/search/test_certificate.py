"""The certificate of a search: every sole near its best design is walked, and none is better."""

import json
from itertools import product

import numpy as np
import pytest
from running import composed, unrender
from searching import QUICK, SMALL, assert_same, problem

import footopt as fo
from footopt.design import Evaluator, Store, search
from footopt.design.certificate import MOST, certified, neighbours
from footopt.design.solvers.moves import shifts
from footopt.studies.runs import run_study

FINER = fo.Accuracy(dt=5e-3, plates=40)
EVERY = np.array(list(product(range(1, 5), repeat=5)))


def near(k, space):
    """By definition: at most two waypoints differ, or a run of them is shifted by one level."""
    two = (EVERY != k).sum(axis=1) <= 2
    shifted = (EVERY[:, None] == k + shifts(space.n)).all(axis=2).any(axis=1)
    return EVERY[(two | shifted) & (EVERY != k).any(axis=1)]


@pytest.fixture(scope="module")
def poor():
    """What four random soles come to."""
    return search(problem(), "ga", pop_size=4, n_gen=1, seed=1)


@pytest.fixture(scope="module")
def found(poor):
    return certified(poor, FINER, 5, Evaluator(poor.problem))


def test_neighbours_are_those_of_the_definition():
    for k in SMALL.random(20, seed=1):
        found, distance = neighbours(k, SMALL)
        assert distance == 2
        assert sorted(map(tuple, found)) == sorted(map(tuple, near(k, SMALL)))


@pytest.mark.parametrize(("n", "K", "distance"), [(11, 10, 2), (22, 10, 2), (23, 10, 1), (11, 100, 1)])
def test_a_large_neighbourhood_is_cut_down_to_what_can_be_walked(n, K, distance):
    space = fo.Waypoints(n=n, K=K)
    found, within = neighbours(np.full(n, 2), space)
    assert within == distance
    assert len(found) <= MOST + n * (n + 1)
    assert {tuple(k) for k in np.full(n, 2) + shifts(n)} <= {tuple(k) for k in found}


def test_the_certified_design_is_the_best_of_its_neighbourhood_by_both_accuracies(poor, found):
    result, confirmed, certificate = found
    assert certificate.holds
    assert certificate.steps > 0
    assert certificate.finely > 0
    assert all(part in str(certificate) for part in (f"{certificate.finely} of them", "by a shift"))
    k = result.k[confirmed.designs[0]]
    assert certificate.k == tuple(k)
    around = near(k, SMALL)
    inside = around[SMALL.box_violation(around) <= SMALL.box_tolerance * SMALL.H]
    assert (certificate.soles, certificate.inside) == (len(around), len(inside))
    for accuracy in (QUICK, FINER):
        values = fo.evaluate([k, *inside], poor.problem.scene, accuracy, ("efficiency",), SMALL).efficiency
        assert values[0] <= values[1:].min() + (1e-12 if accuracy is FINER else certificate.margin)
    assert len(result.k) == len(poor.k) + certificate.steps
    assert result.feasible[confirmed.designs].all()


class Formula(fo.FootProblem):
    """Walks that are numbers drawn for each sole, which change by up to 2 % at a finer accuracy."""

    def walk(self, k):
        values, place = np.ones((len(k), len(self.record))), (k - 1) @ 4 ** np.arange(5)
        draw = np.random.default_rng(1)
        drawn, change = draw.uniform(1e-4, 1.1e-4, 4**5), draw.uniform(-0.02, 0.02, 4**5)
        steady = drawn.argsort()[-10:]  # the best of all do not change
        change[steady] = 0.0
        factor = 1.0 + change * (self.accuracy == FINER)
        values[:, self.record.index("efficiency")] = -(drawn * factor)[place]
        return values, np.full(len(k), "")


@pytest.mark.parametrize("finalists", [1, 5])
@pytest.mark.parametrize("seed", range(1, 6))
def test_neighbours_that_change_more_than_finalists_are_compared_finely_too(finalists, seed):
    """And a better one is taken, however far behind it was at the accuracy of the search."""
    p = problem(kind=Formula)
    first = search(p, "ga", pop_size=4, n_gen=1, seed=seed)
    result, confirmed, certificate = certified(first, FINER, finalists, Evaluator(p))
    k = result.k[confirmed.designs[0]]
    around = near(k, SMALL)
    around = around[SMALL.inside(around)]
    coarse, fine = (q.minimised(q.walk(np.array([k, *around]))[0])[:, 0] for q in (p, p.at(FINER)))
    judged = coarse <= coarse[0] + certificate.margin * abs(coarse[0])
    changes = np.abs(fine / coarse - 1.0)[judged]
    assert certificate.margin >= 2.0 * changes[1:].max(initial=0.0) > 0.0
    assert certificate.finely == judged.sum() - 1
    assert fine[0] == fine[judged].min()
    assert certificate.holds
    assert certificate.steps == len(result.k) - len(first.k)


class Limited(Formula):
    """The best of all takes more work by the finer accuracy."""

    def walk(self, k):
        values, reasons = super().walk(k)
        best = values[:, self.record.index("efficiency")] < -1.0997e-4
        values[:, self.record.index("work")] += best * (self.accuracy == FINER)
        return values, reasons


def test_a_design_that_breaks_a_limit_at_the_finer_accuracy_is_not_certified():
    first = search(Limited(space=SMALL, accuracy=QUICK, limits={"work": 1.5}), "exhaustive")
    _, confirmed, certificate = certified(first, FINER, 1, Evaluator(first.problem))
    assert certificate.k != tuple(first.k[first.best])
    assert certificate.holds
    assert confirmed.good[0]


def test_walks_are_counted_kept_and_read_again(poor, found, tmp_path):
    with Store(tmp_path / "s.sqlite", poor.problem) as store:
        result, _, certificate = certified(poor, FINER, 5, Evaluator(poor.problem, store))
        assert len(store) >= certificate.walks > 0
        again = certified(poor, FINER, 5, Evaluator(poor.problem, store))
    assert certificate == again[2] == found[2]
    assert_same(result, again[0])


def test_more_walks_than_are_granted_are_not_walked(poor):
    result, confirmed, certificate = certified(poor, FINER, 5, Evaluator(poor.problem), most=10)
    assert not certificate.holds
    assert certificate.walks == 0
    assert result is poor
    assert confirmed.designs[0] in range(4)
    assert "No certificate" in str(certificate)


def test_a_run_certifies_the_design_that_it_leaves(tmp_path, monkeypatch):
    unrender(monkeypatch)
    words = ("foot.n=5", "foot.K=4", "accuracy=draft", "study.confirm=null", "report=light")
    words += ("solver.pop_size=4", "solver.n_gen=1", "study.certify=true")
    run_study(composed(*words), tmp_path, {})
    found = json.loads((tmp_path / "result.json").read_text())
    assert found["certificate"]["holds"]
    assert found["certificate"]["k"] == found["design"]["k"]
    assert found["certificate"]["says"] in (tmp_path / "report.html").read_text()
