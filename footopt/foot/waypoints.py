"""The design space: integer heights of waypoints along the sole, joined by a cubic spline.

Everything here works on a whole population at once, design by design or with elementwise operations,
so that a sole does not depend, to the last bit, on the batch it is computed in.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from footopt.arrays import Array, Bools, Ints
from footopt.compiled import cached_njit, inlined
from footopt.errors import SettingError, check, check_kind, check_number, check_whole, is_number

FINE = 32  # samples of the spline between two waypoints, for its arc length and its box violation


@dataclass(frozen=True)
class Waypoints:
    """A space of soles: n waypoints, uniform in x over [-L, L], at z_i = -k_i H / K.

    The heights k_i are whole numbers from 1 (high) to K (low); a cubic spline with not-a-knot ends joins
    the points. The paper's eq. 8 gives x_i = (i-1)(3-n)L/(n-1), which does not span the box;
    x_i = -L + 2L(i-1)/(n-1) does, and is used here.

    Parameters
    ----------
    n : int
        Waypoints, 4 or more.
    K : int
        Levels of height, from 1 (high) to K (low).
    L : float, m
        Half the length of the box in which the sole lies.
    H : float, m
        Height of the box, which reaches from -H to 0.
    width : float, m
        Width of the feet; the paper does not give it.
    ankle : (2,), m
        Place of the ankle in the foot frame; the paper does not give it.
    box_tolerance : float
        How far a spline may leave the box [-H, 0] between waypoints before the design is infeasible, in
        units of H; infinity is the paper's choice.
    closed : bool
        Whether the sides and the top of the foot feel the sand, too, not only the sole.
    top : float, m
        Height of the foot's flat top in the foot frame.

    Raises
    ------
    SettingError
        A value is out of range.
    """

    n: int = 11
    K: int = 10
    L: float = 0.13
    H: float = 0.03
    width: float = 0.10
    ankle: tuple[float, float] = (0.0, 0.0)
    box_tolerance: float = 0.05
    closed: bool = False
    top: float = 0.0

    def __post_init__(self) -> None:
        hint = "A not-a-knot cubic spline needs four points; the paper's feet have 11."
        check_whole("foot.n", self.n, 4, 200, hint)
        check_whole("foot.K", self.K, 1, 10**6)
        check_length("foot.L", self.L)
        check_length("foot.H", self.H)
        check_dimensions(self.width, self.ankle, self.top, self.closed)
        object.__setattr__(self, "ankle", tuple(self.ankle))
        allowed = "a number >= 0, in units of H (.inf: no constraint, as in the paper)"
        check_number("foot.box_tolerance", self.box_tolerance, 0, np.inf, allowed)

    @property
    def x(self) -> Array:
        """The waypoints' x_p, (n,), m."""
        return -self.L + 2.0 * self.L * np.arange(self.n) / (self.n - 1)

    def check(self, k: ArrayLike) -> Ints:
        """The heights as whole numbers, (designs, n); raises `SettingError` for others."""
        try:
            given = np.atleast_2d(np.asarray(k, float))
        except (TypeError, ValueError):  # words, or rows of different lengths
            given = np.empty((0, 0))
        allowed = f"{self.n} whole numbers (foot.n) from 1 to {self.K} a design"
        hint = f"For as many as these set foot.n={given.shape[-1]}." if given.shape[-1] > 3 else ""
        check(given.ndim == 2 and given.shape[1] == self.n, "foot.k", k, allowed, hint)
        bad = ~((given >= 1) & (given <= self.K) & (given == np.rint(given)))
        if bad.any():
            row, column = map(int, np.argwhere(bad)[0])
            allowed, hint = f"a whole number from 1 to K = {self.K}", "Raise foot.K for a finer grid."
            raise SettingError(f"foot.k[{column}]", given[row, column].item(), allowed, hint)
        return given.astype(np.int64)

    def heights(self, k: ArrayLike) -> Array:
        """z_p of the waypoints, (designs, n), m."""
        return -self.check(k).astype(np.float64) * (self.H / self.K)

    def contour(self, k: ArrayLike) -> Array:
        """The soles as dense polylines from heel to toe, (designs, (n-1) FINE + 1, 2), m."""
        z = self.heights(k)
        x = -self.L + 2.0 * self.L * (np.arange((self.n - 1) * FINE + 1) / FINE) / (self.n - 1)
        return np.stack(np.broadcast_arrays(x, fine_heights(z, slope_matrix(self.n))), axis=-1)

    def points(self, k: ArrayLike, steps: int) -> Array:
        """Points on the spline at equal steps along its arc, (designs, steps + 1, 2), m."""
        z, spacing = self.heights(k), 2.0 * self.L / (self.n - 1)
        return np.asarray(arc_points(z, slope_matrix(self.n), spacing, steps))

    def box_violation(self, k: ArrayLike) -> Array:
        """How far each spline leaves the box [-H, 0], (designs,), m; 0 inside."""
        z = self.heights(k)
        return np.asarray(leaves(z, slope_matrix(self.n), self.H))

    def inside(self, k: ArrayLike) -> Bools:
        """Which soles stay in the box, but for `box_tolerance`, (designs,)."""
        return np.asarray(self.box_violation(k) <= self.box_tolerance * self.H)

    def random(self, designs: int, seed: int, inside: bool = False) -> Ints:
        """Random designs, (designs, n): of a seed always the same, of those `inside` the box if asked for.

        Raises `SettingError` if hardly any random sole respects the box.
        """
        check_whole("designs", designs, 0, 10**9)
        check_whole("seed", seed, 0, 2**63)
        rng, kept = np.random.default_rng(seed), np.empty((0, self.n), np.int64)
        if not inside:
            return rng.integers(1, self.K + 1, (designs, self.n))
        for _ in range(1000):
            k = rng.integers(1, self.K + 1, (max(designs, 64), self.n))
            kept = np.concatenate([kept, k[self.inside(k)]])
            if len(kept) >= designs:
                return kept[:designs]
        allowed = "large enough that random soles are found inside the box"
        hint = f"With foot.n={self.n} and foot.K={self.K} hardly any is."
        raise SettingError("foot.box_tolerance", self.box_tolerance, allowed, hint)


