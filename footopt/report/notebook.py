"""Cards in notebooks: IPython is told how to show footopt's objects, without importing any of them yet."""

from __future__ import annotations

from typing import Any

#: Where the classes are that have a card (those that inherit from them have it, too).
CLASSES = {
    "footopt.design.result": ("SearchResult",),
    "footopt.foot.foot": ("Foot",),
    "footopt.gait.gait": ("Gait",),
    "footopt.sand.media": ("Sand",),
    "footopt.walk.results": ("Table", "Walk"),
    "footopt.walk.scene": ("Scene",),
}


def register(shell: Any) -> None:
    """Register the cards with an IPython shell.

    Parameters
    ----------
    shell : IPython.core.interactiveshell.InteractiveShell
        What ``IPython.get_ipython()`` returns.
    """
    formatter = shell.display_formatter.formatters["text/html"]
    for module, names in CLASSES.items():
        for name in names:
            formatter.for_type_by_name(module, name, _card)


def _card(thing: object) -> str:
    from footopt.report.cards import card

    return card(thing)
