"""What the page of a study holds, read without a browser."""

import json
import re


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
    assert len(data["figures"]) == len(list((folder / "figures").glob("*.png"))) > 0
    assert all(figure["source"].startswith("data:image/png;base64,") for figure in data["figures"])
    assert len({figure["says"] for figure in data["figures"]}) == len(data["figures"])
    assert data["headline"]
    for table in data["tables"]:
        assert table["rows"]
        assert all(len(row) == len(table["head"]) for row in table["rows"])
    assert data["tables"]
    entry = data["entry"]
    assert {"settings", "versions", "wall_time_s"} <= set(entry)
    assert all(entry[name] == result[name] for name in entry if name != "error_estimate")
    assert ("seed" in entry) == ("seed" in result)
    assert "http" not in text.replace("http://www.w3.org/2000/svg", "")
