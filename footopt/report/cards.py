"""Cards of walks, feet and so on in a notebook, from the first import of footopt there."""

from typing import Any

KINDS = (
    "design.result.SearchResult", "foot.foot.Foot", "gait.gait.Gait", "sand.media.Sand",
    "walk.results.Table", "walk.results.Walk", "walk.scene.Scene",
)  # fmt: skip


def card(thing: object) -> str:
    """HTML of an object; what draws it is imported when the first one is shown."""
    from footopt.report.plot import card

    return card(thing)


def register(shell: Any) -> None:
    """Have IPython's shell show them, for these classes and for those that inherit from them."""
    html = shell.display_formatter.formatters["text/html"]
    for kind in KINDS:
        html.for_type_by_name(*f"footopt.{kind}".rsplit(".", 1), card)
