"""What a run says: progress with the time left, tables that fit, colours only where they are seen."""

import io
import re
import sys

import numpy as np
import pytest
from rich.console import Console
from study_pages import leave_job
from terminals import on_a_terminal

import footopt as fo
from footopt.report import progress as module
from footopt.report import summary, terminal
from footopt.report.progress import LINES, PATIENCE, Pace, _Parts, progress, report_generations
from footopt.studies.base import Study
from footopt.studies.settings import Config

FOOTOPT = [sys.executable, "-m", "footopt"]
COLOUR = re.compile(r"\x1b\[[\d;]*\b(3[0-8]|4[0-8]|9[0-7]|10[0-7])[\d;]*m")
ESCAPE = re.compile(r"\x1b\[[\d;?]*[A-Za-z]")


class Clock:
    """A clock that a test turns."""

    now = 0.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(module.time, "perf_counter", clock)
    monkeypatch.setattr(Pace.__init__, "__defaults__", (clock,))
    return clock


def paced(seconds):
    """Each unit's guess of the time left over the true one, from a fifth of the time on."""
    clock = Clock()
    pace = Pace(len(seconds), clock)
    ratios, end = [], sum(seconds)
    for took in seconds:
        clock.now += took
        pace.step()
        if 0.2 * end < clock.now < 0.9 * end:
            ratios.append(pace.left / (end - clock.now))
    return np.array(ratios)


class TestPace:
    def test_what_was_compiled_or_known_first_is_soon_forgotten(self):
        """Ten seconds of compiling, and a search of which the first half is read from a store."""
        compiled = paced([10.0] + [0.5] * 100)
        assert np.all(compiled[10:] < 1.05)
        resumed = paced([0.001] * 50 + [0.4] * 50)
        assert np.all((resumed > 0.5) & (resumed < 2.0))

    @pytest.mark.parametrize("seed", range(5))
    def test_uneven_units_that_nobody_knew_are_foretold_to_a_factor_of_two(self, seed):
        seconds = np.random.default_rng(seed).lognormal(0.0, 0.7, 80)
        ratios = paced(seconds.tolist())
        assert np.all((ratios > 0.5) & (ratios < 2.0))

    def test_units_that_end_together_are_no_sudden_speed(self):
        """As two threads end theirs: after ten seconds two are done, a millisecond apart."""
        clock = Clock()
        pace = Pace(20, clock)
        for now in (10.0, 10.001):
            clock.now = now
            pace.step()
        assert pace.left == pytest.approx(90.0, rel=0.01)

    def test_counts_down_between_units_and_ends_at_zero(self):
        clock = Clock()
        pace = Pace(2, clock)
        assert np.isnan(pace.left)
        clock.now = 4.0
        pace.step()
        assert pace.left == pytest.approx(4.0)
        clock.now = 7.0
        assert pace.left == pytest.approx(1.0)
        clock.now = 70.0
        assert pace.left == 0.0


def told(clock, units, seconds, name="walk"):
    """The lines that a piece of work of that many units leaves in a log file."""
    file = io.StringIO()
    with progress(Console(file=file, width=130), units, name) as step:
        for i in range(units):
            clock.now += seconds
            step(news=f"number {i + 1}")
    return file.getvalue().splitlines()


class TestALogFile:
    def test_has_about_ten_lines_with_count_rate_and_time_left(self, clock):
        lines = told(clock, 200, 0.5)
        assert len(lines) == LINES
        assert lines[0] == "walk 20/200  2/s  left 90 s  number 20"
        assert lines[-1] == "walk 200/200  2/s  left 0.0 s  number 200"

    def test_few_long_units_have_a_line_each(self, clock):
        lines = told(clock, 3, 100.0)
        assert [line.split("  ")[1:3] for line in lines[:2]] == [
            ["100 s each", "left 3 min 20 s"],
            ["100 s each", "left 100 s"],
        ]

    def test_work_of_less_than_two_seconds_leaves_nothing(self, clock):
        assert told(clock, 200, 0.9 * PATIENCE / 200) == []

    @pytest.mark.parametrize(
        ("base", "best"),
        [
            *((unknown, r"efficiency J_W -\S+") for unknown in (None, np.nan)),
            (-1e-4, r"J_W x \d\.\d\d of flat"),
        ],
    )
    def test_a_search_tells_its_best_value(self, base, best, clock):
        file = io.StringIO()
        with progress(Console(file=file, width=130), 4, "generation") as step:

            def slowly(generation):
                clock.now += 1.0
                report_generations(step, "efficiency", base=base)(generation)

            fo.search(fo.FootProblem(accuracy="draft"), "ga", slowly, pop_size=10, n_gen=4)
        last = file.getvalue().splitlines()[-1]
        assert re.match(rf"generation 4/4  1/s  left 0.0 s  best {best}, \d+ evaluations/s$", last)


