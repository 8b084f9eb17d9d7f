"""Ranks that another law turns round are found by walking, and marked."""

import numpy as np
import pytest

import footopt as fo
from footopt.studies import ranks
from footopt.walk import PRESETS
from footopt.walk.ladder import numerics

SPACE = fo.Waypoints()
FEET = SPACE.random(6, seed=2, inside=True)
FLAT = np.full(SPACE.n, SPACE.K)


@pytest.fixture(scope="module")
def problem():
    return fo.FootProblem(fo.Scene(), "efficiency", SPACE, "draft")


@pytest.fixture(scope="module")
def found(problem):
    best_first = FEET[np.argsort(problem.walk(FEET)[0][:, problem.record.index("efficiency")])]
    return ranks.rank_changes(problem, best_first, FLAT, 0.3), best_first


def test_each_other_law_is_walked_once_and_the_run_s_own_is_not(found):
    assert [r.law for r in found[0]] == ["leading edge", "shadowing", "both", "zeta x 0.74", "zeta x 1.3"]
    under_edge = ranks.alternative_laws(fo.Scene(effects=(fo.LeadingEdge(), fo.Inertia())), 0.0)
    assert [s.name for s in under_edge] == ["plain law", "shadowing", "both"]
    assert all(fo.Inertia() in s.scene.effects for s in under_edge)


def test_places_losses_and_turns_are_those_of_the_walks(found):
    ranked, feet = found
    numbers = numerics(PRESETS["draft"], fo.Scene(), SPACE)
    for rank, law in zip(ranked, ranks.alternative_laws(fo.Scene(), 0.3), strict=True):
        values = fo.evaluate([*feet, FLAT], law.scene, numbers, ("efficiency", "work"))
        own = fo.evaluate([*feet, FLAT], fo.Scene(), numbers, ("efficiency", "work"))
        j = values.values[:-1, 0]
        assert rank.place == 1 + (j < j[0]).sum()
        assert rank.loss == pytest.approx((j[0] - j.min()) / abs(j.min()))
        for column, name in enumerate(("efficiency", "work")):
            turns = np.sign(own.values[0, column] - own.values[-1, column]) != np.sign(
                values.values[0, column] - values.values[-1, column]
            )
            assert (name in rank.turned) == turns
