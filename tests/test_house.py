"""How the house is built: what may import what, and what importing costs."""

import ast
import importlib
import subprocess
import sys
from pathlib import Path

import pytest

import footopt

ROOT = Path(footopt.__file__).parent
#: A run's data flows one way: no package imports one that comes after it.
ORDER = ["files", "sand", "effects", "foot", "gait", "walk", "design", "report", "studies", "cli"]
#: Libraries that one place only may import.
SEAMS = {
    "pymoo": "design",
    "moocore": "design",
    "dask": "design",
    "distributed": "design",
    "hydra": "cli",
    "omegaconf": "cli",
    "matplotlib": "report",
    "plotly": "report",
}
HEAVY = [
    "numpy", "numba", "scipy", "pymoo", "hydra", "omegaconf", "matplotlib", "ezdxf", "rich", "pandas",
    "xarray",
]  # fmt: skip
MODULES = sorted(ROOT.rglob("*.py"))


def home(path):
    """The package (or module) of footopt that a file belongs to."""
    return path.relative_to(ROOT).with_suffix("").parts[0]


def imports(path):
    """Every absolute module name that a file imports, and whether inside a function."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    lazy = {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        for inner in ast.walk(node)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, id(node) in lazy) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import"
            yield node.module, id(node) in lazy
            yield from ((f"{node.module}.{alias.name}", id(node) in lazy) for alias in node.names)


#: All but errors, the configuration's dataclasses, and the public face.
IN_THE_FLOW = [path for path in MODULES if home(path) in ORDER]


@pytest.mark.parametrize("path", IN_THE_FLOW, ids=lambda p: str(p.relative_to(ROOT)))
def test_no_module_imports_one_below_it(path):
    allowed = ORDER[: ORDER.index(home(path)) + 1]
    for name, _ in imports(path):
        parts = name.split(".")
        if parts[0] == "footopt" and len(parts) > 1 and parts[1] in ORDER:
            assert parts[1] in allowed, f"{path} imports {name}"


def test_foot_and_gait_do_not_know_each_other():
    for one, other in (("foot", "gait"), ("gait", "foot")):
        for path in (ROOT / one).rglob("*.py"):
            assert not any(name.startswith(f"footopt.{other}") for name, _ in imports(path)), path


@pytest.mark.parametrize("library", SEAMS)
def test_a_library_behind_a_seam_is_imported_by_one_place_only(library):
    homes = {home(path) for path in MODULES if any(n.split(".")[0] == library for n, _ in imports(path))}
    assert homes <= {SEAMS[library]}


def test_the_errors_need_nothing():
    assert not any(name.startswith(("footopt", "numpy")) for name, _ in imports(ROOT / "errors.py"))


def loaded_after(code):
    script = f"import sys; {code}; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return {name.split(".")[0] for name in run.stdout.split()}


def test_importing_footopt_is_cheap():
    assert not loaded_after("import footopt") & set(HEAVY)


def test_simulating_needs_no_optimiser_no_hydra_and_no_figures():
    loaded = loaded_after("import footopt as fo; fo.simulate, fo.evaluate, fo.Foot, fo.Gait, fo.Sand")
    assert not loaded & {"pymoo", "hydra", "omegaconf", "matplotlib", "rich", "pandas", "xarray"}


def test_drawing_a_foot_needs_no_optimiser_and_no_pyplot():
    script = "import sys, footopt as fo; fo.plot(fo.Foot.flat()); print(*sys.modules)"
    run = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=120
    )
    loaded = run.stdout.split()
    assert "matplotlib" in loaded
    assert not {"matplotlib.pyplot", "pymoo", "pandas", "xarray"} & set(loaded)


@pytest.mark.parametrize("name", footopt.__all__)
def test_every_public_name_is_there(name):
    assert getattr(footopt, name) is not None
    assert name in dir(footopt)


def test_the_public_face_is_the_one_that_is_documented():
    documented = {
        "Scene",
        "Sand",
        "Gait",
        "Walker",
        "Foot",
        "Accuracy",
        "simulate",
        "evaluate",
        "FootProblem",
        "stress",
    }
    assert documented <= set(footopt.__all__)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="has no attribute 'shoe'"):
        _ = footopt.shoe


@pytest.mark.parametrize("package", ["sand", "foot", "gait", "walk", "design"])
def test_packages_export_what_they_say(package):
    module = importlib.import_module(f"footopt.{package}")
    for name in module.__all__:
        assert hasattr(module, name), name
