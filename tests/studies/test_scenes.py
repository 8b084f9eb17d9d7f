"""Scenes and their effects from the settings, the audit that says which matter, closed contours."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf
from running import footopt, only_folder
from shapely import Polygon
from study_pages import check_page

import footopt as fo
from footopt.cli.main import CONF
from footopt.effects import EFFECTS
from footopt.errors import SettingError
from footopt.foot import Plates
from footopt.foot.outline import closed_contour
from footopt.studies import build
from footopt.studies.stability import judge
from footopt.studies.stability_cases import CASES, Setup
from footopt.walk.audit import audit

K = (5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4)


def settings(*overrides):
    with initialize_config_dir(str(CONF), version_base="1.3"):
        return OmegaConf.to_object(compose("config", [*overrides]))


def scene_of(*overrides):
    return build.make_scene(settings(*overrides))


class TestSettings:
    def test_the_papers_walk_has_no_effect(self):
        assert scene_of().effects == ()

    @pytest.mark.parametrize("name", EFFECTS)
    def test_an_effect_is_switched_on_by_its_name_with_the_defaults_of_its_class(self, name):
        assert scene_of(f"effects={name}").effects == (EFFECTS[name](),)

    def test_effects_combine_and_act_in_one_order_however_they_are_named(self):
        one = scene_of("effects=[inertia,slope,layers]", "effects.slope.angle=-3")
        other = scene_of("effects=[layers,slope,inertia]", "effects.slope.angle=-3")
        assert one.effects == other.effects
        assert {*one.effects} == {fo.Layers(), fo.Inertia(), fo.Slope(-3.0)}

    @pytest.mark.parametrize(
        ("name", "effects", "zeta"),
        [
            ("walk", (), 5.0),
            ("incline", (fo.Slope(10.0),), 5.0),
            ("crust", (fo.Layers((0.02,), (0.04,)),), 5.0),
            ("patchy", (fo.Patches((0.9,), (1.5,), (0.2,), 0.05),), 5.0),
            ("brisk", (fo.Inertia(),), 5.0),
            ("deep", (fo.LeadingEdge(),), 0.2),
        ],
    )
    def test_scenes(self, name, effects, zeta):
        config = settings(f"scene={name}")
        scene = build.make_scene(config)
        assert (scene.effects, scene.sand.zeta) == (effects, zeta)
        assert config.scene.name == name
        assert scene.gait.period == (0.9 if name == "brisk" else 1.2)
        assert build.make_space(config.foot).closed == (name == "deep")

    def test_what_the_command_line_names_wins_over_the_scene(self):
        scene = scene_of("scene=deep", "sand=hard", "effects=[]")
        assert (scene.sand.zeta, scene.effects) == (5.0, ())
        assert scene_of("scene=incline", "effects.slope.angle=-7").effects == (fo.Slope(-7.0),)
        assert scene_of("effects=[]", "scene=brisk").effects == ()

    def test_two_effects_of_a_kind_are_refused(self):
        with pytest.raises(SettingError, match="at most one effect of a kind"):
            fo.Scene(effects=(fo.Slope(1.0), fo.Slope(2.0)))

    def test_a_scene_of_ones_own_is_a_small_file(self, tmp_path):
        """As the README shows it."""
        (tmp_path / "mine" / "scene").mkdir(parents=True)
        (tmp_path / "mine" / "scene" / "beach.yaml").write_text(
            "# @package _global_\n"
            "defaults:\n"
            "  - override /effects: [slope, layers]\n"
            "scene:\n  name: beach\n"
            "effects:\n  slope: {angle: 3.0}\n  layers: {depths: [0.01, 0.05], factors: [2.0, 0.5]}\n"
        )
        arguments = ["--config-dir", str(tmp_path / "mine"), "scene=beach", "--cfg", "job", "-p", "effects"]
        done = footopt(*arguments, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        shown = OmegaConf.to_container(OmegaConf.create(done.stdout))
        assert shown["slope"] == {"angle": 3.0}
        assert shown["layers"] == {"depths": [0.01, 0.05], "factors": [2.0, 0.5]}

    def test_a_bad_parameter_is_named(self, tmp_path):
        done = footopt("study=simulate", "effects=slope", "effects.slope.angle=60", cwd=tmp_path)
        assert done.returncode == 1
        assert "effects.slope.angle = 60" in done.stderr
        assert "Traceback" not in done.stderr

    def test_auto_is_for_a_search_and_for_one_walk(self):
        with pytest.raises(SettingError, match=r"effects\.auto.*study=effects"):
            scene_of("study=stability", "effects=auto")


class TestClosedContours:
    def test_the_plates_run_once_around(self):
        foot = fo.Foot.from_waypoints(K, closed=True, top=0.02)
        plates = foot.plates(64, directed=True)
        outline = closed_contour(foot.contour, foot.top)
        loop = np.linalg.norm(np.diff(outline, axis=0, append=outline[:1]), axis=1).sum()
        assert plates.area.sum() == pytest.approx(loop * foot.width, rel=1e-3)
        # the divergence theorem: the sum of normals is zero, and x n_x is the area
        normal = np.stack([plates.tz[0], -plates.tx[0]])
        assert (normal * plates.area).sum(axis=1) == pytest.approx([0.0, 0.0], abs=1e-5)
        enclosed = (plates.x * normal[0] * plates.area).sum() / foot.width
        assert enclosed == pytest.approx(Polygon(outline).area, rel=5e-3)

    def test_the_sole_comes_first_and_is_the_open_one(self):
        open_, closed = (fo.Foot.from_waypoints(K, closed=c).plates(40) for c in (False, True))
        np.testing.assert_array_equal(closed.x[:, :40], open_.x)
        assert closed.x.shape[1] == 40 + 5 + 20 + 5

    def test_a_side_of_no_length_has_no_area_and_is_finite(self):
        plates = fo.Foot.shape("circle", closed=True).plates(40, directed=True)
        assert all(np.isfinite(column).all() for column in plates)
        assert plates.area.min() == pytest.approx(0.0, abs=1e-20)

    def test_a_population_and_a_foot_have_the_same_plates(self):
        space = fo.Waypoints(closed=True, top=0.01)
        alone = fo.Foot.from_waypoints(K, space).plates(48, directed=True)
        for a, b in zip(space.plates([K, K], 48, directed=True), alone, strict=True):
            np.testing.assert_array_equal(a[1], b[0])

    def test_open_and_closed_feet_do_not_mix(self):
        feet = [fo.Foot.from_waypoints(K), fo.Foot.from_waypoints(K, closed=True)]
        with pytest.raises(SettingError, match=r"foot\.closed"):
            fo.evaluate(feet)

    def test_sides_and_top_carry_where_they_are_in_the_sand(self, flat_foot):
        """On soft sand the whole foot is, and the top holds it down when it is lifted."""
        scene = fo.Scene(sand=fo.Sand.named("soft"), effects=(fo.LeadingEdge(),))
        open_, closed = (fo.simulate(replace(flat_foot, closed=c), scene, "draft") for c in (False, True))
        assert open_.force[:, :, 1].min() > -10.0  # steep parts of the sole alone
        assert closed.force[:, :, 1].min() < -30.0
        assert closed.objectives["work"] > open_.objectives["work"]

    def test_take_keeps_what_is_there(self):
        plates = fo.Foot.from_waypoints(K).plates(16)
        assert isinstance(plates.take(slice(0, 1)), Plates)
        assert plates.take(slice(0, 1)).tx is None


FEET = fo.Waypoints().random(12, seed=3, inside=True)


class TestAudit:
    def test_an_effect_that_hardly_acts_is_left_out_and_ranks_feet_alike(self):
        found = audit(fo.Inertia(rho=0.01), fo.Scene(), FEET, "draft", 0.01, repeats=1)
        assert not found.matters
        assert "leave it out" in found.verdict
        assert (found.lost, found.feet) == (0, 12)
        assert found.tau == pytest.approx(1.0)
        assert (found.changes < 1e-3).all()

    def test_an_effect_that_acts_is_kept_and_says_what_it_changes(self):
        found = audit(fo.Inertia(rho=8000.0), fo.Scene(), FEET, "draft", 0.01, repeats=1)
        assert found.matters
        assert found.worst == "peak_power"
        assert found.verdict.startswith("changes peak power by")
        assert found.verdict.endswith("above your 1 %, keep it")
        with_ = fo.evaluate(FEET, fo.Scene(effects=(fo.Inertia(rho=8000.0),)), "draft").values
        without = fo.evaluate(FEET, fo.Scene(), "draft").values
        expected = np.percentile(np.abs(with_ / without - 1.0), 95.0, axis=0)
        np.testing.assert_allclose(found.changes, expected)

    def test_the_effect_takes_the_place_of_one_of_its_kind(self):
        scene = fo.Scene(effects=(fo.Inertia(rho=100.0),))
        found = audit(fo.Inertia(rho=8000.0), scene, FEET[:3], "draft", repeats=1)
        assert found.scene.effects == ()

    @pytest.mark.slow
    def test_walks_that_fail_with_it_are_counted_and_matter(self):
        found = audit(fo.Layers((1e-3,), (1e-4,)), fo.Scene(), FEET[:3], "draft", repeats=1)
        assert (found.lost, found.feet, found.matters) == (3, 0, True)
        assert "3 walks fail" in found.verdict


@pytest.mark.slow
def test_the_study_from_the_command_line(tmp_path):
    words = ["study=effects", "study.feet=4", "accuracy=draft", "hydra.run.dir=out"]
    done = footopt(*words, cwd=tmp_path, drawn=True)
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "out" / "effects.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {r["effect"] for r in rows} == set(EFFECTS)
    assert {r["sand"] for r in rows if r["effect"] == "leading_edge"} == {"soft", "regular", "hard"}
    assert all(r["tolerance"] == "0.02" for r in rows)
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert "leading_edge" in result["called_for"]
    assert all(
        (tmp_path / "out" / "figures" / f"effects.{end}").stat().st_size > 5000 for end in ("png", "pdf")
    )
    check_page(tmp_path / "out")
    assert "leading edge on soft sand changes" in done.stdout


@pytest.mark.slow
def test_auto_simulates_what_matters_and_records_why(tmp_path):
    arguments = [
        "study=simulate",
        f"foot.k={list(K)}".replace(" ", ""),
        "effects=[auto,slope]",
        "accuracy=draft",
    ]
    done = footopt(*arguments, "effects.tolerance=0.1", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    result = json.loads((only_folder(tmp_path) / "result.json").read_text())
    assert set(result["scene"]["effects"]) == {"leading_edge", "slope"}
    assert {a["effect"]: a["matters"] for a in result["effects_audit"]} == {
        "leading_edge": True,
        "inertia": False,
    }
    assert "effects=auto: inertia changes" in done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("effect", EFFECTS)
@pytest.mark.parametrize("case", [c.name for c in CASES])
def test_hard_cases_are_stable_with_each_effect(effect, case):
    (chosen,) = (c for c in CASES if c.name == case)
    scene = fo.Scene(effects=(EFFECTS[effect](),))
    base = Setup(fo.Foot.from_waypoints(K), scene, fo.Accuracy.named("standard"))
    (verdict,) = judge(chosen, base, ["sdirk2_control"])
    assert verdict.stable, verdict.measures
