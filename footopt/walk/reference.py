"""Walks that a second program has computed.

`PUBLISHED` is what another program, written apart from this one, found for one foot: the law in its angles,
LSODA, 100 chords for plates, a creep speed of 1e-5 m/s, and all else as the defaults are. Every release and
study=doctor is held to it.
"""

from typing import NamedTuple

from footopt.walk.accuracy import TOLERANCES, Accuracy


class Published(NamedTuple):
    """Height of the hip at the start, m, and the five objectives in the order of `objectives.FIVE`."""

    sand: str
    zeta: float
    start: float
    objectives: tuple[float, float, float, float, float]


#: Heights of the foot's waypoints.
RAMP = (1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 8)

PUBLISHED = (
    Published("soft", 0.2, 0.86572, (1.84941, 0.76065, 684.635, 606.292, 0.17711)),
    Published("regular", 1.0, 0.91440, (2.08141, 0.88027, 364.225, 364.768, 0.23598)),
    Published("hard", 5.0, 0.93425, (2.16852, 0.91860, 148.094, 502.316, 0.29326)),
)

#: The program's own plates and creep speed, in steps so short that time adds nothing.
SAME_PLATES = Accuracy("sdirk2", 1e-4, 100, 1e-5, "same plates", rule="chord")

#: Largest relative difference that is allowed to each accuracy: what presets promise, less for the finest.
LIMITS = {**TOLERANCES, "reference": 2e-4, "same plates": 2e-4}