def heights_text(k: ArrayLike) -> str:
    """Heights as texts and the command line have them: [5,8,9,8]."""
    return f"[{','.join(map(str, np.asarray(k).tolist()))}]"


def as_space(space: Waypoints | None, n: int = Waypoints.n) -> Waypoints:
    """The design space that is given, or else the paper's with n waypoints."""
    if space is None:
        return Waypoints(n=n)
    check_kind("space", space, Waypoints, "fo.Waypoints(n=11, K=10) is the paper's.")
    return space


def check_length(setting: str, value: float) -> None:
    """Raise unless a length can be one of a foot."""
    check_number(setting, value, 1e-4, 10.0, "a length from 1e-4 to 10, in m")


def check_dimensions(width: float, ankle: tuple[float, float], top: float, closed: bool) -> None:
    """Raise unless these are the width, the ankle's place and the top's height of a foot, closed or not."""
    check_length("foot.width", width)
    place = np.shape(ankle) == (2,) and all(is_number(at) and abs(at) <= 10.0 for at in ankle)
    check(place, "foot.ankle", ankle, "two numbers [x_p, z_p] from -10 to 10, in m")
    check_number("foot.top", top, -10, 10, "a finite height in the foot frame, from -10 to 10, in m")
    check(isinstance(closed, bool | np.bool_), "foot.closed", closed, "true or false")


@lru_cache
def slope_matrix(n: int) -> Array:
    """Slopes of the not-a-knot spline at its knots, from the values: dz/du = matrix @ z.

    To the bit those of scipy's CubicSpline, whose import takes longer than 3,000 walks.
    """
    from scipy.linalg import solve_banded

    rise = np.diff(np.eye(n), axis=0)  # of each piece, from the values
    ends = np.array([5.0 * rise[0] + rise[1], rise[-2] + 5.0 * rise[-1]]) / 2.0
    right = np.vstack([ends[:1], 3.0 * (rise[:-1] + rise[1:]), ends[1:]])
    # s0 + 2 s1, s[i-1] + 4 s[i] + s[i+1], and 2 s[n-2] + s[n-1] are these
    bands = np.array(
        [[0.0, 2.0, *[1.0] * (n - 2)], [1.0, *[4.0] * (n - 2), 1.0], [*[1.0] * (n - 2), 2.0, 0.0]]
    )
    slopes: Array = solve_banded((1, 1), bands, right)
    before, bend = slopes[-2], slopes[-2] + slopes[-1] - 2.0 * rise[-1]
    slopes[-1] = before + 2.0 * (rise[-1] - before - bend) + 3.0 * bend  # at the end of the last piece
    return slopes


