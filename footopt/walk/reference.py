"""The second program: a contact from the readable law, and published numbers.

`PUBLISHED` is what another program, written apart from this one, found for one foot: the law in its angles,
LSODA, 100 chords for plates, a creep speed of 1e-5 m/s, and all else as the defaults are. Every release and
study=doctor is held to it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.effects import laws
from footopt.effects.shadowing import filler
from footopt.foot import Foot
from footopt.gait.gait import Pose
from footopt.walk.accuracy import TOLERANCES, Accuracy
from footopt.walk.loop import compiled_contact
from footopt.walk.plates import plate_states
from footopt.walk.prepare import sole, world
from footopt.walk.scene import Scene
from footopt.walk.state import COUNTS

Array = NDArray[np.float64]

BURIED = 0.02  # m, mean depth of the sole where the law is asked without a walk


class Published(NamedTuple):
    """Height of the hip at the start, m, and the five objectives in the order of `objectives.FIVE`."""

    sand: str
    zeta: float
    start: float
    objectives: tuple[float, float, float, float, float]


#: Heights of the foot's waypoints.
RAMP = (1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 8)

PUBLISHED = (
    Published("soft", 0.2, 0.86572, (1.84941, 0.76065, 684.635, 606.292, 0.17711)),
    Published("regular", 1.0, 0.91440, (2.08141, 0.88027, 364.225, 364.768, 0.23598)),
    Published("hard", 5.0, 0.93425, (2.16852, 0.91860, 148.094, 502.316, 0.29326)),
)

#: The program's own plates and creep speed, in steps so short that time adds nothing.
SAME_PLATES = Accuracy("sdirk2", 1e-4, 100, 1e-5, "same plates", rule="chord")

#: Largest relative difference that is allowed to each accuracy: what presets promise, less for the finest.
LIMITS = {**TOLERANCES, "reference": 2e-4, "same plates": 2e-4}


def contact_forces(
    foot: Foot, scene: Scene, plates: int, motion: tuple[float, float, float], creep: float, angles: bool
) -> tuple[Array, Array, float]:
    """The force on one level, buried foot, by the compiled contact and by the readable law.

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
    angles : bool
        Whether the readable law is that in the angles, or the affine form.

    Returns
    -------
    compiled, readable : (2,), N
        The force in x and z.
    size : float, N
        Sum of the plates' forces, to which differences are to be related.
    """
    sheets = foot.plates(plates, "chord", directed=True, fill=filler(scene.effects))
    vx, vz, rate = motion
    none = np.zeros((1, 2))
    ankle = -BURIED - float(np.mean(sheets.z))  # of the left foot; the right one is in the air
    pose = Pose(none, np.array([[ankle, 10.0]]), none, none, none, np.array([[rate, 0.0]]))
    counts = np.zeros(1, COUNTS)[0]
    constants = world(scene, Accuracy(creep=creep))
    both = compiled_contact(laws(scene.effects))
    left = both(constants, sole(sheets), pose.table()[0], 0.0, 0.0, vx, vz, creep, 1e-3, counts).left
    states = plate_states(sheets, pose, np.zeros((1, 2)), np.array([[vx, vz]]), scene, creep, angles)
    size = float(np.linalg.norm(states.force[0, 0], axis=-1).sum())
    return np.array([left.x, left.z]), states.total[0, 0], size
