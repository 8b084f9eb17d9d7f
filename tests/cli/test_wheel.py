"""The wheel works where no checkout is: it carries its settings and its data, and says what it needs."""

import os
import subprocess
import sys
import sysconfig
import venv
import zipfile
from importlib.metadata import distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from running import LIMIT

ROOT = Path(__file__).parents[2]


def needed(requirements, found):
    """Names of what requirements ask for, and of all that these ask for, added to `found`."""
    for requirement in map(Requirement, requirements):
        if requirement.name not in found and (requirement.marker is None or requirement.marker.evaluate()):
            found.add(requirement.name)
            needed(distribution(requirement.name).requires or (), found)
    return found


@pytest.mark.slow
def test_a_wheel_with_nothing_but_what_it_asks_for_is_imported_and_composes(tmp_path):
    """In a new environment; what is installed here is linked into it, not installed again."""
    pip, quiet = [sys.executable, "-m", "pip"], ["--quiet", "--no-deps", "--no-index"]
    build = [*pip, "wheel", *quiet, "--no-build-isolation", "--wheel-dir", tmp_path / "dist", ROOT]
    subprocess.run(build, check=True, capture_output=True, timeout=LIMIT)
    (wheel,) = (tmp_path / "dist").glob("*.whl")
    names = zipfile.ZipFile(wheel).namelist()
    assert "footopt/conf/config.yaml" in names
    assert "footopt/gait/data/human_walk.json" in names
    assert "footopt/report/page/template.html" in names
    assert "footopt/studies/paper/claims.toml" in names
    assert "footopt/py.typed" in names
    assert not [n for n in names if n.startswith(("tests/", "conf/", "outputs/"))]

    venv.create(tmp_path / "env")
    place = {"base": str(tmp_path / "env"), "platbase": str(tmp_path / "env")}
    site, programs = (Path(sysconfig.get_path(name, vars=place)) for name in ("purelib", "scripts"))
    install = [*pip, "--python", programs / "python", "install", "--no-compile", *quiet, wheel]
    subprocess.run(install, check=True, capture_output=True, timeout=LIMIT)
    (metadata,) = site.glob("footopt-*.dist-info/METADATA")
    lines = metadata.read_text(encoding="utf-8").partition("\n\n")[0].splitlines()
    asked = [line.removeprefix("Requires-Dist: ") for line in lines if line.startswith("Requires-Dist: ")]
    for name in needed([line for line in asked if "extra ==" not in line], set()):
        library = distribution(name)
        for top in {file.parts[0] for file in library.files} - {"..", "__pycache__"}:
            if not (site / top).exists():  # a namespace of several
                (site / top).symlink_to(library.locate_file(top))
    (tmp_path / "conf").mkdir()
    own = "defaults: [config]\nsolver: {n_gen: 2}\nhydra: {searchpath: ['pkg://footopt.conf']}\n"
    (tmp_path / "conf" / "mine.yaml").write_text(own)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    options = {"cwd": tmp_path, "env": environment, "capture_output": True, "text": True, "timeout": LIMIT}
    job = [programs / "footopt", "-cp", tmp_path / "conf", "-cn", "mine", "--cfg", "job"]
    done = subprocess.run(job, **options)
    assert done.returncode == 0, done.stderr
    assert "n_gen: 2" in done.stdout
    modules = [name for name in names if name.endswith(".py") and not name.endswith("__main__.py")]
    every = [name.removesuffix(".py").removesuffix("/__init__").replace("/", ".") for name in modules]
    code = f"import importlib; [importlib.import_module(n) for n in {every}]"
    done = subprocess.run([programs / "python", "-c", code], **options)
    assert done.returncode == 0, done.stderr
