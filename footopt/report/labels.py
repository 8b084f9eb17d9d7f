"""Names beside what they name, in its colour, instead of a legend."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from footopt.report.style import DARK, DESIGNS, Axes

Array = NDArray[np.float64]

GRAIN = 3.0  # points, between two of those that stand for a line
PLACES = 40  # of a thing that its name may be at
THIN = 0.6  # points; names may lie on lines as thin, such as a grid's
HALO = [withStroke(linewidth=2.0, foreground="white")]
RING = 0.5 * np.array([[0, 1], [0, -1], [1, 0], [-1, 0], [0.7, 0.7], [0.7, -0.7], [-0.7, 0.7], [-0.7, -0.7]])
FAR = np.full((1, 2), 1e6)


def label_all(panels: Axes | Iterable[Axes]) -> bool:
    """Name each thing that has a label once, in the panel where it is farthest from all else.

    Call it when the limits of the axes stay. Where a name finds no room, all are in a legend above.

    Parameters
    ----------
    panels : Axes, or several of one figure
        What has the same label in several panels is the same thing.

    Returns
    -------
    inside : bool
        Whether all names are inside the panels, which lie where they lay when this began.
    """
    panels = list(np.ravel(np.asarray(panels, object)))
    figure = panels[0].get_figure(root=True)
    if (layout := figure.get_layout_engine()) is not None:
        layout.execute(figure)  # places in pixels hold only in a laid-out figure
    things = [_things(axes, GRAIN * figure.dpi / 72) for axes in panels]
    taken = [np.concatenate([FAR, *map(_inside, axes.texts)]) for axes in panels]
    handles: dict[str, Any] = {}
    for axes in panels:
        handles |= {label: handle for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    made: list[Any] = []
    for label, handle in handles.items():
        text = figure.text(0.0, 0.0, label, ha="center", va="center")
        half = 0.5 * np.array(text.get_window_extent().size)
        text.remove()
        found = []
        for i, axes in enumerate(panels):
            if label in things[i]:
                rest = np.concatenate([FAR, *(points for name, points in things[i].items() if name != label)])
                place, score = _place(axes, half, things[i][label], rest, taken[i])
                found.append((score - 4.0 * i, i, place))
        score, i, place = max(found, key=lambda one: one[0], default=(-np.inf, 0, FAR[0]))
        if not np.isfinite(score):
            for text in made:
                text.remove()
            legend_above(figure, list(handles.values()), list(handles))
            return False
        looks = {"ha": "center", "va": "center", "zorder": 8, "path_effects": HALO}
        x, z = panels[i].transData.inverted().transform(place)
        made.append(panels[i].text(x, z, label, color=_colour(handle), **looks))
        taken[i] = np.concatenate([taken[i], _inside(made[-1])])
    return True


def legend_above(figure: Figure, handles: Sequence[Any], labels: Sequence[str]) -> None:
    """One legend above all axes, with as many columns as fit beside each other."""
    short = wrapped(labels)
    columns = min(max(int(figure.get_figwidth() / legend_width(short)), 1), max(len(short), 1))
    # the legend takes nothing from the axes
    figure.set_figheight(figure.get_figheight() + 0.17 * -(-len(short) // columns))
    figure.legend(handles, short, loc="outside upper center", ncols=columns)


def wrapped(labels: Iterable[str]) -> list[str]:
    """Labels of a legend, long ones in several lines."""
    return [textwrap.fill(label, 40) for label in labels]


def legend_width(labels: Sequence[str]) -> float:
    """How wide a column of a legend with these labels is, inches."""
    longest = max((len(part) for label in labels for part in label.split("\n")), default=0)
    # an 8 pt letter is about 0.062 inches wide, a line and the gaps beside it 0.45
    return 0.45 + 0.062 * longest


def _things(axes: Axes, grain: float) -> dict[Any, Array]:
    """Points in pixels of all that is drawn on axes: by its label, or by itself if it has none."""
    bars = [container for container in axes.containers if hasattr(container, "lines")]  # of errors
    names = {container.lines[0]: container.get_label() for container in bars}
    found: dict[Any, Array] = {}
    for artist in (*axes.lines, *axes.collections, *axes.patches):
        line = isinstance(artist, Line2D)
        dots = line and artist.get_linestyle() == "None"
        if line and not dots and artist.get_linewidth() <= THIN:
            continue
        paths = artist.get_paths() if hasattr(artist, "get_paths") else [artist.get_path()]
        pixels = (artist.get_transform().transform(path.vertices) for path in paths if len(path.vertices))
        known = [points[np.isfinite(points).all(axis=1)] for points in pixels]
        label = names.get(artist, artist.get_label()) or "_"
        name = artist if label.startswith("_") else label
        size = RING * artist.get_markersize() * axes.figure.dpi / 72 if dots else None
        own = [
            _sparse((points[:, None] + size).reshape(-1, 2), grain) if dots else _dense(points, grain)
            for points in known
            if len(points)
        ]
        if own:
            found[name] = np.concatenate([found.get(name, FAR), *own])
    return found


def _place(axes: Axes, half: Array, own: Array, rest: Array, taken: Array) -> tuple[Array, float]:
    """The best middle of a name's box near its own points, and how good it is, -inf where none is free."""
    frame, point = axes.get_window_extent(), axes.figure.dpi / 72
    low, high = np.array([frame.min, frame.max])
    seen = own[((own >= low) & (own <= high)).all(axis=1)]
    start = seen[:: max(len(seen) // PLACES, 1)]
    up, aside = half[1] + point * np.array([2, 4, 8, 14, 22, 32, 44]), half[0] + 5 * point
    away = np.array([*((0.0, sign * step) for step in up for sign in (1, -1)), (aside, 0.0), (-aside, 0.0)])
    boxes = (start[:, None] + away).reshape(-1, 2)
    far_off = np.tile((abs(away) - half).max(axis=1), len(start))
    inside = ((boxes - half >= low) & (boxes + half <= high)).all(axis=1)
    boxes, far_off = boxes[inside], far_off[inside]
    if not len(boxes):
        return low, -np.inf
    names, near, far = (_apart(boxes, half, points) / point for points in (taken, own, rest))
    # off all else, far from other things, near to its own, and not in a corner
    aside = abs(boxes - (low + high) / 2)[:, 0] / (high - low)[0]
    score = 10 * np.minimum(near, far).clip(max=4) + far.clip(max=30) - 2 * far_off / point - 8 * aside
    score[np.minimum(np.minimum(near, far), names - 3.0) < 0.7] = -np.inf
    best = int(score.argmax())
    return boxes[best], float(score[best])


def _apart(boxes: Array, half: Array, points: Array) -> Array:
    """How far the nearest of some points is from each box about a place."""
    away = np.maximum(abs(points - boxes[:, None]) - half, 0.0)
    least: Array = np.linalg.norm(away, axis=-1).min(axis=1)
    return least


def _colour(handle: Any) -> Any:
    """Of the name of a thing; what is filled or pale has a dark one."""
    handle = getattr(handle, "lines", (handle,))[0]
    colour = handle.get_color() if isinstance(handle, Line2D) else "0.35"
    return DARK if colour == DESIGNS else colour


def _inside(text: Any) -> Array:
    """Points all over a text, pixels."""
    box = text.get_window_extent()
    across, up = np.linspace(box.x0, box.x1, 15), np.linspace(box.y0, box.y1, 4)
    return np.stack(np.meshgrid(across, up), axis=-1).reshape(-1, 2)


def _dense(points: Array, grain: float) -> Array:
    """Points along a line in steps of some pixels."""
    steps = np.maximum(np.ceil(abs(np.diff(points, axis=0)).max(axis=1) / grain), 1.0)
    at = np.append(0.0, np.cumsum(steps))
    fine = np.arange(min(at[-1], 20_000) + 1)
    dense = np.stack([np.interp(fine, at, part) for part in points.T], axis=-1)
    return _sparse(dense, grain)


def _sparse(points: Array, grain: float) -> Array:
    """One of the points in each cell of some pixels."""
    x, z = np.round(points / grain).T
    return points[np.unique(x + 1j * z, return_index=True)[1]]
