"""Hard cases stay stable: what the default stepper is held to, and where the paper's own fails."""

import json
import math
from dataclasses import replace

import pytest
from running import footopt
from study_pages import check_page

import footopt as fo
from footopt.studies.stability import Measure, compare, judge, judge_case
from footopt.studies.stability_cases import CASES
from footopt.walk.accuracy import PRESETS
from footopt.walk.resolution import resolution

BY_NAME = {case.name: case for case in CASES}
BY_NAME["ten times the gravity"] = replace(BY_NAME["gravity 1e4"], changes={"walker.g": 98.1})
PAN, NOISE = "a hard pan under soft sand", "a noisy contour of 5000 points"
BEYOND = "1 mg"  # more than steps of `standard` resolve
#: Fine numbers that no truth comes to: steps of one length, chords that begin and end at the noise's points.
FINE = {
    PAN: fo.Accuracy(dt=5e-5, plates=2000, creep=1e-6),
    NOISE: fo.Accuracy(dt=5e-3, plates=9998, creep=1e-5, control=1e-5, rule="chord"),
    "a comb of 200 waypoints": fo.Accuracy(dt=1e-3, plates=19900, creep=1e-5),
}
STANDS = Measure("truth", 0.0, 0.05)
SLOW = ("a minute of", "a comb of", "gravity", "a noisy")
LONG = [name for name, case in BY_NAME.items() if "effects" in case.changes or name.startswith(SLOW)]


@pytest.fixture(scope="module")
def base(flat_foot):
    return flat_foot, fo.Scene(), PRESETS["standard"]


def the_truth_stands(name, verdict):
    """It hardly changes when it is refined further, and other fine numbers come to it."""
    assert {m.name: m for m in verdict.measures}["truth"].ratio <= 0.1
    if name in FINE:
        fine = fo.simulate(verdict.walk.foot, verdict.walk.scene, FINE[name])
        assert max(m.value for m in compare(fine, verdict.truth, 0.05)) < 0.01


class TestStudy:
    @pytest.mark.parametrize(
        "name",
        [pytest.param(n, marks=pytest.mark.slow) if n in LONG else n for n in BY_NAME if n != BEYOND],
    )
    def test_the_default_stepper_is_stable_in_every_case(self, name, base):
        (verdict,) = judge_case(BY_NAME[name], base, ["sdirk2_control"])
        assert verdict.stable, verdict.measures
        the_truth_stands(name, verdict)

    def test_standing_is_judged_by_what_the_law_itself_yields(self, base):
        """The smoothing lets the walker sink by half a millimetre, which no stepper helps."""
        coarse = (*base[:2], replace(base[2], creep=1e-4))
        (verdict,) = judge_case(BY_NAME["standing on zeta 5"], coarse, ["sdirk2_control"])
        measures = {m.name: m for m in verdict.measures}
        assert measures["drift"].value > 1e-4
        assert measures["drift"].ratio < 0.5
        walk = replace(verdict.walk, com=verdict.walk.com * [[1.0, 1.01]])
        moved = {m.name: m for m in judge(walk, verdict.truth, STANDS, 0.05)}
        assert moved["place"].ratio > 1.0

    @pytest.mark.slow
    def test_what_no_preset_resolves_is_said_and_a_run_warns_of_it(self, base):
        (verdict,) = judge_case(BY_NAME[BEYOND], base, ["sdirk2_control"])
        errors = fo.estimate_error(verdict.walk.foot, verdict.walk.scene, verdict.walk.accuracy)
        warnings = resolution(verdict.walk, errors)
        assert not verdict.stable
        assert len(warnings) == 1
        assert warnings[0].outside
        assert verdict.walk.reason == verdict.truth.reason == ""

    def test_step_control_is_what_keeps_the_peak_of_a_step_ten_times_too_large(self, base):
        free, held = judge_case(BY_NAME["a step ten times larger"], base, ["sdirk2", "sdirk2_control"])
        assert not free.stable
        assert free.decides.name == "peak"
        assert held.walk.counts["shortened"] > 0
        assert held.decides.value < 0.1 * free.decides.value

    def test_what_is_wrong_or_judged_by_a_truth_that_does_not_stand_is_not_called_stable(self, base):
        assert Measure("energy", math.nan, 0.05).ratio == math.inf
        (sunk,) = judge_case(BY_NAME["sinking to the hip"], base, ["sdirk2"])
        assert sunk.walk.reason == "sunk"
        (walked,) = judge_case(BY_NAME["2 kg"], base, ["sdirk2"])
        assert max(m.ratio for m in judge(walked.walk, sunk.truth, STANDS, 0.05)) == math.inf
        doubtful = Measure("truth", 0.1, 0.05)
        assert max(m.ratio for m in judge(walked.walk, walked.truth, doubtful, 0.05)) == 2.0

    @pytest.mark.slow
    def test_from_the_command_line_in_a_reduced_form(self, tmp_path):
        cases = ["standing on zeta 5", "spiky soles", "sinking to the hip"]
        words = [f"study.cases=[{','.join(cases)}]", "study.methods=[sdirk2,explicit_euler]"]
        done = footopt("study=stability", *words, "hydra.run.dir=out", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        result = json.loads((tmp_path / "out" / "result.json").read_text())
        found = [(v["case"], v["method"]) for v in result["verdicts"]]
        assert found == [(c, m) for c in cases for m in ("sdirk2", "explicit_euler")]
        assert [v["stable"] for v in result["verdicts"][:2]] == [True, False]  # the paper's cannot stand
        assert result["stable"] == {"sdirk2": 3, "explicit_euler": 2}
        check_page(tmp_path / "out")
