"""Figures for a paper: one function a figure, from plain data to a matplotlib Figure, a file a subject.

Functions named ``draw_*`` draw on Axes of the caller's.
"""

from footopt.report.figures.scenes import contour, contours
from footopt.report.figures.walks import com, convergence, forces, power_work, scatter_matrix, step
from footopt.report.style import save

__all__ = [
    "com", "contour", "contours", "convergence", "forces", "power_work", "save",
    "scatter_matrix", "step",
]  # fmt: skip
