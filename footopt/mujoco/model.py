"""A robot's model for walks on sand: its feet touch nothing but sand, and sensors measure every step."""

from __future__ import annotations

import copy
import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from footopt.arrays import Array
from footopt.errors import SettingError, check, needed
from footopt.foot import Foot

BIPED = Path(__file__).with_name("biped.xml")
PACKAGE = "pkg://"  # before the name of a package and a path in it


@dataclass(frozen=True)
class Model:
    """A compiled model, which is compared by its content."""

    digest: str
    compiled: Any = field(compare=False, repr=False)
    feet: tuple[str, ...] = ()
    mujoco: str = ""  # its version

    @classmethod
    def read(cls, source: Any, feet: Sequence[str]) -> Model:
        """Compile a model that stands on sand; source and feet as in `Robot`. A mujoco.MjSpec is not changed.

        Geoms of the feet, and of everything that is not the robot, such as floors, are taken out of
        collisions: sand is in their place. They keep their mass, inertia and looks. Raises `SettingError` if
        MuJoCo does not compile the model, a foot is not a body of it, or no joint lets it sink, and
        `MissingError` without MuJoCo.
        """
        mujoco = needed("mujoco", "fo.mujoco.Robot", "mujoco")
        what = str(source) if isinstance(source, Path) or "<" not in str(source) else "MJCF"
        try:
            spec = _spec(mujoco, source)
            bodies = {body.name: body for body in spec.bodies}
            names = [name for name in bodies if name and name != "world"]
            for name in feet:
                check(name in names, "robot.feet", name, f"the name of a body: {', '.join(names)}")
            for geom in spec.geoms:
                if geom.parent.name in feet:
                    geom.contype = geom.conaffinity = 0
            parents = {geom.name: geom.parent.name for geom in spec.geoms}
            for pair in list(spec.pairs):
                if {parents.get(pair.geomname1), parents.get(pair.geomname2)} & {"world", *feet}:
                    spec.delete(pair)
            _add_sensors(mujoco, spec, bodies[feet[0]])
            model = spec.compile()
        except SettingError:
            raise
        except (ValueError, OSError) as error:  # what MuJoCo says of a model that it cannot read
            said = " ".join(str(error).split())
            raise SettingError("robot.model", what, "a model that MuJoCo compiles", said) from None
        trees = {int(model.body_rootid[model.body(name).id]) for name in feet}
        once = len(trees) == 1 and len({*feet}) == len(feet)
        check(once, "robot.feet", [*feet], "bodies of one robot, each once")
        others = model.body_rootid[model.geom_bodyid] != model.body_rootid[model.body(feet[0]).id]
        model.geom_contype[others] = model.geom_conaffinity[others] = 0  # floors, rocks, targets
        content = np.empty(mujoco.mj_sizeModel(model), np.uint8)
        mujoco.mj_saveModel(model, None, content)
        made = cls(hashlib.sha256(content.tobytes()).hexdigest(), model, tuple(feet), mujoco.__version__)
        _ = made.height_address  # raises if no joint lets it sink
        return made

    def wearing(self, foot: Foot, density: float) -> Model:
        """A copy whose feet have the mass and inertia of a sole with its flat top, by a density, kg/m^3."""
        import mujoco

        found = copy.copy(self.compiled)
        area, (x, z), (xx, zz, xz) = moments(foot)
        mean, spread = 0.5 * (xx + zz), math.hypot(0.5 * (xx - zz), xz)
        along, mass = 0.5 * math.atan2(2.0 * xz, xx - zz), density * foot.width * area
        least, most, across = mean - spread, mean + spread, foot.width**2 / 12.0
        for name, ankle in zip(self.feet, self.ankles, strict=True):
            row = found.body(name).id
            check(found.body_simple[row] == 0, "robot.density", density, "null where a foot is all the robot")
            found.body_sameframe[row], found.body_mass[row] = 0, mass
            found.body_ipos[row] = ankle[0] + x - foot.ankle[0], 0.0, ankle[2] + z - foot.ankle[1]
            found.body_iquat[row] = math.cos(0.5 * along), 0.0, -math.sin(0.5 * along), 0.0
            found.body_inertia[row] = mass * np.array([least + across, mean + mean, most + across])
        mujoco.mj_setConst(found, mujoco.MjData(found))
        return replace(self, digest=f"{self.digest} {density} {hash(foot)}", compiled=found)

    @property
    def mass(self) -> float:
        """Of the tree of bodies that the feet belong to, kg."""
        m = self.compiled
        return float(m.body_subtreemass[m.body_rootid[m.body(self.feet[0]).id]])

    @cached_property
    def height(self) -> float:
        """Of its centre of mass over the lower foot's body, in the model's own pose, m."""
        import mujoco

        m = self.compiled
        mujoco.mj_kinematics(m, data := mujoco.MjData(m))
        mujoco.mj_comPos(m, data)
        centre = data.subtree_com[m.body_rootid[m.body(self.feet[0]).id], 2]
        return float(abs(centre - min(data.body(foot).xpos[2] for foot in self.feet)))

    @cached_property
    def height_address(self) -> int:
        """The place in qpos of the robot's height: of a free joint, or of one that slides upward."""
        import mujoco

        m, free, slide = self.compiled, 0, 2
        mujoco.mj_kinematics(m, data := mujoco.MjData(m))
        root = m.body_rootid[m.body(self.feet[0]).id]
        for joint in np.flatnonzero(m.jnt_bodyid == root):
            if m.jnt_type[joint] == free:
                return int(m.jnt_qposadr[joint]) + 2
            if m.jnt_type[joint] == slide and data.xaxis[joint, 2] > 1.0 - 1e-9:
                return int(m.jnt_qposadr[joint])
        name = m.body(root).name
        raise SettingError(
            "robot.model", name, "a body with a free joint, or with one that slides along z", "Add one."
        )

    @cached_property
    def ankles(self) -> Array:
        """The joint that each foot turns about, or else its origin, in the body's axes, (feet, 3), m."""
        m, found = self.compiled, np.zeros((len(self.feet), 3))
        for place, name in zip(found, self.feet, strict=True):
            for joint in np.flatnonzero((m.jnt_bodyid == m.body(name).id) & np.isin(m.jnt_type, (1, 3))):
                place[:] = m.jnt_pos[joint]  # of a ball or a hinge
        return found

    def chains(self) -> list[list[int]]:
        """The bodies from the root to each foot."""
        m, found = self.compiled, []
        for name in self.feet:
            chain = [int(m.body(name).id)]
            while m.body_parentid[chain[0]] != 0:
                chain.insert(0, int(m.body_parentid[chain[0]]))
            found.append(chain)
        return found


