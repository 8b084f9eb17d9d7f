"""What effects cost: the bare walk against one without their code, and what each effect adds.

python tests/benchmarks/effects.py  # a table for soft, regular and hard sand
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from types import ModuleType

from deleted import walking, without_effects
from measure import SANDS, feet, interleaved, scene

import footopt as fo
from footopt.sand.effects import EFFECTS

DELETED = "code deleted"
#: What is walked, by name: each effect with its own defaults, and all of them.
SETS = {
    "bare": (),
    **{name: (effect(),) for name, effect in EFFECTS.items()},
    "all": tuple(effect() for effect in EFFECTS.values()),
}


@lru_cache
def deleted() -> ModuleType:
    """The loop with the effects' code deleted, in a folder that stays until the process ends."""
    deleted.folder = tempfile.TemporaryDirectory()  # type: ignore[attr-defined]
    return without_effects(Path(deleted.folder.name))  # type: ignore[attr-defined]


def jobs(sand: str, designs: int) -> dict[str, Callable[[], fo.Table]]:
    """Walks of random feet on a sand, one thread: by the deleted source, bare, and with each of `SETS`."""

    def walk(*effects: object) -> fo.Table:
        return fo.evaluate(feet(designs), replace(scene(sand), effects=effects), threads=1)

    def without() -> fo.Table:
        with walking(deleted()):
            return walk()

    return {DELETED: without, **{name: partial(walk, *effects) for name, effects in SETS.items()}}


def compare(sand: str, designs: int = 30, repeats: int = 25) -> dict[str, tuple[float, float]]:
    """Processor time over the bare walk's, and evaluations of the contact likewise, by what is walked."""
    chosen = jobs(sand, designs)
    counts = {name: job().evaluations.sum() for name, job in chosen.items()}
    times = interleaved(chosen, repeats, time.thread_time)
    return {name: (times[name] / times["bare"], float(counts[name] / counts["bare"])) for name in chosen}


def main() -> None:
    """Print the table."""
    print(f"{'over the bare walk':>20}" + "".join(f"{f'{sand}: time':>16}  evaluations" for sand in SANDS))
    found = {sand: compare(sand) for sand in SANDS}
    for name in (DELETED, *SETS):
        row = (f"{found[sand][name][0]:16.3f} {found[sand][name][1]:12.3f}" for sand in SANDS)
        print(f"{name:>20}" + "".join(row))


if __name__ == "__main__":
    main()