@inlined
def _fill_slopes(slopes, z, matrix):
    """Fill in `slopes` with matrix @ z, whose sums BLAS may round differently from batch to batch."""
    for i in range(len(z)):
        total = 0.0
        for j in range(len(z)):
            total += z[j] * matrix[i, j]
        slopes[i] = total


@inlined
def _piece(z, slopes, i):
    """The coefficients of a spline (n,) between its waypoints i and i + 1, by the powers of u - i."""
    rise, d0, d1 = z[i + 1] - z[i], slopes[i], slopes[i + 1]
    return z[i], d0, 3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise


@inlined
def _height(piece, s):
    """The height of a piece where s = u - i, m."""
    z, slope, quadratic, cubic = piece
    return z + s * (slope + s * (quadratic + s * cubic))


@cached_njit(nogil=True, error_model="numpy")
def fine_heights(z, matrix):
    """Splines through z, (designs, n), m, at `FINE` steps a piece, (designs, (n-1) FINE + 1), m."""
    designs, n = z.shape
    out, slopes = np.empty((designs, (n - 1) * FINE + 1)), np.empty(n)
    for d in range(designs):
        _fill_slopes(slopes, z[d], matrix)
        for i in range(n - 1):
            piece = _piece(z[d], slopes, i)
            for j in range(FINE + 1):  # a piece's last point is the next one's first
                out[d, i * FINE + j] = _height(piece, j / FINE)
    return out


@cached_njit(nogil=True, error_model="numpy")
def leaves(z, matrix, depth):
    """How far splines through z, (designs, n), m, leave [-depth, 0] at `FINE` steps a piece, (designs,), m.

    A piece lies within the hull of its Bezier points. It is skipped if these leave no further than others.
    """
    worst, slopes, last = np.empty(len(z)), np.empty(z.shape[1]), z.shape[1] - 2
    for d in range(len(z)):
        worst[d] = 0.0
        _fill_slopes(slopes, z[d], matrix)
        for i in range(last + 1):
            hull = z[d, i], z[d, i] + slopes[i] / 3.0, z[d, i + 1] - slopes[i + 1] / 3.0, z[d, i + 1]
            if max(max(hull), -depth - min(hull)) > worst[d] - 1e-9 * depth:
                piece = _piece(z[d], slopes, i)
                for j in range(FINE + (i == last)):
                    height = _height(piece, j / FINE)
                    worst[d] = max(worst[d], height, -depth - height)
    return worst


@cached_njit(nogil=True, error_model="numpy")
def arc_points(z, matrix, spacing, steps):
    """Points at equal steps along the arcs of splines z(u), (designs, steps + 1, 2), m.

    z are waypoints, (designs, n), m; u counts them from 0, `spacing` is dx/du, m. The arc length is summed by
    the trapezoidal rule over `FINE` pieces between two waypoints; within a piece, u is linear in it. The
    points themselves are on the spline.
    """
    designs, n = z.shape
    pieces = (n - 1) * FINE
    out = np.empty((designs, steps + 1, 2))
    slopes, speed, arc = np.empty(n), np.empty(pieces + 1), np.empty(pieces + 1)
    arc[0] = 0.0
    for d in range(designs):
        _fill_slopes(slopes, z[d], matrix)
        for i in range(n - 1):
            _, slope, quadratic, cubic = _piece(z[d], slopes, i)
            for j in range(FINE + 1):
                s = j / FINE
                rate = slope + s * (2.0 * quadratic + 3.0 * s * cubic)
                speed[i * FINE + j] = np.sqrt(spacing * spacing + rate * rate)
        for j in range(pieces):
            arc[j + 1] = arc[j] + 0.5 * (speed[j] + speed[j + 1])
        step, first = arc[pieces] / steps, 0
        for i in range(n - 1):
            piece = _piece(z[d], slopes, i)
            for j in range(i * FINE, (i + 1) * FINE):
                end = steps + 1 if j == pieces - 1 else int(arc[j + 1] / step) + 1
                begin, per_length = (j - i * FINE) / FINE, 1.0 / (FINE * (arc[j + 1] - arc[j]))
                for m in range(first, end):
                    s = begin + (m * step - arc[j]) * per_length
                    out[d, m, 0] = spacing * (i + s - 0.5 * (n - 1))
                    out[d, m, 1] = _height(piece, s)
                first = end
    return out
