"""A study of one's own is a function in a plugin: it is run, shown and recorded as those of footopt are."""

import json

import pytest
from hydra.errors import ConfigCompositionException
from running import composed, unrender
from study_pages import check_page

from footopt import studies
from footopt.errors import SettingError
from footopt.report import figures
from footopt.studies.runs import run_study

PLUGIN = """
from dataclasses import dataclass

from footopt.report import figures, terminal
from footopt.studies import STUDIES, StudySettings


def run(study):
    study.save("contour", lambda: figures.contour(study.foot), "The sole.")
    table = terminal.table(("hollow (mm)",))
    table.add_row(f"{study.options.times * study.foot.hollow:.1f}")
    found = {"objectives": {"hollow": study.foot.hollow}}
    study.conclude("A sole", [table], found, summary=["It is hollow."])


@dataclass
class Settings(StudySettings):
    times: float = 1e3
    reads = ("foot",)


STUDIES["hollow"] = Settings, run
"""
MADE = ("versions", "machine", "wall_time_s", "wall_time_covers")  # how a result was


@pytest.mark.slow
def test_it_is_found_by_its_name(tmp_path, capsys, monkeypatch):
    unrender(monkeypatch)
    monkeypatch.setitem(studies.STUDIES, "hollow", None)  # what the plugin adds goes at the end
    del studies.STUDIES["hollow"]
    (tmp_path / "hollow_study.py").write_text(PLUGIN)
    monkeypatch.syspath_prepend(tmp_path)
    words = ("foot.k=[5,8,9,8,5,4,4,2,2,3,4]", f"plugins=[{tmp_path / 'hollow_study.py'}]")
    run_study(composed("study=hollow", "study.times=2e3", *words), tmp_path, {"any": 1})
    with pytest.raises(ConfigCompositionException, match=r"study\.time"):
        composed("study=hollow", "study.time=2e3", *words)
    with pytest.raises(SettingError, match=r"^sand\.zeta = 2\.0: must be left out: study=hollow does not"):
        run_study(composed("study=hollow", "sand.zeta=2", *words), tmp_path, {}, ["sand.zeta=2"])
    check_page(tmp_path)
    result = json.loads((tmp_path / "result.json").read_text())
    assert list(result) == ["study", "units", "maximise", "objectives", "settings", *MADE]
    assert (result["units"], result["maximise"]) == ({"hollow": "m"}, {"hollow": False})
    assert (result["study"], result["settings"]) == ("hollow", {"any": 1})
    assert "It is hollow." in capsys.readouterr().out
    monkeypatch.setattr(figures, "contour", None)  # not to be called
    run_study(composed("study=hollow", "report=none", *words), tmp_path / "none", {})
