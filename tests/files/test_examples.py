"""The examples' files are what their page says; `test_docs` runs its commands."""

from pathlib import Path

import numpy as np
import pytest

import footopt as fo
from footopt.studies.calibrate import calibrate

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_the_three_rockers_are_one_foot():
    path = EXAMPLES / "sole" / "rocker"
    feet = [fo.read_foot(path.with_suffix(f".{end}"), layer=layer)
            for end, layer in (("dxf", "FOOT"), ("svg", "FOOT"), ("csv", None))]  # fmt: skip
    x = np.linspace(-0.119, 0.129, 200)
    heights = [np.interp(x, *foot.contour.T) for foot in feet]
    np.testing.assert_allclose(heights[1:], [heights[0]] * 2, rtol=0, atol=3e-5)
    assert feet[0].contour[:, 1].min() == pytest.approx(-0.028, abs=1e-6)


def test_the_gait_is_the_built_in_one():
    gait, human = fo.read_gait(EXAMPLES / "gait" / "walk.mot"), fo.Gait.human()
    assert gait.period == pytest.approx(human.period, rel=0.01)
    for joint in ("thigh", "knee", "foot"):
        for mine, true in zip((gait, human), (human, gait), strict=True):
            angles = [np.degrees(getattr(g, joint).at(np.arange(200) / 200)[0]) for g in (mine, true)]
            assert np.ptp(angles[0]) == pytest.approx(np.ptp(angles[1]), abs=2.5)


def test_the_plates_are_of_the_zeta_that_their_page_names_and_the_sand_is_six_tenths_of_the_generic_one():
    found = calibrate(EXAMPLES / "sand" / "plates.csv")
    assert found.zeta.low <= 0.8 <= found.zeta.high
    assert found.warnings == []
    read, generic = fo.read_sand(EXAMPLES / "sand" / "stresses.csv").stress_map, fo.StressMap()
    assert [read.A00, read.B01] == pytest.approx([0.6 * generic.A00, 0.6 * generic.B01], abs=0.005)
