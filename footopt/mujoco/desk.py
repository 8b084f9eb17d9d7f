"""What a step of the sand under MuJoCo's bodies reads and writes, and when it begins."""

from __future__ import annotations

from typing import Any, NamedTuple

from footopt.compiled import inlined

AGAIN, NEW, HOLD, RESTART = range(4)
#: A clock's numbers: start of the step and its length, s; 1 where the integrator is RK4; 1 once the step's
#: middle has been seen, 2 once its end has; 1 once it runs.
START, STEP, RK4, STAGE, RUNS = range(5)


class Desk(NamedTuple):
    """All that a step reads and writes: MuJoCo's own arrays, and those of b bodies with p faces."""

    places: Any  # (nbody, 3), m: MuJoCo's xpos
    attitude: Any  # (nbody, 9): xmat
    velocity: Any  # (nv,): qvel
    passive: Any  # (nv,): qfrc_passive
    bodies: Any  # (b, 4): row in MuJoCo, first face, one past the last, SOLE or MESH
    active: Any  # (b,): those in the sand, the first of it
    counts: Any  # (len(step.COUNTED),)
    clock: Any  # see `START`
    length: Any  # (1,), m: over which bristles bend
    laws: Any  # (b, 9), N/m^3: `sand.law.Law`, or xi and the surface's friction
    reach: Any  # (b,), m
    faces: Any  # (10 p,): `stage.X` and so on, a body's as (10, its faces)
    moments: Any  # (p, 10): of their places
    bristles: Any  # (3, 3 p): at the step's beginning, middle, end
    forces: Any  # (3 p,), N
    slopes: Any  # (9 p,), N s/m
    now: Any  # (b, 6): twists in the world's axes, m/s and rad/s
    twists: Any  # (b, 6): those of the step before
    gained: Any  # (b, 6): accelerations that the sand gave in it
    free: Any  # (b, 6): accelerations by all but the sand
    gravity: Any  # (3,), m/s^2
    mean: Any  # (b, 6), N and N m: the wrench that MuJoCo is given
    last: Any  # (b, 6): the wrench at the step's end
    power: Any  # (b,), W: of the sand, at the step's end
    pending: Any  # (b,), J: its work over the step
    work: Any  # (b,), J: over the steps before
    depths: Any  # (b,), m: of the deepest face
    jacobian: Any  # (6 b, nv): of all bodies, in the world's axes
    own: Any  # (6 b, nv): of those in the sand, in their own
    answer: Any  # (6 b, nv): inv(M) J' of these


class Feet(NamedTuple):
    """The bodies in the sand, in the middle of a step."""

    bodies: Any  # (k,)
    ups: Any  # (k, 3): up, in their axes
    heights: Any  # (k,), m: of their origins
    along: Any  # (k, 4): x of a place in them, as `stage.at` takes it
    wide: Any  # (6 k,): what makes speeds of twists
    mobility: Any  # (6 k, 6 k): W
    rest: Any  # (6 k,): room for what is left of an equation


@inlined
def tick(clock, time):
    """What a call at a time means: the same step AGAIN, a NEW one, a stage of RK4 to HOLD, or a RESTART."""
    passed = (time - clock[START]) / clock[STEP]
    if clock[RUNS] == 0.0:
        passed = -1.0
    if abs(passed) < 1e-6:
        return AGAIN
    if clock[RK4] == 1.0 and abs(passed - 0.5) < 1e-6:
        clock[STAGE] = 1.0
        return HOLD
    ends = abs(passed - 1.0) < 1e-6
    if ends and clock[STAGE] == 1.0:
        clock[STAGE] = 2.0
        return HOLD
    clock[START], clock[STAGE], clock[RUNS] = time, 0.0, 1.0
    return NEW if ends else RESTART
