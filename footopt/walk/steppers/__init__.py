"""Time steppers; a new file in this folder is found by itself."""

import pkgutil
from importlib import import_module

from footopt.walk.steppers.base import (
    STEPPERS,
    Stepper,
    acceleration,
    accumulate,
    advance,
    explicit_contact,
    finish_step,
)
from footopt.walk.steppers.explicit import runge_kutta

__all__ = [
    "STEPPERS", "Stepper", "acceleration", "accumulate", "advance", "explicit_contact", "finish_step",
    "runge_kutta",
]  # fmt: skip

for _module in pkgutil.iter_modules(__path__):
    import_module(f"{__name__}.{_module.name}")
