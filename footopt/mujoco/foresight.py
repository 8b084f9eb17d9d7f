"""The beginning of a step: where the bodies are, and what joints, servos and limits will do in it.

What pulled in the step before is known from how speeds changed. The forces of springs, dampers and servos of
hinges and slides follow from their new lengths, speeds and commands, and so does how the limit of a joint
pushes; of all else the force is taken to stay what it was.
"""

import numpy as np

from footopt.compiled import called_fast, inlined_fast
from footopt.mujoco import step as steps
from footopt.mujoco.faces import AREA, COLUMNS, NX, NZ, X, Y, Z, cross, dot, plus
from footopt.mujoco.step import AGAIN, HOLD, NEW, RESTART, inner, workspace


@called_fast
def align(address):
    """Turn the Jacobian from the world's axes to the bodies' own ones in the middle of the step."""
    space = workspace(address)
    for i in range(0, len(space.jacobian), 3):
        rows, axes = space.jacobian[i : i + 3], space.frame[i // 6]
        for j in range(rows.shape[1]):
            row = rows[0, j], rows[1, j], rows[2, j]
            for a in range(3):
                rows[a, j] = dot((axes[a], axes[3 + a], axes[6 + a]), row)


@inlined_fast
def stop(freedom, angle, pull, dt):
    """The limit that a joint has reached: its side, torque without acceleration, N m, and inertia, kg m^2.

    MuJoCo's soft constraint has the torque D (a_ref - a), a_ref = -brake v - stiff d r, D = d / ((1 - d)
    mobility), r how far the joint is beyond the limit, and d an impedance that rises with r from its least
    value to its most; a is the acceleration before the integrator adds damping. The side is 0 at no limit.
    """
    low, high = angle - freedom.range[0], freedom.range[1] - angle
    side, beyond = (1.0, -low) if low < high else (-1.0, -high)
    if not beyond > 0.0:
        return 0.0, 0.0, 0.0
    least, most, width, middle, power = freedom.impedance
    x = min(beyond / width, 1.0)
    if x <= middle:
        y = middle * (x / middle) ** power
    else:
        y = 1.0 - (1.0 - middle) * ((1.0 - x) / (1.0 - middle)) ** power
    d = least + y * (most - least)
    inertia = d / ((1.0 - d) * freedom.mobility)
    torque = inertia * (side * freedom.stiff * d * beyond - freedom.brake * pull.speed)
    return side, torque, inertia * (1.0 + dt * freedom.mobility * (pull.added - pull.held))


@called_fast
def hold(address, k):
    """Let the limit of a joint push, or push no longer if it did."""
    space = workspace(address)
    pull, freedom, dt = space.pulls[k], space.freedoms[k], space.step[0].dt
    _, torque, inertia = stop(freedom, space.angles[0, freedom.place], pull, dt)
    torque, held = (-torque, 0.0) if pull.held > 0.0 else (torque, inertia / dt)
    pull.torque += torque
    pull.added += held - pull.held
    pull.more += (held - pull.held) * pull.change - torque
    pull.held = held


@called_fast
def switched(address):
    """Whether limits of joints were taken to push that pull, or not to push that do; they are switched."""
    space = workspace(address)
    able, changed = space.step[0].able, False
    for k in range(len(space.freedoms)):
        pull, freedom = space.pulls[k], space.freedoms[k]
        side, torque, inertia = stop(freedom, space.angles[0, freedom.place], pull, space.step[0].dt)
        gain = pull.change / space.step[0].dt - space.answers[k, able] + space.gained[0, k]
        if side != 0.0 and (side * (torque - inertia * gain) > 0.0) != (pull.held > 0.0):
            hold(address, k)
            changed = True
    return changed


@called_fast
def foresee(address, meaning):
    """Find by how much more joints and servos pull back in a step than in the one before."""
    space = workspace(address)
    step, dt = space.step[0], space.step[0].dt
    for k in range(len(space.freedoms)):
        pull, freedom, speed = space.pulls[k], space.freedoms[k], space.velocity[0, k]
        if meaning != AGAIN:
            gain = speed - pull.speed
            before = freedom.damping * gain + dt * freedom.stiffness * speed + pull.torque
            pull.change = gain - dt * space.gained[0, k] if meaning == NEW else 0.0
            pull.past = before - pull.added * pull.change if meaning == NEW else 0.0
        pull.speed = speed
        pull.torque = pull.added = pull.more = pull.held = space.gained[0, k] = 0.0
    for i in range(len(space.servos)):
        servo = space.servos[i]
        length, speed = space.lengths[0, servo.output], space.speeds[0, servo.output]
        pull, direct = space.pulls[servo.freedom], servo.control >= 0
        given = space.controls[0, servo.control] if direct else space.activations[0, servo.activation]
        given = min(max(given, servo.inputs[0]), servo.inputs[1])
        by_length, by_speed = servo.bias[1] + servo.gain[1] * given, servo.bias[2] + servo.gain[2] * given
        free = servo.bias[0] + servo.gain[0] * given + by_length * length + by_speed * speed
        pull.torque += servo.gear * min(max(free, servo.forces[0]), servo.forces[1])
        if step.implicit and servo.forces[0] < free < servo.forces[1]:
            pull.added -= servo.gear * servo.gear * (by_speed + step.ahead * by_length)
            pull.more -= servo.gear * step.ahead * by_length * speed
    for k in range(len(space.freedoms)):
        pull, freedom = space.pulls[k], space.freedoms[k]
        torque, ahead = pull.torque, step.ahead * freedom.stiffness
        pull.torque = min(max(torque, freedom.torques[0]), freedom.torques[1])
        if step.freed and pull.torque != torque:
            pull.added = pull.more = 0.0
        pull.torque -= pull.more + ahead * pull.speed
        pull.added += step.damped * freedom.damping + ahead
        pull.more = pull.past - pull.torque + pull.added * pull.change
        side, torque, _ = stop(freedom, space.angles[0, freedom.place], pull, dt)
        if side * torque > 0.0:
            hold(address, k)


def begin(address, meaning):
    """Begin a step, after a RESTART with all sunk straight down; whether the sand is to be solved for."""
    space = workspace(address)
    if meaning == HOLD:
        align(address)
        return False
    step, vectors, velocity, any_near = space.step[0], space.vectors, space.velocity[0], False
    late = 0.5 * step.dt * step.rk4  # from MuJoCo's places to the middle
    for b in range(len(space.bodies)):
        body, rows = space.bodies[b], space.jacobian[6 * b : 6 * b + 6]
        vz = inner(rows[2], velocity)
        spin = inner(rows[3], velocity), inner(rows[4], velocity), inner(rows[5], velocity)
        axes, height, frame = space.attitude[body.row], space.places[body.row, 2], space.frame[b]
        for a in range(3):
            axis = axes[a], axes[3 + a], axes[6 + a]
            frame[a], frame[3 + a], frame[6 + a] = plus(axis, late, cross(spin, axis))
        body.height = height + late * vz
        turned = abs(spin[0]) + abs(spin[1])
        margin = 2.0 * step.dt * (abs(vz) + turned * body.reach + 10.0 * step.dt)
        low = end = np.inf
        if height - body.reach < margin:
            faces = space.faces[0, COLUMNS * body.first : COLUMNS * body.last]
            faces, up = faces.reshape(COLUMNS, body.last - body.first), (axes[6], axes[7], axes[8])
            for i in range(faces.shape[1]):
                middle = height + dot(up, (faces[X, i], faces[Y, i], faces[Z, i]))
                rise = body.half * faces[AREA, i] * abs(up[0] * faces[NZ, i] - up[2] * faces[NX, i])
                low, end = min(low, middle), min(end, middle - rise)
        body.depth, body.near = max(-end, 0.0), low < margin
        any_near = any_near or low < margin
        if meaning == NEW:
            space.spent[steps.WORK, b] += space.spent[steps.PENDING, b]
        elif meaning == RESTART:
            count = body.last - body.first
            for i in range(3 * count):
                space.bristles[2, 3 * body.first + i] = -frame[6 + i // count]
        body.power = space.spent[steps.PENDING, b] = 0.0
    align(address)
    step.steps += meaning == NEW
    step.restarts += meaning == RESTART
    for i in range(vectors.shape[1]):
        twist, frame = inner(space.jacobian[i], velocity), space.frame[i // 6]
        if meaning == NEW:
            vectors[steps.BEFORE, i] = vectors[steps.MEAN, i]
            vectors[steps.FREE, i] = (twist - vectors[steps.TWIST, i]) / step.dt - vectors[steps.GAINED, i]
        elif meaning == RESTART:
            vectors[steps.BEFORE, i] = vectors[steps.FREE, i] = 0.0
            if i % 6 < 3:
                g, a = step.gravity, i % 6
                vectors[steps.FREE, i] = dot((g[0], g[1], g[2]), (frame[a], frame[3 + a], frame[6 + a]))
        vectors[steps.TWIST, i] = twist
        vectors[steps.GAINED, i] = vectors[steps.MEAN, i] = vectors[steps.END, i] = 0.0
    foresee(address, meaning)
    for i in range(space.bristles.shape[1]):
        if meaning != AGAIN:
            space.bristles[0, i] = space.bristles[2, i]
        space.bristles[2, i] = 0.0
    return any_near
