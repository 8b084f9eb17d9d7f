"""The paper's five shapes as feet, and where the shank meets them."""

from __future__ import annotations

from dataclasses import replace

from footopt.errors import check
from footopt.foot import SHAPES, Foot
from footopt.studies.build import make_foot
from footopt.studies.settings import Config

MOUNTS = ("centre", "top")


def make_shapes(config: Config) -> dict[str, Foot]:
    """The five shapes by name; `study.mount` says where the shank meets them.

    "centre" is the centre of the shape's bounding box, "top" the middle of its upper side; the
    setting foot.ankle shifts the ankle from there.
    """
    mount = config.study.mount
    check(mount in MOUNTS, "study.mount", mount, f"one of {', '.join(MOUNTS)}")
    feet = {name: make_foot(replace(config.foot, shape=name)) for name in SHAPES}
    if mount == "centre":
        return feet
    # the box's centre is the origin, and every shape's contact line reaches its lower side
    return {
        name: replace(foot, ankle=(foot.ankle[0], foot.ankle[1] - float(foot.contour[:, 1].min())))
        for name, foot in feet.items()
    }
