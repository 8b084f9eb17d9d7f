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

import footopt.walk

#: Names that are None where a scene has no effect that needs them, besides a test on `column`, a row of
#: directions.
ABSENT = {"loads", "gates", "pushes", "all_tx", "tilt", "column"}
SOURCES = ("contact", "steppers", "loop")


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
    package.mkdir()
    (package / "__init__.py").touch()
    for source in SOURCES:
        text = (Path(footopt.walk.__file__).parent / f"{source}.py").read_text(encoding="utf-8")
        tree: ast.AST = ast.parse(text.replace("footopt.walk", name))
        if delete:
            tree = Delete().visit(tree)
        (package / f"{source}.py").write_text(ast.unparse(tree), encoding="utf-8")


def load(folder: Path, name: str = "footopt_deleted") -> ModuleType:
    """The loop of a package that `write` has written."""
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module(f"{name}.loop")
    finally:
        sys.path.remove(str(folder))


@contextmanager
def walking(loop: ModuleType) -> Iterator[None]:
    """footopt walks by another package's loop."""
    simulate = sys.modules["footopt.walk.simulate"]
    with patch.multiple(simulate, walk_range=loop.walk_range, STEPPERS=loop.steppers.STEPPERS):
        yield
