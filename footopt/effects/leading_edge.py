"""The leading edge: only faces that lead feel sand."""

from dataclasses import dataclass
from typing import NamedTuple

from footopt.effects.base import Effect
from footopt.effects.dual import smooth_step


class LeadingEdgeLaw(NamedTuple):
    """It has no parameters."""

    def gate(self, lead, depth):
        """A cubic step from 0 where the whole plate trails to 1 where all of it leads."""
        return smooth_step(lead)


@dataclass(frozen=True)
class LeadingEdge(Effect, name="leading_edge"):
    """Only faces that lead, n.v > 0, feel sand: a face that trails leaves a gap behind it and is not pulled.

    Smoothed over the width w of the speeds along the normal within a plate (`footopt.walk.contact`), at least
    the creep speed, so that implicit steps converge: all of the stress at n.v >= w, none at n.v <= -w.

    Source: the leading-edge hypothesis of RFT in Agarwal, Goldman & Kamrin, PNAS 120 (2023), and of
    granular RFT codes before it; without it (the paper) a foot that is lifted out of the sand is pulled
    back. Range: dry, cohesionless grains that do not close the gap during a step.
    """

    law = LeadingEdgeLaw()
    literature, plausible, in_page = True, True, True
