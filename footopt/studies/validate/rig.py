"""The rigs that repeat experiments: bodies pushed quasi-statically through the sand of the walk.

Every rig takes an experiment's set-up, its inputs and a scene with its sand and effects, and returns the
prediction of each quantity at M points or at all of them, in SI units. Plates and law are those of the walk.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from footopt.arrays import Array
from footopt.effects import parameters, reshaping
from footopt.foot import Foot
from footopt.gait import Pose
from footopt.sand import Sand
from footopt.sand.law import EARTH, PER_CM3
from footopt.walk import Accuracy, Scene, Walk, simulate
from footopt.walk.plates import plate_states

Values = Mapping[str, Any]
#: Force on a body, (M, 2), N, by the heights of its origin (M,), m, the velocity of the origin (M, 2), m/s,
#: the counter-clockwise rate (M,), rad/s, and its pitch (M,), rad; the last three may be the same for all.
Body = Callable[..., Array]

CREEP = 1e-6  # m/s, of bodies that move at about 1 m/s
BISECTIONS = 50
FIRM = 1e3  # zeta of firm ground
DOWN = (0.0, -1.0)


def body(foot: Foot, scene: Scene, plates: int) -> Body:
    """Cut a body into plates, and return its force in a scene."""
    cut = foot.plates(plates, "chord", reshaping(scene.effects))
    constants = scene.constants(Accuracy())

    def force(height: Array, velocity: ArrayLike, rate: ArrayLike = 0.0, pitch: ArrayLike = 0.0) -> Array:
        count = len(height)
        none, turned, turns = (np.broadcast_to(v, count)[:, None].astype(float) for v in (0.0, pitch, rate))
        pose = Pose(none, none, none, none, turned, turns)
        moves = np.broadcast_to(np.asarray(velocity, float), (count, 2))
        com = np.stack([np.zeros(count), height], axis=-1)
        return np.asarray(plate_states(cut, pose, com, moves, constants, CREEP).force.sum(axis=(1, 2)))

    return force


def balanced(
    foot: Foot, scene: Scene, plates: int, load: Array, velocity: ArrayLike, rate: ArrayLike, deepest: float
) -> tuple[Array, Array]:
    """Return the sinkage (M,), m, at which the sand carries a load (M,), N, and the force there, (M, 2), N.

    Bisected between the surface and `deepest`, m, the largest sinkage.
    """
    touching, force = -float(foot.contour[:, 1].min()), body(foot, scene, plates)
    low, high = np.zeros_like(load), np.full_like(load, deepest)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        carried = force(touching - middle, velocity, rate)[:, 1] >= load
        low, high = np.where(carried, low, middle), np.where(carried, middle, high)
    return high, force(touching - high, velocity, rate)


def flat(length: float, width: float) -> Foot:
    """Return a level plate."""
    return Foot(np.array([[-0.5 * length, 0.0], [0.5 * length, 0.0]]), width)


def wheel(setup: Values, inputs: Values, scene: Scene, fine: bool) -> dict[str, Array]:
    """A rigid wheel at given slips under given loads: its sinkage and its drawbar pull.

    Slip is (rim speed - speed) / the larger of both: -1 is a locked wheel that is dragged. `course` is the
    zeta with which the measured sinkage carries the load, over its mean: 1 at each slip for a law that is
    right, whatever the sand's zeta.
    """
    radius, plates, load = setup["radius"], 1600 if fine else 400, inputs["load"]
    foot = Foot.shape("circle", length=np.pi * radius, width=setup["width"])
    velocity, rate = rolling(setup)
    sinkage, force = balanced(foot, scene, plates, load, velocity, rate, radius)
    measured = -float(foot.contour[:, 1].min()) - setup["measured"]["sinkage"]
    needed = load / body(foot, scene, plates)(measured, velocity, rate)[:, 1]
    return {"sinkage": sinkage, "drawbar": force[:, 0], "course": needed / needed.mean()}


def rolling(setup: Values) -> tuple[Array, Array]:
    """Velocities of a wheel's axle, (M, 2), and its rates of turn, (M,), at given slips."""
    slip = np.asarray(setup["slip"], float)
    speed, rim = np.where(slip > 0.0, 1.0 - slip, 1.0), np.where(slip > 0.0, 1.0, 1.0 + slip)
    return np.stack([speed, np.zeros_like(speed)], axis=-1), -rim / setup["radius"]


