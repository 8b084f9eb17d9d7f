"""One browser for all tests of pages that a process runs."""

import browsers
import pytest


@pytest.fixture(scope="session")
def downloads(tmp_path_factory):
    return tmp_path_factory.mktemp("downloads")


@pytest.fixture(scope="session")
def browser(downloads, tmp_path_factory):
    driver = browsers.start(downloads, tmp_path_factory.mktemp("profile"))
    yield driver
    driver.quit()
