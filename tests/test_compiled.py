"""Compiled code is kept on disk where there is a place for it, and its absence is no crash."""

import os
import subprocess
import sys

import pytest

import footopt
from footopt import compiled

SCRIPT = "import footopt as fo; print(fo.simulate(fo.Foot.flat(), accuracy='draft').objectives['work'])"


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


@pytest.mark.slow
def test_a_package_and_a_home_that_cannot_be_written_still_walk(tmp_path):
    import shutil
    from pathlib import Path

    package = Path(footopt.__file__).parent
    shutil.copytree(package, tmp_path / "footopt", ignore=shutil.ignore_patterns("__pycache__"))
    for folder in ("walker", "foot"):  # a file in the way stops root, too
        (tmp_path / "footopt" / folder / "__pycache__").write_text("")
    home = tmp_path / "home"
    home.write_text("")
    env = {k: v for k, v in os.environ.items() if k not in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME")}
    env |= {"HOME": str(home), "PYTHONPATH": str(tmp_path), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], cwd=tmp_path, env=env, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) > 0
    assert "every start compiles it again" in done.stderr


def test_a_users_own_functions_are_part_of_what_compiled_code_is_cached_by(tmp_path):
    """An edited effect or stepper is compiled again, in a file or typed into a session."""
    from footopt.walker.loop import _source

    def loaded(text):
        path = tmp_path / "mine.py"
        path.write_text(text)
        namespace = {}
        exec(compile(text, str(path), "exec"), namespace)
        return namespace["hook"]

    first = _source((loaded("def hook(a):\n    return a\n"),))
    second = _source((loaded("def hook(a):\n    return 2 * a\n"),))
    typed = [eval(f"lambda a: {n} * a") for n in (1, 2)]
    digests = {_source(()), first, second, *(_source((f,)) for f in typed)}
    assert len(digests) == 5
