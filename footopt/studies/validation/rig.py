"""A small rig: bodies pushed quasi-statically through the sand of the walk, in a balance of load.

Every rig takes an experiment's set-up, its inputs and the effects that are on, and gives what the law
predicts for each quantity, in SI units. The law is the readable form that the compiled contact is tested
against; effects and plates are those of the walk.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.effects import Effect, Inertia
from footopt.effects.shadowing import filler
from footopt.foot import Foot, Plates
from footopt.gait.gait import Pose
from footopt.sand import Sand, StressMap, alpha
from footopt.sand.intrusion import material_constant
from footopt.sand.law import PER_CM3, by_angles
from footopt.walk import Scene, simulate
from footopt.walk.plates import forces, plate_states

Array = NDArray[np.float64]
Values = Mapping[str, Any]
Rig = Callable[[Values, Values, Sequence[Effect], bool], dict[str, Array]]

CREEP = 1e-6  # m/s, of bodies that move at about 1 m/s
BISECTIONS = 50
FIRM = 1e3  # zeta of firm ground


def scene_of(zeta: float, effects: Sequence[Effect]) -> Scene:
    """A scene with the generic map, scaled, and some effects."""
    return Scene(sand=Sand(zeta=float(zeta), name="rig"), effects=tuple(effects))


def body_force(foot: Foot, scene: Scene, plates: int, height: Array, velocity: Array, rate: Array) -> Array:
    """Force on a level body whose origin is at some heights, (M, 2), N.

    height : (M,), m. velocity : (M, 2), m/s, of the origin. rate : (M,), rad/s, counter-clockwise.
    """
    return force_on(cut_for(foot, scene, plates), scene, height, velocity, rate)


def cut_for(foot: Foot, scene: Scene, plates: int) -> Plates:
    """A body's plates in a scene."""
    return foot.plates(plates, "chord", directed=True, fill=filler(scene.effects))


def force_on(cut: Plates, scene: Scene, height: Array, velocity: Array, rate: Array) -> Array:
    """`body_force` of a body that is cut into plates."""
    none = np.zeros((len(height), 1))
    pose = Pose(none, none, none, none, none, rate[:, None])
    com = np.stack([np.zeros_like(height), height], axis=-1)
    return np.asarray(plate_states(cut, pose, com, velocity, scene, CREEP).force.sum(axis=(1, 2)))


def balanced(
    foot: Foot, scene: Scene, plates: int, load: Array, velocity: Array, rate: Array, deepest: float
) -> tuple[Array, Array]:
    """Sinkage (M,), m, at which the sand carries a load (M,), N, and the force there, (M, 2), N.

    Bisected between the surface and `deepest`, m, below which no answer is sought.
    """
    touching, cut = -float(foot.contour[:, 1].min()), cut_for(foot, scene, plates)
    low, high = np.zeros_like(load), np.full_like(load, deepest)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        carried = force_on(cut, scene, touching - middle, velocity, rate)[:, 1] >= load
        low, high = np.where(carried, low, middle), np.where(carried, middle, high)
    return high, force_on(cut, scene, touching - high, velocity, rate)


def wheel(setup: Values, inputs: Values, effects: Sequence[Effect], fine: bool) -> dict[str, Array]:
    """A rigid wheel at given slips under given loads: its sinkage and its drawbar pull.

    Slip is (rim speed - speed) / the larger of both: -1 is a locked wheel that is dragged.
    """
    radius, slip = setup["radius"], np.asarray(setup["slip"], float)
    speed, rim = np.where(slip > 0.0, 1.0 - slip, 1.0), np.where(slip > 0.0, 1.0, 1.0 + slip)
    foot = Foot.shape("circle", length=np.pi * radius, width=setup["width"])
    velocity = np.stack([speed, np.zeros_like(speed)], axis=-1)
    scene, load, rate = scene_of(inputs["zeta"], effects), np.asarray(setup["load"], float), -rim / radius
    sinkage, force = balanced(foot, scene, 1600 if fine else 400, load, velocity, rate, radius)
    return {"sinkage": sinkage, "drawbar": force[:, 0]}


