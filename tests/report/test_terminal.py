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
from footopt.report import summary, terminal
from footopt.report.progress import progress, report_generations
from footopt.studies.base import Study
from footopt.studies.settings import Config

FOOTOPT = [sys.executable, "-m", "footopt"]
COLOUR = re.compile(r"\x1b\[[\d;]*\b(3[0-8]|4[0-8]|9[0-7]|10[0-7])[\d;]*m")
ESCAPE = re.compile(r"\x1b\[[\d;?]*[A-Za-z]")


def test_a_log_file_has_no_progress():
    file = io.StringIO()
    with progress(Console(file=file, width=130), 200, "walk") as step:
        for i in range(200):
            step(news=f"number {i + 1}")
    assert file.getvalue() == ""


@pytest.mark.parametrize(
    ("base", "best"), [(None, r"efficiency J_W -\S+"), (np.nan, r"efficiency J_W -\S+"),
                       (-1e-4, r"J_W x \d\.\d\d of flat")],
)  # fmt: skip
def test_a_search_tells_its_best_value(base, best):
    said = []
    tell = report_generations(lambda news="", units=1: said.append(news), "efficiency", base=base)
    fo.search(fo.FootProblem(accuracy="draft"), "ga", tell, pop_size=10, n_gen=2)
    assert len(said) == 2
    assert re.fullmatch(rf"best {best}, \d+ evaluations/s", said[-1])


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
        assert re.search(r"walk \d+/28 ━+", lines[-1])
        assert len({line.split()[1] for line in lines}) > 3  # it moved


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
