"""One walk of a robot in MuJoCo: its start, its steps, and its outcome."""

import ctypes
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache
from threading import Lock
from typing import Any, NamedTuple

import numpy as np

from footopt.arrays import Array
from footopt.errors import check
from footopt.foot import Foot
from footopt.mujoco.attaching import Contact
from footopt.mujoco.controllers import Tracker
from footopt.mujoco.joints import RK4, at_joints
from footopt.mujoco.model import Model, with_step
from footopt.mujoco.native import library
from footopt.walk import FIVE, Accuracy

#: Quantities that a walk measures, beside how well servos follow.
MEASURED = (*FIVE, "joint_work", "torque", "survival", "maximum_sinkage", "peak_vertical_force")
HIGH = 100.0  # m, above the sand, for a walk in the air
SQUARE = 0.5  # cosine of how far the axes of a foot may be from forward and up at the start
AXES = [0, 2]  # x and z of three
_LOCK, _quieted = Lock(), list[Any]()  # an entry per walk under way; the first has MuJoCo's own settings


class Outcome(NamedTuple):
    """The outcome of a walk, up to its failure if it fails."""

    totals: dict[str, float]
    reason: str
    evaluations: int
    t: Array  # (T,), s: ends of steps
    com: Array  # (T + 1, 3), m: beginnings, and the end
    velocity: Array  # (T + 1, 3), m/s
    sand: Array  # (T, feet, `step.TRACED`)
    states: Array  # (T, states)
    bristles: Array  # (T, feet, 3, faces), in the feet's own axes; empty unless they are traced


@contextmanager
def quiet() -> Iterator[None]:
    """Keep MuJoCo from warning of walks that diverge, and from writing a log: they have a reason.

    Also keep it from reading the clock in every part of a step, which takes a twentieth of a walk.
    """
    import mujoco

    clock = ctypes.c_void_p.in_dll(library(), "mjcb_time")
    with _LOCK:
        _quieted.append((mujoco.get_mju_user_warning(), clock.value))
        mujoco.set_mju_user_warning(lambda message: None)
        clock.value = None
    try:
        yield
    finally:
        with _LOCK:
            if len(_quieted) == 1:
                mujoco.set_mju_user_warning(_quieted[0][0])
                clock.value = _quieted[0][1]
            del _quieted[-1]


def walk(robot: Any, foot: Foot | None, accuracy: Accuracy, end: float, traced: bool = False) -> Outcome:
    """Walk with a foot until `end`, s; with None in the air."""
    import mujoco

    steps, model = max(1, math.ceil(end / accuracy.dt - 1e-9)), robot.model
    if foot and robot.density is not None:
        model = model.wearing(foot, robot.density)
    t, height = end / steps * np.arange(steps + 1, dtype=np.float64), robot.model.height_address
    weight = model.mass * robot.g
    own = with_step(model, t[1])
    data = mujoco.MjData(own)
    posed(robot, own, data)
    if foot is None:
        data.qpos[height] += HIGH
        states, sensed = stepped(robot, own, data, t)
        counts, sand = {"evaluations": 0, "failures": 0}, np.zeros((steps, len(robot.feet), 6))
        return outcome(robot, t, sensed, sand, states, counts)
    soles, plates = soles_of(robot, foot), 2 * accuracy.plates
    contact = Contact(own, data, soles, robot.sand, robot.effects, plates, steps + 1, traced)
    try:
        data.qpos[height] += contact.lift(weight)
        allowed = "one that carries the robot"
        check(math.isfinite(data.qpos[height]), "sand.zeta", robot.sand.zeta, allowed, "Or wider feet.")
        states, sensed = stepped(robot, own, data, t)
    finally:
        contact.detach()
    found = outcome(robot, t, sensed, contact.trace[:steps], states, contact.counts)
    bristles = np.stack([contact.bristles(name)[:steps] for name in soles], axis=1)
    return found._replace(bristles=bristles, totals=found.totals | {"weight": weight})


def stepped(robot: Any, model: Any, data: Any, t: Array) -> tuple[Array, Array]:
    """States after steps that begin at some times, and what sensors measure in them."""
    import mujoco

    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    states = np.empty((len(t), mujoco.mj_stateSize(model, kind)))
    sensed = np.empty((len(t), model.nsensordata))
    if robot.scripted:
        from mujoco import rollout

        mujoco.mj_getState(model, data, states[0], kind)
        commands, first = commands_at(robot.controller, robot.model, t.tobytes())[0], states[:1].copy()
        rollout.rollout(model, data, first, commands[None], state=states[None], sensordata=sensed[None])
        return states, sensed
    period, due = robot.model.compiled.opt.timestep, 0
    mujoco.mj_forward(model, data)  # what a controller sees first
    for n in range(len(t)):
        if (passed := int(t[n] / period + 1e-6)) >= due:  # shorter steps are no faster control
            robot.controller.function(model, data)
            due, wrong = passed + 1, data.ctrl[~np.isfinite(data.ctrl)]  # MuJoCo would replace them by 0
            check(not len(wrong), "robot.controller", robot.controller.name, "one that sets numbers", "nan?")
        mujoco.mj_step(model, data)
        sensed[n] = data.sensordata
        mujoco.mj_getState(model, data, states[n], kind)
    return states, sensed


