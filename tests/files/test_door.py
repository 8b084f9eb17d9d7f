"""Every way in: what a user gives is used as it says, or refused with one clear message; never a traceback.

The bad files are made by `door_files`. What a reader makes of one must be right: what a file says again in
another way (its frames, its rates, the length of a bone) must agree, a walk must be one, and where part of
a file is missing what is left must be what was there.
"""

import json
import os
import time
from contextlib import contextmanager

import door_files
import numpy as np
import pytest
from door_files import LESS, SAME, TOLD
from test_gait_files import misfit

import footopt as fo
from footopt.design import FootProblem, Store
from footopt.errors import FileError, FootoptError, SettingError
from footopt.files import reading
from footopt.files import soles as outline
from footopt.files.gaits.angles import LIMITS, PERIODS
from footopt.files.soles.lines import crossing
from footopt.studies.export import foot_of

PATIENCE = 10.0  # s a file
GAITS = ("trc", "mot", "c3d", "csv gait", "csv stride", "csv markers", "json")
SOLES = ("dxf", "dxf lines", "svg", "csv sole")
KINDS = (*GAITS, *SOLES, "csv sand")
#: Formats that say nothing twice: of a changed number, only what no walk or sole can be is told.
PLAIN = ("json", *SOLES)
#: Different bad files of each kind, at least.
LEAST = {kind: 30 if kind == "c3d" else 75 for kind in KINDS}
assert sum(LEAST.values()) >= 500


@pytest.fixture(scope="session")
def good(tmp_path_factory):
    return door_files.good_files(tmp_path_factory.mktemp("good"))


def opened(kind, path):
    """What a file of a kind is read as."""
    if kind in GAITS:
        return fo.Gait.from_file(path)
    if kind == "csv sand":
        return fo.Sand.from_table(path)
    return outline.read(path, layer="FOOT" if kind == "dxf lines" else None)


def refusal(error, name):
    """What is wrong with a message, or ""."""
    text = str(error)
    if not isinstance(error, FootoptError):
        return f"{type(error).__name__}: {text[:200]}"
    if name not in text:
        return f"does not name the file: {text}"
    if (
        len(text) > 500
        or not text.isprintable()
        or "Traceback" in text
        or "0x7f" in text
        or "<function" in text
    ):
        return f"is no clear message: {text[:600]!r}"
    return ""


def mistake(kind, found, true, case):
    """Why what was read is not what the file says, or ""."""
    if kind in GAITS:
        return mistake_in_gait(kind, found, true, case)
    if kind == "csv sand":
        off = max(abs(a - b) for a, b in zip(found.stress_map.law, true.stress_map.law, strict=True))
        told = max(found.fit_error) > 2 * max(true.fit_error)
        return f"coefficients off by {off:.3f} N/cm^3" if off > (0.1 if told else 0.03) else ""
    return mistake_in_sole(found, true, case)


def mistake_in_gait(kind, found, true, case):
    angles = {
        name: np.degrees(getattr(found, name).at(np.arange(200) / 200)[0]) for name in ("thigh", "knee")
    }
    for name, values in angles.items():
        if not (LIMITS[name][0] - 5 <= values.min() and values.max() <= LIMITS[name][1] + 5):
            return f"{name} from {values.min():.1f} to {values.max():.1f} deg"
    if not PERIODS[0] <= found.period <= PERIODS[1]:
        return f"period {found.period} s"
    if kind == "json" and case.change != SAME:
        return ""
    # a single stride that ends some rows too soon cannot be told from a shorter one
    off, longer = (8.0, 0.08) if kind == "csv stride" and case.change == LESS else (1.0, 0.02)
    if kind == "csv stride" and case.change != LESS:
        off = 2.5  # nothing averages one wrong value out
    if case.change == TOLD:
        off = 5.1  # the pelvis' tilt
    if abs(found.period / true.period - 1) > longer:
        return f"period {found.period:.4f} s instead of {true.period:.4f} s"
    return f"{misfit(found):.2f} deg off" if misfit(found) > off else ""


