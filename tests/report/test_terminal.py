"""What a run says: progress with the time left, tables that fit, colours only where they are seen."""

import io
import re
import sys

import pytest
from rich.console import Console
from study_pages import leave_job
from terminals import on_a_terminal

import footopt as fo
from footopt.report import summary, terminal
from footopt.report.numbers import number
from footopt.report.progress import progress

FOOTOPT = [sys.executable, "-m", "footopt"]
COLOUR = re.compile(r"\x1b\[[\d;]*\b(3[0-8]|4[0-8]|9[0-7]|10[0-7])[\d;]*m")
ESCAPE = re.compile(r"\x1b\[[\d;?]*[A-Za-z]")


def test_a_log_file_has_no_progress():
    file = io.StringIO()
    with progress(Console(file=file, width=130), 200, "walk") as step:
        for i in range(200):
            step(news=f"number {i + 1}")
    assert file.getvalue() == ""


SINKING = [*FOOTOPT, "study=simulate", "sand.zeta=0.001", "accuracy=draft"]  # warns, in yellow


@pytest.mark.slow
@pytest.mark.parametrize("unwanted", [{}, {"NO_COLOR": "1"}])
def test_colours_are_seen_on_a_terminal_but_not_where_they_are_not_wanted(unwanted, tmp_path):
    text, code = on_a_terminal(SINKING, cwd=tmp_path, **unwanted)
    assert code == 1
    assert "The walk failed" in text
    assert bool(COLOUR.search(text)) != bool(unwanted)


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
        assert summary.compare(tmp_path, [tmp_path / "0"]) == 0
        text = ESCAPE.sub("", file.getvalue())
        assert "…" not in text
        assert number(walk.objectives["work"]) in text
        assert "summary.csv, too: efficiency, cost of transport" in text
