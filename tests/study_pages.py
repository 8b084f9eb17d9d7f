"""What runs leave in their folders: read from the page without a browser, or left as a run would."""

import json
import re

import footopt as fo
from footopt.files import identity
from footopt.files import io as files
from footopt.walk import OBJECTIVES


def data_of(folder):
    """What the page in a folder is made of."""
    text = (folder / "report.html").read_text(encoding="utf-8")
    return json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1])


def check_page(folder):
    """Every figure of a study's folder is on its page in words, with its tables and how it was made."""
    path = folder / "report.html"
    assert path.stat().st_size < 8e6
    text, data = path.read_text(encoding="utf-8"), data_of(folder)
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    assert len(data["figures"]) == len(list((folder / "figures").glob("*.png")))
    assert all(figure["source"].startswith("data:image/svg+xml;base64,") for figure in data["figures"])
    assert len({figure["says"] for figure in data["figures"]}) == len(data["figures"])
    assert data["headline"]
    for table in data["tables"]:
        assert table["rows"]
        assert all(len(row) == len(table["head"]) for row in table["rows"])
    assert data["tables"] or data["figures"]
    entry = data["entry"]
    assert {"settings", "versions", "wall_time_s"} <= set(entry)
    assert all(entry[name] == result[name] for name in entry if name != "error_estimate")
    assert ("seed" in entry) == ("seed" in result)
    assert "http" not in text.replace("http://www.w3.org/2000/svg", "")


def leave_job(folder, walk, words=()):
    """What a job of a multirun leaves in its folder, as far as a table or page over all jobs reads it."""
    folder.mkdir()
    fo.write_foot(walk.foot, folder / "contour.csv")
    files.write_walk(folder / "walk.nc", walk.variables, {"reason": walk.reason})
    result = {
        "objectives": walk.objectives,
        "units": {name: OBJECTIVES[name].unit for name in walk.objectives},
        "maximise": {name: OBJECTIVES[name].maximise for name in walk.objectives},
        "design": {"k": walk.foot.k, "hollow_mm": 0.0},
        "settings": {"foot": {"top": walk.foot.top, "width": walk.foot.width}},
        "versions": identity.versions(),
    }
    files.write_text(folder / "result.json", files.json_text(result))
    identity.write(folder, {}, words)
