"""Cards of walks, feet and so on in a notebook, from the first import of footopt there."""

from __future__ import annotations

import sys


def card(thing: object) -> str:
    """HTML of an object; what draws it is imported when the first one is shown."""
    from footopt.report.plot import card

    return card(thing)


_html = sys.modules["IPython"].get_ipython().display_formatter.formatters["text/html"]
for _kind in (
    "design.result.SearchResult",
    "foot.foot.Foot",
    "gait.gait.Gait",
    "sand.media.Sand",
    "walk.results.Table",
    "walk.results.Walk",
    "walk.scene.Scene",
):
    _html.for_type_by_name(*f"footopt.{_kind}".rsplit(".", 1), card)  # and classes that inherit from it
