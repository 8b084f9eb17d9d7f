"""A film of a walk, GIF or MP4: the walker, its feet close with the forces along them, and the time."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter

from footopt.arrays import Array
from footopt.errors import TINY, FileError, FootoptError, check, check_number
from footopt.files.io import write_whole
from footopt.report.numbers import title
from footopt.report.stage import ARROW, Stage, draw_ground, draw_key, write
from footopt.report.style import PAGE, as_text, new_figure, sides, styled
from footopt.walk import Walk

FRAMES = 2000  # of a GIF, at most: they are in memory until it is written, about a megabyte each
WIDEST = 3.0  # times its height: a longer walk is followed by the camera
CLOSE, ASPECT = 3.1, 0.28  # the close-up: its width, of a sole's length, and its height by its width
LONGEST = 0.23  # longest arrow in the close-up, of that length


def check_film(path: str | Path, setting: str = "path") -> Path:
    """Raise a `SettingError` or `FileError` unless `animate` can write such a file."""
    path = Path(path)
    check(path.suffix.lower() in (".gif", ".mp4"), setting, path.name, "a name that ends in .gif or .mp4")
    if path.suffix.lower() == ".mp4" and not FFMpegWriter.isAvailable():
        raise FileError(f"{path}: an .mp4 needs the program ffmpeg, which is not installed. Try a .gif.")
    return path


@styled()
def animate(walk: Walk, path: str | Path, fps: int = 25, speed: float = 0.5, dpi: int = 120) -> Path:
    """Write a film of a walk. The file is there as a whole or as it was before.

    Parameters
    ----------
    walk : Walk
        The walk.
    path : str or Path
        The file. Its name ends in .gif, or in .mp4, which needs the program ffmpeg.
    fps : int
        Frames per second. A GIF gets the nearest rate that it can have, 50 at most.
    speed : float
        Of the walk in the film: 1 is as in life, 0.25 four times slower.
    dpi : int
        Dots per inch of a picture 7 inches wide.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    SettingError
        The file has another ending, or a number cannot be used.
    FileError
        ffmpeg is missing, or the file cannot be written.
    """
    check(hasattr(walk, "t") and hasattr(walk, "legs"), "walk", walk, "a Walk, as fo.simulate returns")
    path = check_film(path)
    check_number("fps", fps, TINY, 100, "a number of frames per second > 0 and <= 100")
    check_number("speed", speed, TINY, 1e300, "a number > 0: 1 is as in life, 0.25 four times slower")
    check_number("dpi", dpi, 20, 600, "a number of dots per inch from 20 to 600")
    if len(walk.t) == 0:
        raise FootoptError(f"{path}: there is nothing to film, the walk failed at once: {walk.reason}.")
    gif, rate = path.suffix.lower() == ".gif", float(fps)
    if gif:  # its frames last whole hundredths of a second, two or more; the writer rounds down
        rate = math.nextafter(100.0 / max(round(100.0 / fps), 2), 0.0)
    kind: Any = PillowWriter if gif else FFMpegWriter
    at, writer = times(walk, rate, speed), kind(rate)
    most, hint = f"such that a GIF has at most {FRAMES} frames, not {len(at)}", "Make an .mp4."
    check(len(at) <= FRAMES or not gif, "speed", speed, most, hint)
    with walk.camera() as camera, write_whole(path) as new:
        figure, show = scene_of(walk, at, speed, camera)
        with writer.saving(figure, str(new), dpi):
            for i in range(len(at)):
                show(i)
                writer.grab_frame()
    return path


def times(walk: Walk, fps: float, speed: float) -> Array:
    """Times of the frames, s: as many as a film of the walk at a speed has, the last at its end."""
    begin, end = float(walk.t[0]), float(walk.t[-1])
    frames = max(1, math.ceil((end - begin) * fps / speed - 1e-9))
    return np.asarray(np.minimum(begin + np.arange(frames + 1) * speed / fps, end))


def scene_of(walk: Walk, t: Array, speed: float, camera: Any = None) -> tuple[Any, Callable[[int], None]]:
    """A figure, and a function that moves the walker in it to the i-th of some times, s.

    The upper panel shows the walker, in pictures of a `Walk.camera` if there is one, with the whole force on
    each foot; the lower one a close-up of its feet with the forces along the soles.
    """
    stage = Stage(walk, t)
    left, right, low, high = stage.limits
    high = max(high, 1.05 * camera.top) if camera else high
    wide = min(right - left, WIDEST * (high - low))
    close, longest = np.array([CLOSE, LONGEST]) * np.ptp(walk.foot.contour[:, 0])
    deep = min(float(stage.sole[..., 1].min()), 0.0) - 1.1 * longest
    largest = max(float(np.linalg.norm(stage.force, axis=-1).max()), 1e-9)
    heights = [(PAGE - 0.6) * (high - low) / wide, (PAGE - 0.6) * ASPECT]
    figure = new_figure(PAGE, sum(heights) + 0.9)
    whole, near = figure.subplots(2, 1, height_ratios=heights)
    label = as_text(f"{title(walk.foot.name)} on {walk.world.sand.title}")
    figure.suptitle(f"{label}, {speed:g} × real time")

    def show(i: int) -> None:
        hip = float(stage.legs[i, 0, 0, 0])
        middle = float(np.clip(hip, left + 0.5 * wide, right - 0.5 * wide))
        views = (whole, middle, wide, (low, high)), (near, hip, close, (deep, deep + close * ASPECT))
        for axes, x, span, z in views:
            axes.clear()
            axes.set(xlim=(x - 0.5 * span, x + 0.5 * span), ylim=z, aspect="equal", ylabel="$z$ (m)")
            draw_ground(axes, stage.ground)
        whole.plot(*walk.com.T, color="black", lw=0.6, ls=":")
        if camera:
            view = *whole.get_xlim(), *whole.get_ylim()
            whole.imshow(camera.picture(int(stage.index[i]), *view), extent=view, aspect="equal", zorder=1.5)
        arrows = stage.draw_feet(whole, i, stage.scale, legs=not camera)
        draw_key(whole, arrows, stage.scale * ARROW * high)
        draw_key(near, stage.draw_feet(near, i, largest / longest, close=True), 0.8 * largest)
        for foot, (side, _) in enumerate(sides(walk)):
            write(near, side, stage.legs[i, foot, -1], (0, 12), ha="center")
        near.set_xlabel("$x$ (m)")
        ended = f", failed: {walk.reason}" if walk.reason and t[i] >= walk.t[-1] else ""
        whole.set_title(f"{t[i]:.2f} s{ended}", loc="right", fontsize=10)

    show(0)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # a layout of each frame's own would tremble
    return figure, show
