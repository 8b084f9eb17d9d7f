"""One format for each quantity."""

import math

import pytest

import footopt as fo
from footopt.report.numbers import change, number
from footopt.report.terminal import describe_scene


@pytest.mark.parametrize(
    ("value", "text"),
    [(2.1344, "2.134"), (12345.6, "12346"), (-0.00025268, "-2.527e-4"), (0.0009999999, "0.001"), (3e-15, "0"),
     (math.nan, "-")],
)  # fmt: skip
def test_numbers_have_four_digits_and_short_exponents(value, text):
    assert number(value) == text


def test_a_change_of_j_w_is_a_multiple_and_others_are_percentages():
    assert change("efficiency", -2.527e-4, -1.413e-4) == "x 1.79"
    assert change("efficiency", -0.969e-4, -1e-4) == "x 0.97"
    assert change("work", 90.0, 100.0) == "-10.0 %"
    assert change("work", 1.0, 0.0) == "-"


def test_parameters_of_effects_have_units():
    scene = fo.Scene(effects=(fo.Slope(10), fo.Patches((0.9,), (1.5,), (0.2,))))
    words = "patches (begins 0.9 m, ends 1.5 m, factors 0.2, blur 0.05 m), slope (angle 10 deg)"
    assert describe_scene(scene) == f"hard sand (zeta 5), {words}"
