"""An effect of your own: a rigid floor under a shallow bed, as in a laboratory's trackway.

Near a floor the stress rises exponentially, over a length of some grain diameters: Stone et al.,
Physical Review E 70, 041301 (2004). Here the depth-linear stress is multiplied by 1 + exp((|z| - D)/l).
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

import footopt as fo
from footopt.effects import base as effects


class FloorLaw(NamedTuple):
    depth: float  # D, m
    length: float  # l, m


@dataclass(frozen=True)
class Floor:
    depth: float = 0.10
    length: float = 0.01
    nothing = False

    @property
    def law(self):
        return FloorLaw(self.depth, self.length)


def floor_load(law, state, depth, x):
    load, grow, slide = state  # strength integrated over depth, and its derivatives by depth and by x
    rise = np.exp(np.minimum(depth - law.depth, 0.1) / law.length)
    return load * (1.0 + rise), grow * (1.0 + rise) + load * rise / law.length, slide * (1.0 + rise)


effects.register(FloorLaw, load=floor_load)
effects.EFFECTS["floor"] = Floor

if __name__ == "__main__":
    for found in ((), (Floor(0.10),), (Floor(0.05),)):
        walk = fo.simulate(fo.Foot.flat(), fo.Scene(sand=fo.Sand.named("soft"), effects=found))
        print(*found or ["no floor"], f"sole {1e3 * walk.objectives['maximum_sinkage']:.0f} mm deep")
