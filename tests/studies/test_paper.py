"""The paper's claims are measured on walks, their verdicts follow from the numbers, and all is drawn."""

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from running import footopt
from study_pages import check_page

import footopt as fo
from footopt.design import Solver, search
from footopt.errors import SettingError
from footopt.foot import SHAPES
from footopt.gait.gait import LEFT, RIGHT
from footopt.report import figures, style
from footopt.report.figures import paper as paper_figures
from footopt.studies import shapes as shapes_study
from footopt.studies.base import Study
from footopt.studies.paper import claims, readings, study, sweep
from footopt.studies.paper.claims import CLAIMS, SANDS, Evidence
from footopt.studies.paper.errata import ERRATA
from footopt.studies.paper.page import grid, kind
from footopt.studies.paper.readings import Readings, ReadProblem, read, switch_losses
from footopt.studies.paper.sweep import FACTORS, changed, combinations, factors, sensitivity, verdict
from footopt.studies.settings import Config, StudyConfig
from footopt.walk.phases import STANDS

HOLLOW = (5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4)
ROCKER = (1, 3, 5, 7, 8, 9, 9, 9, 9, 9, 9)
#: Not those that move only the search.
MOVES_WALKS = [f for f in FACTORS if f.setting not in ("solver.seed", "foot.box_tolerance")]
QUICK = ("study=paper", "study.quick=true")


def config(**settings):
    """The default settings, some of them changed by their names on the command line."""
    return changed(Config(), {name.replace("__", "."): value for name, value in settings.items()})


def scene(sand):
    return fo.Scene(sand=fo.Sand.named(sand))


@pytest.fixture(scope="module")
def evidence():
    """All walks at draft accuracy, with feet that nobody searched for."""
    feet = {"hard": HOLLOW, "regular": ROCKER, "soft": ROCKER}
    return study.Setup(config(study__confirm="draft")).evidence(
        {sand: fo.Foot.from_waypoints(k) for sand, k in feet.items()}
    )


@pytest.fixture(scope="module")
def walk():
    return fo.simulate(fo.Foot.from_waypoints(HOLLOW), scene("hard"), "fine")


@pytest.fixture(scope="module")
def failed():
    walk = fo.simulate(fo.Foot.from_waypoints(HOLLOW), fo.Scene(sand=fo.Sand(zeta=0.02)), "draft")
    assert not walk.feasible
    return walk


class TestReadings:
    def test_the_library_s_own_change_nothing(self, walk):
        assert read(walk, Readings()).objectives == walk.objectives

    def test_narrower_readings_find_less(self, walk):
        losses = [
            read(walk, Readings(speed_loss=name)).objectives["speed_loss"] for name in readings.SPEED_LOSS
        ]
        assert losses == sorted(losses, reverse=True)
        assert losses[-1] > 0.0
        single = read(walk, Readings(peak_power="single")).objectives["peak_power"]
        assert 0.0 < single <= walk.objectives["peak_power"]

    def test_j_w_follows_from_its_parts_as_they_are_read(self, walk):
        o = read(walk, Readings("single", "window")).objectives
        cost = o["work"] * o["peak_power"] * o["speed_loss"]
        assert o["efficiency"] == pytest.approx(-o["distance"] * o["mean_height"] / cost)
        assert o["efficiency"] != walk.objectives["efficiency"]

    @pytest.mark.parametrize("name", readings.SPEED_LOSS)
    def test_a_fall_at_a_switch_is_found_there_and_nowhere_else(self, walk, name):
        velocity = np.ones_like(walk.velocity)
        velocity[walk.t > 1.7] = 0.7
        losses = switch_losses(replace(walk, velocity=velocity), Readings(speed_loss=name))
        np.testing.assert_allclose(losses, [0.0, 0.3, 0.0], atol=1e-12)

    def test_power_while_both_feet_stand_does_not_count_in_single_stance(self, walk):
        both = (walk.force[..., 1] > 0.05 * walk.scene.walker.weight).all(axis=1)
        power = np.where(both[:, None], -1e6, walk.power)
        assert readings.single_stance_power(replace(walk, power=power)) == readings.single_stance_power(walk)
        assert both.any()

    def test_a_failed_walk_has_no_readings(self, failed):
        assert math.isnan(read(failed, Readings("single", "window")).objectives["efficiency"])
        assert np.isnan(switch_losses(failed, Readings())).all()

    @pytest.mark.parametrize("chosen", [Readings(), Readings("single", "narrow")])
    def test_a_problem_ranks_by_what_is_read(self, chosen):
        problem = ReadProblem(chosen, scene=scene("hard"), accuracy="draft")
        out = problem.evaluate(np.array([HOLLOW, ROCKER]), return_as_dictionary=True)
        for k, f, values in zip((HOLLOW, ROCKER), out["F"], out["values"], strict=True):
            walk = fo.simulate(fo.Foot.from_waypoints(k), scene("hard"), "draft")
            expected = read(walk, chosen).objectives
            assert f[0] == pytest.approx(expected["efficiency"], rel=1e-12)
            np.testing.assert_allclose(values, [expected[name] for name in problem.record], rtol=1e-12)

    def test_a_search_ranks_by_what_is_read(self):
        chosen = Readings("single", "narrow")
        problem = ReadProblem(chosen, scene=scene("hard"), accuracy="draft")
        result = search(problem, Solver("ga", pop_size=8, n_gen=2, seed=1))
        for k, j in zip(result.k, result.column("efficiency"), strict=True):
            walk = fo.simulate(fo.Foot.from_waypoints(k), scene("hard"), "draft")
            assert j == pytest.approx(read(walk, chosen).objectives["efficiency"], rel=1e-12)
            assert j != pytest.approx(walk.objectives["efficiency"], rel=1e-2)

    @pytest.mark.parametrize(("name", "value"), [("peak_power", "double"), ("speed_loss", "tunnel")])
    def test_unknown_readings_are_refused(self, name, value):
        with pytest.raises(SettingError, match=rf"study\.{name} = '{value}': must be one of"):
            Readings.of(StudyConfig(**{name: value}))


