"""study=doctor: it finds what is wrong, says what to do, and holds the walk to the published numbers."""

import json
import re
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import numpy as np
import pytest
from running import footopt, program
from study_pages import data_of

import footopt as fo
from footopt import compiled, studies
from footopt.errors import FootoptError
from footopt.files import run
from footopt.studies import doctor
from footopt.studies.settings import Config, StudyConfig
from footopt.walk.reference import LIMITS, PUBLISHED, RAMP, SAME_PLATES

ROOT = Path(fo.__file__).parent.parent


def examine(folder):
    """The study in this process."""
    studies.run(Config(study=StudyConfig(name="doctor")), folder, {})


def findings(folder):
    (path,) = folder.rglob("result.json")
    return {f["what"]: f for f in json.loads(path.read_text())["findings"]}


@pytest.fixture(autouse=True)
def few_feet(monkeypatch):
    """A speed that nobody reads is measured with few walks."""
    monkeypatch.setattr(doctor, "FEET", 4)


@pytest.fixture
def one_sand(monkeypatch):
    """The self-test is that on hard sand alone."""
    monkeypatch.setattr(doctor, "PUBLISHED", PUBLISHED[2:])


def test_the_readme_says_what_the_walk_is_held_to():
    lines = (ROOT / "README.md").read_text().splitlines()
    for published in PUBLISHED:
        (row,) = [line for line in lines if f"({published.sand}) |" in line]
        zeta, *rest = re.findall(r"[\d.]+", row)
        assert float(zeta) == published.zeta
        assert tuple(map(float, rest[:5])) == published.objectives
        for said, name in zip(rest[5:], ("standard", "reference"), strict=True):
            assert float(said) / 100 <= LIMITS[name]


def test_a_sound_installation_passes_with_the_measured_differences(tmp_path):
    done = footopt("study=doctor", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = findings(tmp_path)
    assert not [f for f in found.values() if f["good"] is False]
    for published in PUBLISHED:
        scene = fo.Scene(sand=fo.Sand.named(published.sand))
        for accuracy in ("standard", "reference", SAME_PLATES):
            name = accuracy if isinstance(accuracy, str) else accuracy.name
            values = fo.evaluate([RAMP], scene, accuracy).values[0]
            worst = 100 * np.abs(values / published.objectives - 1).max()
            assert f"differs by up to {worst:.2g} %" in found[f"{published.sand} sand, {name}"]["found"]
    assert "FAILED" not in done.stdout
    (path,) = tmp_path.rglob("report.html")
    page = data_of(path.parent)
    (table,) = page["tables"]
    assert [row[:2] for row in table["rows"]] == [[f["what"], f["found"]] for f in found.values()]
    assert not any(map(any, table["bad"]))
    assert (page["headline"], page["warnings"]) == (["All is as it should be."], [])
    assert page["entry"]["versions"] == run.versions()


@pytest.mark.slow
def test_code_that_is_not_compiled_is_found_and_the_self_test_skipped(tmp_path):
    done = program("study=doctor", cwd=tmp_path, NUMBA_DISABLE_JIT="1")
    assert done.returncode == 1
    assert "compiled code: switched off by NUMBA_DISABLE_JIT. Unset NUMBA_DISABLE_JIT" in done.stderr
    found = findings(tmp_path)
    (page,) = tmp_path.rglob("report.html")
    assert f"Everything is in {page.parent}" in done.stdout  # to be sent to who may help
    assert found["self-test"]["found"].startswith("skipped")
    assert not any("sand" in what for what in found)


@pytest.mark.usefixtures("one_sand")
def test_a_package_that_is_not_there_is_no_fault_and_said_how_to_get(tmp_path, monkeypatch):
    def without(name):
        if name == "pandas":
            raise PackageNotFoundError(name)
        return "1.0"

    monkeypatch.setattr(doctor, "version", without)
    examine(tmp_path)
    said = findings(tmp_path)["pandas"]["found"]
    assert 'pip install "footopt[pandas]"' in said
    assert ["pandas", said, ""] in data_of(tmp_path)["tables"][0]["rows"]


@pytest.mark.usefixtures("one_sand")
def test_a_cache_that_cannot_be_kept_is_found(tmp_path, monkeypatch):
    monkeypatch.setattr(doctor, "kept", lambda function: (None, 0))
    with pytest.raises(FootoptError, match=r"cache folder: none that can be written\. Set NUMBA_CACHE_DIR"):
        examine(tmp_path)


def test_a_walk_that_is_wrong_fails_with_what_to_do(tmp_path, monkeypatch):
    distance, *others = PUBLISHED[2].objectives
    wrong = PUBLISHED[2]._replace(objectives=(1.01 * distance, *others))
    monkeypatch.setattr(doctor, "PUBLISHED", (*PUBLISHED[:2], wrong))
    with pytest.raises(FootoptError) as error:
        examine(tmp_path)
    assert "3 of " in str(error.value)
    assert "hard sand, standard: differs by up to 0.98 % (distance); 0.5 % are allowed" in str(error.value)
    assert "Results cannot be trusted" in str(error.value)
    page = data_of(tmp_path)
    assert page["title"].startswith("3 of ")
    assert len(page["warnings"]) == 3
    assert all("Results cannot be trusted" in warning for warning in page["warnings"])
    (table,) = page["tables"]
    marked = [row[0] for row, bad in zip(table["rows"], table["bad"], strict=True) if bad[2]]
    assert marked == [f"hard sand, {name}" for name in ("standard", "reference", "same plates")]


def test_a_program_that_breaks_is_a_finding_and_the_rest_is_said(tmp_path, monkeypatch):
    def broken(*arguments, **options):
        raise RuntimeError("no such symbol")

    monkeypatch.setattr(doctor, "evaluate", broken)
    with pytest.raises(FootoptError, match=r"self test: RuntimeError: no such symbol\. Try to install"):
        examine(tmp_path)
    assert "xarray" in findings(tmp_path)


@pytest.mark.usefixtures("one_sand")
def test_a_folder_that_cannot_be_written_is_said_at_the_end(tmp_path, capsys):
    (tmp_path / "report.html").mkdir()  # in the way, also for root
    with pytest.raises(FootoptError, match=r"results: cannot write .*hydra\.run\.dir"):
        examine(tmp_path)
    out = capsys.readouterr().out
    assert out.count("hard sand, standard") == 1
    assert re.search(r"^results .*FAILED", out, flags=re.M)


def test_the_processor_is_the_one_that_numba_compiles_for(monkeypatch):
    name, bits = compiled.processor()
    assert name
    assert bits in (0, 128, 256, 512)
    monkeypatch.setattr(compiled.config, "CPU_NAME", "generic")
    monkeypatch.setattr(compiled.config, "CPU_FEATURES", "-avx512f,-avx")
    name, narrower = compiled.processor()
    assert name == "generic"
    assert narrower <= min(bits, 128)
