"""What the page of a study holds, read without a browser."""

import json
import re


def check_page(folder):
    """Every figure of a study's folder is on its page in words, with its tables and how it was made."""
    path = folder / "report.html"
    assert path.stat().st_size < 8e6
    text = path.read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1])
    assert len(data["figures"]) == len(list((folder / "figures").glob("*.png"))) > 0
    assert all(figure["source"].startswith("data:image/png;base64,") for figure in data["figures"])
    assert len({figure["says"] for figure in data["figures"]}) == len(data["figures"])
    assert data["headline"]
    for table in data["tables"]:
        assert table["rows"]
        assert all(len(row) == len(table["head"]) for row in table["rows"])
    assert data["tables"]
    assert {"seed", "settings", "versions", "wall_time_s"} <= set(data["entry"])
    assert "http" not in text.replace("http://www.w3.org/2000/svg", "")
