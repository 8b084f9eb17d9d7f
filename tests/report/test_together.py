"""Figures are drawn by copies of the process where it has no threads; what a copy cannot do is done here."""

from __future__ import annotations

import os
import sys
import threading
import time
from functools import partial
from pathlib import Path

import pytest

from footopt.errors import FileError
from footopt.report.together import together

copies = pytest.mark.skipif(sys.platform != "linux", reason="only there can a process be copied safely")


@pytest.fixture
def alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """No other thread of Python's, whatever runs the tests."""
    monkeypatch.setattr(threading, "active_count", lambda: 1)


def note(folder: Path, name: str) -> None:
    """A line with who has done a job, in a file of its own: a second time would be a second line."""
    with (folder / name).open("a") as file:
        file.write(f"{os.getpid()}\n")


def noted(folder: Path) -> list[str]:
    return [path.read_text() for path in sorted(folder.iterdir())]


@pytest.mark.usefixtures("alone")
@pytest.mark.parametrize("most", [1, 2, 7])
def test_every_job_is_done_once(tmp_path: Path, most: int) -> None:
    with together([partial(note, tmp_path, f"job {i}") for i in range(5)], most):
        pass
    done = noted(tmp_path)
    assert len(done) == 5
    assert all(text.count("\n") == 1 for text in done)


@copies
@pytest.mark.usefixtures("alone")
def test_jobs_run_while_the_block_does(tmp_path: Path) -> None:
    with together([partial(note, tmp_path, name) for name in ("a", "b")], 2):
        until = time.monotonic() + 60.0
        while not noted(tmp_path) and time.monotonic() < until:
            time.sleep(0.01)
        assert noted(tmp_path)
    assert f"{os.getpid()}\n" not in noted(tmp_path)[:1]


def test_a_process_with_threads_is_not_copied(tmp_path: Path) -> None:
    ended = threading.Event()
    other = threading.Thread(target=ended.wait)
    other.start()
    try:
        with together([partial(note, tmp_path, f"job {i}") for i in range(3)], 4):
            assert not noted(tmp_path)
    finally:
        ended.set()
        other.join()
    assert noted(tmp_path) == [f"{os.getpid()}\n"] * 3


@copies
@pytest.mark.usefixtures("alone")
def test_what_a_copy_cannot_do_is_done_here(tmp_path: Path) -> None:
    own = os.getpid()

    def only_here(name: str) -> None:
        if os.getpid() != own:
            os._exit(9)  # as if it were killed
        note(tmp_path, name)

    with together([partial(only_here, f"job {i}") for i in range(3)], 3):
        time.sleep(0.2)
    assert noted(tmp_path) == [f"{own}\n"] * 3


@copies
@pytest.mark.usefixtures("alone")
def test_a_copy_that_hangs_is_done_without(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("footopt.report.together.PATIENCE", 1)
    own = os.getpid()

    def hangs_elsewhere() -> None:
        while os.getpid() != own:
            time.sleep(1.0)
        note(tmp_path, "job")

    with together([hangs_elsewhere, lambda: None], 2):
        time.sleep(0.2)
    assert noted(tmp_path) == [f"{own}\n"]


@pytest.mark.usefixtures("alone")
def test_an_error_of_a_copy_is_raised_here(tmp_path: Path) -> None:
    def fails() -> None:
        raise FileError("the disk is full")

    with pytest.raises(FileError, match="disk is full"), together([fails, fails], 2):
        time.sleep(0.2)


@pytest.mark.usefixtures("alone")
def test_once_the_block_is_interrupted_no_job_is_begun(tmp_path: Path) -> None:
    def slow(name: str) -> None:
        note(tmp_path, name)
        time.sleep(0.5)

    jobs = [partial(slow, f"job {i}") for i in range(20)]
    with pytest.raises(KeyboardInterrupt), together(jobs, 3):
        raise KeyboardInterrupt
    assert len(noted(tmp_path)) <= 2  # a copy's first


@copies
@pytest.mark.usefixtures("alone")
def test_what_the_system_does_not_allow_is_done_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused() -> int:
        raise BlockingIOError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(os, "fork", refused)
    with together([partial(note, tmp_path, f"job {i}") for i in range(3)], 3):
        pass
    assert noted(tmp_path) == [f"{os.getpid()}\n"] * 3
