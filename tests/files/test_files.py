"""Files that a run leaves are there as a whole, or as they were."""

import pytest

import footopt as fo
from footopt.errors import FileError
from footopt.files import run as files


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


def test_a_table_replaces_the_old_one(path):
    files.write_csv(path, ["a", "b"], [[1.0, float("nan")], ["x, y", 3]])
    assert path.read_text() == 'a,b\n1.0,\n"x, y",3\n'


def test_a_walk_that_cannot_be_written_is_named_and_leaves_nothing(tmp_path, monkeypatch):
    walk = fo.simulate(fo.Foot.flat(), accuracy="draft")
    with pytest.raises(FileError, match="nowhere"):
        files.write_walk(tmp_path / "nowhere" / "walk.nc", walk.variables, {})
    files.write_walk(tmp_path / "walk.nc", walk.variables, {})
    assert [p.name for p in tmp_path.iterdir()] == ["walk.nc"]