def moments(foot: Foot) -> tuple[float, tuple[float, float], tuple[float, float, float]]:
    """Area, m^2, centre, m, and variances xx, zz and xz, m^2, of a sole that is closed by a flat top."""
    top = max(foot.top, foot.contour[:, 1].max())
    heel, toe = foot.contour[0, 0], foot.contour[-1, 0]
    p = np.vstack([foot.contour, [[toe, top], [heel, top]]])
    q = np.roll(p, -1, axis=0)
    part = 0.5 * (p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1])  # of the triangles to the origin, m^2
    area, centre = part.sum(), (part @ (p + q)) / (3.0 * part.sum())
    second = [part @ (p[:, i] * p[:, j] + q[:, i] * q[:, j] + (p + q)[:, i] * (p + q)[:, j]) / (12.0 * area)
              for i, j in ((0, 0), (1, 1), (0, 1))]  # fmt: skip
    x, z = centre.tolist()
    return float(area), (x, z), (second[0] - x * x, second[1] - z * z, second[2] - x * z)


@lru_cache(maxsize=16)
def with_step(model: Model, dt: float) -> Any:
    """A compiled copy of a model with a time step."""
    found = copy.copy(model.compiled)
    found.opt.timestep = dt
    return found


def _spec(mujoco: Any, source: Any) -> Any:
    """A specification that may be changed."""
    if isinstance(source, mujoco.MjSpec):
        return source.copy()
    text = str(source)
    if "<" in text:
        return mujoco.MjSpec.from_string(text)
    path = Path(text)
    if text.startswith(PACKAGE):
        package, _, inside = text.removeprefix(PACKAGE).partition("/")
        folder = getattr(find_spec(package), "submodule_search_locations", None) or [""]
        hint = f"pip install {package}?"
        check(folder[0] != "", "robot.model", text, "in a package that is installed", hint)
        path = Path(folder[0]) / inside
    check(path.is_file(), "robot.model", str(path), "a file, MJCF as text, or a mujoco.MjSpec")
    return mujoco.MjSpec.from_file(str(path))


def _add_sensors(mujoco: Any, spec: Any, foot: Any) -> None:
    """Add sensors: centre of mass, its velocity, the root's upright axis; actuators' force, speed, place."""
    root = foot
    while root.parent is not None and root.parent.name != "world":
        root = root.parent
    root.name = root.name or "robot"
    kind, thing = mujoco.mjtSensor, mujoco.mjtObj
    for whole in (kind.mjSENS_SUBTREECOM, kind.mjSENS_SUBTREELINVEL):
        spec.add_sensor(type=whole, objtype=thing.mjOBJ_BODY, objname=root.name)
    spec.add_sensor(type=kind.mjSENS_FRAMEZAXIS, objtype=thing.mjOBJ_XBODY, objname=root.name)
    for i, actuator in enumerate(spec.actuators):
        actuator.name = actuator.name or f"actuator_{i}"
        for each in (kind.mjSENS_ACTUATORFRC, kind.mjSENS_ACTUATORVEL, kind.mjSENS_ACTUATORPOS):
            spec.add_sensor(type=each, objtype=thing.mjOBJ_ACTUATOR, objname=actuator.name)
