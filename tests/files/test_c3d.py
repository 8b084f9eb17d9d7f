"""C3D: what another library writes, and what it does not: other processors and whole numbers."""

import struct

import ezc3d
import numpy as np
import pytest
from motion_files import HUMAN, misfit, record, write_c3d

import footopt as fo
from footopt.errors import FootoptError
from footopt.files.gaits.c3d import DEC, MIPS, read_c3d

INTEL = 84


def numbers(values, kind, processor):
    """Numbers as a processor writes them."""
    if kind == "f4" and processor == DEC:
        bits = (4 * np.asarray(values, np.float32)).view(np.uint32)
        return np.stack([bits >> 16, bits & 0xFFFF], axis=-1).astype("<u2").tobytes()
    return np.asarray(values).astype((">" if processor == MIPS else "<") + kind).tobytes()


def parameter(name, group, kind, sizes, values, processor):
    head = struct.pack("bb", len(name), group) + name.encode()
    body = struct.pack("bB", kind, len(sizes)) + bytes(sizes) + values + b"\0"
    return head + numbers([2 + len(body)], "u2", processor) + body


def c3d(names, places, processor, floats, rate=100.0, unit="mm", first=1):
    """A C3D file of markers (n, markers, 3), with an analog channel beside them."""
    n, many, _ = places.shape
    scale = -0.1 if floats else 0.1
    values = np.concatenate([places if floats else np.round(places / 0.1), np.zeros((n, many, 1))], axis=2)
    values[np.isnan(values).any(axis=2)] = (1, 2, 3, -1)
    rows = np.concatenate([values.reshape(n, -1), np.full((n, 2), 7.0)], axis=1)  # two samples a frame
    wide = max(map(len, names))
    chain = struct.pack("bb", 5, -1) + b"POINT" + numbers([3], "u2", processor) + b"\0"
    for args in (
        ("SCALE", 1, 4, (), numbers([scale], "f4", processor)),
        ("RATE", 1, 4, (), numbers([rate], "f4", processor)),
        ("UNITS", 1, -1, (4,), unit.encode().ljust(4)),
        ("LABELS", 1, -1, (wide, many), b"".join(name.encode().ljust(wide) for name in names)),
    ):
        chain += parameter(*args, processor)
    blocks = (len(chain) + 4 + 511) // 512
    section = (bytes([1, 80, blocks, processor]) + chain).ljust(512 * blocks, b"\0")
    words = [many, 2, first, first + n - 1, 0]
    header = bytes([2, 80]) + numbers(words, "u2", processor) + numbers([scale], "f4", processor)
    header += numbers([2 + blocks, 2], "u2", processor) + numbers([rate], "f4", processor)
    data = numbers(rows, "f4" if floats else "i2", processor)
    return header.ljust(512, b"\0") + section + data.ljust(-(-len(data) // 512) * 512, b"\0")


@pytest.mark.parametrize("processor", [INTEL, DEC, MIPS])
@pytest.mark.parametrize("floats", [True, False])
def test_every_processor_and_both_kinds_of_numbers(processor, floats):
    t, places = record(HUMAN, strides=2.2)
    array = 1e3 * np.stack(list(places.values()), axis=1)
    array[20:25, 3] = np.nan
    markers = read_c3d(c3d(list(places), array, processor, floats, first=51))
    assert list(markers.places) == list(places)
    assert markers.t[[0, -1]] == pytest.approx([0.5, 0.5 + t[-1]])
    for i, name in enumerate(places):
        np.testing.assert_allclose(markers.places[name], 1e-3 * array[:, i], atol=1e-6 if floats else 6e-5)


def test_what_another_library_writes_and_reads(tmp_path):
    path = write_c3d(tmp_path / "walk.c3d", *record(HUMAN))
    theirs, ours = ezc3d.c3d(str(path)), read_c3d(path.read_bytes())
    assert list(ours.places) == theirs["parameters"]["POINT"]["LABELS"]["value"]
    points = 1e-3 * theirs["data"]["points"][:3].transpose(1, 2, 0)
    np.testing.assert_allclose(list(ours.places.values()), points, rtol=0, atol=1e-12)


def test_damaged_bytes_end_in_a_message_or_in_what_was_walked(tmp_path):
    """Of 60 such files ezc3d ends the process on 5, and does not come to an end on one."""
    path = write_c3d(tmp_path / "walk.c3d", *record(HUMAN, strides=2.2, rate=60.0))
    whole = path.read_bytes()
    for draw in range(20):
        content, rng = bytearray(whole), np.random.default_rng(draw)
        for at in rng.integers(0, 1500, 12):
            content[at] = rng.integers(256)
        path.write_bytes(content)
        try:
            gait, said = fo.Gait.from_file(path), "walk.c3d"
        except FootoptError as error:
            gait, said = HUMAN, str(error)
        assert misfit(gait) < 1.0
        assert "walk.c3d" in said
        assert not any(w in said for w in ("index", "bad_alloc", "github", "struct", "buffer"))
