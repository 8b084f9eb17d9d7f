"""Compiled code is kept on disk where there is a place for it, and its absence is no crash."""

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