def pad(setup: Values, inputs: Values, effects: Sequence[Effect], fine: bool) -> dict[str, Array]:
    """A level pad with blades that is dragged along under a load: what the blades add to its traction."""
    length, width = setup["length"], setup["width"]
    flat = np.array([[-length / 2, 0.0], [length / 2, 0.0]])
    scene, load = scene_of(inputs["zeta"], effects), np.array([float(inputs["load"])])

    def traction(contour: Array) -> float:
        foot = Foot(contour, width)
        plates = 3200 if fine else 800
        along, still = np.array([[1.0, 0.0]]), np.zeros(1)
        return float(-balanced(foot, scene, plates, load, along, still, 1.0)[1][0, 0])

    bladed = traction(blades(length, round(inputs["blades"]), setup["height"], setup["thickness"]))
    return {"gain in traction": np.array([bladed / traction(flat) - 1.0])}


def blades(length: float, count: int, height: float, thickness: float) -> Array:
    """A level sole with blades at equal distances under it, the outer ones at its ends, (m, 2), m."""
    points = []
    for middle in np.linspace(-0.5 * (length - thickness), 0.5 * (length - thickness), count):
        left, right = middle - 0.5 * thickness, middle + 0.5 * thickness
        points += [(left, 0.0), (left, -height), (right, -height), (right, 0.0)]
    return np.array(points)


def plate(setup: Values, inputs: Values, effects: Sequence[Effect], fine: bool) -> dict[str, Array]:
    """Stress per depth on small plates at all angles of a table, for each direction of motion."""
    beta, gamma = angles(setup)
    velocity = np.stack([np.cos(gamma), -np.sin(gamma)], axis=-1)
    normal = np.stack([np.sin(beta), -np.cos(beta)], axis=-1)
    place = np.broadcast_to(np.array([0.0, -1.0]), velocity.shape)  # at a depth of 1 m: stress per metre
    scene, area = scene_of(inputs["zeta"], effects), np.ones_like(beta)
    stress = by_angles(beta, velocity, CREEP, scene.sand.stress_map)
    force = forces(stress, place, velocity, normal, area, scene, CREEP)
    return {"alpha_x": -force[:, 0], "alpha_z": force[:, 1]}


def angles(setup: Values) -> tuple[Array, Array]:
    """Angles of the plates and of motion, both (M,), rad: given pairs, or all, or those whose face leads."""
    if "pairs" in setup:
        beta, gamma = np.radians(np.asarray(setup["pairs"], float).T)
        return beta, gamma
    beta, gamma = np.meshgrid(np.radians(setup["beta"]), np.radians(setup["gamma"]), indexing="ij")
    into = np.sin(beta) * np.cos(gamma) + np.cos(beta) * np.sin(gamma)
    kept = into > 1e-9 if setup.get("leading") else np.full(beta.shape, True)
    return beta[kept], gamma[kept]


def measured_map(setup: Values) -> dict[str, Array]:
    """Another map's stresses per depth at an experiment's angles, N/m^3, from its published coefficients.

    None where an experiment states what was measured at each pair of angles.
    """
    if "pairs" in setup:
        return {}
    beta, gamma = angles(setup)
    if "fourier" in setup:
        return dict(
            zip(("alpha_x", "alpha_z"), alpha(beta, gamma, StressMap(**setup["fourier"])), strict=True)
        )
    x, z = three_dimensional(np.asarray(setup["polynomial"], float), beta, gamma)
    return {"alpha_x": PER_CM3 * x, "alpha_z": PER_CM3 * z}


def three_dimensional(coefficients: Array, beta: Array, gamma: Array) -> tuple[Array, Array]:
    """3D-RFT for motion in the plane of a plate's normal, psi = 0: alpha_x and alpha_z.

    coefficients : (3, 20), of f1, f2 and f3 in the order of Agarwal, Goldman & Kamrin, PNAS 120 (2023).
    """
    a, b = np.sin(gamma), np.cos(beta)
    c = np.cos(gamma) * np.sin(beta) + a * b
    one = np.ones_like(a)
    terms = [one, a, b, c, a * a, b * b, c * c, a * b, b * c, c * a, a**3, b**3, c**3]
    terms += [a * b * b, b * a * a, b * c * c, c * b * b, c * a * a, a * c * c, a * b * c]
    f1, f2, f3 = coefficients @ np.stack(terms)
    return -(f1 * np.sin(beta) + f2 * np.cos(gamma)), -(f1 * b + f2 * a + f3)


