"""A file that is not what its reader wants is refused by its name; what editors change is read alike."""

import numpy as np
import pytest
from motion_files import HUMAN, write_mot, write_table

import footopt as fo
from footopt.cli.main import resume
from footopt.errors import FileError
from footopt.files import identity

FOOT = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4])
SAND = "beta,gamma,alpha_x,alpha_z\n" + "".join(
    f"{b},{g},{x:.4f},{z:.4f}\n"
    for b in (-60, -20, 0, 30, 70)
    for g in (-80, 10, 60, 120)
    for x, z in [1e-6 * np.array(fo.stress.alpha(*np.radians((b, g))))]
)
READERS = {".mot": fo.read_gait, ".dxf": fo.read_foot, ".svg": fo.read_foot,
           " gait.csv": fo.read_gait, " sole.csv": fo.read_foot, " sand.csv": fo.read_sand}  # fmt: skip


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    """A good file of each kind, as bytes."""
    folder = tmp_path_factory.mktemp("good")
    write_mot(folder / "a.mot", HUMAN)
    write_table(folder / "a gait.csv", HUMAN, 4.4)
    (folder / "a sand.csv").write_text(SAND)
    for kind in (".dxf", ".svg", " sole.csv"):
        fo.write_foot(FOOT, folder / f"a{kind}")
    return {kind: (folder / f"a{kind}").read_bytes() for kind in READERS}


def read(path, content):
    path.write_bytes(content)
    found = READERS[path.name.removeprefix("a")](path)
    return found.contour.tolist() if isinstance(found, fo.Foot) else found


@pytest.mark.parametrize("kind", READERS)
def test_what_is_no_such_file_is_refused_with_its_name(kind, good, tmp_path):
    path, content = tmp_path / f"a{kind}", good[kind]
    others = [good[other] for other in good if other[-4:] != kind[-4:]]
    for bad in (b"", b" \n\n", content.decode().encode("utf-16"), bytes(len(content)), *others):
        with pytest.raises(FileError) as caught:
            read(path, bad)
        assert path.name in str(caught.value)


@pytest.mark.parametrize("kind", READERS)
def test_what_editors_do_changes_nothing(kind, good, tmp_path):
    path, content = tmp_path / f"a{kind}", good[kind]
    true = read(path, content)
    for same in (b"\r\n".join(content.splitlines()) + b"\r\n", content.rstrip()):
        assert read(path, same) == true
    if kind != ".dxf":
        assert read(path, b"\xef\xbb\xbf" + content) == true


@pytest.mark.parametrize("kind", READERS)
def test_what_cannot_be_opened_is_named(kind, tmp_path):
    (tmp_path / f"a{kind}").mkdir()
    for name in (f"a{kind}", f"b{kind}", "n" * 300 + kind):
        with pytest.raises(FileError, match="cannot be read") as caught:
            READERS[kind](tmp_path / name)
        assert kind in str(caught.value)
        assert isinstance(caught.value, OSError)


@pytest.mark.parametrize(
    "text", ["a: !!python/object/apply:os.system ['touch made']\n", "study:\n\tname: optimize\n", "- 1\n", ""]
)
def test_bad_yaml_of_a_run_to_resume_is_refused(text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / identity.FILE).write_text(text)
    with pytest.raises(FileError, match="resume = "):
        resume([f"resume={tmp_path}"])
    assert not (tmp_path / "made").exists()
