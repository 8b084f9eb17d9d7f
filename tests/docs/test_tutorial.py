"""The tutorial notebook runs from top to bottom."""

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

TUTORIAL = Path(__file__).parents[2] / "examples" / "tutorial.ipynb"
LIMIT = 300  # s, for a cell: the machine may be busy with other tests


def cells(notebook, kind):
    return [cell for cell in notebook.cells if cell.cell_type == kind]


@pytest.mark.slow
def test_it_runs_from_top_to_bottom(tmp_path):
    notebook = nbformat.read(TUTORIAL, as_version=4)
    assert all(cell.outputs == [] for cell in cells(notebook, "code"))
    for cell in cells(notebook, "code"):  # its searches and its film, smaller
        for large, less in (("n_gen=20", "n_gen=3"), ("n_gen=15", "n_gen=4"), ("fps=10", "fps=2")):
            cell.source = cell.source.replace(large, less)
    NotebookClient(
        notebook, timeout=LIMIT, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}
    ).execute()
    shown = [output for cell in cells(notebook, "code") for output in cell.outputs]
    assert not [output for output in shown if output.get("name") == "stderr"]
    (random,) = [float(o.text.split(":")[1]) for o in shown if o.output_type == "stream"]
    result = next(o.data["text/plain"] for o in shown if "memetic" in o.get("data", {}).get("text/plain", ""))
    found = float(result.partition("efficiency ")[2].partition(">")[0])
    assert found < random < 0  # as the text says
    assert (tmp_path / "sole.dxf").stat().st_size > 0
    assert (tmp_path / "walk.gif").stat().st_size > 0
