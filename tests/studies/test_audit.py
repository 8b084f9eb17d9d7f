"""What an effect changes in a scene, and whether that matters; what an accuracy decides wrongly."""

import json

import numpy as np
import pytest
from running import composed, footopt, only_folder
from study_pages import check_page

import footopt as fo
from footopt.effects import EFFECTS
from footopt.studies import build
from footopt.studies.accuracy import wrong_pairs
from footopt.studies.effects import audit, every_effect, switched
from footopt.walk.accuracy import PRESETS
from footopt.walk.ladder import numerics

FEET = fo.Waypoints().random(12, seed=3, inside=True)


def test_an_effect_that_acts_matters_and_its_changes_are_those_of_the_walks():
    found = audit(fo.Slope(10.0), fo.Scene(), FEET, "draft", 0.01)
    assert found.matters
    assert not found._replace(tolerance=10.0).matters
    assert 0.0 < found.kendall_tau < 1.0
    assert found.walks_lost == 0
    with_ = fo.evaluate(FEET, fo.Scene(effects=(fo.Slope(10.0),)), "draft").values
    without = fo.evaluate(FEET, fo.Scene(), "draft").values
    expected = np.percentile(np.abs(with_ / without - 1.0), 95.0, axis=0)
    np.testing.assert_allclose(found.changes, expected)
    distance, height, *costs = (with_ / without).T
    assert found.gain == pytest.approx(np.median(distance * height / np.prod(costs, axis=0)))


def test_an_effect_takes_the_place_of_one_of_its_kind_and_is_audited_as_the_scene_has_it():
    one, other, slope = fo.Inertia(rho=100.0), fo.Inertia(rho=8000.0), fo.Slope(3.0)
    without, with_ = switched(other, fo.Scene(effects=(one, slope)))
    assert without.effects == (slope,)
    assert set(with_.effects) == {other, slope}
    audited = every_effect(fo.Scene(effects=(slope,)))
    assert [type(effect) for effect in audited] == list(EFFECTS.values())
    assert slope in audited


@pytest.mark.parametrize(
    ("words", "effects"),
    [
        (["scene=deep", "effects=[]"], ()),
        (["effects=[]", "scene=brisk"], ()),
        (["effects=[layers,slope]", "effects.slope.angle=-3"], (fo.Slope(-3.0), fo.Layers())),
        (["scene=incline", "effects.slope.angle=-7"], (fo.Slope(-7.0),)),
    ],
)
def test_effects_of_the_command_line_combine_and_win_over_those_of_the_scene(words, effects):
    assert build.make_scene(composed(*words)).effects == fo.Scene(effects=effects).effects


@pytest.mark.slow
def test_the_study_from_the_command_line(tmp_path):
    words = ["study=effects", "study.feet=4", "accuracy=draft", "hydra.run.dir=out"]
    done = footopt(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert {a["effect"] for a in result["audit"]} == set(EFFECTS)
    assert all(a["tolerance"] == 0.02 for a in result["audit"])
    assert "leading_edge" in result["called_for"]
    for found in result["audit"]:
        scene = fo.Scene(effects=(EFFECTS[found["effect"]](),))
        assert fo.Accuracy(**found["accuracy"]) == numerics(PRESETS["draft"], scene, fo.Waypoints())
    check_page(tmp_path / "out")


@pytest.mark.slow
@pytest.mark.parametrize("given", [(), ("leading_edge",)], ids=["nothing", "leading edge"])
def test_auto_simulates_what_matters_and_what_is_given_and_records_why(given, tmp_path):
    """Shadowing changes more than the tolerance by itself, and less where only faces that lead count.

    All kernels are those of the study above.
    """
    effects = f"effects=[{','.join(['auto', *given])}]"
    words = ["foot.k=[5,8,9,8,5,4,4,2,2,3,4]", "effects.tolerance=0.13", "accuracy=draft"]
    done = footopt("study=simulate", effects, *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    result = json.loads((only_folder(tmp_path) / "result.json").read_text())
    assert set(result["scene"]["effects"]) == {"leading_edge"}
    matters = {"leading_edge": True, "inertia": False, "shadowing": False}
    assert {a["effect"]: a["matters"] for a in result["effects_audit"]} == {
        name: whether for name, whether in matters.items() if name not in given
    }


def test_pairs_turned_round_are_wrong_and_so_are_ties_and_failed_walks_where_there_is_an_order():
    truth = np.array([-3.0, -1.0, -2.0, 4.0])
    assert wrong_pairs(10.0 + 1e-3 * truth, truth) == 0.0
    assert wrong_pairs(-truth, truth) == 1.0
    assert wrong_pairs(np.array([-3.0, -2.0, -1.0, 4.0]), truth) == pytest.approx(1 / 6)
    assert wrong_pairs(np.array([1.0, 1.0]), np.array([1.0, 2.0])) == 1.0
    assert wrong_pairs(np.array([1.0, np.nan]), np.array([1.0, 2.0])) == 1.0