class TestClaims:
    def test_every_claim_has_a_margin_and_says_how(self, evidence):
        margins = study.measure(evidence)
        assert np.isfinite(margins).all()
        for name, claim in CLAIMS.items():
            assert claim.name == name
            assert claim.says
            assert claim.decided
            assert claim.place.startswith("Fig. ")
        assert {claim.about for claim in CLAIMS.values()} == {"shapes", "optima"}

    def test_a_claim_about_shapes_turns_with_the_shapes(self, evidence):
        by_distance = sorted(evidence.shapes, key=lambda n: evidence.shapes[n].objectives["distance"])
        best = evidence.shapes[by_distance[-1]]
        order = {**evidence.shapes, "reversed_triangle": best, by_distance[-1]: evidence.shapes["circle"]}
        assert CLAIMS["triangle_furthest"].margin(replace(evidence, shapes=order)) >= 0.0
        order = {**evidence.shapes, "reversed_triangle": evidence.shapes[by_distance[0]]}
        assert CLAIMS["triangle_furthest"].margin(replace(evidence, shapes=order)) < 0.0

    def test_claims_about_sands_turn_when_two_sands_are_exchanged(self, evidence):
        swapped = replace(
            evidence, optima={**evidence.optima, "soft": evidence.hard, "hard": evidence.optima["soft"]}
        )
        for name in ("hard_furthest", "hard_sinks_least", "soft_shortest", "soft_sinks_deepest"):
            assert CLAIMS[name].margin(evidence) > 0.0, name
            assert CLAIMS[name].margin(swapped) < 0.0, name

    def test_a_walk_that_failed_leaves_its_claims_undecided(self, evidence, failed):
        broken = replace(evidence, optima={**evidence.optima, "soft": failed})
        margins = dict(zip(CLAIMS, study.measure(broken), strict=True))
        about_the_contour = ("soft_convex", "soft_curves_little")
        for name in CLAIMS:
            if name.startswith("soft_") and name not in about_the_contour:
                assert math.isnan(margins[name]), name
        assert math.isfinite(margins["regular_foot_more_work"])
        without_shape = replace(evidence, shapes={**evidence.shapes, "circle": failed})
        assert math.isnan(CLAIMS["same_vertical_velocity"].margin(without_shape))

    def test_mean_drags_add_up_to_the_change_of_momentum(self, walk):
        t, speed = walk.t[walk.t >= 1.1], walk.velocity[walk.t >= 1.1, 0]
        forth, back = (claims.mean_drag(walk, way) for way in (1, -1))
        impulse = (forth - back) * (t[-1] - t[0])
        gross = (forth + back) * (t[-1] - t[0])
        assert impulse == pytest.approx(60.0 * (speed[-1] - speed[0]), abs=3e-3 * gross)

    def test_work_after_three_steps_is_all_the_work_of_the_paper_s_walk(self, walk):
        assert claims.work_after_three_steps(walk) == pytest.approx(walk.objectives["work"], rel=1e-3)

    def test_the_curvature_of_a_circle_and_of_a_flat_foot(self):
        circle = fo.Foot.shape("circle")
        assert claims.rms_curvature(circle) == pytest.approx(np.pi / 0.26, rel=1e-3)
        for foot in (circle, fo.Foot.flat(), fo.Foot.shape("ellipse")):
            assert claims.inward_turn(foot) == pytest.approx(0.0, abs=1e-6)
        assert claims.inward_turn(fo.Foot.from_waypoints(HOLLOW)) > 10.0

    def test_a_filled_foot_is_the_hull_and_has_no_hollow(self):
        foot = fo.Foot.from_waypoints(HOLLOW)
        full = claims.filled(foot)
        assert foot.hollow > 0.003
        assert full.hollow == pytest.approx(0.0, abs=1e-12)
        z = np.interp(foot.contour[:, 0], *full.contour.T)
        assert (z <= foot.contour[:, 1] + 1e-12).all()

    def test_the_zone_of_a_foot_that_is_all_in_the_sand(self, walk):
        sunk = claims.contact_zone(replace(walk, com=walk.com - [0.0, 1.0]))
        assert sunk.whole == sunk.middle == 1.0
        zone = claims.contact_zone(walk)
        assert 0.0 < zone.middle < 1.0
        assert abs(zone.centre) < 0.13

    def test_the_push_is_part_of_the_step(self, walk):
        step = claims.one_step(walk)
        assert 0.0 < claims.push_time(walk) < step.t[-1]
        assert (step.force[:, 1] > STANDS).all()


