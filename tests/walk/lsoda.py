"""A walk by SciPy's LSODA with the readable law in its angles: a second program, for tests."""

import numpy as np
from scipy.integrate import solve_ivp

from footopt.effects import base as effects
from footopt.effects import laws, reshaping
from footopt.sand import alpha


def by_angles(beta, velocity, creep, stress_map):
    """Stress per depth on plates with angles beta (rad) that move, (..., 2), N/m^3, smoothed by creep.

    The terms in gamma change their sign with the direction of motion, the others do not.
    """
    vx, vz = velocity[..., 0], velocity[..., 1]
    gamma, speed = np.arctan2(-vz, vx), np.hypot(vx, vz)
    there, back = alpha(beta, gamma, stress_map), alpha(beta, gamma + np.pi, stress_map)
    share = speed / np.sqrt(np.maximum(speed * speed + creep * creep, 1e-300))
    ax, az = (0.5 * (t + b) + share * 0.5 * (t - b) for t, b in zip(there, back, strict=True))
    return np.stack([-ax, az], axis=-1)


def plates_by_angles(plates, pose, com, velocity, scene, creep):
    """Force and velocity of chord plates at M instants, (M, 2 feet, N, 2): eqs. 4 and 1 as published."""
    x, z, tx, tz = plates.x[0], plates.z[0], plates.tx[0], plates.tz[0]
    cos, sin, rate = np.cos(pose.pitch)[..., None], np.sin(pose.pitch)[..., None], pose.rate[..., None]
    ahead, up = cos * x - sin * z, sin * x + cos * z
    vx = (velocity[:, 0, None] + pose.vx)[..., None] - rate * up
    vz = (velocity[:, 1, None] + pose.vz)[..., None] + rate * ahead
    depth = np.maximum(-((com[:, 1, None] + pose.z)[..., None] + up), 0.0)
    place = (com[:, 0, None] + pose.x)[..., None] + ahead
    v, normal = np.stack([vx, vz], axis=-1), np.stack([sin * tx + cos * tz, sin * tz - cos * tx], axis=-1)
    stress = by_angles(np.arctan2(tz, tx) + pose.pitch[..., None], v, creep, scene.sand.stress_map)
    acting, vn = laws(scene.effects), np.sum(normal * v, axis=-1)
    load, gate = effects.load(acting.loads, depth, place), effects.gate(acting.gates, vn / creep, depth)
    push = effects.push(acting.pushes, vn, depth)
    area = plates.area[0]
    return (scene.zeta * load * gate * area)[..., None] * stress - (push * area)[..., None] * normal, v


def lsoda_objectives(walk, rtol=1e-9):
    """The five objectives of a walk, of chord plates, that is simulated again to a relative tolerance.

    It takes the plates, the creep speed and the start of the walk that is given, integrates work and height
    along with the motion, and shares no code with the compiled walk but the effects' hooks.
    """
    scene, accuracy = walk.scene, walk.accuracy
    walker, t_f = scene.walker, scene.duration
    plates = walk.foot.plates(accuracy.plates, "chord", fill=reshaping(scene.effects))
    tilt, g = scene.gravity

    def at(t, state):
        """Force and power of the plates at times (T,) in states (4, T)."""
        pose = scene.gait.pose(t, walker.l1, walker.l2)
        force, v = plates_by_angles(plates, pose, state[:2].T, state[2:].T, scene, accuracy.creep)
        return force, np.sum(force * v, axis=-1)

    def rate(t, y):
        force, power = at(np.array([t]), y[:4, None])
        fx, fz = force.sum(axis=(0, 1, 2))
        ax, az = fx / walker.mass + tilt, fz / walker.mass - g
        return np.array([y[2], y[3], ax, az, power.sum(), y[1]])

    start, tight = [0.0, walk.start[1], 0.0, 0.0, 0.0, 0.0], {"rtol": rtol, "atol": 1e-2 * rtol}
    solution = solve_ivp(rate, (0.0, t_f), start, "LSODA", max_step=5e-3, dense_output=True, **tight)
    t = np.linspace(scene.gait.heel_strike, t_f, 20_001)
    states = solution.sol(t)[:4]
    pieces = [slice(i, i + 1000) for i in range(0, len(t), 1000)]
    power = np.concatenate([at(t[piece], states[:, piece])[1].sum(axis=-1) for piece in pieces])
    return {
        "distance": float(solution.y[0, -1]),
        "mean_height": float(solution.y[5, -1] / t_f),
        "work": float(abs(solution.y[4, -1])),
        "peak_power": float(np.abs(power).max()),
        "speed_loss": float(np.max(np.maximum.accumulate(states[2]) - states[2])),
    }
