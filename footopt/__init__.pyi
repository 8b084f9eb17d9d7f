"""Public names, which footopt imports when they are first used."""

from footopt import mujoco as mujoco
from footopt.cli.main import run as run
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
from footopt.files.soles import read_foot as read_foot
from footopt.files.tables import read_sand as read_sand
from footopt.foot import Foot as Foot
from footopt.foot import Waypoints as Waypoints
from footopt.gait import Gait as Gait
from footopt.report.film import animate as animate
from footopt.report.plot import plot as plot
from footopt.report.summary import load_all as load_all
from footopt.sand import Sand as Sand
from footopt.sand import StressMap as StressMap
from footopt.sand import stress as stress
from footopt.studies.runs import Run as Run
from footopt.studies.runs import load as load
from footopt.walk import Accuracy as Accuracy
from footopt.walk import FunctionSimulator as FunctionSimulator
from footopt.walk import Scene as Scene
from footopt.walk import Simulator as Simulator
from footopt.walk import Table as Table
from footopt.walk import Tolerance as Tolerance
from footopt.walk import Walk as Walk
from footopt.walk import Walker as Walker
from footopt.walk import estimate_error as estimate_error
from footopt.walk import evaluate as evaluate
from footopt.walk import simulate as simulate

__version__: str
