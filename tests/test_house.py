"""How the house is built: what may import what, how large a file may be, and what importing costs."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import footopt
from footopt.effects import EFFECTS

ROOT = Path(footopt.__file__).parent
#: The rooms from the ground up: a file imports from its own room and from those before it.
ROOMS = ("arrays", "errors", "compiled", "sand", "effects", "foot", "gait", "walk", "mujoco", "design",
         "files", "report", "studies", "cli")  # fmt: skip
#: Libraries that one room only may import.
SEAMS = {"pymoo": "design", "moocore": "design", "hydra": "cli", "matplotlib": "report"}
HEAVY = {"numpy", "numba", "scipy", "pymoo", "hydra", "omegaconf", "matplotlib", "ezdxf", "rich", "pandas",
         "xarray", "shapely", "trimesh"}  # fmt: skip
LONGEST = 350  # lines of a file
MODULES = {
    ".".join(["footopt", *path.relative_to(ROOT).with_suffix("").parts]).removesuffix(".__init__"): path
    for path in sorted(ROOT.rglob("*.py"))
}


def room(module):
    """The room of a module of footopt, or its name where it stands at the top."""
    return ([*module.split("."), ""])[1]


def imports(path):
    """Every absolute module name that a file imports, inside functions and for the type checker, too."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import"
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                yield inner if inner in MODULES else node.module
        elif isinstance(node, ast.Call) and getattr(node.func, "id", "") == "import_module":
            yield from (
                a.value for a in node.args if isinstance(a, ast.Constant) and isinstance(a.value, str)
            )


#: Files that are about certain effects: hard cases, and what an experiment measured.
EXPERIMENTS = ("footopt.studies.stability_cases", "footopt.studies.validate.rig")
#: Names of effects that are also words for something else.
WORDS = {"layers", "patches", "rest", "slope"}

#: What each file imports, and which files of footopt. A package's `__init__` only says what it offers.
IMPORTS = {name: set(imports(path)) for name, path in MODULES.items()}
ARROWS = {name: (found & set(MODULES)) - {name} for name, found in IMPORTS.items()}


def test_imports_go_one_way_lazy_ones_too():
    for module in (name for name in MODULES if room(name) in ROOMS):
        allowed = ROOMS[: ROOMS.index(room(module)) + 1]
        for found in ARROWS[module] - {"footopt"}:
            assert room(found) in allowed, f"{module} imports {found}"


def test_no_two_files_import_each_other_by_any_way_round():
    open_, done = [], set()

    def follow(module):
        assert module not in open_, " -> ".join([*open_[open_.index(module) :], module])
        if module not in done:
            open_.append(module)
            for found in ARROWS[module] - {"footopt"}:
                follow(found)
            done.add(open_.pop())

    for module in MODULES:
        follow(module)


def test_an_effect_is_named_in_its_own_file_only():
    """A file asks an effect for its answers (`effects.base.Effect`), none by its name."""
    own = {kind.__module__: kind.__name__ for kind in EFFECTS.values()}
    for module, path in MODULES.items():
        if module not in (*own, "footopt", "footopt.effects", *EXPERIMENTS):
            assert not IMPORTS[module] & set(own), module
            tree = [*ast.walk(ast.parse(path.read_text(encoding="utf-8")))]
            names = {getattr(node, "id", getattr(node, "attr", getattr(node, "name", ""))) for node in tree}
            texts = {node.value for node in tree if isinstance(node, ast.Constant)}
            assert not names & set(own.values()) | texts & (set(EFFECTS) - WORDS), module


@pytest.mark.parametrize("library", SEAMS)
def test_a_library_behind_a_seam_is_imported_by_one_room_only(library):
    found = {room(name) for name, names in IMPORTS.items() if library in {n.split(".")[0] for n in names}}
    assert found <= {SEAMS[library]}


def test_a_file_fits_on_a_few_screens_and_says_what_it_is_for():
    for module, path in MODULES.items():
        text = path.read_text(encoding="utf-8")
        assert len(text.splitlines()) <= LONGEST, module
        assert ast.get_docstring(ast.parse(text)), module


def loaded_after(code):
    """Names of all modules that a process has loaded after some code."""
    script = f"import sys; {code}; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return set(run.stdout.split())


def test_importing_footopt_is_cheap():
    assert not loaded_after("import footopt") & HEAVY


def test_simulating_needs_no_optimiser_no_hydra_and_no_figures():
    loaded = loaded_after("import footopt as fo; fo.simulate, fo.evaluate, fo.Gait, fo.Scene()")
    assert not loaded & {"pymoo", "hydra", "omegaconf", "matplotlib", "rich", "pandas", "xarray", "shapely"}


@pytest.mark.slow
def test_drawing_a_foot_needs_no_optimiser_and_no_pyplot():
    loaded = loaded_after("import footopt as fo; fo.plot(fo.Foot.flat())")
    assert "matplotlib" in loaded
    assert not {"matplotlib.pyplot", "pymoo", "pandas", "xarray"} & loaded


def test_every_public_name_is_there_and_documented():
    for name in footopt.__all__:
        assert getattr(footopt, name) is not None, name
        assert name in dir(footopt)
        assert name == "__version__" or getattr(footopt, name).__doc__, name
