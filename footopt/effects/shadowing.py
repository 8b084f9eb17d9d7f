"""Shadowing: sand that rests in a hollow, or between blades, moves with the foot.

Either in the foot's frame, whatever it does: the sole is moved towards its lower convex hull before it is cut
into plates (`filled`). Or in the direction of motion, at each instant: a plate is hidden if a straight line
along its own velocity h, on its side in the sand, meets the same sole again, ahead of a face that leads or
behind one that trails. The sand between cannot leave and moves with both; what slides on the ground is its
edge, a face along the motion.

Which directions a plate sees does not change as the foot moves. They are a sector of the foot's frame between
the two lines that touch the rest of the sole, toe- and heelwards (`horizons`), which on a convex sole is all
of the sand's side. With a and b the components of h along the normals of these lines, and a cubic step S::

    s = S(b) - S(a)     1 hidden on the way to the toe, -1 on the way to the heel, 0 seen
    f = zeta |z| dA [ (1 - r s^2) (a - M h) + r s |s| (t.h) (a_h - M_h h) ],   r = 1 - effective

t is the plate's direction, a_h and M_h are the law's on a face along h. The t.h of the plates around a pocket
add up to the length of its edge. All of it is smooth in h, and has its derivatives here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from footopt.compiled import cached_njit, inlined, inlined_fast
from footopt.effects.base import EFFECTS, VARIANTS, Effect, Scale
from footopt.errors import check

Array = NDArray[np.float64]

HULLS = ("sole", "motion")
EDGE = 0.05  # of h, over which a shadow's edge is smooth: 3 degrees


@dataclass(frozen=True)
class Shadowing:
    """What lies in a hollow counts with a part: the sole comes nearer to its lower hull.

    - ``hull="sole"``: each point of the sole is moved straight down, in the foot frame, until its gap to the
      convex hull is `effective` times what it was; plates are cut from that sole. Source: Agarwal, Karsai,
      Goldman & Kamrin, Science Advances 7 (2021), who let a third of the height of a wheel's grousers count.
      Range: grooves that are narrow, and sand that has come to rest in them. It does not know where the foot
      moves.
    - ``hull="motion"``: a plate that the sole itself hides, ahead or behind, feels `effective` of its own
      stress and, for the rest, that of the edge of the sand which moves with it (see the top of this
      module). The law is footopt's own. Range: motion over more than the pocket's length, as sand is
      taken to be at rest in it at once; straight lines, while a foot that turns moves on circles; what of
      the sole is above the sand hides, too; the edge feels the depth of the plate that it hides.

    A convex sole shadows nothing, by either.

    Parameters
    ----------
    effective : float, 1, optional
        The part that counts of a groove's depth, or of a hidden plate: 1 is the plain law, 0 the hull. By
        default a third of a groove's depth, and nothing of a hidden plate.
    hull : str
        Towards which hull: sole, of the sole in its own frame; motion, in the direction of motion.

    Raises
    ------
    SettingError
        The part is not from 0 to 1, or the hull another.
    """

    effective: float | None = None
    hull: str = "sole"
    law = None
    number, source = "depth of the hollow that does not count / z", "Agarwal et al. (2021)"

    def __post_init__(self) -> None:
        check(0 <= self.part <= 1, "effects.shadowing.effective", self.effective, "a part, from 0 to 1")
        check(self.hull in HULLS, "effects.shadowing.hull", self.hull, f"one of {', '.join(HULLS)}")

    @property
    def part(self) -> float:
        """`effective`, or its default."""
        if self.effective is None:
            return 1.0 / 3.0 if self.hull == "sole" else 0.0
        return self.effective

    @property
    def nothing(self) -> bool:
        """Whether all of a groove counts."""
        return self.part == 1.0

    def estimate(self, scale: Scale) -> float:
        """What a groove loses of its depth, over the depth to which a foot sinks."""
        return (1.0 - self.part) * scale.hollow / scale.depth

    def __call__(self, points: Array) -> Array:
        """Soles (designs, points, 2), m, as plates are cut from them."""
        return filled(points, self.part) if self.hull == "sole" else points

    def sight(self, points: Array, parts: int) -> Array | None:
        """`horizons` of soles whose plates have so many chords each; None if nobody asks for them."""
        return None if self.hull == "sole" else horizons(points[:, ::parts])


def filler(effects: Sequence[Effect]) -> Shadowing | None:
    """A scene's shadowing, which is what `foot.Plates` asks to fill soles; None without it."""
    return next((effect for effect in effects if isinstance(effect, Shadowing)), None)


