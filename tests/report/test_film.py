"""Films of walks: as long as they say, whole or not there, and clear words where they cannot be."""

import itertools
import shutil
import subprocess

import numpy as np
import pytest
from matplotlib.quiver import Quiver
from PIL import Image

import footopt as fo
from footopt.errors import FootoptError
from footopt.report import film, stage

needs_ffmpeg = pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")


@pytest.fixture(scope="module")
def walk():
    return fo.simulate(fo.Foot.flat(), fo.Scene(t_f=1.3), "draft")


@pytest.mark.slow
def test_a_gif_has_the_frames_and_the_pace_that_were_asked_for(walk, tmp_path):
    path = fo.animate(walk, tmp_path / "new" / "walk.gif", fps=4, speed=1.0, dpi=40)
    assert path == tmp_path / "new" / "walk.gif"
    assert [p.name for p in path.parent.iterdir()] == ["walk.gif"]
    with Image.open(path) as image:
        assert image.n_frames == len(film.times(walk, 4, 1.0)) == pytest.approx(1.3 * 4 + 1, abs=1)
        assert image.info["duration"] == 250  # ms
        assert image.info["loop"] == 0  # for ever
        frames = []
        for i in range(image.n_frames):
            image.seek(i)
            frames.append(np.asarray(image.convert("L"), float))
    moved = [abs(a - b).mean() for a, b in itertools.pairwise(frames)]
    assert max(moved[:2]) < 0.5  # it stands until .5 s but for the clock
    assert min(moved[3:-1]) > 0.5  # and then it walks


def line(axes, part):
    """The points of a part of the picture on axes."""
    return next(found.get_xydata() for found in axes.lines if found.get_label() == f"_{part}")


def test_a_frame_shows_legs_soles_force_and_time(walk):
    t = np.array([1.15, 1.2])
    figure, show = film.scene_of(walk, t, speed=1.0)
    show(0)
    axes = figure.axes[0]
    placed = stage.Stage(walk, t)
    for foot, side in enumerate(("left", "right")):
        assert np.array_equal(line(axes, f"{side}-leg"), placed.legs[0, foot])
        assert np.array_equal(line(axes, f"{side}-sole"), placed.sole[0, foot])
    (arrows,) = (found for found in axes.collections if isinstance(found, Quiver))
    force = walk.force[np.searchsorted(walk.t, 1.15)]
    loaded = force[np.linalg.norm(force, axis=1) > 0.0]
    np.testing.assert_allclose(np.stack([arrows.U, arrows.V], axis=1), loaded, rtol=1e-3, atol=0.1)
    assert axes.get_title(loc="right") == "1.15 s"
    count = len(axes.get_children())
    show(1)
    assert len(axes.get_children()) == count  # what was drawn before is gone


@pytest.fixture(scope="module")
def robot_walk():
    pytest.importorskip("mujoco")
    robot = fo.mujoco.Robot(duration=0.6, after=0.0)
    return fo.simulate(fo.Foot.flat(), robot, fo.Accuracy(dt=2e-3, plates=16))


@pytest.mark.slow
def test_a_robot_is_filmed_by_mujocos_renderer_where_there_is_one(robot_walk, tmp_path):
    """Its torso is in the picture where it is in the world."""
    with robot_walk.camera() as camera:
        if camera is None:
            pytest.skip("neither EGL nor OSMesa: a machine without OpenGL")
        x, z = robot_walk.joints[-1, 0, 0]  # the hip
        image = camera.picture(-1, x - 1.0, x + 1.0, z - 1.0, z + 1.0)
    high, wide = image.shape[:2]
    seen = image[..., 3] > 0
    assert seen[int(0.35 * high), wide // 2]  # 0.3 m above the hip
    assert not seen[:, : wide // 4].any()
    assert not seen[int(0.99 * high) :].any()  # below are its feet, which soles replace
    fo.animate(robot_walk, tmp_path / "walk.gif", fps=5, speed=1.0, dpi=40)


def test_a_failed_walk_is_filmed_to_its_end_and_one_without_a_step_is_refused(tmp_path):
    walk = fo.simulate(fo.Foot.flat(), fo.Scene(sand=fo.Sand(zeta=0.02)), "draft")
    assert walk.reason == "sunk"
    figure, show = film.scene_of(walk, walk.t[-1:], 1.0)
    show(0)
    assert figure.axes[0].get_title(loc="right").endswith("failed: sunk")
    void = fo.simulate(fo.Foot.flat(), fo.Scene(sand=fo.Sand(zeta=1e-3)), "draft")
    with pytest.raises(FootoptError, match="failed at once: sunk"):
        fo.animate(void, tmp_path / "walk.gif")


@needs_ffmpeg
@pytest.mark.slow
def test_an_mp4_is_what_players_play(walk, tmp_path):
    path = fo.animate(walk, tmp_path / "walk.mp4", fps=5, speed=1.0, dpi=61)
    probe = ["ffprobe", "-v", "error", "-select_streams", "v", "-of", "csv=p=0", "-count_frames",
             "-show_entries", "stream=codec_name,width,height,pix_fmt,nb_read_frames", path]  # fmt: skip
    found = subprocess.run(probe, capture_output=True, text=True, check=True, timeout=60).stdout
    codec, width, height, pixels, frames = found.strip().split(",")
    assert (codec, pixels) == ("h264", "yuv420p")
    assert int(width) % 2 == int(height) % 2 == 0
    assert int(frames) == len(film.times(walk, 5, 1.0))