def mistake_in_sole(found, true, case):
    length = np.ptp(found[:, 0])
    if not (np.isfinite(found).all() and len(found) >= 2 and found[0, 0] < 0 < found[-1, 0]):
        return "no line from heel to toe around the origin"
    if not 5e-3 <= length <= 1.5 or np.ptp(found[:, 1]) > 2 * length or crossing(found, False) is not None:
        return "no simple line of a sole's size"
    if case.change == SAME:
        same = found.shape == true.shape and np.allclose(found, true, rtol=0, atol=1e-9)
        return "" if same else "not the same sole"
    if case.change == LESS:
        apart = np.linalg.norm(found[:, None] - true, axis=2).min(axis=1).max()
        return f"has points {apart} m from what was there" if apart > 1e-9 else ""
    return ""


def judged(kind, good, folder, rounds):
    """Open every bad file of a kind: how many, how many were refused, the slowest, and what is wrong."""
    path, wrong, refused, slowest = folder / f"bad_file.{kind.split()[0]}", [], 0, (0.0, "")
    path.write_bytes(good[kind])
    true, contents = opened(kind, path), set()
    for case in door_files.cases(kind, good, rounds):
        if case.content == good[kind]:
            continue
        contents.add(case.content)
        path.write_bytes(case.content)
        started = time.perf_counter()
        try:
            found = opened(kind, path)
        except Exception as error:
            refused += 1
            said = refusal(error, path.name)
            wrong += [f"{case.name}: {said}"] if said else []
            wrong += [f"{case.name}: refused: {error}"] if case.change == SAME else []
        else:
            said = mistake(kind, found, true, case)
            wrong += [f"{case.name}: {said}"] if said else []
        slowest = max(slowest, (time.perf_counter() - started, case.name))
    return len(contents), refused, slowest, wrong


class TestBadFiles:
    @pytest.mark.parametrize("kind", KINDS)
    def test_are_read_right_or_refused_with_a_clear_message(self, kind, good, tmp_path, record_property):
        count, refused, slowest, wrong = judged(kind, good, tmp_path, rounds=1)
        record_property("files", f"{kind}: {count} files, {refused} refused, slowest {slowest}")
        assert not wrong, "\n".join(wrong)
        assert slowest[0] < PATIENCE, slowest
        assert count >= LEAST[kind]
        assert refused >= 0.4 * count  # the others are still what they were

    @pytest.mark.slow
    @pytest.mark.parametrize("kind", KINDS)
    def test_of_chance_in_larger_number(self, kind, good, tmp_path):
        _, _, slowest, wrong = judged(kind, good, tmp_path, rounds=2 if kind == "c3d" else 3)
        assert not wrong, "\n".join(wrong)
        assert slowest[0] < PATIENCE, slowest

    def test_are_the_same_every_time(self, good):
        one, two = ([hash(c.content) for c in door_files.cases("trc", good)] for _ in range(2))
        assert one == two


# --- what is no file --------------------------------------------------------------------------------


def in_the_way(folder, what, name):
    """Something that is not a file under a file's name."""
    path = folder / name
    if what == "folder":
        path.mkdir()
    elif what == "loop":
        path.symlink_to(path.name)
    elif what == "secret":
        path.write_text("x")
        path.chmod(0)
    elif what == "long":
        path = folder / ("n" * 300 + name)
    elif what == "zero byte":
        path = folder / f"a\0{name}"
    elif what == "line break":
        path = folder / f"a\n\x1b[31m{name}"
    return path


NOBODY = 65534
NO_FILES = ("folder", "loop", "secret", "long", "zero byte", "line break", "nothing")


@contextmanager
def somebody(what):
    """A secret is read as a user who may not read everything, should it be root who tests."""
    root = what == "secret" and os.geteuid() == 0
    if root:
        os.seteuid(NOBODY)
    try:
        yield
    finally:
        if root:
            os.seteuid(0)


