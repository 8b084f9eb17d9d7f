"""Feet under every law that sand may follow, and the one to print: it loses least under the worst of them."""

import numpy as np
import pytest
from searching import QUICK, SMALL

import footopt as fo
from footopt.design import robust
from footopt.design.archive import Evaluator
from footopt.design.robust import Race, RobustProblem
from footopt.design.scenarios import possible_laws
from footopt.design.to_print import candidates, compare, drafted
from footopt.walk.accuracy import PRESETS

LAWS = possible_laws(fo.Scene(), 0.3)
FLAT = np.full(SMALL.n, SMALL.K)
EVERY = np.indices((SMALL.K,) * SMALL.n).reshape(SMALL.n, -1).T + 1
EVERY = EVERY[SMALL.inside(EVERY)]


def j_w(feet, scene):
    return fo.evaluate(feet, scene, QUICK, ("efficiency",), SMALL).values[:, 0]


def worst_losses(laws):
    """Of all soles of the space, by walking each under each law."""
    j = np.stack([j_w(EVERY, law.scene) for law in laws])
    best = np.nanmin(j, axis=1, keepdims=True)
    return np.nanmax((j - best) / np.abs(best), axis=0)


def test_the_laws_are_the_scene_s_own_and_each_other_one_once():
    names = ["own law", "leading edge", "shadowing", "both", "zeta x 0.74", "zeta x 1.3"]
    assert [law.name for law in LAWS] == names
    under_edge = possible_laws(fo.Scene(effects=(fo.LeadingEdge(), fo.Inertia())), 0.0)
    assert [law.name for law in under_edge] == ["own law", "plain law", "shadowing", "both"]
    assert all(fo.Inertia() in law.scene.effects for law in under_edge)


def test_losses_and_changes_are_those_of_the_walks():
    problem = fo.FootProblem(fo.Scene(), "efficiency", SMALL, QUICK)
    feet = np.concatenate([SMALL.random(5, seed=2, inside=True), FLAT[None]])
    under = compare(problem, LAWS, feet)
    for law, losses, changes in zip(LAWS, under.losses, under.changes, strict=True):
        values = fo.evaluate(feet, law.scene, QUICK, ("efficiency", "work"), SMALL).values
        np.testing.assert_allclose(losses, 1.0 - values[:, 0] / values[:, 0].min())
        np.testing.assert_allclose(changes["work"], values[:, 1] / values[-1, 1] - 1.0)
    np.testing.assert_array_equal(under.worst, under.losses.max(axis=0))
    assert under.worst[under.steadiest] == under.worst.min()


def test_the_foot_to_print_is_the_one_that_loses_least_of_all_soles():
    worst = worst_losses(LAWS)
    result = fo.search(fo.FootProblem(fo.Scene(), "efficiency", SMALL, QUICK), "exhaustive")
    under = fo.design.under_laws(result, fo.design.confirm(result, QUICK, 1), share=0.2)
    assert under.worst[under.steadiest] == pytest.approx(worst.min())
    assert under.worst[under.steadiest] < under.worst[0]


def test_under_two_laws_it_is_neither_s_best():
    laws = [fo.Scenario(f"zeta {zeta}", fo.Scene(sand=fo.Sand(zeta))) for zeta in (0.3, 8.0)]
    result = fo.search(fo.FootProblem(fo.Scene(), "efficiency", SMALL, QUICK), "exhaustive")
    under = compare(result.problem, laws, candidates(result, laws, 0.2))
    assert under.worst[under.steadiest] == pytest.approx(worst_losses(laws).min())
    assert min(under.losses[:, under.steadiest]) > 0.0


def test_a_foot_to_print_keeps_the_limits_under_every_law():
    limit = {"peak_power": 260.0}
    result = fo.search(fo.FootProblem(fo.Scene(), "efficiency", SMALL, QUICK, limits=limit), "exhaustive")
    under = compare(result.problem, LAWS, np.concatenate([candidates(result, LAWS, 0.2), FLAT[None]]))
    chosen = under.k[[under.steadiest]]
    for law in LAWS:
        assert fo.evaluate(chosen, law.scene, QUICK, ("peak_power",), SMALL).values[0, 0] <= 260.0


def test_a_sole_that_a_law_rules_out_is_evaluated_under_no_other():
    """Its loss is then a lower bound, and worse than those of ten others, which are exact."""
    references = [np.nanmin(j_w(EVERY, law.scene)) for law in LAWS[:3]]
    problem = RobustProblem(LAWS[:3], "efficiency", SMALL, QUICK, references=references)
    alone = [Evaluator(fo.FootProblem(law.scene, "efficiency", SMALL, QUICK)) for law in LAWS[:3]]
    race, at = Race(LAWS[:3], references, alone), problem.record.index("efficiency")
    batches = SMALL.random(400, seed=1, inside=True).reshape(20, 20, -1)
    raced = np.concatenate([race.walk(k)[0][:, at] for k in batches])
    exact = problem.walk(batches.reshape(400, -1))[0][:, at]
    np.testing.assert_array_less(raced, exact + 1e-12)
    known = raced == exact
    assert np.sort(exact)[: robust.KEPT].tolist() == np.sort(raced)[: robust.KEPT].tolist()
    assert raced[~known].min() > np.sort(exact)[robust.KEPT - 1]
    of_one = Race(LAWS[:1], references[:1], alone[:1]).walk(batches[0])[0][:, at]
    own = j_w(batches[0], LAWS[0].scene)
    np.testing.assert_allclose(of_one, own / abs(references[0]), rtol=0, atol=1e-12)


def test_feet_are_ranked_no_finer_than_by_a_draft():
    given = fo.Tolerance(5e-4), PRESETS["draft"], fo.Tolerance(0.1), QUICK
    assert [drafted(one) for one in given] == [PRESETS["draft"], *given[1:]]


def test_losses_of_a_measure_whose_best_foot_has_nothing_of_it_are_relative_to_the_largest():
    problem = fo.FootProblem(fo.Scene(), "hollow", SMALL, QUICK)
    under = compare(problem, LAWS[:2], np.concatenate([SMALL.random(5, seed=2, inside=True), FLAT[None]]))
    assert [*under.losses[:, -1], under.losses.max()] == pytest.approx([0.0, 0.0, 1.0])


def test_a_law_under_which_no_foot_walks_is_left_out():
    sinking = [fo.Scenario("quicksand", fo.Scene(sand=fo.Sand(1e-3)))]
    problem = fo.FootProblem(fo.Scene(), "efficiency", SMALL, QUICK)
    result = fo.search(problem, walks=40)
    feet = candidates(result, (*LAWS[:2], *sinking), 0.5)
    under = compare(problem, (*LAWS[:2], *sinking), feet)
    assert np.isnan(under.losses[2]).all()
    assert np.isfinite(under.worst[under.steadiest])


def test_candidates_are_kept_in_a_store_and_the_same_when_read_from_it(tmp_path):
    result = fo.search(fo.FootProblem(fo.Scene(), "efficiency", SMALL, QUICK), walks=40)
    first, again = (candidates(result, LAWS[:3], 0.5, store=tmp_path / "s.sqlite") for _ in range(2))
    np.testing.assert_array_equal(first, again)
    np.testing.assert_array_equal(first, candidates(result, LAWS[:3], 0.5))
