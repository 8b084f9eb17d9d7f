"""study=credibility measures its evidence, and the docs' page is what it writes."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from running import footopt
from study_pages import check_page

from footopt.studies import credibility

DOCS = Path(__file__).parents[2] / "docs" / "credibility.md"


@pytest.mark.slow
def test_the_page_of_the_docs_is_what_the_study_writes(tmp_path):
    done = footopt("study=credibility", "hydra.run.dir=out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    written = (tmp_path / "out" / "credibility.md").read_text(encoding="utf-8")
    kept, number = DOCS.read_text(encoding="utf-8"), re.compile(r"\d+(?:\.\d+)?")
    assert number.sub("#", written) == number.sub("#", kept)
    ours, theirs = (np.array(number.findall(text), float) for text in (written, kept))
    np.testing.assert_allclose(ours, theirs, rtol=0.1)  # another processor rounds otherwise
    check_page(tmp_path / "out")
    factors = json.loads((tmp_path / "out" / "result.json").read_text())["factors"]
    assert {0} < {f["level"] for f in factors} <= {0, 1, 2, 3, 4}


def test_levels_follow_what_was_measured():
    assert [credibility.by(share, 0.0, 0.5, 0.9) for share in (0.0, 0.49, 0.5, 0.89, 0.95)] == [1, 1, 2, 2, 3]
    assert credibility.validated() == (1, {"every": 36, "agree": 11, "differ": 22, "open": 3})
