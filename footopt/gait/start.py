"""From standing to walking: the phase starts at mid-stance and speeds up while the angles blend in.

A blend of the angles alone would drive the hip backwards; the phase ramp keeps it going forwards.
With r = T/2, S5(s) = 10 s^3 - 15 s^4 + 6 s^5 and I5 its integral,

    s = clip((t - t0)/r, 0, 1),  q = clip((t - t0)/(T/3), 0, 1)
    phase_left = 1/4 + I5(s)/2 until t = t0 + r, then 1/2 + (t - t0 - r)/T
    angles = (1 - w) standing + w cycle(phase),  w_left = S5(q), w_right = S5(s)

The left foot's weight ends sooner because it carries the body; angles and rates are continuous for
every T. The paper's walker "first stands with the left leg steadily" and starts at 0.5 s.
"""

import numpy as np

from footopt.arrays import Array

_LIFT = np.radians(20.0)
#: Thigh, shank and pitch (rad) when standing, each for the left and the right leg. The left leg is
#: straight; the right thigh and knee are bent by 20 deg: its foot is level and 2.8 cm higher.
STANDING = (np.array([0.0, _LIFT]), np.zeros(2), np.zeros(2))


def smooth_step(s: Array) -> tuple[Array, Array]:
    """S5 and its derivative: from 0 to 1 with two flat derivatives at each end."""
    return s**3 * (10.0 - 15.0 * s + 6.0 * s * s), 30.0 * s * s * (1.0 - s) ** 2


def ramp(t: Array, t0: float, period: float) -> tuple[Array, Array, Array, Array]:
    """Phase (strides), its rate, weight of the cycle and its rate at times t (T,), s, each (T, 2 feet).

    The walk starts at t0, s, infinity for standing still; a stride takes the period, s.
    """
    r = period / 2.0
    since = t - t0
    s, q = np.clip(since / r, 0.0, 1.0), np.clip(since / (period / 3.0), 0.0, 1.0)
    phase = 0.25 + 0.5 * s**4 * (2.5 - 3.0 * s + s * s) + np.maximum(since - r, 0.0) / period
    (w_right, right_rate), (w_left, left_rate) = smooth_step(s), smooth_step(q)
    phase_rate = smooth_step(s)[0] / period
    return (
        np.stack([phase, phase + 0.5], axis=-1),
        np.stack([phase_rate, phase_rate], axis=-1),
        np.stack([w_left, w_right], axis=-1),
        np.stack([left_rate / (period / 3.0), right_rate / r], axis=-1),
    )
