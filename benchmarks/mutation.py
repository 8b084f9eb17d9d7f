"""Whether the tests notice a mistake: lines of the physics and of the search are broken, one at a time.

python benchmarks/mutation.py                # 60 mutations, about an hour of a core
python benchmarks/mutation.py --only 7 12    # some of them again

Lines are drawn by a seed from the rooms below. On a line an operator, a sign, a comparison, a constant or an
index is changed, or a statement is left out. In a copy of the checkout the default tests of the room run
first, the others only if these pass. A test that fails, or a run beyond the limit, catches the mutation.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parents[1]
#: The rooms that are broken, and where the tests of each are; of a walk's, one that compiles little is first.
PHYSICS = ["physics"]
ROOMS = {"sand": PHYSICS, "effects": PHYSICS, "gait": PHYSICS, "walk": ["walk/test_identity.py", "walk"],
         "design": ["search"]}  # fmt: skip
LIMIT = 900.0  # s, for the tests of one mutation
GUARDS = ("strict", "frozen", "overwrite_a", "nogil", "repr")  # keywords
SWAPS = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult,
    ast.FloorDiv: ast.Mult, ast.Mod: ast.Mult, ast.Lt: ast.GtE, ast.GtE: ast.Lt, ast.Gt: ast.LtE,
    ast.LtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is,
    ast.In: ast.NotIn, ast.NotIn: ast.In, ast.And: ast.Or, ast.Or: ast.And, ast.USub: ast.UAdd,
}  # fmt: skip


def mutations(node: ast.AST) -> Iterator[tuple[ast.AST, ast.AST, str, Any]]:
    """Every mutation below a node: the part that changes, and whose field gets which value.

    Types, texts, defaults, errors and guards that change no result are left as they are.
    """
    if isinstance(node, ast.JoinedStr | ast.Raise | ast.arguments):
        return
    if isinstance(node, ast.keyword) and node.arg in GUARDS:
        return
    if isinstance(node, ast.BinOp | ast.BoolOp | ast.UnaryOp | ast.AugAssign) and type(node.op) in SWAPS:
        yield node, node, "op", SWAPS[type(node.op)]()
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        yield node, node, "ops", [SWAPS[type(node.ops[0])]()]
    if isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield node, node, "value", not node.value
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        yield node, node, "value", 2 * node.value if node.value > 1 else node.value + 1
    for name, field in ast.iter_fields(node):
        if name in ("annotation", "returns"):
            continue
        for i, part in enumerate(field if isinstance(field, list) else [field]):
            call = isinstance(part, ast.Expr) and isinstance(part.value, ast.Call)
            if call or isinstance(part, ast.AugAssign):
                yield part, node, name, [*field[:i], ast.Pass(), *field[i + 1 :]]
            if isinstance(part, ast.AST):
                yield from mutations(part)


def drawn(count: int, seed: int) -> list[tuple[Path, int, str, str, str]]:
    """Mutations of so many random lines: file, line, what it was and is, and the text of the broken file."""
    texts = {p: p.read_text(encoding="utf-8") for r in ROOMS for p in (HERE / "footopt" / r).rglob("*.py")}
    places: dict[tuple[Path, int], list[int]] = {}
    for path in sorted(texts):
        for n, (part, *_) in enumerate(mutations(ast.parse(texts[path]))):
            places.setdefault((path, part.lineno), []).append(n)
    rng, found = random.Random(seed), []
    for path, line in rng.sample(sorted(places), count):
        tree = ast.parse(texts[path])
        part, owner, field, value = [*mutations(tree)][rng.choice(places[path, line])]
        was = ast.unparse(part)
        setattr(owner, field, value)
        now = "left out" if part is not owner else ast.unparse(part)
        found.append((path.relative_to(HERE), line, was, now, ast.unparse(tree) + "\n"))
    return found


def failed(copy: Path, rooms: list[str]) -> str:
    """The first default test that fails in a copy, or nothing. Compiled code is kept by its sources."""
    options = ["-x", "-n", "0", "-p", "no:cacheprovider", "--tb=no", "-rfE"]
    command = [sys.executable, "-m", "pytest", *options, *(f"tests/{room}" for room in rooms)]
    env = os.environ | {"PYTHONPATH": str(copy), "NUMBA_CACHE_DIR": str(copy / "compiled")}
    try:
        run = subprocess.run(command, cwd=copy, env=env, text=True, capture_output=True, timeout=LIMIT)
    except subprocess.TimeoutExpired:
        return "the limit"
    said = [line.split(" - ")[0] for line in run.stdout.splitlines() if line[:6] in ("FAILED", "ERROR ")]
    return said[0] if said else "an error of pytest" if run.returncode else ""


def main() -> None:
    """Print a line for each mutation, and how many were caught."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=60, help="of mutations")
    parser.add_argument("--seed", type=int, default=1, help="of the lines")
    parser.add_argument("--only", type=int, nargs="+", help="numbers of some of them")
    given = parser.parse_args()
    chosen = given.only or range(1, given.count + 1)
    found, caught = drawn(given.count, given.seed), 0
    rooms = sorted({test.parent.name for test in (HERE / "tests").glob("*/test_*.py")})
    rooms += sorted(test.name for test in (HERE / "tests").glob("test_*.py"))
    rooms.sort(key=lambda room: [room] not in [own[-1:] for own in ROOMS.values()])
    print("| | place | was | is | caught by |\n| --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "footopt"
        shutil.copytree(HERE, copy, ignore=shutil.ignore_patterns(".*", "__pycache__", "build"))
        for number in chosen:
            path, line, was, now, text = found[number - 1]
            (copy / path).write_text(text, encoding="utf-8")
            own = ROOMS[path.parts[1]]
            stages = [*([room] for room in own), [room for room in rooms if room not in own]]
            by = next(filter(None, (failed(copy, stage) for stage in stages)), "")
            caught += bool(by)
            print(f"| {number} | {path}:{line} | `{was}` | `{now}` | {by or '**nothing**'} |", flush=True)
            shutil.copy2(HERE / path, copy / path)
    print(f"\n{caught} of {len(chosen)} are caught.")


if __name__ == "__main__":
    main()
