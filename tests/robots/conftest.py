"""Attaching sand compiles MuJoCo's callback, 6 s in each process that does: such tests are slow."""

import pytest

ATTACH = {"block", "pushed", "request"}


def pytest_collection_modifyitems(items):
    for item in items:
        if item.path.parent.name == "robots" and ATTACH & set(item.fixturenames):
            item.add_marker(pytest.mark.slow)
