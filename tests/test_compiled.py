"""Compiled code is kept on disk by what it is compiled from."""

import sys
from pathlib import Path

import numpy as np
from numba import njit
from numba.core.registry import cpu_target

import footopt
import footopt as fo
from footopt import compiled
from footopt.walk.loop import walk_designs
from footopt.walk.own_code import compiled_for, fingerprint


def test_every_module_that_a_walk_is_compiled_from_is_part_of_its_key():
    """Those that the compiled loop names, directly or not; messages are not compiled."""
    from footopt.walk import loop

    house = Path(footopt.__file__).parent
    keyed = {path for name in compiled.SOURCES for path in (house / name).rglob("*.py")}
    walked, left = set(), [loop]
    while left:
        module = left.pop()
        if module not in walked:
            walked.add(module)
            homes = (sys.modules.get(getattr(thing, "__module__", "")) for thing in vars(module).values())
            left += [home for home in homes if home and home.__name__.startswith("footopt.")]
    found = {Path(module.__file__) for module in walked} - {house / "errors.py", Path(compiled.__file__)}
    assert house / "sand" / "law.py" in found
    assert house / "gait" / "__init__.py" in keyed  # not compiled, but what a stored design is made of
    assert found <= keyed, found - keyed


def test_whole_registers_are_filled_where_there_are_some_and_only_by_footopt():
    def square(x):
        total = 0.0
        for value in x:
            total += value * value
        return total

    codegen = cpu_target.target_context.codegen()
    usual, (*_, features) = codegen._tm, codegen.magic_tuple()
    ours = compiled.wide_njit(fastmath=True)(square)
    assert ours(np.ones(100)) == 100.0
    assert ("zmm" in ours.inspect_asm(ours.signatures[0])) == ("+avx512f" in features)
    assert codegen._tm is usual


def test_a_function_that_compiled_code_calls_can_still_be_called_from_python():
    """Only those that cannot have no machine code of their own."""
    doubled = njit(lambda x: 2.0 * x)
    tripled = compiled.inlined(lambda x: 3.0 * x)
    codegen = cpu_target.target_context.codegen()
    usual = codegen._library_class
    assert compiled.wide_njit(lambda x: doubled(tripled(x)))(1.0) == 6.0
    assert len(doubled.signatures) == 1
    assert (doubled(2.0), tripled(2.0)) == (4.0, 6.0)
    assert len(doubled.signatures) == 1
    assert codegen._library_class is usual


def test_one_walk_is_compiled_for_every_plausible_law_of_the_sand():
    walk, feet = compiled_for(walk_designs, ()), fo.Waypoints().random(2, seed=1)
    fo.evaluate(feet, fo.Scene(), "draft")
    compiled_before = walk.signatures
    for effects in [(fo.LeadingEdge(),), (fo.Shadowing(),), (fo.LeadingEdge(), fo.Shadowing())]:
        fo.evaluate(feet, fo.Scene(effects=effects), "draft")
        assert walk.signatures == compiled_before


def test_walks_of_several_threads_go_on_side_by_side():
    """Compiled code lets go of Python's lock."""
    assert compiled_for(walk_designs, ()).targetoptions["nogil"]


def test_a_source_that_was_changed_has_its_code_elsewhere_in_a_folder_of_the_user_alone(
    tmp_path, monkeypatch
):
    monkeypatch.setattr(compiled.config, "CACHE_DIR", str(tmp_path / "kept"))
    made = compiled.cache_folder.__wrapped__
    before = Path(made())
    assert (before.parent, before.stat().st_mode & 0o777) == (tmp_path / "kept", 0o700)
    assert Path(made()) == before
    read = Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda p: read(p) + b"#" * (p.parts[-2:] == ("sand", "law.py")))
    assert Path(made()) != before


def test_without_a_cache_folder_the_code_is_compiled_all_the_same(tmp_path, monkeypatch, caplog):
    (tmp_path / "file").touch()
    monkeypatch.setattr(compiled.config, "CACHE_DIR", str(tmp_path / "file"))
    monkeypatch.setattr(compiled, "cache_folder", compiled.cache_folder.__wrapped__)
    assert compiled.cached_njit(nogil=True)(lambda x: x + 1)(1) == 2
    assert "NUMBA_CACHE_DIR" in caplog.text


def test_an_effect_of_a_user_that_was_edited_is_compiled_again(tmp_path):
    """In a file or typed into a session."""

    def loaded(text):
        path = tmp_path / "mine.py"
        path.write_text(text)
        namespace = {}
        exec(compile(text, str(path), "exec"), namespace)
        return namespace["hook"]

    first = fingerprint(loaded("def hook(a):\n    return a\n"))
    second = fingerprint(loaded("def hook(a):\n    return 2 * a\n"))
    typed = [fingerprint(eval(f"lambda a: {n} * a")) for n in (1, 2)]
    assert len({first, second, *typed}) == 4
