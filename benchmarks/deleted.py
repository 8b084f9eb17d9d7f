"""The compiled walk with the effects' code deleted from its source: what an absent effect must cost."""

from __future__ import annotations

import ast
import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from unittest.mock import patch

import footopt.effects.slope
import footopt.walk

#: Names that are None where a scene has no effect that needs them.
ABSENT = {"loads", "gates", "pushes", "tangent", "tilt", "h0", "bristles", "rest"}
SOURCES = ("state", "contact", "standing", "bristles", "newton", "metrics", "sources",
           "loop", "steppers")  # fmt: skip


class Delete(ast.NodeTransformer):
    """Resolve every test ``if name is (not) None`` for the names in `ABSENT`, as if it were None."""

    def visit_If(self, node: ast.If) -> ast.AST | list[ast.stmt] | None:
        """The branch that is taken, in place of the whole."""
        self.generic_visit(node)
        match node.test:
            case ast.Compare(ast.Name(name), [ast.Is()], [ast.Constant(None)]) if name in ABSENT:
                return node.body
            case ast.Compare(ast.Name(name), [ast.IsNot()], [ast.Constant(None)]) if name in ABSENT:
                return node.orelse or None
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        """What comes after a return is not there either."""
        self.generic_visit(node)
        ends = [i for i, line in enumerate(node.body) if isinstance(line, ast.Return)]
        node.body = node.body[: ends[0] + 1] if ends else node.body
        return node


def write(folder: Path, name: str = "footopt_deleted", delete: bool = True) -> None:
    """Write a package like `footopt.walk` into a folder: its compiled part without the effects.

    Parameters
    ----------
    name : of the package. delete : False for a plain copy.
    """
    package = folder / name
    (package / "steppers").mkdir(parents=True)
    (package / "__init__.py").touch()
    walk, slope = Path(footopt.walk.__file__).parent, Path(footopt.effects.slope.__file__)
    files = [path for source in SOURCES for path in (walk / f"{source}.py", *(walk / source).glob("*.py"))]
    for path in (*filter(Path.exists, files), slope):
        text = path.read_text(encoding="utf-8")
        for old in ("footopt.walk", "footopt.effects.slope"):
            text = text.replace(old, name if old == "footopt.walk" else f"{name}.slope")
        text = text.replace('EFFECTS["slope"] = Slope', "")
        tree: ast.AST = ast.parse(text)
        if delete:
            tree = Delete().visit(tree)
        place = package / (path.relative_to(walk) if path != slope else "slope.py")
        place.write_text(ast.unparse(tree), encoding="utf-8")


def load(folder: Path, name: str = "footopt_deleted") -> ModuleType:
    """The loop of a package that `write` has written, with its contact and its steppers."""
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module(f"{name}.loop")
    finally:
        sys.path.remove(str(folder))


@contextmanager
def walking(loop: ModuleType) -> Iterator[None]:
    """footopt walks by another package's loop."""
    simulate = sys.modules["footopt.walk.simulate"]
    steppers = sys.modules[f"{loop.__package__}.steppers"]
    with patch.multiple(simulate, walk_range=loop.walk_range, STEPPERS=steppers.STEPPERS):
        yield
