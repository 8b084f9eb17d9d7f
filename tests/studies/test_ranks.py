"""Ranks that another law turns round are found by walking, and marked."""

import numpy as np
import pytest

import footopt as fo
from footopt.report import terminal
from footopt.studies import ranks
from footopt.walk import OBJECTIVES, PRESETS
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


def test_a_turned_rank_is_marked_in_the_table_and_its_laws_are_named():
    turned = ranks.turned_by([ranks.RankChange("shadowing", 3, 0.05, ("work",), {}),
                              ranks.RankChange("both", 1, 0.0, ("work",), {})])  # fmt: skip
    assert turned == {"work": ["shadowing", "both"]}
    values = dict.fromkeys(OBJECTIVES, 1.0)
    shown = terminal.objective_table("best", values, dict.fromkeys(OBJECTIVES, 0.0), values, turned=turned)
    cells = dict(zip(shown.columns[0].cells, shown.columns[5].cells, strict=True))
    assert {name for name, cell in cells.items() if cell.endswith("*")} == {"work (min)"}
    assert "work: shadowing, both" in shown.caption


def test_a_change_is_told_with_its_range_under_other_laws_and_whether_its_sign_is_certain():
    flat = dict.fromkeys(OBJECTIVES, 100.0) | {"efficiency": -1.0}
    values = flat | {"efficiency": -2.0, "work": 110.0}
    under = {name: [0.0, 0.0] for name in values} | {"efficiency": [0.5, 0.75], "work": [-0.02, 0.3, np.nan]}
    assert terminal.headline("efficiency", -2.0, -1.0, under).startswith("J_W x 2.00")
    assert "x 1.50 to 1.75 under 2 other laws" in terminal.headline("efficiency", -2.0, -1.0, under)
    shown = terminal.gains_table(values, flat, under, "efficiency")
    rows = [*zip(*(column.cells for column in shown.columns), strict=True)]
    assert ("-2 to +30 %", "sign not certain") in [row[-2:] for row in rows]
    assert "efficiency" not in [row[0] for row in rows]
    assert terminal.doubtful(0.1, [0.2, 0.01]) == ""