def posed(robot: Any, model: Any, data: Any) -> Any:
    """Data of a robot in the pose in which it starts, at any height."""
    import mujoco

    mujoco.mj_resetData(model, data)
    if robot.key is not None:
        mujoco.mj_resetDataKeyframe(model, data, model.key(robot.key).id)
        data.time = 0.0
    elif isinstance(robot.controller, Tracker):
        for act, angle in commands_at(robot.controller, robot.model, np.zeros(1).tobytes())[1].items():
            data.qpos[model.jnt_qposadr[model.actuator_trnid[act, 0]]] = angle[0]
    mujoco.mj_kinematics(model, data)
    return data


def check_axes(robot: Any) -> None:
    """Raise unless gravity is down, and the feet's axes are forward and up at the start."""
    import mujoco

    model, (gx, gy, gz) = robot.model.compiled, robot.model.compiled.opt.gravity.tolist()
    check(-gz > abs(gx) + abs(gy), "robot.model", [gx, gy, gz], "of gravity along -z")
    data, allowed = posed(robot, model, mujoco.MjData(model)), "a body with x forward and z up at the start"
    hint = "Put a body inside of it that has these axes and no joint, and name that one."
    for name in robot.feet:
        x, _, z = data.body(name).xmat.reshape(3, 3).T
        check(min(x[0], z[2]) >= SQUARE, "robot.feet", name, allowed, hint)


def soles_of(robot: Any, foot: Foot) -> dict[str, Foot]:
    """The soles of a robot by name of the body, with the ankle at the body's origin."""
    places = [tuple(place) for place in (foot.ankle - robot.model.ankles[:, AXES]).tolist()]
    soles = {place: foot if place == tuple(foot.ankle) else replace(foot, ankle=place) for place in places}
    return {name: soles[place] for name, place in zip(robot.feet, places, strict=True)}


@lru_cache(maxsize=32)
def commands_at(controller: Any, model: Model, t: bytes) -> tuple[Array, dict[int, Array]]:
    """Commands at times, and the angles that a gait demands of joints then, by actuator."""
    of, times = model.compiled, np.frombuffer(t)
    wanted = controller.targets(of, times) if isinstance(controller, Tracker) else {}
    return controller.commands(of, times), wanted


def outcome(
    robot: Any, t: Array, sensed: Array, sand: Array, states: Array, counts: dict[str, int]
) -> Outcome:
    """The outcome of a walk from what sensors measured at the beginnings of its steps, and at its end."""
    model, m, steps = robot.model, robot.model.compiled, len(t) - 1
    own = sensed[:, sensed.shape[1] - 9 - 3 * m.nu :]  # sensors that `Model.read` has added last
    com, velocity, upright = np.split(own[:, :9], 3, axis=1)
    force, speed, place = (own[:, 9 + i :: 3] for i in range(3))
    reset = np.abs(states[:, 0] - t - t[1]) > 0.5 * t[1]  # MuJoCo resets a simulation that diverges
    lost = ~np.isfinite(com).all(axis=1) | ~np.isfinite(states).all(axis=1) | reset
    lean = np.einsum("ni,i->n", upright, upright[0])
    down = (com[:, 2] < robot.lowest * com[0, 2]) | (lean < math.cos(robot.tilt))
    ended = lost | down
    reason, end = "", max(int(np.argmax(ended)) - 1, 0) if ended.any() else steps
    if down.any():
        reason = "fallen"
    if lost.any() or counts["failures"]:
        reason = "diverged"
    totals = {"survival": float(t[end])}
    if not reason and com[-1, 0] <= com[0, 0]:
        reason = "backward"
    if not reason:
        late = t >= robot.after - 1e-9
        # force of a step: an implicit integrator takes the damping of servos at its end, but at their limits;
        # RK4 lets a servo follow its joint within the step
        servo = force.any(axis=0) & (m.actuator_biastype == 1)
        stiffness, damping = np.where(servo, m.actuator_biasprm[:, 1:3].T, 0.0)
        low, high = np.where(m.actuator_forcelimited[:, None], m.actuator_forcerange, [-np.inf, np.inf]).T
        given, (force, gear) = force, at_joints(m, force)
        implicit = (m.opt.integrator > RK4) & (low < force) & (force < high) & (force == given)
        mean = force[:-1] + implicit[:-1] * damping * np.diff(speed, axis=0)
        if m.opt.integrator == RK4:
            last = given[:-1] + stiffness * np.diff(place, axis=0) + damping * np.diff(speed, axis=0)
            mean = 0.5 * (force[:-1] + at_joints(m, np.clip(last, low, high))[0])
        power = np.maximum(mean * 0.5 * (speed[:-1] + speed[1:]), 0.0).sum(axis=1)
        v = velocity[late, 0]
        totals |= {
            "distance": com[-1, 0] - com[0, 0],
            "mean_height": np.trapezoid(com[:, 2], t) / t[-1],
            "work": abs(sand[-1, :, 4].sum()),
            "peak_power": np.abs(sand[late[1:], :, 3]).max(initial=0.0),
            "speed_loss": (np.maximum.accumulate(v) - v).max(initial=0.0),
            "joint_work": t[1] * power.sum(),
            "torque": np.abs(force * gear).max(initial=0.0),
            "maximum_sinkage": sand[..., 5].max(),
            "peak_vertical_force": sand[..., 2].sum(axis=1).max(),
        }
        if isinstance(robot.controller, Tracker):
            wanted = commands_at(robot.controller, model, t.tobytes())[1]
            missed = [place[:, act] - target for act, target in wanted.items()]
            totals["tracking_error"] = np.sqrt(np.mean(np.square(missed))) if missed else 0.0
    found = {name: float(value) for name, value in totals.items()}
    times, evaluations = t[1 : end + 1], counts["evaluations"]
    return Outcome(found, reason, evaluations, times, com, velocity, sand, states, bristles=np.empty(0))
