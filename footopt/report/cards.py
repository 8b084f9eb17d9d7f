"""Cards of walks, feet and so on in a notebook, from the first import of footopt there."""

from importlib import import_module
from typing import Any

KINDS = (
    "design.result.SearchResult", "foot.foot.Foot", "gait.gait.Gait", "sand.media.Sand",
    "walk.results.Table", "walk.results.Walk", "walk.scene.Scene",
)  # fmt: skip


def register(shell: Any) -> None:
    """Have IPython's shell show them, for these classes and for those that inherit from them."""
    html = shell.display_formatter.formatters["text/html"]
    for kind in KINDS:  # what draws them is imported when the first one is shown
        html.for_type_by_name(
            *f"footopt.{kind}".rsplit(".", 1), lambda thing: import_module("footopt.report.plot").card(thing)
        )
