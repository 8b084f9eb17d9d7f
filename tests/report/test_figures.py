"""Figures say what they show, with units, and a walk that failed does not break them."""

import re
import threading
from contextlib import nullcontext
from types import SimpleNamespace

import matplotlib
import numpy as np
import pytest
from fontTools import subset
from matplotlib.colors import same_color

import footopt as fo
from footopt.errors import FileError, SettingError
from footopt.gait.gait import RIGHT
from footopt.report import figures, style
from footopt.report.body import forces_along
from footopt.report.figures import accuracy, fronts, paper
from footopt.report.figures.fronts import Fronts
from footopt.walk.objectives import FIVE, OBJECTIVES
from footopt.walk.phases import stance

HOLLOW = (5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4)
DESIGNED = (2, 6, 6, 2, 1, 1, 1, 1, 3, 4, 1)  # by the default run


@pytest.fixture(scope="module")
def foot():
    return fo.Foot.from_waypoints(HOLLOW)


@pytest.fixture(scope="module")
def hard(foot):
    return fo.simulate(foot, fo.Scene(sand=fo.Sand.named("hard")), "draft")


@pytest.fixture(scope="module")
def soft(foot):
    return fo.simulate(foot, fo.Scene(sand=fo.Sand.named("soft")), "draft")


@pytest.fixture(scope="module")
def sunk(foot):
    """A walk that fails on its way."""
    walk = fo.simulate(foot, fo.Scene(sand=fo.Sand(zeta=0.02)), "draft")
    assert walk.reason == "sunk"
    assert len(walk.t) > 0
    assert walk.t[-1] < walk.scene.duration
    return walk


@pytest.fixture(scope="module")
def void(foot):
    """A walk that fails before its first step."""
    walk = fo.simulate(foot, fo.Scene(sand=fo.Sand(zeta=1e-3)), "draft")
    assert walk.reason == "sunk"
    assert len(walk.t) == 0
    return walk


@pytest.fixture(scope="module")
def table():
    values = np.random.default_rng(0).random((30, 5)) + np.arange(5)
    values[4] = np.nan
    return values


def texts(figure):
    return [t.get_text() for t in figure.findobj(matplotlib.text.Text) if t.get_text()]


def lines(axes):
    return {line.get_label(): line for line in axes.get_lines()}


