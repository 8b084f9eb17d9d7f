"""The paper's claims are measured on walks: each turns when what it compares is exchanged."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from paper_cases import HOLLOW, ROCKER, config

import footopt as fo
from footopt.design import Solver, search
from footopt.foot import SHAPES
from footopt.studies import Paper
from footopt.studies.paper import claims, walks
from footopt.studies.paper.claims import CLAIMS, LIMITS, MEASURES, measure
from footopt.studies.paper.walks import SANDS, objective, read, switch_losses
from footopt.walk.objectives import SLOW

STORED = json.loads((Path(__file__).parents[2] / "outputs/reference/paper/claims.json").read_text())


def scene(sand):
    return fo.Scene(sand=fo.Sand.named(sand))


def walked(settings, feet):
    """The study's evidence with feet that are given, not searched."""

    def search(problem, solver):
        return SimpleNamespace(foot=SimpleNamespace(k=feet[problem.scene.sand.name]))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(walks, "search", search)
        return walks.evidence(settings, {})


@pytest.fixture(scope="module")
def evidence():
    return walked(config(study__confirm="draft"), {"hard": HOLLOW, "regular": ROCKER, "soft": ROCKER})


@pytest.fixture(scope="module")
def walk():
    return fo.simulate(fo.Foot.from_waypoints(HOLLOW), scene("hard"), "fine")


class TestReadings:
    def test_the_library_s_own_change_nothing_and_narrower_ones_find_less(self, walk):
        assert read(walk, Paper()).objectives == walk.objectives
        losses = [read(walk, Paper(speed_loss=name)).objectives["speed_loss"] for name in walks.SPEED_LOSS]
        assert losses == sorted(losses, reverse=True)
        assert losses[-1] > 0.0
        single = read(walk, Paper(peak_power="single")).objectives["peak_power"]
        assert 0.0 < single <= walk.objectives["peak_power"]

    @pytest.mark.parametrize("name", walks.SPEED_LOSS)
    def test_a_fall_at_a_switch_is_found_there_and_nowhere_else(self, walk, name):
        velocity = np.ones_like(walk.velocity)
        velocity[walk.t > 1.7] = 0.7
        losses = switch_losses(replace(walk, velocity=velocity), name)
        np.testing.assert_allclose(losses, [0.0, 0.3, 0.0], atol=1e-12)

    @pytest.mark.parametrize("chosen", [Paper(), Paper(peak_power="single", speed_loss="narrow")])
    def test_a_search_ranks_by_what_is_read(self, chosen):
        with objective(chosen) as name:
            problem = fo.FootProblem(scene("hard"), name, accuracy="draft")
            result = search(problem, Solver("ga", pop_size=8, n_gen=1, seed=1))
        assert name not in SLOW  # nothing is left behind
        for k, j in zip(result.k, result.column(name), strict=True):
            walk = fo.simulate(fo.Foot.from_waypoints(k), scene("hard"), "draft")
            assert j == pytest.approx(read(walk, chosen).objectives["efficiency"], rel=1e-12)


def cast(found, name, subject, others):
    """The numbers with one walk for what a claim is about, and another for what it is compared with."""
    figure, whose = CLAIMS[name]["place"][:6], name.split("_")[0]
    if figure == "Fig. 7":
        return found | {"crossed": subject, "filled": subject, "hard": others}
    mine = {
        "triangle": ["reversed_triangle"],
        "flat": ["rectangle"],
        "ellipse": ["ellipse", "rectangle"],
    }.get(whose, [whose])
    group = SHAPES if figure == "Fig. 4" else SANDS
    return found | {n: subject if n in mine else others for n in group}


#: Claims with a limit, which compare nothing.
ALONE = {"circle_loses", "same_vertical_velocity", "push_off_carries"}
ALONE |= {"hard_hollow", "regular_convex", "soft_convex"}


class TestClaims:
    def test_every_claim_has_a_margin(self, evidence):
        assert np.isfinite(list(measure(evidence, "walk").values())).all()
        assert f"less {LIMITS['marked_loss']:g} m/s" in CLAIMS["circle_loses"]["decided"]

    @pytest.mark.parametrize("name", [name for name in CLAIMS if name not in ALONE])
    def test_a_claim_turns_when_what_it_compares_is_exchanged(self, evidence, name):
        found = {n: claims.numbers(w, "walk") for n, w in evidence.items()}
        one, other = found["hard"], found["soft"]
        there, back, same = (
            MEASURES[name](cast(found, name, *pair)) for pair in ((one, other), (other, one), (one, one))
        )
        assert min(there, back) < 0.0, "a claim and its opposite both hold"
        assert max(there, back) > 0.0, "neither a claim nor its opposite holds"
        assert same == 0.0, "a claim holds of walks that are the same"

    @pytest.mark.slow
    def test_the_stored_margins_are_what_is_measured(self):
        margins = measure(walked(config(), {sand: STORED["walks"][sand]["k"] for sand in SANDS}), "walk")
        stored = {claim["id"]: claim["margin"] for claim in STORED["claims"]}
        assert margins == pytest.approx(stored, rel=1e-6)
