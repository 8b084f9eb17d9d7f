"""A user's own functions and types: what a walk with them depends on, and its compiled functions."""

import ast
import dis
import hashlib
import inspect
import marshal
import os
import pickle
import re
import site
import sys
import sysconfig
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache, partial
from itertools import accumulate
from numbers import Number
from pathlib import Path
from types import CodeType
from typing import Any, NamedTuple

import numpy as np
from numba import config

from footopt.compiled import cached_njit, wide_njit
from footopt.effects.base import HOOKS
from footopt.errors import check

PLAIN = (Number, str, tuple, np.ndarray)
#: Folders of footopt and of installed packages, whose versions stand for their code.
FOLDERS = (
    Path(__file__).parents[1],
    sysconfig.get_path("stdlib"),
    *set(site.getsitepackages()) - {sys.prefix, sys.base_prefix},  # on Windows, as all that is below them
    site.getusersitepackages(),
)
INSTALLED = tuple(f"{folder}{os.sep}" for folder in FOLDERS)


def is_own(thing: Any) -> bool:
    """Whether a type or function is a user's, not footopt's."""
    return not thing.__module__.startswith("footopt.")


def own_line(text: str) -> str:
    """The first line of a user's own file that an error of numba names; "" if there is none."""
    for name, line in re.findall(r'File "([^"]+)", line (\d+)', text):
        if not str(Path(name).resolve()).startswith(INSTALLED):
            return f"{name}, line {line}"
    return ""


def own_code(laws: Sequence[Any], stepper: Any = None) -> tuple[Any, ...]:
    """The user's own types and functions among those that a walk with some effects and a stepper needs."""
    hooks = [getattr(type(law), hook) for law in laws for hook in HOOKS if hasattr(law, hook)]
    step = () if stepper is None else (type(stepper), type(stepper).step)
    return tuple(filter(is_own, (*step, *map(type, laws), *hooks)))


class Imported(NamedTuple):
    """A user's file as it was when it was imported, or first asked for: an edit counts once it is again."""

    there: Mapping[str, Any]  # its variables
    spec: Any  # another one after importlib.reload
    source: bytes
    data: dict[str, tuple[Any, bytes]]  # variables that its functions read and that are not `PLAIN`, by name


_IMPORTED: dict[str, Imported] = {}  # by path


def imported(there: Mapping[str, Any], path: str) -> Imported:
    """A user's module, or script, by its variables, with its file at a path."""
    known, spec = _IMPORTED.get(path), there.get("__spec__")
    if known is None or known.there is not there or known.spec is not spec:
        source = Path(path).read_bytes()
        names = {name for one in _functions(there, there) for name in _names(one.__code__, "LOAD_GLOBAL")}
        data = {name: (there.get(name), _content(there.get(name))) for name in names}
        known = _IMPORTED[path] = Imported(there, spec, source, data)
    return known


def _content(one: Any) -> bytes:
    """What a variable holds that is not `PLAIN`; nothing of code, random numbers, and what has no pickle."""
    drawn = type(one).__module__.partition(".")[0] == "random" or isinstance(one, np.random.Generator)
    if drawn or isinstance(one, PLAIN) or hasattr(one, "__name__"):  # as code has
        return b""
    with suppress(Exception):
        return pickle.dumps(sorted(one, key=repr) if isinstance(one, set | frozenset) else one)
    return b""


def _functions(some: Mapping[str, Any], there: Mapping[str, Any]) -> Iterator[Any]:
    """The functions and methods among some variables that are of a module, by its variables."""
    for one in list(some.values()):
        for part in list(vars(one).values()) if isinstance(one, type) else [one]:
            code = getattr(part, "fget", getattr(part, "__func__", part))  # of properties, class methods
            if inspect.isfunction(code) and code.__globals__ is there:
                yield code


def source_of(thing: Any) -> bytes:
    """The file of a function or type, and the user's files that it imports; its code if it has no file."""
    try:
        there = getattr(thing, "__globals__", None) or vars(sys.modules[thing.__module__])
        return b"".join(sources(there, inspect.getfile(thing)).values())
    except (OSError, TypeError, KeyError):
        # version 2 marks no object by how often it is in use
        parts = vars(thing).values() if isinstance(thing, type) else [thing]
        return b"".join(marshal.dumps(part.__code__, 2) for part in parts if hasattr(part, "__code__"))


def sources(there: Mapping[str, Any], path: str) -> dict[str, bytes]:
    """The file of a user's module, by its variables, and those that it imports, as they were, by path."""
    files = {path: imported(there, path).source}
    _read_imported(there, path, files)
    return files


def _read_imported(there: Mapping[str, Any], path: str, files: dict[str, bytes]) -> None:
    """Read the files of a user's modules that a module with its file at a path imports, and so on."""
    for node in _statements(files[path]):
        names = [one.name for one in node.names] if isinstance(node, ast.Import) else []
        if isinstance(node, ast.ImportFrom):
            package = there["__package__"].split(".")[: -node.level + 1 or None] if node.level else []
            within = [*package, *filter(None, [node.module])]
            names = [".".join([*within, one.name]) for one in node.names]
        for name in (part for full in names for part in accumulate(full.split("."), "{}.{}".format)):
            place = getattr(sys.modules.get(name), "__file__", None) or ""
            if place.endswith(".py") and not place.startswith(INSTALLED) and place not in files:
                inner = vars(sys.modules[name])
                files[place] = imported(inner, place).source
                _read_imported(inner, place, files)


