"""A walk by SciPy's LSODA with the readable law in its angles: a second program, for tests."""

import numpy as np
from scipy.integrate import solve_ivp

from footopt.effects.shadowing import filler
from footopt.walk.plates import plate_states


def lsoda_objectives(walk, rtol=1e-9):
    """The five objectives of a walk, of chord plates, that is simulated again to a relative tolerance.

    It takes the plates, the creep speed and the start of the walk that is given, integrates work and height
    along with the motion, and shares no code with the compiled walk but the effects' hooks.
    """
    scene, accuracy = walk.scene, walk.accuracy
    walker, t_f = scene.walker, scene.duration
    plates = walk.foot.plates(accuracy.plates, "chord", directed=True, fill=filler(scene.effects))
    tilt, g = scene.gravity

    def at(t, state):
        """The plates at times (T,) in states (4, T)."""
        pose = scene.gait.pose(t, walker.l1, walker.l2)
        return plate_states(plates, pose, state[:2].T, state[2:].T, scene, accuracy.creep, angles=True)

    def rate(t, y):
        states = at(np.array([t]), y[:4, None])
        fx, fz = states.total.sum(axis=(0, 1))
        ax, az = fx / walker.mass + (tilt or 0.0), fz / walker.mass - g
        return np.array([y[2], y[3], ax, az, states.power.sum(), y[1]])

    start, tight = [0.0, walk.start[1], 0.0, 0.0, 0.0, 0.0], {"rtol": rtol, "atol": 1e-2 * rtol}
    solution = solve_ivp(rate, (0.0, t_f), start, "LSODA", max_step=5e-3, dense_output=True, **tight)
    t = np.linspace(scene.gait.heel_strike, t_f, 20_001)
    states = solution.sol(t)[:4]
    pieces = [slice(i, i + 1000) for i in range(0, len(t), 1000)]
    power = np.concatenate([at(t[piece], states[:, piece]).power.sum(axis=-1) for piece in pieces])
    return {
        "distance": float(solution.y[0, -1]),
        "mean_height": float(solution.y[5, -1] / t_f),
        "work": float(abs(solution.y[4, -1])),
        "peak_power": float(np.abs(power).max()),
        "speed_loss": float(np.max(np.maximum.accumulate(states[2]) - states[2])),
    }
