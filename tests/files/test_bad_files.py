"""Every file that a user gives is read to what it says, or refused with one clear message; never a traceback.

The bad files are made by `bad_files`.
"""

import json
from dataclasses import replace
from itertools import islice
from random import Random

import numpy as np
import pytest
from bad_files import FOOT, GAITS, KINDS, REFUSED, SAME, SOLES, every, good_files, tree
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from running import footopt, tries
from shapely import LineString

import footopt as fo
from footopt.cli.run import resume
from footopt.design import FootProblem, Store
from footopt.errors import FileError, FootoptError, SettingError
from footopt.files import identity
from footopt.files.soles import LENGTHS
from footopt.studies.runs import foot_of


@pytest.fixture(scope="session")
def good(tmp_path_factory):
    return good_files(tmp_path_factory.mktemp("good"))


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("bad")


def opened(kind, path):
    """What a file of a kind is read as: a gait, a sole (n, 2) or sand."""
    if kind in GAITS:
        return fo.read_gait(path)
    if kind in SOLES:
        return fo.read_foot(path).contour
    return fo.read_sand(path)


def assert_clear(error, name):
    """A message that names the file in one line, not too long."""
    text = str(error)
    if not isinstance(error, FootoptError):
        raise AssertionError(name) from error
    assert name in text
    assert len(text) < 500
    assert text.isprintable()
    assert not any(private in text for private in ("Traceback", "0x7f", "<function", "broadcast"))


def assert_right(kind, found, true, owed):
    """What was read is a gait, a sole or a sand, and what the file says."""
    if kind in GAITS:
        assert owed != SAME or replace(found, source="") == replace(true, source="")
        assert 0.2 <= found.period <= 5.0
        assert np.isfinite([found.thigh.a0, *found.thigh.a, *found.knee.b]).all()
    elif kind in SOLES:
        assert np.isfinite(found).all()
        assert 5e-3 <= np.ptp(found[:, 0]) <= LENGTHS[1]
        assert LineString(found).is_simple
        if owed == SAME:
            np.testing.assert_allclose(found, true, rtol=0, atol=1e-9)
    else:
        assert owed != SAME or found.stress_map == true.stress_map
        assert max(found.fit_error) < 0.5


def judge(kind, case, good, folder):
    """Open a bad file: it gives what is owed."""
    path = folder / f"bad_file.{kind.split()[0]}"
    path.write_bytes(good[kind])
    true = opened(kind, path)
    path.write_bytes(case.content)
    try:
        found = opened(kind, path)
    except Exception as error:
        found = error
    if isinstance(found, Exception):
        assert_clear(found, path.name)
        assert case.owed != SAME, (case.how, str(found))
    else:
        assert case.owed != REFUSED, case.how
        assert_right(kind, found, true, case.owed)


@pytest.mark.parametrize("kind", KINDS)
class TestBadFiles:
    """Read right, or refused with a clear message."""

    def test_of_every_fourth_sort(self, kind, good, folder):
        for case in islice(every(Random(1), kind, good), 0, None, 4):
            judge(kind, case, good, folder)

    @pytest.mark.slow
    @settings(max_examples=tries(2), phases=[Phase.generate])  # files are large: shrinking takes minutes
    @given(random=st.randoms(use_true_random=False))
    def test_of_every_sort_with_changes_anywhere(self, kind, good, folder, random):
        for case in every(random, kind, good):
            judge(kind, case, good, folder)


# --- what is no file --------------------------------------------------------------------------------

READERS = {
    "a.mot": fo.read_gait,
    "a.json": fo.read_gait,
    "a.dxf": fo.read_foot,
    "a.svg": fo.read_foot,
    "a.csv": fo.read_sand,
}


def in_the_way(folder, what, name):
    """Something that cannot be read, under a file's name."""
    path = folder / name
    if what == "folder":
        path.mkdir()
    elif what == "too long":
        path = folder / ("n" * 300 + name)
    elif what == "with a line break":
        path = folder / f"a\n\x1b[31m{name}"
    return path