@pytest.mark.timeout(10)  # a hang
class TestWhatIsNoFile:
    @pytest.mark.parametrize("what", NO_FILES)
    @pytest.mark.parametrize(
        "name", ["a.trc", "a.mot", "a.c3d", "a.csv", "a.json", "sole.dxf", "sole.svg", "sole.csv"]
    )
    def test_is_named_at_once(self, what, name, tmp_path):
        path = in_the_way(tmp_path, what, name)
        with somebody(what), pytest.raises(FileError, match="cannot be read") as caught:
            outline.read(path) if name.startswith("sole") else fo.Gait.from_file(path)
        assert not refusal(caught.value, name)

    @pytest.mark.parametrize("what", NO_FILES)
    def test_as_a_table_of_stresses(self, what, tmp_path):
        path = in_the_way(tmp_path, what, "a.csv")
        with somebody(what), pytest.raises(FileError, match=r"sand\.table = .*cannot be read") as caught:
            fo.Sand.from_table(path)
        assert not refusal(caught.value, "a.csv")

    @pytest.mark.parametrize("what", ["folder", "loop", "long", "zero byte"])
    def test_as_a_store(self, what, tmp_path):
        path = in_the_way(tmp_path, what, "designs.sqlite")
        with pytest.raises(FileError, match=r"study\.store = ") as caught:
            Store(path, FootProblem())
        assert not refusal(caught.value, "designs.sqlite")

    @pytest.mark.parametrize("what", NO_FILES)
    def test_as_the_result_of_a_run(self, what, tmp_path):
        if what not in ("long", "zero byte", "line break"):
            in_the_way(tmp_path, what, "result.json")
        with (
            somebody(what),
            pytest.raises(FileError, match=r"study\.run = .*not the folder of a run") as caught,
        ):
            foot_of(tmp_path)
        assert not refusal(caught.value, tmp_path.name)

    def test_a_file_that_grows_beyond_its_limit_is_not_read_to_its_end(self, tmp_path, monkeypatch):
        monkeypatch.setitem(reading.LIMITS, "sand", 100)
        (tmp_path / "a.csv").write_text("beta,gamma,alpha_x,alpha_z\n" + "1,2,3,4\n" * 20)
        with pytest.raises(FileError, match=r"larger than 0\.0001 MB"):
            fo.Sand.from_table(tmp_path / "a.csv")


# --- the folders of runs, stores, YAML --------------------------------------------------------------


def run_folder(folder, shape="waypoints"):
    """What footopt study=export needs of a run."""
    foot = door_files.FOOT
    foot.to_file(folder / "contour.csv")
    settings = {
        "foot": {"shape": shape, "width": 0.1, "ankle": [0.0, 0.0], "n": 11, "K": 10, "L": 0.13, "H": 0.03}
    }
    k = list(foot.k) if shape == "waypoints" else None
    design = {"name": "one", "k": k, "width_m": 0.1, "ankle_m": [0.0, 0.0]}
    return {"design": design, "settings": settings}


def bad_results(result):
    """Results with something wrong in them, by name."""
    odd = [
        None,
        [],
        {},
        "x",
        -1,
        0,
        10**400,
        float("nan"),
        float("inf"),
        True,
        [1] * 12,
        [0] * 11,
        [1.5] * 11,
        "9" * 5000,
    ]
    for where, names in (("design", ("k", "width_m", "ankle_m", "name")), ("settings", ("foot",))):
        for name in names:
            for value in odd:
                yield f"{name} {str(value)[:20]}", {**result, where: {**result[where], name: value}}
    for name in result["settings"]["foot"]:
        for value in odd:
            yield (
                f"foot.{name} {str(value)[:20]}",
                {**result, "settings": {"foot": {**result["settings"]["foot"], name: value}}},
            )
    for value in odd:
        yield f"design {str(value)[:20]}", {**result, "design": value}
        yield f"all {str(value)[:20]}", value


@pytest.mark.parametrize("shape", ["waypoints", "ellipse"])
def test_a_run_that_was_changed_gives_its_foot_or_a_message(shape, tmp_path):
    result = run_folder(tmp_path, shape)
    true, path, count = None, tmp_path / "result.json", 0
    for name, content in [("good", result), *bad_results(result)]:
        path.write_text(json.dumps(content))
        count += 1
        try:
            foot = foot_of(tmp_path)
        except FootoptError as error:
            text = str(error)
            assert text.isprintable(), name
            assert len(text) < 500, name
            assert name != "good"
        else:
            true = true or foot
            assert np.isfinite(foot.contour).all(), name
            assert 0 < foot.width < 100, name
            assert np.isfinite(foot.ankle).all(), name
            if not name.startswith(("foot.", "k")):
                np.testing.assert_array_equal(foot.contour, true.contour)
    assert count > 150


