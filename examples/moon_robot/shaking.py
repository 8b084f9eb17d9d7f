"""A measure of one's own: how hard the trunk is shaken, as its camera would see it."""

import numpy as np

from footopt.walk.objectives import measure


@measure("walk", "$a_{\\mathrm{rms}}$", "m/s^2", maximise=False, worst=1e3, least=0.0)
def shaking(walk):
    """Root mean square of the vertical acceleration of the trunk from the first heel strike."""
    late = walk.t >= walk.scene.gait.heel_strike
    return float(np.sqrt(np.mean(np.gradient(walk.velocity[late, 1], walk.t[late]) ** 2)))
