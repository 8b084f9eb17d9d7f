"""Compiled code is kept on disk where there is a place for it, and its absence is no crash."""

import os
import subprocess
import sys

import pytest

from footopt import compiled


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