def hidden_part(effects: Sequence[Effect]) -> float | None:
    """The part r of a hidden plate's stress that it does not feel; None if no plate is hidden."""
    effect = filler(effects)
    return None if effect is None or effect.hull == "sole" else 1.0 - effect.part


@cached_njit(nogil=True, error_model="numpy")
def filled(points, effective):
    """Soles whose gaps to their lower convex hulls are `effective` times what they were.

    points: (designs, m, 2), m, in the order of the contour.
    """
    out = points.copy()
    count = points.shape[1]
    order, hull = np.empty(count, np.int64), np.empty(count, np.int64)
    for d in range(len(points)):
        x, z = points[d, :, 0], points[d, :, 1]
        for i in range(count):  # by x, then z; nearly in order as they come, unless the sole overhangs
            j = i
            while j > 0 and (x[order[j - 1]], z[order[j - 1]]) > (x[i], z[i]):
                order[j] = order[j - 1]
                j -= 1
            order[j] = i
        size = 0
        for i in order:  # Andrew's monotone chain
            while size >= 2:
                a, b = hull[size - 2], hull[size - 1]
                if (x[b] - x[a]) * (z[i] - z[a]) - (z[b] - z[a]) * (x[i] - x[a]) > 0.0:
                    break
                size -= 1
            if size == 0 or x[i] > x[hull[size - 1]]:  # what stands above a corner is no floor
                hull[size] = i
                size += 1
        right = 0
        for i in order:
            while right < size - 1 and x[hull[right]] < x[i]:
                right += 1
            a, b = hull[max(right - 1, 0)], hull[right]
            part = (x[i] - x[a]) / (x[b] - x[a]) if x[i] < x[b] else 1.0
            gap = z[i] - z[a] - part * (z[b] - z[a])
            if gap > 1e-12:  # a convex sole keeps its last bit
                out[d, i, 1] = z[i] - (1.0 - effective) * gap
    return out


@inlined
def convex(x, z):
    """Whether a sole's ends of plates never turn towards the sand, but for rounding."""
    for i in range(1, len(x) - 1):
        ax, az, bx, bz = x[i] - x[i - 1], z[i] - z[i - 1], x[i + 1] - x[i], z[i + 1] - z[i]
        if ax * bz - az * bx < -1e-9 * (abs(ax) + abs(az)) * (abs(bx) + abs(bz)):
            return False
    return True