def grousers(setup: Values, inputs: Values, scene: Scene, fine: bool) -> dict[str, Array]:
    """Of grousers, over their positions: gain in drawbar over a smooth wheel, sinkage over the first's."""
    tip, count, plates, phases = setup["radius"], setup["grousers"], 1600 if fine else 800, 8 if fine else 4
    angle = np.radians(np.linspace(-80.0, 80.0, 3201))  # from straight down
    velocity, rate = rolling(setup)

    def found(rim: float, turned: float, load: ArrayLike) -> Array:
        raised = np.abs((angle * count / (2.0 * np.pi) + turned) % 1.0 - 0.5) < 0.5 * setup["share"]
        radius = np.where(raised, tip, rim)
        foot = Foot(np.stack([radius * np.sin(angle), -radius * np.cos(angle)], axis=-1), setup["width"])
        sinkage, force = balanced(foot, scene, plates, np.asarray(load, float), velocity, rate, tip)
        return np.stack([sinkage, force[:, 0]])

    each = [found(setup["rim"], (i + 0.5) / phases, setup["load"]) for i in range(phases)]
    sinkage, drawbar = np.mean(each, axis=0)
    smooth = found(tip, 0.0, setup["smooth_load"])[1]
    return {"gain in drawbar": drawbar - smooth, "slip-sinkage": sinkage / sinkage[0]}


def plate(setup: Values, inputs: Values, scene: Scene, fine: bool) -> dict[str, Array]:
    """Stress per depth on small plates at given pairs of their angle and direction of motion, deg."""
    beta, gamma = np.radians(np.asarray(setup["pairs"], float).T)
    velocity = np.stack([np.cos(gamma), -np.sin(gamma)], axis=-1)
    # one plate of 1 m^2 at a depth of 1 m: stress per metre
    force = body(flat(1.0, 1.0), scene, 1)(np.full(len(beta), -1.0), velocity, 0.0, beta)
    return {"alpha_x": -force[:, 0], "alpha_z": force[:, 1]}


def growth(setup: Values, inputs: Values, scene: Scene, fine: bool) -> dict[str, Any]:
    """Exponent with which the force on a level plate grows with its depth."""
    depth = np.geomspace(setup["depths"][0], setup["depths"][1], 40 if fine else 20)
    force = body(flat(setup["size"], setup["size"]), scene, 8)(-depth, DOWN, 0.0)
    return {"exponent": np.polyfit(np.log(depth), np.log(force[:, 1]), 1)[0]}


def friction(setup: Values, inputs: Values, scene: Scene, fine: bool) -> dict[str, Array]:
    """zeta from density and angle of friction by 3D-RFT: .87574 xi is the stress under a level plate."""
    mu = np.tan(np.radians(inputs["angle"]))
    xi = inputs["density"] * EARTH * (894.0 * mu**3 - 386.0 * mu**2 + 89.0 * mu)
    return {"zeta": 0.87574 * xi / PER_CM3}


def drag(setup: Values, inputs: Values, scene: Scene, fine: bool) -> dict[str, Any]:
    """The additional drag on an upright plate at a high speed against a low one, over rho A v^2."""
    size, (low, high) = setup["size"], setup["speeds"]
    upright = Foot(np.array([[0.0, -0.5], [0.0, 0.5]]) * size, size)
    (inertia,) = scene.effects
    density = parameters(inertia)["rho"]
    force = body(upright, scene, 8)
    slow, fast = -force(np.full(2, -setup["depth"]), [(low, 0.0), (high, 0.0)], 0.0)[:, 0]
    return {"inertia factor": (fast - slow) / (density * size**2 * (high**2 - low**2))}


def rod(setup: Values, inputs: Values, scene: Scene, fine: bool) -> dict[str, Array]:
    """Powers with which the drag of an upright plate grows with its width, its depth and its speed."""
    plates = 400 if fine else 100

    def drag_of(doubled: str) -> float:
        width, depth, speed = (setup[one] * (1 + (one == doubled)) for one in ("diameter", "depth", "speed"))
        upright = Foot(np.array([[0.0, -depth], [0.0, 0.0]]), width)
        return float(-body(upright, scene, plates)(np.zeros(1), (speed, 0.0), 0.0)[0, 0])

    once = drag_of("")
    return {"power of the drag": np.array([np.log2(drag_of(name) / once) for name in setup["doubled"]])}


@cache
def flat_walk(scene: Scene, accuracy: str) -> Walk:
    """A walk with flat soles, which several inputs share."""
    return simulate(Foot.flat(), scene, accuracy)


def walker(setup: Values, inputs: Values, scene: Scene, fine: bool) -> dict[str, Any]:
    """A person's weight on flat soles: forces on the ground, work on the sand, speed against firm ground."""
    accuracy = "fine" if fine else "standard"
    walk, firm = (flat_walk(s, accuracy) for s in (scene, replace(scene, sand=Sand(zeta=FIRM))))
    force = walk.force[walk.t >= scene.gait.heel_strike, :, 1] / scene.walker.weight
    found = walk.objectives
    per_metre = found["work"] / (scene.walker.mass * found["distance"])
    return {
        "peak force": force.max(),
        "pull": -force.min(),
        "work ratio": 1.0 + per_metre / inputs["firm_work"],
        "speed ratio": found["distance"] / firm.objectives["distance"],
    }


RIGS: dict[str, Callable[[Values, Values, Scene, bool], dict[str, Any]]] = {
    each.__name__: each for each in (wheel, grousers, plate, growth, friction, drag, rod, walker)
}