PIECE = """
import time
from footopt.report.progress import progress
from footopt.report.terminal import console
with progress(console(), {units}, "walk") as step:
    for i in range({units}):
        time.sleep({seconds})
        step(news=f"number {{i}} of these")
"""


class TestATerminal:
    @pytest.mark.slow
    def test_has_a_bar_that_stays_within_its_width(self):
        text, code = on_a_terminal([sys.executable, "-c", PIECE.format(units=28, seconds=0.1)], 60)
        assert code == 0
        lines = [line for line in re.split(r"[\r\n]+", ESCAPE.sub("", text)) if "walk " in line]
        assert all(len(line) <= 60 for line in lines)
        assert re.search(r"walk 28/28 ━+ \S+/s +left 0\.0 s", lines[-1])
        assert len({line.split()[1] for line in lines}) > 3  # it moved

    @pytest.mark.parametrize("width", range(5, 60, 3))
    def test_leaves_out_what_does_not_fit_instead_of_cutting_a_number(self, width):
        said = ["best J_W x 1.78 of flat", "front 1234", "98765 evaluations/s"]
        out = Console(file=io.StringIO(), width=width)
        out.print(_Parts(said))
        (line, *more) = out.file.getvalue().rstrip("\n").split("\n")
        assert not more
        assert line.strip() in ["", *(", ".join(said[:n]) for n in (1, 2, 3))]

    def test_shows_nothing_for_short_work(self):
        text, code = on_a_terminal([sys.executable, "-c", PIECE.format(units=5, seconds=0.1)])
        assert (code, text.strip()) == (0, "")


SINKING = [*FOOTOPT, "study=simulate", "sand.zeta=0.001", "accuracy=draft"]  # warns, in yellow


class TestColours:
    @pytest.mark.slow
    def test_on_a_terminal(self, tmp_path):
        text, code = on_a_terminal(SINKING, cwd=tmp_path)
        assert code == 1  # the walk failed
        assert COLOUR.search(text)

    @pytest.mark.slow
    @pytest.mark.parametrize("environment", [{"NO_COLOR": "1"}, {"TERM": "dumb"}], ids=str)
    def test_not_where_they_are_not_wanted(self, environment, tmp_path):
        text, code = on_a_terminal(SINKING, cwd=tmp_path, **environment)
        assert code == 1
        assert "The walk failed" in text
        assert not COLOUR.search(text)


class TestNarrowTables:
    def test_numbers_are_never_cut_and_words_wrap(self):
        out = Console(file=io.StringIO(), width=60, force_terminal=True)
        shown = terminal.table(("objective", "a number", "one more number"), words=("objective",))
        shown.add_row("a rather long name of an objective", "-2.527e-4", "1.23456789e-05 ± 2.5e-07")
        out.print(shown)
        text = ESCAPE.sub("", out.file.getvalue())
        assert "-2.527e-4" in text
        assert "1.23456789e-05 ± 2.5e-07" in text
        assert "…" not in text
        assert {"rather", "long", "name", "objective"} <= set(text.split())

    @pytest.mark.slow
    def test_the_closing_table_of_a_search_fits_into_80_columns(self, tmp_path):
        command = [*FOOTOPT, "accuracy=draft", "solver.pop_size=10", "solver.n_gen=3"]
        text, code = on_a_terminal(command, 80, cwd=tmp_path)
        assert code == 0
        lines = ESCAPE.sub("", text).splitlines()
        assert all(len(line) <= 80 for line in lines if "outputs" not in line)
        assert "…" not in text
        (row,) = [line for line in lines if line.startswith("efficiency (min)")]
        assert len(re.findall(r"-\d\.\d+e-4", row)) == 2

    def test_a_multirun_cuts_no_number_and_names_the_columns_left_out(self, tmp_path, monkeypatch):
        walk = fo.simulate(fo.Foot.flat(), accuracy="draft")
        leave_job(tmp_path / "0", walk)
        file = io.StringIO()
        monkeypatch.setattr(summary, "console", lambda: Console(file=file, width=80, force_terminal=True))
        assert summary.of_multirun(tmp_path) == 0
        text = ESCAPE.sub("", file.getvalue())
        assert "…" not in text
        assert terminal.number(walk.objectives["work"]) in text
        assert "summary.csv, too: efficiency, cost of transport" in text

    def test_a_folders_name_is_in_one_piece(self, tmp_path):
        study = Study(Config(), tmp_path / ("deep[er]" * 20), {})
        study.console = Console(
            file=io.StringIO(), width=80, force_terminal=True, highlight=False, markup=False
        )
        study.close()
        assert str(study.folder) in study.console.file.getvalue()


class TestModelError:
    def test_errors_of_several_walks_are_ranges_and_what_failed_has_none(self):
        (line,) = terminal.describe_model(
            [{"work": 0.54, "distance": 0.06}, {}, None, {"work": 0.98, "distance": 0.06}]
        )
        assert line.endswith(": work 54 % to 98 %, distance 6 %")

    def test_without_walks_nothing_is_said(self):
        assert terminal.describe_model([{}, None]) == []
