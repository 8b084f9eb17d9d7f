"""The leading edge: only faces that lead feel sand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from footopt.effects.base import EFFECTS, Scale, register


class LeadingEdgeLaw(NamedTuple):
    """It has no parameters."""


@dataclass(frozen=True)
class LeadingEdge:
    """Only faces that lead, n.v > 0, feel sand: what trails leaves a gap behind and is not pulled.

    Smoothed over the speeds along the normal that a plate holds (`footopt.walk.contact`), at least the creep
    speed, so that implicit steps converge: all of the stress at n.v >= w, none at n.v <= -w.

    Source: the leading-edge hypothesis of RFT in Agarwal, Goldman & Kamrin, PNAS 120 (2023), and of
    granular RFT codes before it; without it (the paper) a foot that is lifted out of the sand is pulled
    back. Range: dry, cohesionless grains that do not close the gap during a step.
    """

    law = LeadingEdgeLaw()
    nothing = False
    number, source = "stress of a plate pulled up / pushed down", "Agarwal, Goldman & Kamrin (2023)"

    def estimate(self, scale: Scale) -> float:
        """What holds back a level plate that is lifted, over what carries one that sinks."""
        return abs(scale.pull) / scale.stress


def leading_gate(law, state, vn, width):
    """A cubic step from 0 at n.v = -w to 1 at n.v = w."""
    share, by_vn = state
    s = np.minimum(np.maximum(vn / width, -1.0), 1.0)
    step, slope = 0.5 + s * (0.75 - 0.25 * s * s), 0.75 * (1.0 - s * s) / width
    return share * step, by_vn * step + share * slope


EFFECTS["leading_edge"] = LeadingEdge
register(LeadingEdgeLaw, gate=leading_gate)
