"""footopt: design feet for bipeds that walk on sand.

    import footopt as fo

    scene = fo.Scene(sand=fo.Sand.named("hard"))
    walk = fo.simulate(fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4]), scene)
    walk.objectives

Public names, which `__init__.pyi` lists, are imported when first used, so that importing footopt is cheap.
"""

import os
from importlib import import_module

__version__ = "0.2.0.dev0"

_here = os.path.dirname(__file__)
with open(os.path.join(_here, "__init__.pyi"), encoding="utf-8") as _stub:  # from MODULE import NAME as NAME
    _HOME = {line.split()[-1]: line.split()[1] for line in _stub if line.startswith("from")}

__all__ = ["__version__", *sorted(_HOME)]

# Hydra looks for pkg://footopt.conf, which is inside this package in a wheel, and beside it in a checkout
if not os.path.isdir(os.path.join(_here, "conf")):
    __path__.append(os.path.dirname(_here))


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module 'footopt' has no attribute {name!r}")
    home = _HOME[name]
    value = import_module(f"{home}.{name}") if home == __name__ else getattr(import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