@lru_cache(maxsize=64)
def _statements(code: bytes) -> tuple[ast.AST, ...]:
    return tuple(_at_import(code))


def _at_import(code: Any) -> Iterator[ast.AST]:
    """The nodes that run when a module is imported, in every process: not those inside its functions."""
    with suppress(SyntaxError, ValueError):  # of a file that is being edited: text has no children
        code = ast.parse(code) if isinstance(code, bytes) else code
    for child in ast.iter_child_nodes(code) if isinstance(code, ast.AST) else ():
        if not isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef, ast.expr)):
            yield child
            yield from _at_import(child)


@lru_cache(maxsize=32)
def _compiled(function: Callable[..., Any], key: Any, compiler: Callable[..., Any]) -> Any:
    """A function, compiled anew for every key."""
    return compiler(nogil=True, error_model="numpy")(function)


def compiled_for(function: Callable[..., Any], laws: Sequence[Any], stepper: Any = None) -> Any:
    """A function that takes the laws of effects, compiled.

    With a user's own effect or stepper it is not cached on disk: every process reads that cache, and not all
    of them can import the user's types. It is compiled again after they are edited, or what they read is.
    """
    check(not config.DISABLE_JIT, "NUMBA_DISABLE_JIT", config.DISABLE_JIT, "0: only compiled code walks")
    own = own_code(laws, stepper)
    return _compiled(function, (own, *map(fingerprint, own)), wide_njit if own else cached_njit)


def fingerprint(own: Any, within: tuple[Any, ...] = ()) -> tuple[str, str]:
    """Of a user's type or function the name, and a digest of its file and of what is bound to it."""
    inner = own.func if isinstance(own, partial) else own
    named = inner if hasattr(inner, "__qualname__") else type(inner)
    digest = hashlib.sha256(source_of(named))
    bound: list[Any] = [own.args, own.keywords] if isinstance(own, partial) else []
    bound += [cell.cell_contents for cell in getattr(inner, "__closure__", None) or ()]
    bound += [getattr(inner.__self__, "__dict__", None)] if inspect.ismethod(inner) else []
    kinds = filter(is_own, named.__mro__) if isinstance(named, type) else ()
    methods = (one for kind in kinds for one in vars(kind).values())
    for function in filter(inspect.isfunction, (getattr(inner, "__func__", inner), *methods)):
        bound += _read(function)
    within = (*within, inner)
    for one in filter(inspect.isfunction, bound):  # a function's own, and not itself again
        digest.update(b"" if one in within else fingerprint(one, within)[1].encode())
    kept = [getattr(inner, name, None) for name in ("__defaults__", "__kwdefaults__")]
    for one in [*bound, *kept, *([] if named is inner else [getattr(inner, "__dict__", None)])]:
        with suppress(Exception):  # what cannot be pickled is a function, whose file says what it does
            digest.update(pickle.dumps(one))
    module = "__main__" if named.__module__ == "__mp_main__" else named.__module__  # a worker's name of it
    return f"{module}.{named.__qualname__}", digest.hexdigest()


def _read(function: Any) -> list[Any]:
    """What a function reads of its module: of a notebook all, of a file what a script may change in it.

    These are the numbers, texts, tuples and arrays that it, and the functions and classes there that it uses,
    read and that none sets. Others, such as lists and dictionaries, often keep what has been computed: one
    counts as it was when the file was imported, until the name stands for another one.
    """
    there = function.__globals__
    if "__file__" not in there:
        return [there.get(name) for name in _names(function.__code__, "LOAD_GLOBAL")]
    kept = {name for one in _functions(there, there) for name in _names(one.__code__, "STORE_GLOBAL")}
    read, todo = dict[str, Any](), [function]
    while todo:
        new = {k: there.get(k) for k in _names(todo.pop().__code__, "LOAD_GLOBAL") if k not in read}
        todo += _functions(new, there)
        read |= new
    known = _IMPORTED.get(function.__code__.co_filename)
    left = {} if known is None else known.data
    read = {k: one for k, one in read.items() if k not in kept and k[:2] != "__"}
    seen = {k: left[k][1] for k, one in read.items() if k in left and left[k][0] is one}
    return [one if isinstance(one, PLAIN) else seen.get(k) or _content(one) for k, one in read.items()]


@lru_cache(maxsize=1024)
def _names(code: CodeType, how: str) -> tuple[str, ...]:
    """The names of a module that code, and functions within it, load or store."""
    found = dict.fromkeys(one.argval for one in dis.get_instructions(code) if one.opname == how)
    within = (_names(inner, how) for inner in code.co_consts if isinstance(inner, CodeType))
    return (*found, *(name for names in within for name in names))