YAML = {
    "in itself": "a: &a [*a]\n",
    "deep": "a: " + "[" * 5000 + "]" * 5000,
    "code": "a: !!python/object/apply:os.system ['touch made']\n",
    "tabs": "study:\n\tname: optimize\n",
    "open": "study: {name: optimize\n",
    "twice": "study: {name: a}\nstudy: {name: b}\n",
    "a list": "- 1\n- 2\n",
    "a word": "study",
    "nothing": "",
    "several": "study: {name: optimize}\n---\nstudy: {name: optimize}\n",
    "large": "a: " + "x" * 1_100_000,
    "a colon": "a: b: c\n",
    "an alias of nothing": "study: *nowhere\n",
    "zero": "study: \0\n",
    "interpolation": "study: ${oc.env:HOME}\n",
    "interpolation of itself": "study: ${study}\n",
    "no study": "sand: {name: hard}\n",
    "a study that is none": "study: {name: [1]}\n",
    "a control character": "study: {name: \x07}\n",
}


class TestYaml:
    @pytest.mark.parametrize("name", YAML)
    @pytest.mark.parametrize("file", ["config", "overrides"])
    def test_of_a_run_to_resume(self, name, file, tmp_path, monkeypatch):
        from footopt.cli.main import resumed

        monkeypatch.chdir(tmp_path)
        (tmp_path / ".hydra").mkdir()
        good = {"config": "study: {name: optimize}\n", "overrides": "[]\n"}
        for part, text in (good | {file: YAML[name]}).items():
            (tmp_path / ".hydra" / f"{part}.yaml").write_text(text)
        with pytest.raises((FileError, SettingError), match=r"resume = ") as caught:
            resumed([f"resume={tmp_path}"])
        assert str(caught.value).isprintable()
        assert len(str(caught.value)) < 500
        assert not (tmp_path / "made").exists()

    def test_of_ones_own_is_looked_at_before_hydra_does(self, tmp_path):
        from footopt.cli.main import check_own_yaml

        (tmp_path / "sand").mkdir()
        good = tmp_path / "sand" / "dune.yaml"
        good.write_text("name: dune\nzeta: 1.3\n")
        for words in (["--config-dir", str(tmp_path)], [f"--config-dir={tmp_path}"], ["-cd", str(tmp_path)]):
            check_own_yaml([*words, "sand=dune"])
            for name in ("tabs", "large", "zero", "an alias of nothing"):
                good.write_text(YAML[name])
                with pytest.raises(FileError, match=r"dune\.yaml"):
                    check_own_yaml([*words, "sand=dune"])
            good.write_text("name: dune\nzeta: 1.3\n")


def bad_stores(path, rounds):
    """A store, damaged in many places."""
    import random

    rng = random.Random(rounds)
    content = path.read_bytes()
    for _ in range(rounds):
        changed = bytearray(content)
        for _ in range(rng.randrange(1, 4)):
            changed[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
        yield bytes(changed)
        yield content[: rng.randrange(1, len(content))]
        begin = rng.randrange(len(content))
        yield content[:begin] + bytes(512) + content[begin + 512 :]


def test_a_damaged_store_is_named_or_gives_what_was_kept(tmp_path, good):
    problem, path = FootProblem(accuracy=fo.Accuracy.named("draft")), tmp_path / "designs.sqlite"
    k = problem.space.random(40, seed=1, inside=True).tolist()
    evaluation = [
        fo.design.store.Evaluation(np.arange(len(problem.record), dtype=float) + i, "") for i in range(40)
    ]
    with Store(path, problem) as store:
        store.add(k, evaluation)
    for side in ("-wal", "-shm"):
        (tmp_path / f"designs.sqlite{side}").unlink(missing_ok=True)
    bad = [*bad_stores(path, 30), *good.values()]
    for content in bad:
        for left in tmp_path.glob("designs.sqlite*"):
            left.unlink()
        path.write_bytes(content)
        try:
            with Store(path, problem) as store:
                found = store.get(k)
        except FileError as error:
            said = refusal(error, path.name)
            assert not said
        else:
            for one, kept in zip(found, evaluation, strict=True):
                assert one is None or (one.values == kept.values).all()
    assert len(bad) > 90