def labels(figure):
    """What a reader sees of a saved figure, but for ticks: (text, box in pixels)."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # as `save`: a second pass of the layout would move what was cut off
    axes = [axis for a in figure.axes for axis in (a.xaxis, a.yaxis)]
    ticks = {id(label) for axis in axes for label in axis.get_ticklabels(which="both")}
    shown = [t for t in figure.findobj(matplotlib.text.Text) if t.get_text() and t.get_visible()]
    return [(t.get_text(), t.get_window_extent()) for t in shown if id(t) not in ticks]


def overlapping(figure):
    found = labels(figure)
    return [
        (a, b) for i, (a, x) in enumerate(found) for b, y in found[i + 1 :] if x.shrunk(0.9, 0.9).overlaps(y)
    ]


def outside(figure):
    page = figure.bbox.padded(1.0)
    return [text for text, box in labels(figure) if not (page.contains(*box.min) and page.contains(*box.max))]


# --- all of them ----------------------------------------------------------------------------------

HISTORY = [
    SimpleNamespace(evaluations=10 * (i + 1), best=b, median=b + 1.0, hypervolume=np.nan)
    for i, b in enumerate([np.nan, -2.0, -2.5, -4.0])
]


#: How to draw each figure from walks by name and a table of objectives.
FIGURES = {
    "contour": lambda walks, table: figures.contour(walks["hard"].foot),
    "designed": lambda walks, table: figures.contour(fo.Foot.from_waypoints(DESIGNED)),
    "contours": lambda walks, table: figures.contours(
        {n: fo.Foot.shape(n) for n in ("ellipse", "reversed_l")}
    ),
    "drawing": lambda walks, table: figures.drawing(walks["hard"].foot, (0.06, 0.02)),
    "convergence": lambda walks, table: figures.convergence(HISTORY, "efficiency $J_W$"),
    "com": lambda walks, table: figures.com(walks),
    "forces": lambda walks, table: figures.forces(walks),
    "power_work": lambda walks, table: figures.power_work(walks),
    "step": lambda walks, table: figures.step(walks["hard"]),
    "scatter": lambda walks, table: figures.scatter_matrix({"front": table}, FIVE, {"chosen": table[7]}),
    "parallel": lambda walks, table: figures.parallel(table, FIVE, {"chosen": table[7]}),
}


@pytest.fixture(scope="module", params=FIGURES)
def figure(request, hard, soft, sunk, table):
    return FIGURES[request.param]({"hard": hard, "soft": soft, "failed": sunk}, table)


def test_a_figure_is_saved_as_picture_and_as_the_same_bytes_again(hard, tmp_path):
    figure = figures.com({"hard": hard})
    png, pdf = figures.save(figure, tmp_path / "new" / "folder", "one")
    assert png.read_bytes().startswith(b"\x89PNG")
    assert pdf.read_bytes().startswith(b"%PDF")
    assert b"CreationDate" not in pdf.read_bytes()
    again = figures.save(figures.com({"hard": hard}), tmp_path, "two")
    assert again[0].read_bytes() == png.read_bytes()
    assert again[1].read_bytes() == pdf.read_bytes()


def test_every_figure_fits_a_journal_is_legible_and_no_label_covers_another(figure, caplog):
    assert figure.get_figwidth() in (3.4, 7.0)
    assert figure.get_figheight() < 9.0
    sizes = {t.get_fontsize() for t in figure.findobj(matplotlib.text.Text) if t.get_text()}
    assert min(sizes) >= 7.0
    assert overlapping(figure) == []
    assert outside(figure) == []
    assert caplog.text == ""  # matplotlib's words are no user's


@pytest.mark.slow
def test_figures_can_be_drawn_from_threads(foot, hard, tmp_path):
    before, failed = dict(matplotlib.rcParams), []

    def draw(i):
        try:
            figures.save(figures.contour(foot), tmp_path, f"contour{i}")
            figures.save(figures.com({"hard": hard}), tmp_path, f"com{i}")
        except Exception as error:
            failed.append(error)

    threads = [threading.Thread(target=draw, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failed == []
    assert dict(matplotlib.rcParams) == before
    assert len({(tmp_path / f"com{i}.png").read_bytes() for i in range(4)}) == 1


def test_a_folder_that_cannot_be_made_is_named(foot, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FileError, match=r"cannot write .*sole\.png"):
        figures.save(figures.contour(foot), tmp_path / "file", "sole")


# --- feet -----------------------------------------------------------------------------------------


def test_a_contour_shows_sole_waypoints_box_and_hollow_in_mm(foot):
    axes = figures.contour(foot).axes[0]
    assert "(mm)" in axes.get_xlabel()
    assert "(mm)" in axes.get_ylabel()
    assert axes.get_aspect() == 1.0
    drawn = lines(axes)
    np.testing.assert_allclose(drawn["_sole"].get_xydata(), 1e3 * foot.contour)
    np.testing.assert_allclose(drawn["_waypoint"].get_ydata(), -3.0 * np.array(HOLLOW))
    box = axes.patches[0]
    assert (box.get_x(), box.get_y(), box.get_width(), box.get_height()) == pytest.approx(
        (-130, -30, 260, 30)
    )
    assert f"hollow {1e3 * foot.hollow:.1f} mm" in texts(axes)
    assert drawn["_lower hull"].get_linestyle() == ":"


def test_a_foot_without_a_hollow_or_without_waypoints_says_or_shows_none():
    flat, shape = figures.contour(fo.Foot.flat()).axes[0], figures.contour(fo.Foot.shape("ellipse")).axes[0]
    assert "circles: waypoints; no hollow" in texts(flat)
    assert "_lower hull" not in lines(flat)
    assert not shape.patches
    assert "_waypoint" not in lines(shape)


# --- a search -------------------------------------------------------------------------------------


def test_convergence_plots_best_and_median_against_evaluations():
    axes = figures.convergence(HISTORY, "work (J)").axes[0]
    best, _, median = axes.get_lines()
    assert axes.get_ylabel() == "work (J)"
    np.testing.assert_array_equal(best.get_ydata(), [np.nan, -2.0, -2.5, -4.0])
    np.testing.assert_array_equal(median.get_xdata(), [10, 20, 30, 40])
    assert best.get_linestyle() != median.get_linestyle()
    assert "best −4" in texts(axes)


def test_convergence_of_j_w_is_a_multiple_of_the_flat_foots_with_the_value_behind():
    axes = figures.convergence(HISTORY, "efficiency $J_W$", -2.0).axes[0]
    np.testing.assert_array_equal(axes.get_lines()[0].get_ydata(), [np.nan, 1.0, 1.25, 2.0])
    assert "best × 2.00 of flat, −4" in texts(axes)


def test_of_several_objectives_the_hypervolume_is_drawn():
    rows = [SimpleNamespace(evaluations=i, best=np.nan, median=np.nan, hypervolume=i / 4) for i in range(4)]
    best = figures.convergence(rows, "hypervolume").axes[0].get_lines()[0]
    np.testing.assert_array_equal(best.get_ydata(), [0.0, 0.25, 0.5, 0.75])


@pytest.mark.parametrize("history", [[], HISTORY[:1]])
def test_a_search_without_a_feasible_design_says_so(history):
    assert "no feasible design was found" in texts(figures.convergence(history, "$J_W$"))


# --- walks ----------------------------------------------------------------------------------------

UNITS = {
    "com": ["(m)", "(m)", "(m/s)", "(m/s)"],
    "forces": [f"{side} foot $f_{axis}$ (N)" for side in ("left", "right") for axis in "xz"],
    "power_work": ["left foot power $P_l$ (W)", "$W_l$ (J)", "right foot power $P_r$ (W)", "$W_r$ (J)"],
}
TRACES = {
    "com": lambda w: [w.com[:, 0], w.com[:, 1], w.velocity[:, 0], w.velocity[:, 1]],
    "forces": lambda w: [w.force[:, 0, 0], w.force[:, 0, 1], w.force[:, 1, 0], w.force[:, 1, 1]],
    "power_work": lambda w: [w.power[:, 0], w.work[:, 0], w.power[:, 1], w.work[:, 1]],
}


@pytest.mark.parametrize("name", UNITS)
def test_traces_are_the_walk_s_with_units_and_heel_strikes(name, hard, soft):
    figure = getattr(figures, name)({"hard sand": hard, "soft sand": soft})
    assert [
        axes.get_ylabel()[-len(unit) :] for axes, unit in zip(figure.axes, UNITS[name], strict=True)
    ] == UNITS[name]
    assert all(axes.get_xlabel() == "time $t$ (s)" for axes in figure.axes[2:])
    for axes, first, second in zip(figure.axes, TRACES[name](hard), TRACES[name](soft), strict=True):
        drawn = lines(axes)
        np.testing.assert_allclose(drawn["hard sand"].get_ydata(), first, rtol=0, atol=1e-12)
        np.testing.assert_allclose(drawn["soft sand"].get_ydata(), second, rtol=0, atol=1e-12)
        np.testing.assert_array_equal(drawn["hard sand"].get_xdata(), hard.t)
        assert drawn["hard sand"].get_linestyle() != drawn["soft sand"].get_linestyle()
        assert drawn["hard sand"].get_color() != drawn["soft sand"].get_color()
        strikes = [x[0] for x in (line.get_xdata() for line in axes.get_lines()) if len(x) == 2]
        assert strikes[:3] == pytest.approx([1.1, 1.7, 2.3])
    assert {"hard sand", "soft sand", "heel strike"} <= set(texts(figure))


def test_a_walk_that_fails_on_its_way_ends_in_a_cross(hard, sunk):
    figure = figures.power_work({"hard": hard, "dust": sunk})
    assert "dust (failed: sunk)" in texts(figure)
    for axes in figure.axes:
        crosses = [line for line in axes.get_lines() if line.get_marker() == "x"]
        assert [line.get_xdata()[0] for line in crosses] == [sunk.t[-1]]
        assert axes.get_xlim() == (0.0, hard.scene.duration)


def test_a_walk_that_fails_at_once_is_named(void):
    figure = figures.forces({"void": void})
    assert texts(figure).count("no samples: sunk") == 4
    assert "void (failed: sunk)" in texts(figure)


def test_standing_still_has_no_heel_strike_and_rounding_is_no_motion(foot):
    scene = fo.Scene(gait=fo.Gait.human(start=float("inf")), t_f=0.2)
    walk = fo.simulate(fo.Foot.flat(), scene, "draft")
    assert 0.0 < np.abs(walk.velocity[:, 0]).max() < 1e-20
    figure = figures.com({"standing": walk})
    assert "heel strike" not in texts(figure)
    assert all(len(axes.get_lines()) == 1 for axes in figure.axes)
    forward = figure.axes[2]
    assert (forward.get_lines()[0].get_ydata() == 0.0).all()
    assert np.ptp(forward.get_ylim()) > 0.01


def test_the_best_and_the_flat_foot_keep_their_colours(hard, soft):
    for walks in ({"best": hard, "flat": soft}, {"flat": soft, "best": hard}):
        drawn = lines(figures.com(walks).axes[0])
        assert same_color(drawn["best"].get_color(), style.BEST)
        assert same_color(drawn["flat"].get_color(), style.FLAT)


# --- one step -------------------------------------------------------------------------------------


@pytest.mark.parametrize("frames", [1, 4])
def test_a_step_s_frames_are_in_order_and_share_one_scale(hard, frames):
    figure = figures.step(hard, frames)
    panels = [axes for axes in figure.axes if axes.axison]
    assert len(panels) == frames
    assert len({(axes.get_xlim(), axes.get_ylim(), axes.get_aspect()) for axes in panels}) == 1
    times = [float(axes.get_title(loc="left").removesuffix(" s")) for axes in panels]
    assert times == sorted(times)
    assert {"$x$ (m)", "$z$ (m)"} <= set(texts(figure))


def arrows(axes):
    """Where the arrows of a panel begin and end, (n, 2) each; of the first panel without its key."""
    drawn = [line.get_xydata() for line in axes.get_lines() if line.get_label() == "_force"][-1]
    return drawn[0::7], drawn[1::7]


def test_arrows_carry_the_force_on_the_foot(hard):
    figure = figures.step(hard)
    first, last, _, _ = stance(hard)
    times = hard.t[first] + (np.arange(6) + 0.5) / 6 * (hard.t[last] - hard.t[first])
    index = np.searchsorted(hard.t, times)
    (label,) = (text for text in figure.axes[0].texts if text.get_text().endswith(" N"))
    key = next(line.get_xydata() for line in figure.axes[0].get_lines() if line.get_label() == "_key")
    newtons, long = float(label.get_text().removesuffix(" N")), key[1, 0] - key[0, 0]
    stated = (re.search(r"sole, from (\S+) N on", text) for text in texts(figure))
    (least,) = (float(found[1]) for found in stated if found)
    assert least < 0.04 * 589.0
    longest = 0.0
    for axes, sample in zip(figure.axes, index, strict=True):  # arrows too short to see are left out
        parts = forces_along(hard, np.array([sample])).force[0, RIGHT]
        sure = np.linalg.norm(parts, axis=1)
        tails, tips = arrows(axes)
        force = (tips - tails) * newtons / long
        assert (sure > 1.05 * least).sum() <= len(force) <= (sure > 0.95 * least).sum()
        shown = parts[np.argsort(sure)[-len(force) :]]
        np.testing.assert_allclose(force.sum(axis=0), shown.sum(axis=0), atol=0.1)
        assert (tips[:, 1] < 0.005).all()  # on the sole
        longest = max(longest, np.linalg.norm(force, axis=1).max())
    assert 0.3 * longest < newtons <= longest
    on_paper = 72 * longest * long / newtons / 0.26  # of a foot, whose panel is about two inches wide
    assert on_paper > 0.25 * 72


@pytest.mark.slow
def test_a_step_shows_the_ground_of_its_scene(foot):
    scene = fo.Scene(effects=(fo.Slope(-5),))
    assert {"g = 9.81 m/s²", "5° downhill"} <= set(texts(figures.step(fo.simulate(foot, scene, "draft"), 1)))
    scene = fo.Scene(effects=(fo.Patches((0.9,), (1.5,), (0.2,)),))  # under the second step
    said = texts(figures.step(fo.simulate(foot, scene, "draft"), 1))
    assert "patch × 0.2" in said
    assert any(text.startswith("left foot, time since touch-down") for text in said)


# --- many designs ---------------------------------------------------------------------------------


def test_a_scatter_matrix_shows_each_pair_once_and_what_stands_out(table):
    other = table[:5] + 1.0
    marks = {"chosen": table[7], "flat sole": table[8]}
    figure = figures.scatter_matrix({"front": table, "other": other}, FIVE, marks)
    grid = np.array(figure.axes).reshape(4, 4)
    good = np.delete(table, 4, axis=0)
    for row in range(4):
        for column in range(row + 1):
            points, more, star, square = grid[row, column].get_lines()
            np.testing.assert_array_equal(points.get_xydata(), good[:, [column, row + 1]])
            np.testing.assert_array_equal(more.get_xydata(), other[:4, [column, row + 1]])
            np.testing.assert_array_equal(star.get_xydata()[0], table[7, [column, row + 1]])
            np.testing.assert_array_equal(square.get_xydata()[0], table[8, [column, row + 1]])
            looks = {(line.get_marker(), line.get_markerfacecolor()) for line in (points, more, star, square)}
            assert len(looks) == 4
    assert not any(grid[row, column].axison for row in range(4) for column in range(row + 1, 4))
    assert {"front", "other", "chosen", "flat sole"} <= set(texts(figure))


def test_parallel_axes_are_turned_so_that_better_is_up(table):
    marks = {"chosen": table[7], "flat sole": table[0]}
    figure = figures.parallel(table, FIVE, marks, "designs on the front")
    axes = figure.axes[0]
    curves = np.array(axes.collections[0].get_segments())[:, :, 1]
    assert len(curves) == 29
    good = np.delete(table, 4, axis=0)
    for i, name in enumerate(FIVE):
        best = good[:, i].argmax() if OBJECTIVES[name].maximise else good[:, i].argmin()
        assert curves[best, i] == pytest.approx(1.0)
        assert curves[:, i].min() == pytest.approx(0.0)
        ends = {f"{good[:, i].min():.4g}", f"{good[:, i].max():.4g}"}
        assert ends <= {text.rstrip("0").rstrip(".") for text in texts(figure)}
    drawn = lines(axes)
    np.testing.assert_allclose(drawn["chosen"].get_ydata(), curves[6])  # row 7, after a failed one
    np.testing.assert_allclose(drawn["flat sole"].get_ydata(), curves[0])
    assert drawn["chosen"].get_linewidth() > 2 * axes.collections[0].get_linewidth()[0]
    assert {"better", "29 designs on the front (1 failed, not drawn)"} <= set(texts(figure))


@pytest.mark.parametrize("count", [1500, 40_000])
def test_thousands_of_parallel_lines_are_neither_a_solid_block_nor_nothing(count):
    many = np.random.default_rng(0).normal(size=(count, 2))
    figure = figures.parallel(many, FIVE[:2])
    figure.canvas.draw()
    axes = figure.axes[0]
    (x0, y0), (x1, y1) = axes.transData.transform([(0.3, 0.4), (0.7, 0.6)]).astype(int)
    pixels = np.asarray(figure.canvas.buffer_rgba())[::-1][y0:y1, x0:x1, :3].astype(float)
    ink = (255 - pixels[..., 0]) / (255 - 255 * matplotlib.colors.to_rgb(style.DESIGNS)[0])
    assert 0.1 < ink.mean() < 0.9
    assert ink.std() > 0.02
    assert f"{count} designs (1 of {-(-count // 1000)} is drawn)" in texts(figure)


def test_odd_tables_are_drawn(table):
    table = table[:, :2]
    nothing, same = np.full((3, 2), np.nan), np.ones((4, 2))
    for values, row in ((nothing, 1), (same, 0), (table[:1], 0), (table, 4)):
        for figure in (
            figures.scatter_matrix({"front": values}, FIVE[:2], {"chosen": values[row]}),
            figures.parallel(values, FIVE[:2], {"chosen": values[row]}),
        ):
            assert ("chosen" in texts(figure)) is bool(np.isfinite(values[row]).all())
            figure.draw_without_rendering()
    figures.parallel(table[:, :1], FIVE[:1]).draw_without_rendering()


def test_a_table_that_does_not_fit_its_names_is_refused(table):
    for draw in (lambda t, names: figures.scatter_matrix({"front": t}, names), figures.parallel):
        with pytest.raises(SettingError, match="4 columns"):
            draw(table, FIVE[:4])
        with pytest.raises(SettingError, match=r"objective\.names"):
            draw(table[:, :2], ["speed", "work"])
    with pytest.raises(SettingError, match="two objectives"):
        figures.scatter_matrix({"front": table[:, :1]}, FIVE[:1])
    with pytest.raises(SettingError, match=r"marks = .* must be of chosen, flat sole"):
        figures.scatter_matrix({"front": table}, FIVE, {"best": table[7]})


# --- studies --------------------------------------------------------------------------------------


def test_claims_say_where_they_hold():
    entry = {"says": "it holds", "margin": 0.1, "changed": {"foot.width=0.05": -0.2, "foot.apex=toe": None}}
    (axes,) = paper.claims([entry, {**entry, "says": "never", "margin": -1.0}]).axes
    assert {"it holds", "never", "the settings", "foot.apex=toe"} <= set(texts(axes.figure))
    holds, not_, undecided = axes.images[0].get_array()[0]
    assert np.allclose(axes.images[0].get_array()[1, 0], not_)
    assert not np.allclose(holds, not_)
    assert np.allclose(undecided, 1.0)


def test_a_stepper_keeps_its_colour_and_ticks_do_not_overprint():
    def measured(stepper, ms, control=None):
        accuracy = fo.Accuracy(stepper, control=control)
        return SimpleNamespace(accuracy=accuracy, errors=np.full((3, 5), 1e-3 * ms), error=1e-3 * ms, ms=ms)

    few = [measured("sdirk2", ms) for ms in (0.6, 1.2, 4.0)]
    many = [measured("heun", 1.5), *few, measured("sdirk2", 1.7, 1e-3)]
    colours = []
    for found in (few, many):
        figure = accuracy.work_precision(found, [])
        figure.draw_without_rendering()
        axes = figure.axes[3]
        boxes = [t.get_window_extent() for t in axes.get_xticklabels(which="both") if t.get_text()]
        assert boxes
        assert not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[i + 1 :])
        assert all(float(t.get_text()) for t in axes.get_xticklabels(which="both") if t.get_text())
        names = {line.get_label(): line.get_color() for line in axes.lines}
        colours.append(names["sdirk2"])
    assert colours[0] == colours[1]


def test_of_two_objectives_a_line_shows_what_half_of_the_seeds_attain():
    values = [np.array([[1.0, 3.0], [2.0, 4.0]]), np.array([[1.0, 2.0], [2.0, 3.0]])]
    found = Fronts(("distance", "work"), (True, False), [0, 1, 2], ["ga", "ga", "de"], [*values, values[0]],
                   [0.5, 0.7, 0.9])  # fmt: skip
    axes = fronts.fronts(found).axes[0]
    points, _, line = axes.get_lines()
    np.testing.assert_array_equal(points.get_xydata(), np.concatenate(values))
    np.testing.assert_array_equal(line.get_xydata(), found.median_attainment("ga"))
    assert (line.get_drawstyle(), line.get_color()) == ("steps-pre", points.get_color())
    assert {"ga: 2 seeds, hypervolume 60 %", "de: hypervolume 90 %"} <= set(texts(axes.figure))


def test_a_pdf_embeds_no_table_or_glyph_that_it_does_not_need(tmp_path, monkeypatch):
    """matplotlib places letters itself, and asks for each outline that it draws."""
    before = subset.Options()
    made = []
    for without in (style._bare_fonts, nullcontext):
        monkeypatch.setattr(style, "_bare_fonts", without)
        figure = style.new_figure(3.0, 2.0)
        figure.subplots().set(title="fine office $J_W$ (%)", xlabel="ankle")
        made.append(style.save(figure, tmp_path / without.__name__, "drawn")[1].read_bytes())
    assert len(made[0]) < len(made[1])
    assert subset.Options().drop_tables == before.drop_tables


def test_a_hollow_s_depth_stands_above_the_axis_where_the_sole_is_at_the_floor_of_its_box():
    figure = figures.foot.contour(fo.Foot.from_waypoints([10, 6, 2, 2, 2, 2, 2, 2, 2, 6, 10]))
    figure.canvas.draw()
    (axes,) = figure.axes
    (words,) = (text for text in axes.texts if "hollow" in text.get_text())
    assert words.get_window_extent().y0 > axes.get_window_extent().y0
