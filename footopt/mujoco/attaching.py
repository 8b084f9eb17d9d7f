"""Attach footopt's sand to a MuJoCo model: a passive force, compiled, that MuJoCo calls in every step."""

from __future__ import annotations

import ctypes
import math
import threading
from collections.abc import Mapping, Sequence
from functools import lru_cache
from numbers import Integral
from typing import Any

import numpy as np

from footopt.arrays import Array
from footopt.effects import Effect, reshaping
from footopt.effects.base import BRISTLE_LENGTH, ordered
from footopt.errors import SettingError, check, check_kind, is_number, needed
from footopt.foot import Foot, Plates
from footopt.mujoco.callback import ATTACHED, FORGOT, MOST, callback, compiled, with_effects
from footopt.mujoco.implicit import ROOM
from footopt.mujoco.joints import RK4, freedoms, servos
from footopt.mujoco.native import functions, memory, remembering
from footopt.mujoco.step import BEGIN, BEND, BODY, COUNTED, DRIFT, END, MEAN, STEP, TRACED, Workspace
from footopt.sand import Sand
from footopt.sand.law import EARTH
from footopt.walk import Accuracy, Scene
from footopt.walk.discretize import with_bypassed_gates
from footopt.walk.state import World

#: Contacts in use by the address of their MjData: they keep alive all the memory that the callback reads.
_KEPT: dict[int, Contact] = {}
_LOCK = threading.Lock()


