"""Effects beyond the plain law, one file each; a new file in this folder is imported automatically.

They act in the order of `EFFECTS`, footopt's own first: layers give a depth that patches multiply.
"""

import pkgutil
from importlib import import_module

from footopt.effects.base import EFFECTS, Effect, bristle_length, laws, name_of, parameters, reshaping
from footopt.effects.inertia import Inertia
from footopt.effects.layers import Layers
from footopt.effects.leading_edge import LeadingEdge
from footopt.effects.patches import Patches
from footopt.effects.rest import Rest
from footopt.effects.shadowing import Shadowing
from footopt.effects.slope import Slope

__all__ = [
    "EFFECTS", "Effect", "Inertia", "Layers", "LeadingEdge", "Patches", "Rest", "Shadowing", "Slope",
    "bristle_length", "laws", "name_of", "parameters", "reshaping",
]  # fmt: skip

for _module in pkgutil.iter_modules(__path__):
    import_module(f"{__name__}.{_module.name}")
