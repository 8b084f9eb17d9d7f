"""The wheel works where no checkout is: it carries its settings and its data, and says what it needs."""

import os
import subprocess
import sys
import zipfile
from importlib.metadata import Distribution, distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from running import LIMIT

ROOT = Path(__file__).parents[1]


def needed(requirements, found):
    """Names of what requirements ask for, and of all that these ask for, added to `found`."""
    for requirement in map(Requirement, requirements):
        if requirement.name not in found and (requirement.marker is None or requirement.marker.evaluate()):
            found.add(requirement.name)
            needed(distribution(requirement.name).requires or (), found)
    return found


@pytest.mark.slow
def test_a_wheel_with_nothing_but_what_it_asks_for_is_imported_and_composes(tmp_path):
    """Beside links to what it asks for, without the packages that are installed here."""
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-index"]
    build += ["--no-build-isolation", "--wheel-dir", tmp_path, ROOT]
    subprocess.run(build, check=True, capture_output=True, timeout=LIMIT)
    site = tmp_path / "site"
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as content:
        names = content.namelist()
        content.extractall(site)
    assert {"footopt/conf/config.yaml", "footopt/gait/data/human_walk.json", "footopt/py.typed"} < {*names}
    assert {"footopt/report/page/template.html", "footopt/studies/paper/claims.toml"} < {*names}
    assert not [n for n in names if n.startswith(("tests/", "conf/", "outputs/"))]

    (metadata,) = site.glob("footopt-*.dist-info")
    for name in needed(Distribution.at(metadata).requires, set()):
        library = distribution(name)
        for top in {file.parts[0] for file in library.files} - {"..", "__pycache__"}:
            if not (site / top).exists():  # a namespace of several
                (site / top).symlink_to(library.locate_file(top))
    own = "defaults: [config]\nsolver: {n_gen: 2}\nhydra: {searchpath: ['pkg://footopt.conf']}\n"
    (tmp_path / "mine.yaml").write_text(own)
    modules = [name for name in names if name.endswith(".py") and not name.endswith("__main__.py")]
    every = [name.removesuffix(".py").removesuffix("/__init__").replace("/", ".") for name in modules]
    for command, said in (
        (["-m", "footopt", "-cp", str(tmp_path), "-cn", "mine", "--cfg", "job"], "n_gen: 2"),
        (["-c", f"import importlib; [importlib.import_module(n) for n in {every}]"], ""),
    ):
        done = subprocess.run(
            [sys.executable, "-S", *command],
            cwd=tmp_path,
            env=os.environ | {"PYTHONPATH": str(site)},
            capture_output=True,
            text=True,
            timeout=LIMIT,
        )
        assert done.returncode == 0, done.stderr
        assert said in done.stdout
