"""What footprints change, by the length of steps, what they cost, and how near they are to finer walks.

python benchmarks/footprints.py  # the three tables of docs/effects.md and docs/accuracy.md, half a minute

With --quick: two feet on regular sand, steps of one length.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
from measure import SANDS, arguments, feet, interleaved

import footopt as fo
from footopt.effects.footprints import finer_cells
from footopt.walk.adapt import adapted

SWINGS = (1.0, 0.7, 0.5, 0.4, 0.3, 0.2)  # of a thigh's angle
SHOWN = ("work", "peak_power", "efficiency")
ON = (fo.Footprints(),)


def scene(sand: str, swing: float) -> fo.Scene:
    """The paper's walk with thighs that swing by a part of their angle."""
    gait = fo.Gait.human()
    a0, a, b = gait.thigh
    thigh = type(gait.thigh)(a0, tuple(swing * np.array(a)), tuple(swing * np.array(b)))
    return fo.Scene(sand=fo.Sand.named(sand), gait=replace(gait, thigh=thigh))


def changes(sand: str, swing: float, designs: int) -> str:
    """Medians of the changes by footprints, in %."""
    level, k = scene(sand, swing), feet(designs)
    without, found = (fo.evaluate(k, replace(level, effects=on), "standard", SHOWN).values for on in ((), ON))
    return ", ".join(f"{100.0 * change:+.1f}" for change in np.nanmedian(found / without - 1.0, axis=0))


def times(sand: str, swing: float, designs: int) -> str:
    """Processor time of a walk, ms, and over that of one without."""
    level, k = scene(sand, swing), feet(designs)

    def walk(on: tuple[fo.Footprints, ...]) -> fo.Table:
        return fo.evaluate(k, replace(level, effects=on), threads=1)

    found = interleaved({"": lambda: walk(()), "on": lambda: walk(ON)}, 5, time.process_time)
    return f"{1e3 * found['on'] / designs:.2g}, {found['on'] / found['']:.0f}"


def errors(sand: str, preset: str, designs: int) -> list[str]:
    """Median and largest error of distance, work, peak power and loss of speed, in %."""
    printed, k = replace(scene(sand, 1.0), effects=ON), feet(designs)
    own = adapted(fo.Accuracy.named("standard"), printed, fo.Waypoints())
    finest = replace(own, dt=own.dt / 8, control=own.control / 64, plates=512, creep=own.creep / 12)
    truth = fo.evaluate(k, replace(printed, effects=finer_cells(ON, 2)), finest).values
    off = 100.0 * np.abs(fo.evaluate(k, printed, preset).values / truth - 1.0)
    return [f"{np.median(off[:, c]):.3f}, {off[:, c].max():.3f}" for c in (0, 2, 3, 4)]


def main() -> None:
    """Print the tables."""
    quick = arguments(__doc__).parse_args().quick
    sands, swings, designs = (("regular",), (0.3,), 2) if quick else (SANDS, SWINGS, 40)
    for title, table in (
        ("change of work, peak power, J_W (%)", changes),
        ("time of a walk (ms), over that without", times),
    ):
        print(f"\n| step on firm ground (m): {title} | {' | '.join(sands)} |\n{'| --- ' * (len(sands) + 1)}|")
        for swing in swings:
            cells = " | ".join(table(sand, swing, designs) for sand in sands)
            print(f"| {scene('hard', swing).scale.step:.2f} | {cells} |")
    print(
        f"\n| errors (%), median and largest | distance | work | peak power | speed loss |\n{'| --- ' * 5}|"
    )
    for sand in sands:
        for preset in ("standard", "fine"):
            print(f"| {sand}, {preset} | {' | '.join(errors(sand, preset, designs))} |")


if __name__ == "__main__":
    main()