def growth(setup: Values, inputs: Values, effects: Sequence[Effect], fine: bool) -> dict[str, Array]:
    """Exponent with which the force on a level plate grows with its depth."""
    depth = np.geomspace(setup["depths"][0], setup["depths"][1], 40 if fine else 20)
    plate_ = Foot(np.array([[-0.5, 0.0], [0.5, 0.0]]) * setup["size"], setup["size"])
    down, still = np.tile([0.0, -1.0], (len(depth), 1)), np.zeros(len(depth))
    force = body_force(plate_, scene_of(inputs["zeta"], effects), 8, -depth, down, still)[:, 1]
    exponent = np.polyfit(np.log(depth), np.log(force), 1)[0]
    return {"exponent": np.full(len(setup["media"]), exponent)}


def extraction(setup: Values, inputs: Values, effects: Sequence[Effect], fine: bool) -> dict[str, Array]:
    """Resistance of a level plate that is pulled up, over that of one that is pushed down."""
    found = plate({"beta": [0.0], "gamma": [90.0, -90.0]}, inputs, effects, fine)["alpha_z"]
    return {"pull over push": np.full(len(setup["media"]), abs(found[1]) / found[0])}


def friction(setup: Values, inputs: Values, effects: Sequence[Effect], fine: bool) -> dict[str, Array]:
    """zeta from density and angle of friction: 3D-RFT's material constant times alpha_z of a level plate."""
    scale = material_constant(np.asarray(inputs["density"], float), np.tan(np.radians(inputs["angle"])))
    _, level = alpha(0.0, np.pi / 2)
    return {"zeta": scale * setup["level"] / float(level)}


def drag(setup: Values, inputs: Values, effects: Sequence[Effect], fine: bool) -> dict[str, Array]:
    """What a dragged upright plate feels more at a high speed than at a low one, over rho A v^2."""
    size, speed = setup["size"], np.asarray(setup["speeds"], float)
    upright, still = Foot(np.array([[0.0, -0.5], [0.0, 0.5]]) * size, size), np.zeros(2)
    density = next(effect.rho for effect in effects if isinstance(effect, Inertia))
    along = np.stack([speed, still], axis=-1)
    height = np.full(2, -setup["depth"])
    force = -body_force(upright, scene_of(inputs["zeta"], effects), 8, height, along, still)[:, 0]
    factor = np.diff(force) / (density * size**2 * np.diff(speed**2))
    return {"inertia factor": np.full(len(setup["body"]), factor[0])}


def rod(setup: Values, inputs: Values, effects: Sequence[Effect], fine: bool) -> dict[str, Array]:
    """Powers with which the drag of an upright plate grows with its width, its depth and its speed."""
    scene, plates = scene_of(inputs["zeta"], effects), 400 if fine else 100

    def drag_of(doubled: str) -> float:
        width, depth, speed = (
            setup[name] * (1 + (name == doubled)) for name in ("diameter", "depth", "speed")
        )
        upright, along = Foot(np.array([[0.0, -depth], [0.0, 0.0]]), width), np.array([[speed, 0.0]])
        return float(-body_force(upright, scene, plates, np.zeros(1), along, np.zeros(1))[0, 0])

    once = drag_of("")
    return {"power of the drag": np.array([np.log2(drag_of(name) / once) for name in setup["doubled"]])}


def walker(setup: Values, inputs: Values, effects: Sequence[Effect], fine: bool) -> dict[str, Array]:
    """A person's weight on flat soles: forces on the ground, work on the sand, speed against firm ground."""
    scene = scene_of(inputs["zeta"], effects)
    accuracy = "fine" if fine else "standard"
    walk, firm = (simulate(Foot.flat(), s, accuracy) for s in (scene, replace(scene, sand=Sand(zeta=FIRM))))
    walking = walk.t >= scene.gait.heel_strike
    force = walk.force[walking, :, 1] / scene.walker.weight
    found = walk.objectives
    per_metre = found["work"] / (scene.walker.mass * found["distance"])
    values = {
        "peak force": force.max(),
        "pull": -force.min(),
        "work ratio": 1.0 + per_metre / inputs["firm_work"],
        "speed ratio": found["distance"] / firm.objectives["distance"],
    }
    return {name: np.array([float(value)]) for name, value in values.items()}


RIGS: dict[str, Rig] = {
    "wheel": wheel,
    "pad": pad,
    "plate": plate,
    "growth": growth,
    "extraction": extraction,
    "friction": friction,
    "drag": drag,
    "rod": rod,
    "walker": walker,
}