@cached_njit(nogil=True, error_model="numpy")
def horizons(ends):
    """Where the plates of soles see sand: from the ends of the plates, (designs, plates + 1, 2), m.

    Returns (designs, 5, plates): cosine and sine of the angle by which the line that touches the sole
    toewards dips into the sand's side of the plate, the same heelwards, and over how much of h a shadow's
    edge is smooth: as wide as the angles at the plate's ends differ, and at least `EDGE`.
    """
    out = np.empty((len(ends), 5, ends.shape[1] - 1))
    angle = np.empty((2, 3))
    for d in range(len(ends)):
        x, z = ends[d, :, 0], ends[d, :, 1]
        if convex(x, z):
            out[d, :, :] = 0.0
            out[d, 0, :], out[d, 2, :], out[d, 4, :] = 1.0, 1.0, EDGE
            continue
        for i in range(len(x) - 1):
            length = max(np.hypot(x[i + 1] - x[i], z[i + 1] - z[i]), 1e-30)
            tx, tz = (x[i + 1] - x[i]) / length, (z[i + 1] - z[i]) / length
            for side in range(2):
                way, first, last = (1, i + 1, len(x)) if side == 0 else (-1, i, -1)
                for place in range(3):  # the plate's ends, and its middle
                    px, pz = x[i] + 0.5 * place * length * tx, z[i] + 0.5 * place * length * tz
                    bx, bz, size = way * tx, way * tz, 1.0  # the lowest line so far
                    here = way if place == 1 + way else 0  # the end that is looked from is no obstacle
                    for j in range(first + here, last, way):
                        rx, rz = x[j] - px, z[j] - pz
                        if way * (bz * rx - bx * rz) > 1e-9 * size * (abs(rx) + abs(rz)):
                            bx, bz = rx, rz
                            size = abs(rx) + abs(rz)
                    angle[side, place] = np.arctan2(tz * bx - tx * bz, way * (tx * bx + tz * bz))
                out[d, 2 * side, i], out[d, 2 * side + 1, i] = (
                    np.cos(angle[side, 1]), np.sin(angle[side, 1])
                )  # fmt: skip
            wide = 0.5 * max(abs(angle[0, 2] - angle[0, 0]), abs(angle[1, 2] - angle[1, 0]))
            out[d, 4, i] = np.sqrt(EDGE * EDGE + wide * wide)
    return out


@inlined_fast
def hidden(part, toe_cos, toe_sin, heel_cos, heel_sin, wide, hx, hz, nx, nz):
    """What a plate with the normal n feels of its own stress, and of its pocket's edge.

    Compiled for one plate; with arrays it is the readable form. Returns the share of the own stress and its
    derivatives by h, then r s |s| (t.h) and its derivatives.
    """
    into, along = hx * nx + hz * nz, hz * nx - hx * nz  # n.h and t.h
    a = np.minimum(np.maximum((into * toe_cos - along * toe_sin) / wide, -1.0), 1.0)
    b = np.minimum(np.maximum((into * heel_cos + along * heel_sin) / wide, -1.0), 1.0)
    s = b * (0.75 - 0.25 * b * b) - a * (0.75 - 0.25 * a * a)
    by_a, by_b = 0.75 * (1.0 - a * a) / wide, 0.75 * (1.0 - b * b) / wide
    by_into, by_along = by_b * heel_cos - by_a * toe_cos, by_b * heel_sin + by_a * toe_sin
    by_x, by_z = by_into * nx - by_along * nz, by_into * nz + by_along * nx
    steep, edge = 2.0 * part * np.abs(s), part * s * np.abs(s)
    return (
        1.0 - part * s * s, -2.0 * part * s * by_x, -2.0 * part * s * by_z,
        edge * along, steep * along * by_x - edge * nz, steep * along * by_z + edge * nx,
    )  # fmt: skip


@inlined_fast
def slid(law, hx, hz):
    """Stress per depth on a face along its motion h, cos 2 beta = h_x^2 - h_z^2, and its derivatives by h."""
    c, s = hx * hx - hz * hz, 2.0 * hx * hz
    mxx, mzz, xz = law.C01 + law.C_sum * c, law.B01 + law.B_sum * c, hx * hz
    return (
        -law.D10 * s - mxx * hx - law.C_diff * s * hz,
        law.A00 + law.A10 * c + law.B_diff * s * hx - mzz * hz,
        -2.0 * law.D10 * hz - mxx - 2.0 * law.C_sum * hx * hx - 2.0 * law.C_diff * hz * hz,
        -2.0 * law.D10 * hx + (2.0 * law.C_sum - 4.0 * law.C_diff) * xz,
        2.0 * law.A10 * hx + (4.0 * law.B_diff - 2.0 * law.B_sum) * xz,
        -2.0 * law.A10 * hz + 2.0 * law.B_diff * hx * hx - mzz + 2.0 * law.B_sum * hz * hz,
    )


EFFECTS["shadowing"] = Shadowing
VARIANTS["shadowing_in_motion"] = Shadowing(hull="motion")
