"""What a recording cannot be is said by the check that knows it, with the place in the file."""

import re

import numpy as np
import pytest
from motion_files import OPENSIM, record, write_c3d, write_mot, write_table, write_trc

import footopt as fo
from footopt.errors import FileError

HUMAN = fo.Gait.human()


def edited(path, change):
    """A text file whose lines are changed."""
    path.write_text("\n".join(change(path.read_text().splitlines())) + "\n")
    return path


def table(path, strides=4.4):
    return write_table(path / "walk.csv", HUMAN, strides)


def trc(path):
    return write_trc(path / "walk.trc", *record(HUMAN, strides=4.3, rate=60.0))


def with_cell(lines, row, column, value):
    cells = lines[row].split(",")
    cells[column] = value
    return [*lines[:row], ",".join(cells), *lines[row + 1 :]]


CHECKS = {
    "a hole in time": (
        lambda p: edited(table(p), lambda lines: lines[:100] + lines[130:]),
        r"nothing is recorded from [\d.]+ to [\d.]+ s",
    ),
    "a jump": (
        lambda p: edited(table(p), lambda lines: with_cell(lines, 100, 2, "79")),
        r"the knee jumps at [\d.]+ s: 79 deg between",
    ),
    "an open stride": (
        lambda p: edited(table(p, 1.0), lambda lines: lines[:55]),
        r"not one whole stride",
    ),
    "another rate": (
        lambda p: edited(trc(p), lambda lines: [line.replace("60.00\t60", "100.00\t60") for line in lines]),
        r"cannot be read as TRC \(.*100",
    ),
    "too many cells": (
        lambda p: edited(trc(p), lambda lines: [*lines[:20], lines[20] + "\t1\t2", *lines[21:]]),
        r"cannot be read as TRC \(line 21",
    ),
    "cut off": (
        lambda p: p / "walk.c3d",
        r"cannot be read as C3D \(its header says \d+ bytes, it has \d+: it is cut off or damaged\)",
    ),
    "no unit of angle": (
        lambda p: edited(
            write_mot(p / "walk.mot", HUMAN, OPENSIM),
            lambda lines: [re.sub("s=yes", "s=maybe", line) for line in lines],
        ),
        r"inDegrees must be yes or no, and is maybe",
    ),
}  # fmt: skip


@pytest.mark.parametrize("check", CHECKS)
def test_a_check_says_what_it_saw(check, tmp_path):
    make, said = CHECKS[check]
    if check == "cut off":
        path = tmp_path / "walk.c3d"
        write_c3d(path, *record(HUMAN, strides=4.3, rate=60.0))
        path.write_bytes(path.read_bytes()[:-2048])
    with pytest.raises(FileError, match=rf"gait\.path = .*walk.*: .*{said}"):
        fo.Gait.from_file(make(tmp_path))


def test_a_byte_order_mark_changes_nothing(tmp_path):
    path = write_mot(tmp_path / "walk.mot", HUMAN, OPENSIM)
    plain = fo.Gait.from_file(path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    marked = fo.Gait.from_file(path)
    assert np.array_equal(marked.thigh.a, plain.thigh.a)
    assert np.array_equal(marked.knee.b, plain.knee.b)