@pytest.mark.parametrize("what", ["folder", "too long", "with a line break", "missing"])
def test_what_cannot_be_read_is_named(what, tmp_path):
    path = in_the_way(tmp_path, what, "a.mot")
    with pytest.raises(FileError, match="cannot be read") as caught:
        fo.read_gait(path)
    assert_clear(caught.value, "a.mot")


@pytest.mark.parametrize("name", READERS)
def test_every_reader_names_what_is_missing(name, tmp_path):
    with pytest.raises(FileError, match="cannot be read") as caught:
        READERS[name](tmp_path / name)
    assert_clear(caught.value, name)


@pytest.mark.parametrize("what", ["folder", "missing"])
def test_a_folder_without_a_result_is_no_run(what, tmp_path):
    in_the_way(tmp_path, what, "result.json")
    with pytest.raises(FileError, match=r"^run = .*not the folder of a run") as caught:
        foot_of(tmp_path)
    assert_clear(caught.value, tmp_path.name)


@pytest.mark.parametrize("what", ["folder", "too long"])
def test_what_cannot_be_a_store_is_named(what, tmp_path):
    path = in_the_way(tmp_path, what, "designs.sqlite")
    with pytest.raises(FileError, match=r"study\.store = ") as caught:
        Store(path, FootProblem())
    assert_clear(caught.value, "designs.sqlite")


# --- the folders of runs, stores, YAML --------------------------------------------------------------


def run_folder(folder, shape):
    """What `footopt study=export` needs of a run; its result is returned."""
    fo.write_foot(FOOT, folder / "contour.csv")
    foot = {"shape": shape, "width": 0.1, "ankle": [0.0, 0.0], "n": 11, "K": 10, "L": 0.13, "H": 0.03}
    k = list(FOOT.k) if shape == "waypoints" else None
    design = {"name": "one", "k": k, "width_m": 0.1, "ankle_m": [0.0, 0.0]}
    return {"design": design, "settings": {"foot": foot}}


@pytest.mark.parametrize("shape", ["waypoints", "ellipse"])
@given(random=st.randoms(use_true_random=False))
def test_a_run_that_was_changed_gives_its_foot_or_a_message(shape, folder, random):
    result = json.dumps(run_folder(folder, shape))
    (folder / "result.json").write_text(json.dumps(tree(random, result)))
    try:
        foot = foot_of(folder)
    except FootoptError as error:
        assert_clear(error, "")
    else:
        assert np.isfinite(foot.contour).all()
        assert 0 < foot.width < 100
        assert np.isfinite(foot.ankle).all()


YAML = {
    "code": "a: !!python/object/apply:os.system ['touch made']\n",
    "tabs": "study:\n\tname: optimize\n",
    "open": "study: {name: optimize\n",
    "a list": "- 1\n- 2\n",
    "nothing": "",
    "several": "study: {name: optimize}\n---\nstudy: {name: optimize}\n",
    "large": "a: " + "x" * 1_100_000,
    "a zero byte": "study: \0\n",
    "interpolation of itself": "study: ${study}\n",
    "no study": "sand: {name: hard}\n",
    "a study that is none": "study: {name: [1]}\n",
}


@pytest.mark.parametrize("name", YAML)
def test_bad_yaml_of_a_run_to_resume_is_refused(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / identity.FILE).write_text(YAML[name])
    with pytest.raises((FileError, SettingError), match=r"resume = ") as caught:
        resume([f"resume={tmp_path}"])
    assert_clear(caught.value, "")
    assert not (tmp_path / "made").exists()


def test_a_yaml_file_of_ones_own_is_named(tmp_path):
    (tmp_path / "sand").mkdir()
    (tmp_path / "sand" / "dune.yaml").write_text(YAML["tabs"])
    done = footopt("--config-dir", str(tmp_path), "sand=dune", cwd=tmp_path)
    assert done.returncode == 1
    assert "dune.yaml" in done.stderr
