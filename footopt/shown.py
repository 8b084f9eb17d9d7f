"""`Shown`: how objects show themselves in a notebook and draw on Axes.

The one place where the flow of data turns round: the drawings are in `footopt.report.show`, which is
imported when something is drawn, so that matplotlib is not needed before.
"""

from __future__ import annotations

import html
from pathlib import Path
from typing import Any


class Shown:
    """Something that a notebook shows as a picture beside its numbers, and a terminal as its numbers."""

    def plot(self, ax: Any = None, what: str | None = None) -> Any:
        """Draw on matplotlib Axes.

        Parameters
        ----------
        ax : where to draw; by default on Axes of a new figure, which a notebook shows. A name alone,
            as in ``walk.plot("power")``, is `what`.
        what : a walk's walk, com, velocity, force, power or work; a sand's alpha_z or alpha_x; a gait's
            angles or path; a search's front or convergence. By default the first of them.

        Returns
        -------
        The Axes; ``.figure.savefig("...")`` keeps the picture.

        Raises
        ------
        SettingError : there is no such drawing of it.
        """
        from footopt.report import show

        return show.plot(self, None, ax) if isinstance(ax, str) else show.plot(self, ax, what)

    def __repr__(self) -> str:
        """What matters of it in one line, without its arrays."""
        try:
            from footopt.report import show

            title, facts = show.words(self)
            return f"<{type(self).__name__} {title}: {'; '.join(map(' '.join, facts.items()))}>"
        except Exception:  # a debugger may look at what is only half made
            return object.__repr__(self)

    def _repr_html_(self) -> str:
        """What matters of it, and a picture; its `repr` where that cannot be drawn."""
        try:
            from footopt.report import show

            return show.card(self)
        except Exception:  # a cell that shows something must not fail for it
            return f"<pre>{html.escape(repr(self))}</pre>"


class Animated(Shown):
    """Something that moves."""

    def animate(self, path: str | Path, fps: int = 25, speed: float = 0.5, dpi: int = 120) -> Path:
        """Write a film of the walk.

        Parameters
        ----------
        path : ends in .gif, or in .mp4, which needs the program ffmpeg.
        fps : frames per second; a GIF gets the nearest rate that it can have, 50 at most.
        speed : of the walk in the film; 1 is as in life, 0.25 four times slower.
        dpi : dots per inch of a picture 7 inches wide.

        Returns
        -------
        path : the file.

        Raises
        ------
        SettingError : another ending, or a number that cannot be used.
        FileError : ffmpeg is missing or fails, or the file cannot be written.
        """
        from footopt.report import film

        walk: Any = self
        return film.write(walk, path, fps, speed, dpi)
