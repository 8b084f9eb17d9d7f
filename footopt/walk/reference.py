"""The walk and the contact of a foot written a second time, from the readable law: what the compiled
ones are held against."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from footopt.effects import readable
from footopt.foot import Foot
from footopt.sand import StressMap, affine, alpha
from footopt.walk.accuracy import Accuracy
from footopt.walk.contact import CONTACT, FX, FZ, TALLY, contact
from footopt.walk.prepare import sole, world
from footopt.walk.results import Walk
from footopt.walk.scene import Scene

Array = NDArray[np.float64]
#: Stresses per depth, (plates, 2), of slopes beta (plates,), velocities (plates, 2) and a creep speed.
Law = Callable[[Array, Array, float, StressMap], Array]

BURIED = 0.02  # m, mean depth of the sole where the law is asked without a walk


def smoothed_law(beta: Array, velocity: Array, creep: float, stress_map: StressMap) -> Array:
    """Stresses per depth by the affine form, with the direction of motion smoothed as in the walk."""
    a, m = affine(beta, stress_map)
    h = velocity / np.sqrt(np.sum(velocity**2, axis=-1, keepdims=True) + creep**2)
    return np.asarray(a - np.einsum("pij,pj->pi", m, h))


def law_of_angles(beta: Array, velocity: Array, creep: float, stress_map: StressMap) -> Array:
    """Stresses per depth as published, in the angles beta and gamma; `creep` is not in it."""
    ax, az = alpha(beta, np.arctan2(-velocity[:, 1], velocity[:, 0]), stress_map)
    return np.stack([-ax, az], axis=-1)


def contact_forces(
    foot: Foot, scene: Scene, plates: int, motion: tuple[float, float, float], creep: float, law: Law
) -> tuple[Array, Array, float]:
    """The force on one level, buried foot, by the compiled contact and by a readable law.

    Parameters
    ----------
    foot : Foot
        Divided into chords.
    scene : Scene
        Its sand and effects are used.
    plates : int
        How many.
    motion : (float, float, float), m/s and rad/s
        The hip's velocity in x and z, and the foot's rate of turn.
    creep : float, m/s
        The creep speed.
    law : callable
        `smoothed_law` or `law_of_angles`.

    Returns
    -------
    compiled, readable : (2,), N
        The force in x and z.
    size : float, N
        Sum of the plates' forces, to which differences are to be related.
    """
    p = foot.plates(plates, "chord", directed=True)
    assert p.tx is not None, "asked for"
    assert p.tz is not None, "asked for"
    (vx, vz, rate), out, tally = motion, np.zeros((2, CONTACT)), np.zeros(TALLY, np.int64)
    pose = np.zeros((2, 7))
    pose[:, 4], pose[0, 6] = 1.0, rate
    pose[0, 1], pose[1, 1] = -1.0, 10.0  # the other foot is in the air
    z = 1.0 - float(np.mean(p.z)) - BURIED
    laws = world(scene, Accuracy(creep=creep))
    contact(out, tally, sole(p), laws, pose, 0.0, z, vx, vz, creep, 1e-3)
    x, depth = p.x[0], np.maximum(-(z - 1.0 + p.z[0]), 0.0)
    velocity = np.stack([vx - rate * p.z[0], vz + rate * x], axis=-1)
    normal = np.stack([p.tz[0], -p.tx[0]], axis=-1)
    stress = law(np.arctan2(p.tz[0], p.tx[0]), velocity, creep, scene.sand.stress_map)
    into = np.sum(normal * velocity, axis=-1)
    load, share, push = readable(scene.effects, depth, x, into, creep)
    forces = (scene.sand.zeta * load * share)[:, None] * stress - push[:, None] * normal
    forces *= p.area[0][:, None]
    return out[0][[FX, FZ]], forces.sum(axis=0), float(np.linalg.norm(forces, axis=-1).sum())


def lsoda_objectives(walk: Walk, rtol: float = 1e-9) -> dict[str, float]:
    """The five objectives of a walk that is simulated again by SciPy's LSODA.

    It takes the law in its angle form and the plates, the creep speed and the start of the walk that is
    given, integrates work and height along with the motion, and shares no code with the compiled walk.
    The scene's effects are left out.

    Parameters
    ----------
    walk : Walk
        Of chord plates.
    rtol : float
        Relative tolerance of the integration.
    """
    from scipy.integrate import solve_ivp

    foot, scene, accuracy = walk.foot, walk.scene, walk.accuracy
    walker, t_f = scene.walker, scene.duration
    points = foot.points(accuracy.plates)
    chord, middle = np.diff(points, axis=0), 0.5 * (points[1:] + points[:-1]) - foot.ankle
    angle = np.arctan2(chord[:, 1], chord[:, 0])
    area = np.hypot(*chord.T) * foot.width

    def contact(t: Array, state: Array) -> tuple[Array, Array]:
        """Force (T, 2 feet, 2) and power (T, 2) of states (4, T)."""
        pose = scene.gait.pose(t, walker.l1, walker.l2)
        cos, sin = np.cos(pose.pitch)[..., None], np.sin(pose.pitch)[..., None]
        rx, rz = cos * middle[:, 0] - sin * middle[:, 1], sin * middle[:, 0] + cos * middle[:, 1]
        depth = np.maximum(-(state[1][:, None] + pose.z)[..., None] - rz, 0.0)
        vx = (state[2][:, None] + pose.vx)[..., None] - pose.rate[..., None] * rz
        vz = (state[3][:, None] + pose.vz)[..., None] + pose.rate[..., None] * rx
        beta, gamma = angle + pose.pitch[..., None], np.arctan2(-vz, vx)
        forth = alpha(beta, gamma, scene.sand.stress_map)
        back = alpha(beta, gamma + np.pi, scene.sand.stress_map)
        speed = np.hypot(vx, vz)
        h = speed / np.sqrt(speed**2 + accuracy.creep**2)  # the part that turns with the motion
        ax, az = (0.5 * (f + b) + h * 0.5 * (f - b) for f, b in zip(forth, back, strict=True))
        pull = scene.sand.zeta * depth * area
        fx, fz = -pull * ax, pull * az
        force = np.stack([fx.sum(axis=-1), fz.sum(axis=-1)], axis=-1)
        return force, (fx * vx + fz * vz).sum(axis=-1)

    def rate(t: float, y: Array) -> Array:
        force, power = contact(np.array([t]), y[:4, None])
        fx, fz = force[0].sum(axis=0)
        return np.array([y[2], y[3], fx / walker.mass, fz / walker.mass - walker.g, power.sum(), y[1]])

    start, tight = [0.0, walk.start[1], 0.0, 0.0, 0.0, 0.0], {"rtol": rtol, "atol": 1e-2 * rtol}
    solution = solve_ivp(rate, (0.0, t_f), start, "LSODA", max_step=5e-3, dense_output=True, **tight)
    t = np.linspace(scene.gait.heel_strike, t_f, 20_001)
    states = solution.sol(t)
    pieces = [slice(i, i + 1000) for i in range(0, len(t), 1000)]
    power = np.concatenate([contact(t[piece], states[:4, piece])[1] for piece in pieces])
    return {
        "distance": float(solution.y[0, -1]),
        "mean_height": float(solution.y[5, -1] / t_f),
        "work": float(abs(solution.y[4, -1])),
        "peak_power": float(np.abs(power).max()),
        "speed_loss": float(np.max(np.maximum.accumulate(states[2]) - states[2])),
    }
