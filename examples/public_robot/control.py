"""A controller of gymnasium's Walker2d that walks on sand: robot.controller=control.py:step

SIMBICON (Yin, Loken & van de Panne, ACM Trans. Graph. 26, 2007) with steps by the clock: servos hold the
angles of a pose, the swing thigh's by the world and by how far and how fast the body is ahead of the stance
foot, and the stance hip turns the torso upright. Angles are in rad, positive forward, as the
model's joints have them.
"""

from __future__ import annotations

import numpy as np

STEP = 0.302  # s
STIFF, DAMPED, SOFT_ANKLE = 250.1, 25.01, 0.3  # N m/rad, N m s/rad, share of both in the swing ankle
GEAR = 100.0  # N m of a motor at a command of 1
EARLY = {"thigh": 0.38, "knee": -0.674}  # of the swing leg in the first half of a step
LATE = {"thigh": 0.317, "knee": -0.15}  # and in the second
SWING_FOOT, STANCE_KNEE, STANCE_PITCH, TORSO = 0.386, -0.073, 0.077, -0.045
AHEAD, FAST = 0.491, 0.511  # rad/m and rad s/m, by which the swing thigh reaches further
LEGS = [3, 4, 5], [6, 7, 8]  # hip, knee and ankle in qpos, the right leg's first
ANKLES = "foot_joint", "foot_left_joint"


def servo(target, angle, rate):
    """Torque, N m."""
    return STIFF * (target - angle) - DAMPED * rate


def step(model, data):
    """Set the motors, from the time, places and speeds alone."""
    steps = data.time / STEP
    swing, pose = int(steps) % 2, EARLY if steps % 1.0 < 0.5 else LATE
    stance = 1 - swing
    q, v = data.qpos, data.qvel
    lean, turning = -q[2], -v[2]  # the torso's, backward
    ahead = data.subtree_com[1, 0] - data.joint(ANKLES[stance]).xanchor[0]
    torque = np.zeros((2, 3))

    hip, knee, ankle = LEGS[swing]
    thigh = pose["thigh"] + AHEAD * ahead + FAST * v[0]
    torque[swing, 0] = servo(thigh, q[hip] + lean, v[hip] + turning)
    torque[swing, 1] = servo(pose["knee"], q[knee], v[knee])
    torque[swing, 2] = SOFT_ANKLE * servo(SWING_FOOT, q[ankle], v[ankle])

    _, knee, _ = leg = LEGS[stance]
    torque[stance, 0] = -servo(TORSO, lean, turning) - torque[swing, 0]
    torque[stance, 1] = servo(STANCE_KNEE, q[knee], v[knee])
    torque[stance, 2] = servo(STANCE_PITCH, q[leg].sum() + lean, v[leg].sum() + turning)
    data.ctrl[:] = np.clip(torque.ravel() / GEAR, -1.0, 1.0)
