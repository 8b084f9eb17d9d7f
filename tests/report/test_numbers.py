"""One format for each quantity, and no progress in a file."""

import io
import math

import pytest
from rich.console import Console

from footopt.report.numbers import change, number
from footopt.report.progress import progress


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


def test_a_log_file_has_no_progress():
    file = io.StringIO()
    with progress(Console(file=file, width=130), 200, "walk") as step:
        for i in range(200):
            step(news=f"number {i + 1}")
    assert file.getvalue() == ""
