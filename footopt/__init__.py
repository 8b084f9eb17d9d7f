"""footopt: design feet for bipeds that walk on sand.

    import footopt as fo

    scene = fo.Scene(sand=fo.Sand.named("hard"))
    walk = fo.simulate(fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4]), scene)
    walk.objectives

Public names are imported when first used, so that importing footopt is cheap.
"""

from __future__ import annotations

import os
import sys

TYPE_CHECKING = False  # imports take time in which Ctrl-C still falls before `footopt.__main__`
if TYPE_CHECKING:
    from typing import Any

    from footopt import mujoco as mujoco
    from footopt.cli.run import run as run
    from footopt.design import FootProblem as FootProblem
    from footopt.design import RobustProblem as RobustProblem
    from footopt.design import Scenario as Scenario
    from footopt.design import SearchResult as SearchResult
    from footopt.design import Spread as Spread
    from footopt.design import draw as draw
    from footopt.design import search as search
    from footopt.effects import Inertia as Inertia
    from footopt.effects import Layers as Layers
    from footopt.effects import LeadingEdge as LeadingEdge
    from footopt.effects import Patches as Patches
    from footopt.effects import Rest as Rest
    from footopt.effects import Shadowing as Shadowing
    from footopt.effects import Slope as Slope
    from footopt.errors import FootoptError as FootoptError
    from footopt.files.feet import write_foot as write_foot
    from footopt.files.gaits import fit_gait as fit_gait
    from footopt.files.gaits import read_gait as read_gait
    from footopt.files.sands import read_sand as read_sand
    from footopt.files.soles import read_foot as read_foot
    from footopt.foot import Foot as Foot
    from footopt.foot import Waypoints as Waypoints
    from footopt.gait import Gait as Gait
    from footopt.report.film import animate as animate
    from footopt.report.plot import plot as plot
    from footopt.sand import Sand as Sand
    from footopt.sand import StressMap as StressMap
    from footopt.sand import stress as stress
    from footopt.studies.runs import Run as Run
    from footopt.studies.runs import load as load
    from footopt.studies.runs import load_all as load_all
    from footopt.walk import Accuracy as Accuracy
    from footopt.walk import Scene as Scene
    from footopt.walk import Table as Table
    from footopt.walk import Walk as Walk
    from footopt.walk import Walker as Walker
    from footopt.walk import estimate_error as estimate_error
    from footopt.walk import evaluate as evaluate
    from footopt.walk import simulate as simulate

__version__ = "0.2.0.dev0"

_NAMES = {
    "footopt.cli.run": "run",
    "footopt.design": "FootProblem RobustProblem Scenario SearchResult Spread draw search",
    "footopt.effects": "Inertia Layers LeadingEdge Patches Rest Shadowing Slope",
    "footopt.errors": "FootoptError",
    "footopt.files.feet": "write_foot",
    "footopt.files.gaits": "fit_gait read_gait",
    "footopt.files.sands": "read_sand",
    "footopt.files.soles": "read_foot",
    "footopt.foot": "Foot Waypoints",
    "footopt.gait": "Gait",
    "footopt.mujoco": "mujoco",
    "footopt.report.film": "animate",
    "footopt.report.plot": "plot",
    "footopt.sand": "Sand StressMap stress",
    "footopt.studies.runs": "Run load load_all",
    "footopt.walk": "Accuracy Scene Table Walk Walker estimate_error evaluate simulate",
}
_HOME = {name: module for module, names in _NAMES.items() for name in names.split()}

#: Classes that notebooks show as a card, and those that inherit from them.
_SHOWN = """
footopt.design.result.SearchResult footopt.foot.foot.Foot footopt.gait.gait.Gait footopt.sand.media.Sand
footopt.walk.results.Table footopt.walk.results.Walk footopt.walk.scene.Scene
"""

__all__ = ["__version__", *sorted(_HOME)]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'footopt' has no attribute {name!r}")
    from importlib import import_module

    module = import_module(_HOME[name])
    value = module if name == "mujoco" else getattr(module, name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__


# Hydra looks for pkg://footopt.conf, which is inside this package in a wheel, and beside it in a checkout
_here = os.path.dirname(__file__)
if not os.path.isdir(os.path.join(_here, "conf")):
    __path__.append(os.path.dirname(_here))


def load_ipython_extension(shell: Any) -> None:
    """Show cards of walks, feet and so on in IPython; importing footopt there does so, too."""

    def card(thing: object) -> str:
        from footopt.report.plot import card

        return card(thing)

    formatter = shell.display_formatter.formatters["text/html"]
    for name in _SHOWN.split():
        formatter.for_type_by_name(*name.rsplit(".", 1), card)


if "IPython" in sys.modules and (_shell := sys.modules["IPython"].get_ipython()) is not None:
    load_ipython_extension(_shell)
