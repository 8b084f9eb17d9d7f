"""An effect of your own: a rigid floor under a shallow bed, as in a laboratory's trackway.

Near a floor the stress rises exponentially, over a length of some grain diameters: Stone et al.,
Physical Review E 70, 041301 (2004). Here the depth-linear stress is multiplied by 1 + exp((|z| - D)/l).
"""

from dataclasses import dataclass
from typing import NamedTuple

import footopt as fo
from footopt.effects import Effect
from footopt.effects.dual import clipped, exp


class FloorLaw(NamedTuple):
    depth: float  # D, m
    length: float  # l, m

    def load(self, load, depth, x):
        return load * (1.0 + exp(clipped(depth - self.depth, -10.0, 0.1) / self.length))


@dataclass(frozen=True)
class Floor(Effect, name="floor"):
    depth: float = 0.10
    length: float = 0.01

    @property
    def law(self):
        return FloorLaw(self.depth, self.length)


if __name__ == "__main__":
    for found in ((), (Floor(0.10),), (Floor(0.05),)):
        walk = fo.simulate(fo.Foot.flat(), fo.Scene(sand=fo.Sand.named("soft"), effects=found))
        print(*found or ["no floor"], f"sole {1e3 * walk.objectives['maximum_sinkage']:.0f} mm deep")
