"""Time steppers; a new file in this folder is found by itself."""

import pkgutil
from importlib import import_module

# isort: off  In the order of every table: explicit ones first, then by order.
from footopt.walk.steppers import explicit as explicit
from footopt.walk.steppers import implicit_euler as implicit_euler
from footopt.walk.steppers import sdirk2 as sdirk2
from footopt.walk.steppers import semi_implicit_euler as semi_implicit_euler
from footopt.walk.steppers.base import STEPPERS, Stepper, acceleration, accumulate, advance, explicit_contact
from footopt.walk.steppers.base import finish_step as finish_step
from footopt.walk.steppers.explicit import runge_kutta as runge_kutta

# isort: on

__all__ = [
    "STEPPERS",
    "Stepper",
    "acceleration",
    "accumulate",
    "advance",
    "explicit_contact",
    "finish_step",
    "runge_kutta",
]

for _module in pkgutil.iter_modules(__path__):
    import_module(f"{__name__}.{_module.name}")
