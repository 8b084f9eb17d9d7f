"""Files that a run leaves are there as a whole, or as they were."""

import os
import resource
import signal
import stat
import time
from contextlib import contextmanager

import numpy as np
import pytest
from running import tries

import footopt as fo
from footopt.errors import FileError
from footopt.files import run as files
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
    return lambda folder: foot.to_file(folder / f"contour.{ending}")


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


def test_files_that_are_replaced_are_on_the_disk_before(tmp_path, monkeypatch):
    """A loss of power then leaves the old file or the new one, never an empty one."""
    done, sync, replace = [], os.fsync, os.replace

    def note_sync(number):
        done.append("folder" if stat.S_ISDIR(os.fstat(number).st_mode) else "file")
        sync(number)

    def note_replace(old, new):
        done.append("replaced")
        replace(old, new)

    monkeypatch.setattr(os, "fsync", note_sync)
    monkeypatch.setattr(os, "replace", note_replace)
    files.write_text(tmp_path / "result.json", "{}")
    assert done == ["file", "replaced", "folder"]


def test_a_link_that_was_put_there_is_replaced_and_not_followed(writers, tmp_path):
    folder, elsewhere = tmp_path / "run", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.write_text("another's")
    for name in NAMES:
        (folder / name).symlink_to(elsewhere)
        (folder / f"{name}.new").symlink_to(elsewhere)
        writers[name](folder)
        assert not (folder / name).is_symlink()
    assert elsewhere.read_text() == "another's"


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")  # the child only writes
def test_a_kill_while_files_are_written_leaves_each_whole(writers, tmp_path):
    """Children that write the same files again and again are killed at any moment."""
    for write in writers.values():
        write(tmp_path)
    before = {name: (tmp_path / name).read_bytes() for name in NAMES}
    for attempt in range(tries(20)):
        if (child := os.fork()) == 0:
            while True:
                for write in writers.values():
                    write(tmp_path)
        time.sleep(0.01 * (attempt % 30))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        for name in NAMES:
            now = (tmp_path / name).read_bytes()
            assert now[-12:] == before[name][-12:], (attempt, name)
            assert abs(len(now) - len(before[name])) < 40, (attempt, name)  # a DXF has its dates
