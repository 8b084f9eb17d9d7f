"""Files that a run leaves are there as a whole, or as they were."""

import numpy as np
import pytest

from footopt.errors import FileError
from footopt.files import io as files


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "designs.csv"
    path.write_text("as it was")
    return path


def broken():
    """A disk that is full after the first row."""
    yield [1.0, float("nan")]
    raise OSError(28, "No space left on device")


def test_a_table_that_breaks_off_leaves_the_old_one(path):
    with pytest.raises(FileError, match=r"cannot write .*designs\.csv .*No space left"):
        files.write_csv(path, ["a", "b"], broken())
    assert path.read_text() == "as it was"
    assert [p.name for p in path.parent.iterdir()] == ["designs.csv"]


def test_a_fault_of_the_program_leaves_it_too(path):
    def rows():
        yield [1.0]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        files.write_csv(path, ["a"], rows())
    assert path.read_text() == "as it was"
    assert [p.name for p in path.parent.iterdir()] == ["designs.csv"]


WALK = {"t": (("time",), "s", np.arange(400.0)), "x": (("time",), "m", np.arange(400.0) ** 2)}


def test_a_walk_that_cannot_be_written_is_named_and_leaves_nothing(tmp_path):
    with pytest.raises(FileError, match="nowhere"):
        files.write_walk(tmp_path / "nowhere" / "walk.nc", WALK, {})
    files.write_walk(tmp_path / "walk.nc", WALK, {})
    assert [p.name for p in tmp_path.iterdir()] == ["walk.nc"]
