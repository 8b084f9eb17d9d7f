"""One browser for the tests of a module."""

import browsers
import pytest


@pytest.fixture(scope="module")
def downloads(tmp_path_factory):
    return tmp_path_factory.mktemp("downloads")


@pytest.fixture(scope="module")
def browser(downloads, tmp_path_factory):
    driver = browsers.start(downloads, tmp_path_factory.mktemp("profile"))
    yield driver
    driver.quit()
