"""What a run says: no progress in a file, and tables that fit."""

import io
import re

from rich.console import Console
from study_pages import leave_job

import footopt as fo
from footopt.report import summary
from footopt.report.numbers import number
from footopt.report.progress import progress

ESCAPE = re.compile(r"\x1b\[[\d;?]*[A-Za-z]")


def test_a_log_file_has_no_progress():
    file = io.StringIO()
    with progress(Console(file=file, width=130), 200, "walk") as step:
        for i in range(200):
            step(news=f"number {i + 1}")
    assert file.getvalue() == ""


class TestNarrowTables:
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
