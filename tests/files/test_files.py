"""Files that a run leaves are there as a whole, or as they were."""

import resource
from contextlib import contextmanager

import numpy as np
import pytest

import footopt as fo
from footopt.errors import FileError
from footopt.files import io as files
from footopt.report import figures


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


@contextmanager
def room(size):
    """Files may not grow beyond a size in bytes: what a full disk is to the program."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


def write_foot(foot, ending):
    return lambda folder: fo.write_foot(foot, folder / f"contour.{ending}")


@pytest.fixture(scope="module")
def writers():
    """Everything that writes a file of a run, by the file's name."""
    foot = fo.Foot.flat()
    found = {f"contour.{ending}": write_foot(foot, ending) for ending in ("csv", "dxf", "svg", "stl")}
    found["walk.nc"] = lambda folder: files.write_walk(folder / "walk.nc", WALK, {})
    found["result.json"] = lambda folder: files.write_json(folder / "result.json", {"a": list(range(200))})
    found["sole.pdf"] = lambda folder: figures.save(figures.contour(foot), folder, "sole")
    return found


@pytest.fixture(scope="module")
def film():
    walk = fo.simulate(fo.Foot.flat(), accuracy="draft")
    return lambda folder: fo.animate(walk, folder / "walk.gif", fps=2, speed=1.0, dpi=20)


NAMES = ("contour.csv", "contour.dxf", "contour.svg", "contour.stl", "walk.nc", "result.json", "sole.pdf")


def assert_whole_on_a_full_disk(write, name, folder):
    write(folder)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    for part in (0.0, 0.9):
        with room(int(part * len(before[name]))), pytest.raises(FileError, match="cannot") as caught:
            write(folder)
        assert str(caught.value).count("cannot") == 1
        assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


@pytest.mark.parametrize("name", NAMES)
def test_a_full_disk_is_said_and_every_file_is_whole_or_as_it_was(writers, name, tmp_path):
    assert_whole_on_a_full_disk(writers[name], name, tmp_path)


@pytest.mark.slow
def test_a_film_is_whole_on_a_full_disk(film, tmp_path):
    assert_whole_on_a_full_disk(film, "walk.gif", tmp_path)
