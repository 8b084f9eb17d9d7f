"""A sand of your own: loosely packed poppy seeds with their own stress map, not a scaled generic one.

Coefficients of Li, Zhang & Goldman, Science 339 (2013), table S2.
"""

import footopt as fo

POPPY = fo.StressMap(
    A00=0.051, A10=0.047, B11=0.053, B01=0.083, Bm11=0.020, C11=-0.026, C01=0.057, Cm11=0.0, D10=0.025
)

if __name__ == "__main__":
    for sand in (fo.Sand(stress_map=POPPY, name="poppy, measured"), fo.Sand.named("poppy_loose")):
        walk = fo.simulate(fo.Foot.flat(), fo.Scene(sand=sand))
        values = walk.objectives
        print(f"{sand.name}: {values['distance']:.3f} m, sole {1e3 * values['maximum_sinkage']:.0f} mm deep")
