"""Tables of the joints and servos of a MuJoCo model, from which `step.pulls` foresees their forces."""

from __future__ import annotations

from typing import Any

import numpy as np

from footopt.arrays import Array

RK4 = 1  # MuJoCo's number of its second explicit integrator; those after it are implicit

#: A degree of freedom of MuJoCo's, in radians or metres.
FREEDOM = np.dtype(
    [
        ("first", np.int64),  # of its row in the sparse inertia
        ("last", np.int64),  # of its row: the diagonal's element
        ("damping", float),  # of the joint, N m s
        ("stiffness", float),  # of the joint, N m
        ("torques", float, 2),  # range of all its servos together, N m
    ]
)

#: An actuator of a hinge or slide: (gain . q) input + bias . q with q = (1, length, velocity), in a range.
SERVO = np.dtype(
    [
        ("freedom", np.int64),
        ("gear", float),
        ("output", np.int64),  # of its length and velocity in MuJoCo's arrays
        ("control", np.int64),  # its input in ctrl, or -1 where it is an activation
        ("activation", np.int64),  # its input in act
        ("gain", float, 3),
        ("bias", float, 3),
        ("inputs", float, 2),  # range
        ("forces", float, 2),  # range
    ]
)


def freedoms(mujoco: Any, model: Any) -> Any:
    """The table of `FREEDOM`, (nv,)."""
    table = np.zeros(model.nv, FREEDOM)
    table["first"], table["last"] = model.M_rowadr, model.M_rowadr + model.M_rownnz - 1
    turns = model.jnt_type >= 2  # hinges and slides, whose springs have one number
    rows, off = model.jnt_dofadr[turns], model.opt.disableflags
    if not off & mujoco.mjtDisableBit.mjDSBL_DAMPER:
        table["damping"] = model.dof_damping
        own = getattr(model, "actuator_damping", np.zeros(model.nu)) * model.actuator_gear[:, 0] ** 2
        on_joints = model.actuator_trntype <= 1
        dofs = model.jnt_dofadr[model.actuator_trnid[on_joints, 0]]
        np.add.at(table["damping"], dofs, own[on_joints])
    if not off & mujoco.mjtDisableBit.mjDSBL_SPRING:
        table["stiffness"][rows] = model.jnt_stiffness[turns]
    limited = model.jnt_actfrclimited[turns, None]
    table["torques"] = -np.inf, np.inf
    table["torques"][rows] = np.where(limited, model.jnt_actfrcrange[turns], [-np.inf, np.inf])
    return table


def servos(mujoco: Any, model: Any) -> Any:
    """The table of `SERVO`: enabled actuators with one input. Others are assumed to pull as before."""
    found, everywhere, each = [], (-np.inf, np.inf), np.arange(model.nu)
    control, output = (getattr(model, f"actuator_{name}adr", each) for name in ("ctrl", "out"))  # since 3.11
    off = model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_ACTUATION
    for i in range(0 if off else len(model.actuator_trntype)):
        joint, dynamics, group = (getattr(model, f"actuator_{n}")[i] for n in ("trnid", "dyntype", "group"))
        affine = model.actuator_gaintype[i], model.actuator_biastype[i]  # 0: fixed gain and no bias
        known = model.actuator_trntype[i] <= 1 and model.jnt_type[joint[0]] >= 2 and max(affine) <= 1
        known &= dynamics <= int(mujoco.mjtDyn.mjDYN_FILTEREXACT) and model.actuator_plugin[i] < 0
        if not known or (group >= 0 and model.opt.disableactuator >> group & 1):
            continue
        kind = "act" if dynamics else "ctrl"
        limited, inputs = (getattr(model, f"actuator_{kind}{what}")[i] for what in ("limited", "range"))
        limited &= not (dynamics or model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CLAMPCTRL)
        forces = model.actuator_forcerange[i] if model.actuator_forcelimited[i] else everywhere
        found.append((
            model.jnt_dofadr[joint[0]], model.actuator_gear[i, 0], output[i],
            -1 if dynamics else control[i], model.actuator_actadr[i] + model.actuator_actnum[i] - 1,
            model.actuator_gainprm[i, :3] * [1, *2 * affine[:1]], model.actuator_biasprm[i, :3] * affine[1],
            inputs if limited else everywhere, forces,
        ))  # fmt: skip
    return np.array(found, SERVO)


def at_joints(model: Any, forces: Array) -> tuple[Array, Array]:
    """Forces of actuators (steps, actuators), limited to the ranges of their joints, and their gears."""
    joints, direct, forces = model.actuator_trnid[:, 0], model.actuator_trntype <= 1, forces.copy()
    gear = np.where(direct, model.actuator_gear[:, 0], 1.0)
    for joint in np.flatnonzero(model.jnt_actfrclimited):
        own = direct & (joints == joint)
        total = (forces[:, own] * gear[own]).sum(axis=1, keepdims=True)
        held = np.clip(total, *model.jnt_actfrcrange[joint])
        forces[:, own] *= np.divide(held, total, out=np.ones_like(total), where=held != total)
    return forces, gear
