"""A measure of one's own: how hard the trunk is shaken, as its camera would see it."""

import numpy as np

from footopt.walk.objectives import measure


@measure("walk", "$a_{\\mathrm{rms}}$", "m/s^2", maximise=False, worst=1e3, least=0.0)
def shaking(walk):
    """Root mean square over time of the vertical acceleration of the trunk from the first heel strike.

    Steps are shorter where more happens, so that a mean over samples is none over time.
    """
    late = walk.t >= walk.scene.gait.heel_strike
    t, acceleration = walk.t[late], np.gradient(walk.velocity[late, 1], walk.t[late])
    return float(np.sqrt(np.trapezoid(acceleration**2, t) / (t[-1] - t[0])))
