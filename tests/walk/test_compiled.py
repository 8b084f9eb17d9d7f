"""Compiled code is kept on disk where there is a place for it, and its absence is no crash."""

import importlib.util
import os
import pickle
import random
import resource
import subprocess
import sys
from pathlib import Path

import pytest
from running import tries

import footopt
from footopt import compiled

KEPT = """
from footopt.compiled import cached_njit

@cached_njit()
def doubled(x):
    return 2.0 * x

@cached_njit()
def halved(x):
    return 0.5 * x
"""


@pytest.fixture
def fresh(tmp_path, monkeypatch):
    """Makes the module of KEPT as a new process would, with one place for its compiled code."""
    path = tmp_path / "kept.py"
    path.write_text(KEPT)
    os.utime(path, (1e9, 1e9))

    def load():
        spec = importlib.util.spec_from_file_location("kept", path)
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, "kept", module)
        spec.loader.exec_module(module)
        return module

    return load


def kept_file(function):
    (path,) = Path(compiled.kept(function)[0]).glob(f"*{function.__name__}*.nbc")
    return path


def damaged(content, seed):
    """Content cut, with a bit flipped, or with a part overwritten."""
    draw = random.Random(seed)
    at = draw.randrange(len(content))
    if seed % 3 == 0:
        return content[:at]
    if seed % 3 == 1:
        return content[:at] + bytes([content[at] ^ 1 << draw.randrange(8)]) + content[at + 1 :]
    other = draw.randbytes(draw.randrange(1, 1000))
    return content[:at] + other + content[at + len(other) :]


def test_without_a_cache_folder_the_code_is_compiled_all_the_same(monkeypatch, caplog):
    def refuse(cache=False, **options):
        def decorate(function):
            if cache:
                raise RuntimeError("cannot cache function: no locator available")
            return function

        return decorate

    monkeypatch.setattr(compiled, "njit", refuse)
    assert compiled.cached_njit(nogil=True)(lambda x: x + 1)(1) == 2
    assert "NUMBA_CACHE_DIR" in caplog.text


def test_a_users_own_functions_are_part_of_what_compiled_code_is_cached_by(tmp_path):
    """An edited effect or stepper is compiled again, in a file or typed into a session."""
    from footopt.walk.sources import digest_of

    def loaded(text):
        path = tmp_path / "mine.py"
        path.write_text(text)
        namespace = {}
        exec(compile(text, str(path), "exec"), namespace)
        return namespace["hook"]

    first = digest_of((loaded("def hook(a):\n    return a\n"),))
    second = digest_of((loaded("def hook(a):\n    return 2 * a\n"),))
    typed = [eval(f"lambda a: {n} * a") for n in (1, 2)]
    digests = {digest_of(()), first, second, *(digest_of((f,)) for f in typed)}
    assert len(digests) == 5


def test_a_walk_is_compiled_again_once_any_module_that_it_is_compiled_from_has_changed():
    """Every module of footopt that the compiled loop names is part of its key; messages are not compiled."""
    from footopt.walk import loop, sources

    house = Path(footopt.__file__).parent
    keyed = {path for name in sources.COMPILED for path in [house / name, *(house / name).rglob("*.py")]}
    walked, left = set(), [loop]
    while left:
        module = left.pop()
        if module not in walked:
            walked.add(module)
            homes = (sys.modules.get(getattr(thing, "__module__", "")) for thing in vars(module).values())
            left += [home for home in homes if home and home.__name__.startswith("footopt.")]
    found = {Path(module.__file__) for module in walked} - {house / "errors.py"}
    assert house / "walk" / "contact.py" in found
    assert found <= keyed, found - keyed


@pytest.mark.slow
def test_kept_code_of_types_that_have_moved_is_compiled_again(tmp_path):
    """As after an update that moved a class: what is kept names a module that is no more."""
    caller = """
import numba
from footopt.compiled import cached_njit
from {module} import Pair

@cached_njit()
def total(pair):
    return pair.a + pair.b

print(total(Pair(1.0, 2.0)), sum(total.stats.cache_hits.values()))
"""
    law = "from typing import NamedTuple\n\nclass Pair(NamedTuple):\n    a: float\n    b: float\n"
    environment = os.environ | {"PYTHONDONTWRITEBYTECODE": "1", "NUMBA_CACHE_DIR": str(tmp_path / "kept")}
    environment["PYTHONPATH"] = os.pathsep.join(
        [str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])]
    )

    def run(module):
        (tmp_path / f"{module}.py").write_text(law)
        path = tmp_path / "caller.py"
        path.write_text(caller.format(module=module))
        os.utime(path, (1e9, 1e9))  # numba knows a source by its time and size
        done = subprocess.run(
            [sys.executable, path], env=environment, capture_output=True, text=True, check=True
        )
        return done.stdout.split()

    assert run("law_a") == ["3.0", "0"]
    assert run("law_a") == ["3.0", "1"]
    (tmp_path / "law_a.py").unlink()
    assert run("law_b") == ["3.0", "0"]
    assert run("law_b") == ["3.0", "1"]


def test_kept_code_that_is_damaged_is_never_used(fresh):
    function = fresh().doubled
    assert function(3.0) == 6.0
    path, cache = kept_file(function), function._cache._cache_file
    (known, _) = pickle.loads((whole := path.read_bytes())[64:])
    assert cache.load(known) is not None
    for seed in range(tries(300)):
        path.write_bytes(damaged(whole, seed))
        assert cache.load(known) is None, seed


@pytest.mark.parametrize("seed", range(min(tries(3), 60)))
def test_damage_of_kept_code_is_said_and_mended(fresh, caplog, seed):
    function = fresh().doubled
    function(3.0)
    path = kept_file(function)
    path.write_bytes(damaged(path.read_bytes(), seed))
    again = fresh().doubled
    assert (again(3.0), compiled.kept(again)[1]) == (6.0, 0)
    assert f"compiled code was damaged and is compiled again ({path})" in caplog.text
    healed = fresh().doubled
    assert (healed(3.0), compiled.kept(healed)[1]) == (6.0, 1)


def test_kept_code_of_two_functions_that_is_exchanged_is_seen(fresh, caplog):
    module = fresh()
    assert (module.doubled(3.0), module.halved(3.0)) == (6.0, 1.5)
    one, other = kept_file(module.doubled), kept_file(module.halved)
    first, second = one.read_bytes(), other.read_bytes()
    one.write_bytes(second)
    other.write_bytes(first)
    module = fresh()
    assert (module.doubled(3.0), module.halved(3.0)) == (6.0, 1.5)
    assert caplog.text.count("was damaged") == 2


def test_a_disk_without_room_for_compiled_code_is_named(fresh, caplog):
    module, limits = fresh(), resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, limits[1]))
    try:
        assert module.doubled(3.0) == 6.0
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert "compiled code cannot be kept" in caplog.text
    assert "NUMBA_CACHE_DIR" in caplog.text
