"""Scenes and their effects from the settings, and the study that says which effects matter."""

import json

import pytest
from every_effect import ALL
from running import composed, footopt, only_folder
from study_pages import check_page

import footopt as fo
from footopt.effects import EFFECTS
from footopt.studies import build
from footopt.studies.stability import judge_case
from footopt.studies.stability_cases import CASES
from footopt.walk.accuracy import PRESETS
from footopt.walk.ladder import numerics

K = (5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4)
HARD = ("standing on zeta 5", "a foot set down at 3 m/s", "spiky soles", "creep 1e-9 on zeta 50",
        "a step ten times larger", "sinking to the hip")  # fmt: skip


def scene_of(*overrides):
    return build.make_scene(composed(*overrides))


class TestSettings:
    def test_effects_combine_and_act_in_one_order_however_they_are_named(self):
        one = scene_of("effects=[inertia,slope,layers]", "effects.slope.angle=-3")
        other = scene_of("effects=[layers,slope,inertia]", "effects.slope.angle=-3")
        assert one.effects == other.effects
        assert {*one.effects} == {fo.Layers(), fo.Inertia(), fo.Slope(-3.0)}

    def test_what_the_command_line_names_wins_over_the_scene(self):
        scene = scene_of("scene=deep", "sand=hard", "effects=[]")
        assert (scene.sand.zeta, scene.effects) == (5.0, ())
        assert scene_of("scene=incline", "effects.slope.angle=-7").effects == (fo.Slope(-7.0),)
        assert scene_of("effects=[]", "scene=brisk").effects == ()


@pytest.mark.slow
def test_the_study_from_the_command_line(tmp_path):
    words = ["study=effects", "study.feet=4", "accuracy=draft", "hydra.run.dir=out"]
    done = footopt(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert {a["effect"] for a in result["audit"]} == set(EFFECTS)
    assert all(a["tolerance"] == 0.02 for a in result["audit"])
    assert "leading_edge" in result["called_for"]
    walked = {a["effect"]: fo.Accuracy(**a["accuracy"]) for a in result["audit"]}
    for name, accuracy in walked.items():
        scene = fo.Scene(effects=(EFFECTS[name](),))
        assert accuracy == numerics(PRESETS["draft"], scene, fo.Waypoints())
    check_page(tmp_path / "out")
    assert "leading edge changes" in done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("given", [(), ("leading_edge",)], ids=["nothing", "leading edge"])
def test_auto_simulates_what_matters_and_what_is_given_and_records_why(given, tmp_path):
    """Shadowing changes more than the tolerance by itself, and less where only faces that lead count.

    All kernels are those of the study above.
    """
    effects, foot = ",".join(["auto", *given]), f"foot.k={list(K)}".replace(" ", "")
    words = ["study=simulate", foot, f"effects=[{effects}]", "effects.tolerance=0.13", "accuracy=draft"]
    done = footopt(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    result = json.loads((only_folder(tmp_path) / "result.json").read_text())
    assert set(result["scene"]["effects"]) == {"leading_edge"}
    matters = {"leading_edge": True, "inertia": False, "shadowing": False}
    assert {a["effect"]: a["matters"] for a in result["effects_audit"]} == {
        name: whether for name, whether in matters.items() if name not in given
    }
    assert "effects=auto: inertia changes" in done.stdout


@pytest.mark.slow
@pytest.mark.parametrize(
    "effects", [(fo.Rest(),), (fo.LeadingEdge(),), ALL], ids=["rest", "leading edge", "all"]
)
@pytest.mark.parametrize("case", HARD)
def test_hard_cases_are_stable_with_effects(effects, case):
    """With the two that turn forces off and on, and with all but rest at once. Each is compiled twice."""
    (chosen,) = (c for c in CASES if c.name == case)
    scene = fo.Scene(effects=effects)
    base = (fo.Foot.from_waypoints(K), scene, PRESETS["standard"])
    (verdict,) = judge_case(chosen, base, ["sdirk2_control"])
    assert verdict.stable, verdict.measures
