"""Figures say what they show, with units, and a walk that failed does not break them."""

from types import SimpleNamespace

import matplotlib
import numpy as np
import pytest

import footopt as fo
from footopt.errors import SettingError
from footopt.report import figures
from footopt.walk.objectives import FIVE, lookup

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


def crowded(figure):
    """Tick labels that leave the page, or touch the label of their axis."""
    page, found = figure.bbox.padded(1.0), []
    for axis in (axis for a in figure.axes for axis in (a.xaxis, a.yaxis)):
        (low, high), label = sorted(axis.get_view_interval()), axis.label.get_window_extent()
        ticks = [t.label1 for t in axis.get_major_ticks() if low <= t.get_loc() <= high]
        for text, box in [(t.get_text(), t.get_window_extent()) for t in ticks if t.get_text()]:
            on_page = page.contains(*box.min) and page.contains(*box.max)
            if not on_page or (axis.label.get_text() and box.shrunk(0.9, 0.9).overlaps(label)):
                found.append(text)
    return found


# --- all of them ----------------------------------------------------------------------------------

BESTS = [(10, np.nan), (20, -2.0), (30, -2.5), (40, -4.0)]
HISTORY = [SimpleNamespace(evaluations=n, best=b, median=b + 1.0, hypervolume=np.nan) for n, b in BESTS]
PROBLEM = SimpleNamespace(names=("efficiency",), accuracy=fo.Accuracy())
SEARCH = SimpleNamespace(history=HISTORY, problem=PROBLEM, solver=SimpleNamespace(name="memetic"))

#: How to draw each figure from walks by name and a table of objectives.
FIGURES = {
    "contour": lambda walks, table: figures.contour(walks["hard"].foot),
    "designed": lambda walks, table: figures.contour(fo.Foot.from_waypoints(DESIGNED)),
    "contours": lambda walks, table: figures.contours(
        {n: fo.Foot.shape(n) for n in ("ellipse", "reversed_l")}
    ),
    "soles": lambda walks, table: figures.contours({"its own": walks["hard"].foot, "flat": fo.Foot.flat()}),
    "convergence": lambda walks, table: figures.convergence(SEARCH),
    "com": lambda walks, table: figures.com(walks),
    "forces": lambda walks, table: figures.forces(walks),
    "power_work": lambda walks, table: figures.power_work(walks),
    "step": lambda walks, table: figures.step(walks["hard"]),
    "scatter": lambda walks, table: figures.scatter_matrix(
        {"front": table}, lookup(FIVE), {"chosen": table[7]}
    ),
}


@pytest.fixture(scope="module", params=FIGURES)
def figure(request, hard, soft, sunk, table):
    return FIGURES[request.param]({"hard": hard, "soft": soft, "failed": sunk}, table)


def test_a_sole_without_width_has_no_endless_figure_and_a_walk_without_a_step_none():
    blade = fo.Foot(contour=np.array([[0.0, 0.0], [0.0, -0.1]]))
    assert figures.contour(blade).get_figheight() <= 3.0 * 3.4
    with pytest.raises(SettingError, match=r"t_f = 0\.6"):
        figures.step(fo.simulate(blade, fo.Scene(t_f=0.6)))


@pytest.mark.slow
def test_a_figure_is_saved_as_picture_and_as_the_same_bytes_again(foot, tmp_path):
    figure = figures.contour(foot)
    png, pdf = figures.save(figure, tmp_path / "new" / "folder", "one")
    assert png.read_bytes().startswith(b"\x89PNG")
    assert pdf.read_bytes().startswith(b"%PDF")
    assert b"CreationDate" not in pdf.read_bytes()
    again = figures.save(figures.contour(foot), tmp_path, "two")
    assert again[0].read_bytes() == png.read_bytes()
    assert again[1].read_bytes() == pdf.read_bytes()


def test_every_figure_fits_a_journal_is_legible_and_no_label_covers_another(figure, caplog):
    assert figure.get_figwidth() in (3.4, 7.0)
    assert figure.get_figheight() < 9.0
    sizes = {t.get_fontsize() for t in figure.findobj(matplotlib.text.Text) if t.get_text()}
    assert min(sizes) >= 7.0
    assert overlapping(figure) == []
    assert outside(figure) == []
    assert crowded(figure) == []
    assert caplog.text == ""  # matplotlib's words are no user's


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


# --- walks ----------------------------------------------------------------------------------------

TRACES = {
    "com": lambda w: [w.com[:, 0], w.com[:, 1], w.velocity[:, 0], w.velocity[:, 1]],
    "forces": lambda w: [w.force[:, 0, 0], w.force[:, 0, 1], w.force[:, 1, 0], w.force[:, 1, 1]],
    "power_work": lambda w: [w.power[:, 0], w.power[:, 1], w.work[:, 0], w.work[:, 1]],
}


@pytest.mark.parametrize("name", TRACES)
def test_traces_are_the_walk_s_with_units_and_heel_strikes(name, hard, soft):
    figure = getattr(figures, name)({"hard sand": hard, "soft sand": soft})
    for axes, first, second in zip(figure.axes, TRACES[name](hard), TRACES[name](soft), strict=True):
        drawn = lines(axes)
        assert axes.get_ylabel().rpartition(" ")[2] in ("(m)", "(m/s)", "(N)", "(W)", "(J)")
        np.testing.assert_allclose(drawn["hard sand"].get_ydata(), first, rtol=0, atol=1e-12)
        np.testing.assert_allclose(drawn["soft sand"].get_ydata(), second, rtol=0, atol=1e-12)
        np.testing.assert_array_equal(drawn["hard sand"].get_xdata(), hard.t)
        assert drawn["hard sand"].get_linestyle() != drawn["soft sand"].get_linestyle()
        assert drawn["hard sand"].get_color() != drawn["soft sand"].get_color()
        strikes = [x[0] for x in (line.get_xdata() for line in axes.get_lines()) if len(x) == 2]
        assert strikes[:3] == pytest.approx([1.1, 1.7, 2.3])


# --- many designs ---------------------------------------------------------------------------------