class Contact:
    """Bodies of a MuJoCo model on sand, whose surface is z = 0: what the sand does, until `detach`.

    The force is added to ``data.qfrc_passive`` in every step. Attach after the model is compiled and its
    integrator, time step and gravity are chosen; the first step starts with all that is in the sand sunk
    straight down. A plane or a height field that the feet would touch is refused: take it away, or the feet's
    part in collisions.

    Parameters
    ----------
    model : mujoco.MjModel
        Of your robot.
    data : mujoco.MjData
        Of this model; only steps that are made with it meet sand.
    feet : mapping of str to Foot
        By name of the body: a sole, whose ankle is the body's origin, x forward and z up.
    sand : Sand
        The sand.
    effects : sequence of Effect
        As in a `Scene`. Rest (friction with memory) is always on; an effect may set its length.
    plates : int, 1
        Number of plates of a sole: half of them along each of two lines, which are at the points of Gauss's
        rule across the width; one line in the middle replaces both if no foot can leave the plane of x and z.
    traced : int
        How many steps are kept in `trace`, from the first one on.
    remembers : bool
        Whether the bristles at the ends of these steps are kept, too, for `bristles`.

    Raises
    ------
    SettingError
        A name is not in the model, data are another's, a floor is in the way, or an effect is not for MuJoCo.
    MissingError
        There is no MuJoCo: ``pip install "footopt[mujoco]"``.
    """

    def __init__(
        self,
        model: Any,
        data: Any,
        feet: Mapping[str, Foot],
        sand: Sand,
        effects: Sequence[Effect] = (),
        plates: int = 64,
        traced: int = 0,
        remembers: bool = False,
    ) -> None:
        mujoco = needed("mujoco", "footopt.mujoco", "mujoco")
        check_kind("model", model, mujoco.MjModel, "Or a mujoco.MjSpec, with None for its data.")
        check_kind("feet", feet, Mapping, "By name of the body.")
        world = _constants(sand, ordered(effects))
        g = float(np.linalg.norm(model.opt.gravity)) / EARTH
        check(feet, "feet", {}, "a body and its foot, at least")
        even = is_number(plates, Integral) and plates >= 4 and plates % 2 == 0
        check(even, "plates", plates, "an even number from 4")
        level = world.tilt == 0.0
        check(level, "effects", "an inclined plane", "on a level one", "Tilt model.opt.gravity.")
        bodies, tables, first, soles = np.zeros(len(feet), BODY), [], 0, dict[int, Array]()
        rows = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) for name in feet]
        check(data.model is model, "data", data, "of this model", "mujoco.MjData(model)")
        if min(rows) < 1:
            names = [model.body(i).name for i in range(1, model.nbody)]
            name = list(feet)[rows.index(min(rows))]
            raise SettingError("feet", name, f"the name of a body: {', '.join(names)}")
        if (fixed := (model.body_weldid[rows] == 0) | (model.body_mocapid[rows] >= 0)).any():
            raise SettingError("feet", [*feet][fixed.argmax()], "a body that moves", "Weld it to that one.")
        self.lines = 1 if _in_one_plane(mujoco, model, data, rows) else 2
        for body, row, foot in zip(bodies, rows, feet.values(), strict=True):
            check_kind("feet", foot, Foot, "By name of its body.")
            if id(foot) not in soles:  # both feet often have one
                cut = foot.plates(plates // 2, fill=reshaping(effects))
                soles[id(foot)] = _sole(cut, foot.width, self.lines)
            table = soles[id(foot)]
            body["law"] = g * np.array(world.law)
            body["row"], body["first"], body["last"] = row, first, first + table.shape[1]
            body["reach"] = np.linalg.norm(table[:3], axis=0).max()
            body["half"] = 0.5 * self.lines / foot.width
            tables.append(table.ravel())
            first += table.shape[1]
            _need_no_floor(model, row, body["reach"])
        step, n = np.zeros(1, STEP), 6 * len(feet)
        step["dt"], step["gravity"] = model.opt.timestep, model.opt.gravity
        kind, euler_explicit = model.opt.integrator, mujoco.mjtDisableBit.mjDSBL_EULERDAMP
        step["rk4"], step["implicit"] = kind == RK4, kind > RK4
        step["freed"] = int(mujoco.__version__.partition(".")[0]) >= 4
        step["damped"] = kind > RK4 or (kind < RK4 and not model.opt.disableflags & euler_explicit)
        step["ahead"] = model.opt.timestep * (kind > int(mujoco.mjtIntegrator.mjINT_IMPLICITFAST))
        step["length"], step["bypass"] = world.bristle_length or BRISTLE_LENGTH, world.bypass
        jacobian = np.zeros((n, model.nv))
        steps, wrenches = compiled(), with_effects(world.effects)
        outside = (
            *functions("mj_getState", "mj_jacBody", "mju_warning"),
            *(steps[i].address for i in range(BEGIN, BEND + 1)), wrenches.address,
            step["time"].ctypes.data, jacobian.ctypes.data, ctypes.addressof(FORGOT),
        )  # fmt: skip
        kept = {  # from step to step
            "moment": (1, 3), "spent": (2, len(feet)), "drift": (DRIFT, model.nv), "gained": (1, model.nv),
            "bristles": (3, 3 * first), "vectors": (6, n),
        }  # fmt: skip
        scratch = {
            "frame": (len(feet), 9), "history": (traced * remembers, 3 * first), "factor": (1, data.M.size),
            "answers": (model.nv, n), "mobility": (n, n), "stiffness": (n, 6),
            "system": (n + 1, n + 1), "room": (ROOM, n),
        }  # fmt: skip
        ends = np.cumsum([math.prod(shape) for shape in kept.values()]).tolist()
        self.memory = memory(model, data, ends[-1])
        parts = zip(kept.items(), np.split(self.memory, ends[:-1]), strict=True)
        self._space = Workspace(
            step=step, bodies=bodies, freedoms=freedoms(mujoco, model), servos=servos(mujoco, model),
            controls=data.ctrl[None], activations=data.act[None],
            lengths=data.actuator_length[None], speeds=data.actuator_velocity[None],
            columns=model.M_colind[None].astype(np.int64), inertia=data.M[None], places=data.xpos,
            attitude=data.xmat.reshape(-1, 9), velocity=data.qvel[None], passive=data.qfrc_passive[None],
            faces=np.concatenate(tables)[None], jacobian=jacobian, trace=np.full((traced, n), np.nan),
            chosen=np.zeros((3, n), np.int64), outside=np.array([outside]),
            **{name: part.reshape(shape) for (name, shape), part in parts},
            **{name: np.zeros(shape) for name, shape in scratch.items()},
        )  # fmt: skip
        self.model, self.data, self.names, self._bodies = model, data, tuple(feet), bodies
        self.acting = world.effects
        self.addresses = np.array([(a.ctypes.data, *a.shape, 0)[:3] for a in self._space])
        _keep(self)

    def detach(self) -> None:
        """Take the sand away from this MjData."""
        import mujoco

        with _LOCK:
            if _KEPT.get(self.data._address) is self:
                del _KEPT[self.data._address]
                ATTACHED[ATTACHED[:, 0] == self.data._address, 0] = 0
                if not _KEPT and mujoco.get_mjcb_passive() == callback():  # not one that was set since
                    mujoco.set_mjcb_passive(None)

    def lift(self, weight: float) -> float:
        """How far to lift the robot, m, for sand to carry a weight, N, as its feet sink; NaN: it cannot."""
        step = self._space.step
        step["weight"] = weight
        compiled()["lift"].ctypes(self.addresses.ctypes.data)
        step["weight"] = 0.0
        return float(step["lift"][0])

    @property
    def trace(self) -> Array:
        """Steps that were asked for, (steps, bodies, `TRACED`); NaN where there was none yet."""
        return np.reshape(self._space.trace, (len(self._space.trace), -1, len(TRACED)))

    def bristles(self, name: str) -> Array:
        """Bristles of the faces of a body at the ends of steps, in its own axes, (steps, 3, faces)."""
        body = self._bodies[self.names.index(name)]
        part = self._space.history[:, 3 * body["first"] : 3 * body["last"]]
        return np.reshape(part, (len(part), 3, body["last"] - body["first"]))

    @property
    def force(self) -> dict[str, Array]:
        """Of the sand on each body at the step's end, (3,), N, in the world's axes."""
        return self._by_name(self._in_world(END)[:, :3])

    @property
    def wrench(self) -> dict[str, Array]:
        """Mean force, N, and torque about the body's origin, N m, (6,), over the step."""
        return self._by_name(self._in_world(MEAN))

    @property
    def power(self) -> dict[str, float]:
        """Of the sand on each body at the step's end, W."""
        return self._by_name(self._bodies["power"].tolist())

    @property
    def work(self) -> dict[str, float]:
        """Of the sand on each body since it was attached, J."""
        return self._by_name(self._space.spent.sum(axis=0).tolist())

    @property
    def depth(self) -> dict[str, float]:
        """Of the deepest face of each body at the step's beginning, m."""
        return self._by_name(self._bodies["depth"].tolist())

    @property
    def counts(self) -> dict[str, int]:
        """Steps, evaluations, stages not solved, and restarts: 1, and one for every jump in time."""
        return {name: int(self._space.step[name][0]) for name in COUNTED}

    def _in_world(self, row: int) -> Array:
        """Vectors of the bodies, (bodies, 6), in the world's axes."""
        vectors, frame = self._space.vectors[row].reshape(-1, 2, 3), self._space.frame.reshape(-1, 3, 3)
        return np.reshape(vectors @ frame.swapaxes(1, 2), (-1, 6))

    def _by_name(self, values: Any) -> dict[str, Any]:
        return dict(zip(self.names, values, strict=True))


def attach(model: Any, data: Any, feet: Mapping[str, Foot], *given: Any, **options: Any) -> Contact:
    """Make a `Contact` of a model and its data, or of a mujoco.MjSpec and None, which it then compiles.

    States of a model that it compiled (`mujoco.mj_getState`) include the memory of the sand: any MjData of
    that model with the same feet attached continue from them, to the last bit.
    """
    mujoco = needed("mujoco", "footopt.mujoco", "mujoco")
    if isinstance(model, mujoco.MjSpec):
        check(data is None, "data", data, "None with a specification", "It is made of the compiled model.")
        plain = model.copy().compile()
        sand = Contact(plain, mujoco.MjData(plain), feet, *given, **options)
        sand.detach()
        model = remembering(model, sand.memory.size)
        data = mujoco.MjData(model)
    return Contact(model, data, feet, *given, **options)


@lru_cache(maxsize=32)
def _constants(sand: Sand, effects: tuple[Effect, ...]) -> World:
    """The constants of a sand with effects."""
    return with_bypassed_gates(Scene(sand, effects=effects).constants(Accuracy()))


def _in_one_plane(mujoco: Any, model: Any, data: Any, rows: list[int]) -> bool:
    """Whether bodies can move in the plane of x and z only, and have y for an axis of their own."""
    moved, turned = np.zeros((2, 3, model.nv))
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    for row in rows:
        mujoco.mj_jacBody(model, data, moved, turned, row)
        if moved[1].any() or turned[::2].any() or data.xmat[row, 1::2].any() or not moved.any():
            return False
    return True


def _sole(cut: Plates, width: float, lines: int) -> Array:
    """The faces of a sole, (10, plates), as `faces.forces` takes them."""
    x, z, c2, s2, area, tx, tz = (np.tile(column[0], lines) for column in cut[:7])
    y = np.repeat([-1.0, 1.0] if lines == 2 else [0.0], len(cut.x[0])) * width / (2.0 * np.sqrt(3.0))
    return np.array([x, y, z, area / lines, tz, 0 * x, -tx, 0.5 - 0.5 * c2, -0.5 * s2, 0.5 + 0.5 * c2])


def _need_no_floor(model: Any, row: int, reach: float) -> None:
    """Raise if a plane or a height field of the world would carry a foot in the sand."""
    bodies, types, others = model.geom_bodyid, model.geom_contype, model.geom_conaffinity
    fixed, own = model.body_weldid[bodies] == 0, model.body_weldid[bodies] == model.body_weldid[row]
    floors = fixed & (model.geom_type < 2) & (model.geom_pos[:, 2] > -reach)
    meet = types[own, None] & others[floors] | others[own, None] & types[floors]
    ends = np.stack([model.pair_geom1, model.pair_geom2])
    paired = (own[ends] & fixed[ends[::-1]] & (model.geom_type[ends[::-1]] < 2)).any()
    free, hint = not (meet.any() or paired), "Zero its contype and conaffinity; delete its pairs."
    check(free, "model", "a floor", "one that no foot touches", hint)


def _keep(contact: Contact) -> None:
    """Have MuJoCo call the callback for the contact's data, while threads may use the rows of others."""
    import mujoco

    address = contact.data._address
    with _LOCK:
        rows = np.flatnonzero(ATTACHED[:, 0] == address)
        free = rows if len(rows) else np.flatnonzero(ATTACHED[:, 0] == 0)
        check(len(free), "data", f"number {MOST + 1}", f"at most {MOST} at once", "Detach one.")
        other, hint = mujoco.get_mjcb_passive(), "Detach the sand, or set None before."
        check(other in (None, callback()), "mjcb_passive", other, "footopt's or None", hint)
        mujoco.set_mjcb_passive(callback())
        _KEPT[address] = contact
        ATTACHED[free[0], 1:] = contact.addresses.ctypes.data, compiled()["passive"].address
        ATTACHED[free[0], 0] = address
