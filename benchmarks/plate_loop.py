"""The plate loop against the machine: `contact.foot_force` and a C loop vectorised by hand.

Both repeat the sums over one submerged foot, at a slightly different speed every time.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
from measure import interleaved
from numba import njit
from numpy.typing import NDArray

import footopt as fo
from footopt.foot import Soles, as_plates
from footopt.walk.contact import foot_force
from footopt.walk.discretize import sole_of
from footopt.walk.state import Ankle, Part, World, plates_between

Array = NDArray[np.float64]
Sums = Callable[[int], Array]

SOURCE = Path(__file__).with_name("plate_loop.c")
CHANGE = 1e-7  # of the forward speed from one repetition to the next, m/s
#: Height of the ankle (m), its velocity (m/s), cos and sin of the pitch, its rate (rad/s), creep
#: speed (m/s) and the stage's coefficient (s): every plate of a random foot is submerged.
MOTION = (-0.05, 0.3, -0.2, np.cos(0.2), np.sin(0.2), 0.5, 1e-4, 1.5e-3)


@njit(error_model="numpy", nogil=True)
def _repeat(out, sole, world, motion, jacobian, repeats, change):
    out[:] = 0.0
    za, vx, vz, cos, sin, rate, creep = motion
    for r in range(repeats):
        ankle = Ankle(0.0, za, vx + change * r, vz, cos, sin, rate)
        sums = foot_force(world.law, world.effects, sole, ankle, creep, jacobian, None)
        for j in range(7):
            out[j] += sums[j]


def submerged_sole(plates: int) -> tuple[Part, World]:
    """A random foot's plates, a multiple of `contact.LANES`, and regular sand's law."""
    space = fo.Waypoints()
    feet = as_plates(Soles(space.random(1, 5, inside=True), space), plates, "arc")
    sole = sole_of(feet)._replace(span=0.0)  # the C loop smooths no turn
    part: Part = plates_between(sole, None, 0, plates)
    return part, fo.Scene(sand=fo.Sand.named("regular")).constants(fo.Accuracy())


def compiled(plates: int, jacobian: bool) -> Sums:
    """footopt's own loop: repetitions to the total of the seven sums."""
    submerged, law = submerged_sole(plates)

    def run(repeats: int) -> Array:
        out = np.empty(7)
        _repeat(
            out,
            submerged,
            law,
            MOTION[:-1],
            MOTION[-1] if jacobian else None,
            repeats,
            CHANGE,
        )
        return out

    return run


def build(folder: Path) -> ctypes.CDLL | str:
    """The C loop, built into a folder; or why it cannot be."""
    if (gcc := shutil.which("gcc")) is None:
        return "there is no gcc"
    library = folder / "plate_loop.so"
    # -ffp-contract=fast is gcc's own default; a reordered sum is written out in the source
    flags = ["-O3", "-march=native", "-fno-math-errno", "-shared", "-fPIC"]
    made = subprocess.run(
        [gcc, *flags, str(SOURCE), "-o", str(library), "-lm"], capture_output=True, text=True
    )
    if made.returncode:
        return f"gcc fails: {made.stderr.strip().splitlines()[-1]}"
    return ctypes.CDLL(str(library))


def by_hand(library: ctypes.CDLL, plates: int, jacobian: bool) -> Sums:
    """The C loop: repetitions to the total of the seven sums."""
    sole, law = submerged_sole(plates)
    columns = [np.ascontiguousarray(c) for c in (sole.x, sole.z, sole.c2, sole.s2, sole.area)]
    coefficients, motion = np.array(law.law), np.array(MOTION)

    def pointer(array: Array) -> ctypes.c_void_p:
        return ctypes.c_void_p(array.ctypes.data)

    def run(repeats: int) -> Array:
        out = np.empty(7)
        library.repeat_sums(
            pointer(out),
            *map(pointer, columns),
            ctypes.c_long(plates),
            pointer(coefficients),
            pointer(motion),
            ctypes.c_int(jacobian),
            ctypes.c_long(repeats),
            ctypes.c_double(CHANGE),
        )
        return out

    return run


def compare(
    library: ctypes.CDLL, plates: int, jacobian: bool, repeats: int = 25, sums: int = 2_000_000
) -> tuple[float, float, float]:
    """Time per submerged plate of footopt's loop and of the C loop, ns, and their ratio.

    sums : plates to sum over in one repeat.
    """
    calls = sums // plates
    ours, theirs = compiled(plates, jacobian), by_hand(library, plates, jacobian)
    times = interleaved({"ours": lambda: ours(calls), "theirs": lambda: theirs(calls)}, repeats)
    each = {name: 1e9 * value / (calls * plates) for name, value in times.items()}
    return each["ours"], each["theirs"], each["ours"] / each["theirs"]
