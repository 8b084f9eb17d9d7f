"""Settings that the tests of the paper's study share."""

from footopt.studies import Paper
from footopt.studies.paper.walks import changed
from footopt.studies.settings import Config

HOLLOW = (5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4)
ROCKER = (1, 3, 5, 7, 8, 9, 9, 9, 9, 9, 9)


def config(**settings):
    """The default settings, some of them changed by their names on the command line."""
    found = Config(study=Paper())
    for name, value in settings.items():
        found = changed(found, name.replace("__", "."), value)
    return found
