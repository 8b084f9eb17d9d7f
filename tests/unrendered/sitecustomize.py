"""Figures are made but not rendered, which is most of a small run's time.

In every process that finds this folder in PYTHONPATH: Python imports this file when it starts.
"""

import importlib.util
import sys

#: What stands for methods of `matplotlib.figure.Figure`.
INSTEAD = {
    "savefig": lambda figure, file, **_: file.write(b""),
    "draw_without_rendering": lambda figure: None,
    "get_layout_engine": lambda figure: None,
}


class Finder:
    """Finds matplotlib.figure as anyone would, and changes it when it is imported."""

    def find_spec(self, name, path=None, target=None):
        if name != "matplotlib.figure":
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(name)
        load = spec.loader.exec_module

        def changed(module):
            load(module)
            for method, function in INSTEAD.items():
                setattr(module.Figure, method, function)

        spec.loader.exec_module = changed
        return spec


if __name__ == "sitecustomize":
    sys.meta_path.insert(0, Finder())