class TestSweep:
    def test_a_factor_that_decides_explains_all_and_another_nothing(self):
        rng = np.random.default_rng(0)
        level, other = rng.permutation(np.arange(120) % 3), rng.permutation(np.arange(120) % 5)
        held = (level > 0).astype(float)
        assert sensitivity(held, level) == pytest.approx(1.0)
        assert sensitivity(held, other) < 0.05
        held[:10] = np.nan
        assert sensitivity(held, level) == pytest.approx(1.0)

    @given(share=st.sampled_from([0.0, 1.0]), levels=st.integers(1, 5))
    def test_nothing_explains_what_never_changes(self, share, levels):
        assert sensitivity(np.full(20, share), np.arange(20) % levels) == 0.0
        assert sensitivity(np.full(20, np.nan), np.arange(20) % levels) == 0.0

    def test_chance_is_what_random_outcomes_reach(self):
        rng = np.random.default_rng(0)
        level = np.arange(48) % 3
        found = [sensitivity(rng.integers(0, 2, 48).astype(float), level) for _ in range(2000)]
        assert np.mean(np.array(found) > sweep.chance(48, 3)) == pytest.approx(0.05, abs=0.015)
        assert sweep.chance(2, 3) == 1.0

    @given(samples=st.integers(1, 40), seed=st.integers(0, 100))
    def test_combinations_give_every_level_its_turn(self, samples, seed):
        drawn = combinations(FACTORS, samples, seed)
        assert drawn.shape == (samples, len(FACTORS))
        for column, factor in zip(drawn.T, FACTORS, strict=True):
            counts = np.bincount(column, minlength=len(factor.levels))
            assert np.ptp(counts) <= 1
        np.testing.assert_array_equal(drawn, combinations(FACTORS, samples, seed))

    def test_the_first_level_is_the_setting_itself(self):
        own = config(foot__width=0.08, scene__t_f=3.0)
        levels = {factor.setting: factor.levels for factor in factors(own)}
        assert levels["foot.width"] == (0.08, 0.10, 0.05, 0.15)
        assert levels["scene.t_f"][0] == 3.0
        for factor, plain in zip(FACTORS, factors(Config()), strict=True):
            assert factor.levels == plain.levels, "the table's first level is not the default"

    def test_changing_settings_leaves_the_given_ones_alone(self):
        before = config()
        after = changed(before, {"foot.width": 0.05, "gait.pitch": "measured"})
        assert (after.foot.width, after.gait.pitch) == (0.05, "measured")
        assert before == Config()

    @pytest.mark.parametrize("factor", MOVES_WALKS, ids=lambda f: f.setting)
    def test_every_level_moves_the_walks_that_it_says(self, factor):
        """Shapes or one foot's walk, as it is read, differ from the first level's."""
        seen = []
        for level in factor.levels:
            setup = study.Setup(changed(config(study__confirm="draft"), {factor.setting: level}))
            walks = setup.shapes() if "shapes" in factor.moves else {}
            if "optima" in factor.moves:
                space = study.build.make_space(setup.config.foot)
                walks["foot"] = setup.walk(fo.Foot.from_waypoints(HOLLOW, space), "hard")
            read_as = [read(w, setup.readings).objectives for w in walks.values()]
            seen.append([o[n] for o in read_as for n in ("distance", "peak_power", "speed_loss")])
        for other in seen[1:]:
            assert other != seen[0]

    def test_shapes_hang_from_their_centre_or_their_top(self):
        centre = shapes_study.make_shapes(config())
        top = shapes_study.make_shapes(config(study__mount="top", foot__ankle=[-0.03, 0.01]))
        assert list(centre) == list(SHAPES)
        for name, foot in centre.items():
            low = foot.contour[:, 1].min()
            assert foot.ankle == (0.0, 0.0)
            assert top[name].ankle == pytest.approx((-0.03, 0.01 - low))
        with pytest.raises(SettingError, match=r"study\.mount = 'side': must be one of centre, top"):
            shapes_study.make_shapes(config(study__mount="side"))

    @pytest.mark.parametrize(
        ("holds", "share", "rates", "says"),
        [
            (True, math.nan, {}, "holds"),
            (False, math.nan, {}, "does not hold"),
            (True, 0.96, {"a": 1.0}, "holds"),
            (False, 0.03, {"a": 0.1}, "does not hold"),
            (False, 0.96, {"a": 1.0, "b": 0.9}, "holds only if"),
            (True, 0.5, {"a": 1.0, "b": 0.0}, "holds only if x.y = a (100%, else 0%)"),
            (
                False,
                0.3,
                {"a": 0.1, "b": 0.2, "c": 0.6},
                "holds only if several agree, mostly x.y = c (60%, else 15%)",
            ),
            (True, 0.5, {}, "holds only if several agree"),
        ],
    )
    def test_verdicts(self, holds, share, rates, says):
        found = verdict(holds, share, rates, "x.y" if rates else "")
        assert found.startswith(says)

    def test_a_judgement_names_what_turns_and_what_decides(self):
        chosen = (
            sweep.Factor("foot.width", (0.1, 0.05), "", ("shapes", "optima")),
            sweep.Factor("foot.apex", ("middle", "toe"), "", ("shapes",)),
        )
        levels = np.array([[i % 2, i // 2 % 2] for i in range(40)])
        margins = np.where(levels[:, 1] == 1, 1.0, -1.0)
        margins[0] = np.nan
        alone = [("foot.width=0.05", -2.0), ("foot.apex=toe", 1.0)]
        about_shapes = sweep.judge(-1.0, alone, margins, levels, chosen, "shapes")
        assert about_shapes.decides == "foot.apex"
        assert about_shapes.rates == {"middle": 0.0, "toe": 1.0}
        assert about_shapes.flips == ("foot.apex=toe",)
        assert (about_shapes.undecided, kind(about_shapes)) == (1, "holds only if")
        assert set(sweep.judge(-1.0, alone, margins, levels, chosen, "optima").sensitivities) == {
            "foot.width"
        }

    def test_the_threads_do_not_change_the_sweep(self, monkeypatch):
        few = tuple(f for f in FACTORS if f.setting in ("foot.apex", "study.speed_loss"))
        monkeypatch.setattr(sweep, "FACTORS", few)
        settings = config(study__confirm="draft")
        budget = study.Budget(6, 2, 1, 2, (6, 1))
        feet = dict.fromkeys(SANDS, fo.Foot.from_waypoints(ROCKER))
        one, two = (study.sweep(settings, feet, budget, threads) for threads in (1, 2))
        np.testing.assert_array_equal(one.margins, two.margins)
        np.testing.assert_array_equal(one.alone, two.alone)
        assert one.changes[0] == "foot.apex=toe"
        assert np.isfinite(one.alone).all()

    def test_a_search_without_a_feasible_foot_leaves_its_claims_undecided(self, monkeypatch):
        monkeypatch.setattr(sweep, "FACTORS", tuple(f for f in FACTORS if f.setting == "foot.width"))
        sinking = changed(config(study__confirm="draft"), {"walker.mass": 2000.0})
        budget = study.Budget(6, 1, 1, 1, (6, 1))
        feet = dict.fromkeys(SANDS, fo.Foot.from_waypoints(ROCKER))
        assert np.isnan(study.sweep(sinking, feet, budget, 1).margins).all()


class TestErrata:
    def test_every_slip_says_where_what_why_and_what_instead(self):
        assert len(ERRATA) >= 15
        assert all(all(part.strip() for part in erratum) for erratum in ERRATA)

    def test_the_waypoints_of_the_paper_do_not_span_the_box_and_ours_do(self):
        space = fo.Waypoints()
        i = np.arange(1, 12)
        assert (i - 1)[-1] * (3 - 11) / (11 - 1) * space.L == pytest.approx(-8 * space.L)
        assert (space.x[0], space.x[-1]) == pytest.approx((-space.L, space.L))

    def test_one_tangent_cannot_tell_down_and_back_from_up_and_forth(self):
        down_back, up_forth = (-1.0, -1.0), (1.0, 1.0)
        assert np.arctan(down_back[1] / down_back[0]) == np.arctan(up_forth[1] / up_forth[0])
        stresses = [fo.stress.alpha(0.0, np.arctan2(-vz, vx))[1] for vx, vz in (down_back, up_forth)]
        assert stresses[0] > 0.0 > stresses[1]

    def test_seven_of_ten_random_splines_leave_the_box(self):
        space = fo.Waypoints()
        violation = space.box_violation(space.random(5000, seed=1))
        assert np.mean(violation > 0.0) == pytest.approx(0.7, abs=0.03)


def texts(figure):
    return [text.get_text() for text in figure.findobj(match=lambda a: hasattr(a, "get_text"))]


class TestFigures:
    def test_sands_and_shapes_keep_their_colours(self, evidence):
        optima = {sand: evidence.optima[sand] for sand in style.SANDS}
        for figure in (figures.power_work(optima), paper_figures.states(optima)):
            lines = {line.get_label(): line.get_color() for line in figure.axes[0].get_lines()}
            assert lines["soft"] == style.BLUE
            assert lines["hard"] == style.VERMILLION
            assert lines["regular"] == style.GREEN

    def test_states_are_the_walks_own(self, evidence):
        walks = paper_figures.labelled(evidence.shapes)
        path, forward, upward = paper_figures.states(walks).axes
        assert "reversed L" in walks
        for i, walk in enumerate(walks.values()):
            np.testing.assert_array_equal(path.get_lines()[i].get_xydata(), walk.com)
        last = list(walks.values())[-1]
        np.testing.assert_array_equal(forward.get_lines()[-1].get_ydata(), last.velocity[:, 0])
        np.testing.assert_array_equal(upward.get_lines()[-1].get_ydata(), last.velocity[:, 1])

    def test_the_gait_shows_both_ankles(self):
        _, path, _ = paper_figures.gait(fo.Scene()).axes
        pose = fo.Gait.human().pose(np.linspace(0.0, 2.9, 1200), 0.47, 0.45)
        left, right = (line for line in path.get_lines() if len(line.get_xdata()) > 1)
        np.testing.assert_allclose(left.get_xydata(), np.stack([pose.x[:, LEFT], pose.z[:, LEFT]], 1))
        np.testing.assert_allclose(right.get_xydata(), np.stack([pose.x[:, RIGHT], pose.z[:, RIGHT]], 1))

    def test_the_five_contact_lines_have_one_length_and_lie_on_their_shapes(self):
        feet = {name: fo.Foot.shape(name) for name in SHAPES}
        for axes, foot in zip(paper_figures.shapes(feet).axes, feet.values(), strict=True):
            line = axes.get_lines()[0].get_xydata()
            assert np.hypot(*np.diff(line, axis=0).T).sum() == pytest.approx(260.0, rel=1e-4)
            (patch,) = axes.patches
            outline = patch.get_xy()
            assert outline[:, 1].min() == pytest.approx(1e3 * foot.contour[:, 1].min())
        assert "4: reversed L" in texts(paper_figures.shapes(feet))

    def test_an_upright_at_the_heel_is_drawn_there(self):
        figure = paper_figures.shapes({"reversed_l": fo.Foot.shape("reversed_l", upright="heel"), **{
            "circle": fo.Foot.shape("circle")}})  # fmt: skip
        outline = figure.axes[0].patches[0].get_xy()
        assert outline[np.argmax(outline[:, 1]), 0] < 0.0

    def test_the_waypoints_scheme(self):
        foot = fo.Foot.from_waypoints(HOLLOW)
        figure = paper_figures.waypoints(foot)
        said = texts(figure)
        assert {"$p_{1}$", "$p_{i}$", "$p_{n}$", "$2L$ = 260 mm", "$2H$ = 60 mm"} <= set(said)
        with pytest.raises(SettingError, match="foot"):
            paper_figures.waypoints(fo.Foot.shape("circle"))

    def test_two_steps_share_one_scale(self, evidence):
        figure = figures.steps({"one": evidence.hard, "other": evidence.crossed}, frames=3)
        assert len(figure.axes) == 6
        spans = {(round(float(np.ptp(a.get_xlim())), 9), a.get_ylim()) for a in figure.axes}
        assert len(spans) == 1
        assert any(text.startswith("other, time since") for text in texts(figure))

    def test_claims_that_were_not_swept_are_drawn_as_such(self):
        rows = [
            paper_figures.Row("it holds", True, 0.75, "foot.width"),
            paper_figures.Row("it does not", False, math.nan, ""),
        ]
        said = texts(paper_figures.claims(rows))
        assert {"75%  foot.width", "not swept", "it holds"} <= set(said)

    def test_figures_of_a_shape_that_failed_are_drawn(self, evidence, failed):
        walks = {**evidence.shapes, "circle": failed}
        paper_figures.states(walks).draw_without_rendering()
        figures.steps({"hard": failed}).draw_without_rendering()


def test_a_bar_in_a_cell_does_not_end_it():
    assert grid(("a",), [("|W|",)]).splitlines()[-1] == "| \\|W\\| |"


@pytest.fixture
def small(monkeypatch):
    """A study of a second: two factors and a tiny search."""
    few = tuple(f for f in FACTORS if f.setting in ("foot.apex", "foot.width"))
    monkeypatch.setattr(sweep, "FACTORS", few)
    monkeypatch.setattr(study, "QUICK_BUDGET", (6, 2))
    monkeypatch.setattr(style, "DPI", 50)


@pytest.mark.slow
def test_the_study_leaves_figures_claims_and_a_page(small, tmp_path, capsys):
    study.run(Study(config(study__quick=True, study__confirm="draft"), tmp_path, {"study": {"quick": True}}))
    drawn = {p.name for p in (tmp_path / "figures").iterdir()}
    for name in ("2b", "3", "4a", "4b", "5", "6", "7", "8a", "8b", "8c"):
        for end in ("png", "pdf"):
            assert any(p.startswith(f"fig{name}_") and p.endswith(end) for p in drawn), name
    content = json.loads((tmp_path / "claims.json").read_text())
    assert [entry["id"] for entry in content["claims"]] == list(CLAIMS)
    for entry in content["claims"]:
        assert entry["verdict"] in ("holds", "holds only if", "does not hold")
        assert entry["margin"] is not None
        assert 0.0 <= entry["share_of_sweep"] <= 1.0
        assert entry["holds_at_the_settings"] == (entry["margin"] > 0.0)
        assert set(entry["single_changes"]) == {"foot.width=0.05", "foot.width=0.15", "foot.apex=toe"}
    assert len(content["errata"]) == len(ERRATA)
    result = json.loads((tmp_path / "result.json").read_text())
    hard = result["optima"]["hard"]
    walked = fo.simulate(fo.Foot.from_waypoints(hard["design"]["k"]), scene("hard"), "draft")
    assert hard["objectives"] == walked.objectives
    text = (tmp_path / "claims.md").read_text()
    said = capsys.readouterr().out
    for claim in CLAIMS.values():
        assert claim.says in text
    assert f"{len(CLAIMS)} claims" in said
    assert "## Errata" in text
    assert "on soft sand: depth of the sole" in text, "no warning where RFT is stretched"


def test_without_a_sweep_claims_are_judged_at_the_settings(small, tmp_path, monkeypatch):
    monkeypatch.setattr(figures, "save", lambda figure, folder, name: None)  # drawn above
    monkeypatch.setattr(study, "write_study", lambda *page: None)
    study.run(Study(config(study__quick=True, study__confirm="draft", study__samples=0), tmp_path, {}))
    entries = json.loads((tmp_path / "claims.json").read_text())["claims"]
    assert all(e["verdict"] == ("holds" if e["margin"] > 0.0 else "does not hold") for e in entries)
    assert all(e["share_of_sweep"] is None for e in entries)
    assert "Nothing was swept" in (tmp_path / "claims.md").read_text()


@pytest.mark.slow
def test_the_shapes_study_is_what_the_library_computes(tmp_path, capsys):
    settings = config(sand__zeta=0.2, foot__length=0.2, accuracy__name="draft")
    shapes_study.run(Study(settings, tmp_path, {}))
    path = tmp_path / "result.json"
    result = json.loads(path.read_text())
    assert list(result["shapes"]) == list(SHAPES)
    for name, entry in result["shapes"].items():
        walk = fo.simulate(fo.Foot.shape(name, 0.2), scene("soft"), "draft")
        assert entry["objectives"] == walk.objectives
        assert entry["error_estimate"]["distance"] < 0.02
    check_page(tmp_path)
    drawn = {p.name for p in (path.parent / "figures").iterdir()}
    assert drawn == {f"{n}.{e}" for n in ("shapes", "states", "forces", "power_work") for e in ("png", "pdf")}
    with open(path.parent / "shapes.csv", newline="") as file:
        rows = {row["shape"]: row for row in csv.DictReader(file)}
    assert float(rows["circle"]["work"]) == result["shapes"]["circle"]["objectives"]["work"]
    assert {"ellipse", "rectangle", "circle", "triangle"} <= set(capsys.readouterr().out.split())


@pytest.mark.slow
def test_both_studies_from_the_command_line(tmp_path):
    for arguments in (QUICK, ("study=shapes", "sand=soft", "study.mount=top")):
        done = footopt(*arguments, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    assert len(list(tmp_path.rglob("shapes.csv"))) == 1
    (path,) = tmp_path.rglob("claims.json")
    assert len(json.loads(path.read_text())["sweep"]["factors"]) == len(FACTORS)
    check_page(path.parent)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"study__seeds": 0}, "study.seeds = 0: must be a whole number >= 1"),
        ({"study__samples": -1}, "study.samples = -1: must be a whole number from 0"),
        ({"study__shape_sand": "mud"}, "study.shape_sand = 'mud': must be one of soft, regular, hard"),
        ({"foot__shape": "circle"}, "foot.shape = 'circle': must be waypoints"),
        ({"foot__k": [1, 2]}, "foot.k = [1, 2]: must be None"),
        ({"scene__t_f": 1.0}, "scene.t_f = 1.0: must be later than the first heel strike"),
        ({"solver__pop_size": 2}, "solver.pop_size = 2: must be a whole number >= 4"),
        ({"study__confirm": "best"}, "accuracy = 'best': must be one of"),
    ],
)
def test_bad_settings_are_refused_before_anything_is_searched(settings, message, tmp_path):
    with pytest.raises(SettingError) as error:
        study.run(Study(config(**settings), tmp_path, {}))
    assert message in str(error.value)
    assert not list(tmp_path.iterdir())


def test_shapes_do_not_take_heights(tmp_path):
    with pytest.raises(SettingError, match=r"foot\.k"):
        shapes_study.run(Study(config(foot__k=[1] * 11), tmp_path, {}))


def test_evidence_reads_values_as_it_is_told(evidence):
    single = Evidence(evidence.shapes, evidence.optima, evidence.crossed, evidence.filled, Readings("single"))
    assert single.of_shapes("peak_power") != evidence.of_shapes("peak_power")
    assert single.of_shapes("distance") == evidence.of_shapes("distance")
