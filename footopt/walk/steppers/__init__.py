"""Time steppers, one file each; a new file in this folder is found by itself."""

import pkgutil
from importlib import import_module

# isort: off  In the order of every table: explicit ones first, then by order.
from footopt.walk.steppers import explicit_euler as explicit_euler
from footopt.walk.steppers import heun as heun
from footopt.walk.steppers import implicit_euler as implicit_euler
from footopt.walk.steppers import rk4 as rk4
from footopt.walk.steppers import sdirk2 as sdirk2
from footopt.walk.steppers import semi_implicit_euler as semi_implicit_euler
from footopt.walk.steppers.base import STEPPERS, STEPS, Stepper, acceleration, add, advance, arrive, register
from footopt.walk.steppers.base import touch as touch

# isort: on

__all__ = ["STEPPERS", "STEPS", "Stepper", "acceleration", "add", "advance", "arrive", "register", "touch"]

for _module in pkgutil.iter_modules(__path__):
    import_module(f"{__name__}.{_module.name}")
