"""Objects as drawings on one Axes, a line of a terminal, tables of pandas."""

from dataclasses import replace

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.io import netcdf_file

import footopt as fo
from footopt.files import io as files
from footopt.report import plot, stage, terminal
from footopt.report.page import write_study

NASTY = '<script>alert("&")</script>'


@pytest.fixture(scope="module")
def walked():
    return fo.simulate(fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4]), accuracy="draft")


@pytest.fixture(scope="module")
def many():
    feet = [replace(fo.Foot.flat(), width=width) for width in np.linspace(0.01, 0.1, 20)]  # narrow ones sink
    table = fo.evaluate(feet, fo.Scene(sand=fo.Sand(zeta=0.1)), "draft")
    assert 0 < table.feasible.sum() < 20
    return table


@pytest.fixture(scope="module")
def searches():
    budget = {"pop_size": 20, "n_gen": 3, "seed": 1}
    one = fo.search(fo.FootProblem(accuracy="draft"), "ga", **budget)
    several = fo.search(fo.FootProblem(objective="pareto", accuracy="draft"), "nsga2", **budget)
    return {"one": one, "several": several}


@pytest.fixture(scope="module")
def things(walked, many, searches):
    """One of everything that shows itself, and the hard cases."""
    return {
        "sand": fo.Sand.named("soft"),
        "gait": fo.Gait.human(),
        "foot": walked.foot,
        "every effect": fo.Scene(
            effects=(fo.Slope(-8), fo.Layers((0.02, 0.1), (0.3, 4)), fo.Patches(), fo.LeadingEdge())
        ),
        "walk": walked,
        "sunk": fo.simulate(walked.foot, fo.Scene(sand=fo.Sand(zeta=0.02)), "draft"),
        "void": fo.simulate(walked.foot, fo.Scene(sand=fo.Sand(zeta=1e-3)), "draft"),
        "table": many,
        **searches,
    }


NAMES = ["sand", "gait", "foot", "every effect", "walk", "sunk", "void", "table", "one", "several"]


@pytest.mark.parametrize("name", NAMES)
def test_every_drawing_is_on_the_axes_that_it_was_given(things, name):
    for what in plot.drawings(things[name]):
        figure = Figure()
        axes = figure.subplots()
        before = dict(matplotlib.rcParams)
        assert fo.plot(things[name], what, ax=axes) is axes
        assert dict(matplotlib.rcParams) == before
        assert axes.lines or axes.collections or axes.patches or axes.texts
        figure.draw_without_rendering()
    assert plt.get_fignums() == []  # pyplot has seen nothing of it


def test_names_are_escaped(tmp_path):
    table = terminal.table((NASTY,), rows=[(NASTY,)])
    written = write_study(tmp_path, NASTY, [NASTY], {}, [table], {"settings": {NASTY: NASTY}})
    assert NASTY.partition("(")[0] not in written.read_text(encoding="utf-8")


# --- what is drawn --------------------------------------------------------------------------------


def test_the_stress_map_is_the_sand_s():
    axes = fo.plot(fo.Sand.named("hard"), "alpha_z")
    shades = axes.collections[0]
    assert shades.get_clim()[1] == pytest.approx(-shades.get_clim()[0])
    inside = [level for path, level in zip(shades.get_paths(), shades.levels, strict=False)
              if path.contains_point((89.0, 0.0))]  # fmt: skip
    assert max(inside) == pytest.approx(5.0 * 1.0, abs=0.5)  # a level plate that moves down


def test_soles_are_where_the_plates_of_the_walk_are(walked):
    index = np.array([10, 200, len(walked.t) - 1])
    soles, plates = stage.Stage(walked, walked.t[index]).sole, walked.plates(index).position
    away = np.linalg.norm(plates[:, :, :, None] - soles[:, :, None], axis=-1).min(axis=-1)
    assert away.max() < 1e-3  # the sole's points are .8 mm apart


def test_the_arrow_of_a_foot_is_its_force(walked):
    index = np.arange(20, len(walked.t), 40)
    at, force = (part[:, :, 0] for part in stage.resultant(*stage.forces_along(walked, index)))
    np.testing.assert_allclose(force, walked.force[index], rtol=5e-3, atol=0.1)
    loaded = np.linalg.norm(force, axis=-1) > 50
    ankle = stage.Stage(walked, walked.t[index]).legs[:, :, 2]
    assert np.linalg.norm(at - ankle, axis=-1)[loaded].max() < 0.15  # within the foot
    airborne = np.linalg.norm(force, axis=-1) == 0
    assert airborne.any()
    assert np.isnan(at[airborne]).all()


# --- tables ---------------------------------------------------------------------------------------


def test_the_walk_file_holds_what_was_traced(walked, tmp_path):
    files.write_walk(tmp_path / "walk.nc", walked.variables, {"reason": walked.reason})
    with netcdf_file(tmp_path / "walk.nc", mmap=False) as file:
        assert set(file.variables) == set(walked.variables)
        for name, (dimensions, unit, values) in walked.variables.items():
            np.testing.assert_array_equal(file.variables[name][:], values)
            assert file.variables[name].units.decode() == unit
            assert file.variables[name].dimensions == dimensions


def test_the_frame_of_a_walk_is_its_traces():
    walk = fo.simulate(fo.Foot.flat(), fo.Scene(), "draft")
    frame, traces = walk.to_frame(), [walk.com, walk.velocity, walk.force, walk.power, walk.work]
    np.testing.assert_array_equal(frame, np.hstack([trace.reshape(len(walk.t), -1) for trace in traces]))
    assert list(frame.columns[4:7]) == ["force_left_x", "force_left_z", "force_right_x"]
    np.testing.assert_array_equal(frame.index, walk.t)
