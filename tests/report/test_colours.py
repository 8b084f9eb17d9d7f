"""Colours of roles can be told apart by the colour-blind, by simulation."""

import itertools

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from footopt.report import style

#: Machado, Oliveira and Fernandes, IEEE Trans. Vis. Comput. Graph. 15 (2009), severity 1, linear RGB.
BLIND = {
    "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
               [-0.003882, -0.048116, 1.051998]],
    "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
               [-0.011820, 0.042940, 0.968881]],
    "tritan": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
               [0.004733, 0.691367, 0.303900]],
    "nobody": np.eye(3),
}  # fmt: skip
XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
TOLD = 12.0  # CIE76 difference: five times what is just noticed


def lab(colour, kind):
    """A colour as somebody sees it, in CIE L*a*b*."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    xyz = XYZ @ np.clip(np.array(BLIND[kind]) @ linear, 0.0, 1.0) / XYZ.sum(axis=1)
    f = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def closest(colours, kind):
    """The smallest difference of two of some colours, and which they are."""
    seen = {name: lab(colour, kind) for name, colour in colours.items()}
    return min((float(np.linalg.norm(seen[a] - seen[b])), a, b) for a, b in itertools.combinations(seen, 2))


@pytest.mark.parametrize("kind", BLIND)
def test_roles_are_told_apart(kind):
    roles = {name: style.PALETTE[name] for name in ("left", "right", "best", "flat", "chosen")}
    assert closest(roles, kind)[0] > TOLD, closest(roles, kind)


@pytest.mark.parametrize("kind", BLIND)
def test_sands_are_told_apart_and_stronger_ones_are_darker(kind):
    sands = {name: style.ROLES[name]["color"] for name in ("soft", "regular", "hard")}
    assert closest(sands, kind)[0] > TOLD
    lightness = [lab(colour, kind)[0] for colour in sands.values()]
    assert lightness == sorted(lightness, reverse=True)
