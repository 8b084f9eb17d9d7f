"""Attach footopt's sand to a MuJoCo model: a passive force, compiled, that MuJoCo calls in every step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.effects import Rest, Slope
from footopt.effects import base as effects
from footopt.effects.footprints import prints_of
from footopt.effects.rest import rest_length
from footopt.effects.shadowing import filler
from footopt.errors import SettingError, needed
from footopt.foot import Foot
from footopt.mujoco.callback import KERNELS, MOST, callback, kernel
from footopt.mujoco.desk import Desk
from footopt.mujoco.intrusion import Grains, xi_of
from footopt.mujoco.step import COUNTED, MESH, SOLE
from footopt.sand import Sand
from footopt.sand.law import PER_CM3
from footopt.walk.scene import EARTH

Array = NDArray[np.float64]

RK4 = 1  # mjINT_RK4

#: Callbacks in use by the address of their MjData: all that they read has to stay where it is.
_ATTACHED: dict[int, Contact] = {}


def attach(
    model: Any,
    data: Any,
    feet: Mapping[str, Foot | str],
    sand: Sand | Grains,
    effects: Sequence[effects.Effect] = (),
    plates: int = 64,
) -> Contact:
    """Put bodies of a MuJoCo model on sand, whose surface is z = 0.

    The force is added to ``data.qfrc_passive`` in every step. Attach after the model is compiled and its
    integrator, time step and gravity are chosen; the first step starts with all that is in the sand sunk
    straight down. What MuJoCo itself knows of the ground is left alone: take its plane away, or the
    feet's part in collisions.

    Parameters
    ----------
    model : mujoco.MjModel
        Of your robot.
    data : mujoco.MjData
        Of this model; only steps that are made with it meet sand.
    feet : mapping of str to Foot or str
        By name of the body: a sole, whose ankle is the body's origin, x forward and z up, or the name of a
        mesh geom of this body.
    sand : Sand or Grains
        Soles feel its planar law, meshes 3D-RFT (`footopt.mujoco.intrusion`).
    effects : sequence of Effect
        As in a `Scene`; a `Rest` says over which length the sand holds, and is there without being named.
    plates : int, 1
        Of a sole: half of them along each of two lines, where Gauss's rule has them across the width.

    Returns
    -------
    Contact
        What the sand does; `Contact.detach` ends it.

    Raises
    ------
    SettingError
        A name is not in the model, or an effect is not for MuJoCo.
    MissingError
        There is no MuJoCo: ``pip install "footopt[mujoco]"``.
    """
    return Contact(model, data, feet, sand, tuple(effects), plates)


class Contact:
    """The sand under the feet of one MjData, made by `attach`.

    Parameters
    ----------
    model, data, feet, sand, effects, plates
        As for `attach`.
    """

    def __init__(
        self,
        model: Any,
        data: Any,
        feet: Mapping[str, Foot | str],
        sand: Sand | Grains,
        chosen: tuple[effects.Effect, ...],
        plates: int,
    ) -> None:
        mujoco = needed("mujoco", "footopt.mujoco", "mujoco")
        _check(feet, chosen, plates)
        grains = sand if isinstance(sand, Grains) else Grains()
        planar = sand.sand if isinstance(sand, Grains) else sand
        zeta = planar.zeta * float(np.linalg.norm(model.opt.gravity)) / EARTH
        chosen = effects.ordered(chosen)
        rows: list[tuple[int, int, int, int]] = []
        tables, laws = [], np.zeros((len(feet), 9))
        for b, (name, foot) in enumerate(feet.items()):
            body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
            if body < 0:
                names = [model.body(i).name for i in range(1, model.nbody)]
                raise SettingError("feet", name, f"the name of a body: {', '.join(names)}")
            solid = isinstance(foot, Foot)
            tables.append(_sole(foot, plates, chosen) if isinstance(foot, Foot) else _mesh(model, body, foot))
            first = rows[-1][2] if rows else 0
            rows.append((body, first, first + tables[-1].shape[1], SOLE if solid else MESH))
            laws[b] = (
                [zeta * PER_CM3 * v for v in planar.stress_map.law]
                if solid
                else [xi_of(zeta), grains.surface, *[0.0] * 7]
            )
        self.model, self.data, self.names = model, data, tuple(feet)
        rk4 = float(model.opt.integrator == RK4)
        clock = np.array([0.0, model.opt.timestep, rk4, 0.0, 0.0])
        length = rest_length(chosen) or Rest().length
        self._desk = _desk(model, data, rows, tables, laws, clock, length)
        acting = effects.laws(chosen)
        self.acting = acting.loads, acting.gates, acting.pushes
        self._kernel = kernel(self.acting, self._desk)
        self._spec = np.array([v for a in self._desk for v in (a.ctypes.data, *a.shape, 0)[:3]], np.int64)
        if data._address not in _ATTACHED and len(_ATTACHED) == MOST:
            raise SettingError("data", f"number {MOST + 1}", f"at most {MOST} at once", "Detach one.")
        _ATTACHED[data._address] = self
        _install(mujoco)

    def detach(self) -> None:
        """Take the sand away from this MjData."""
        if _ATTACHED.get(self.data._address) is self:
            del _ATTACHED[self.data._address]
            _install(needed("mujoco", "footopt.mujoco", "mujoco"))

    @property
    def force(self) -> dict[str, Array]:
        """Of the sand on each body at the step's end, (3,), N, in the world's axes."""
        return {name: self._desk.last[b, :3].copy() for b, name in enumerate(self.names)}

    @property
    def wrench(self) -> dict[str, Array]:
        """Mean force, N, and torque about the body's origin, N m, (6,), given for the step."""
        return {name: self._desk.mean[b].copy() for b, name in enumerate(self.names)}

    @property
    def power(self) -> dict[str, float]:
        """Of the sand on each body at the step's end, W."""
        return dict(zip(self.names, self._desk.power.tolist(), strict=True))

    @property
    def work(self) -> dict[str, float]:
        """Of the sand on each body since it was attached, J."""
        return dict(zip(self.names, (self._desk.work + self._desk.pending).tolist(), strict=True))

    @property
    def depth(self) -> dict[str, float]:
        """Of the deepest face of each body at the step's beginning, m."""
        return dict(zip(self.names, self._desk.depths.tolist(), strict=True))

    @property
    def counts(self) -> dict[str, int]:
        """Steps, evaluations, stages rescued and failed, and restarts: 1, and one for every jump in time."""
        return dict(zip(COUNTED, self._desk.counts.tolist(), strict=True))


def _check(feet: Mapping[str, Foot | str], chosen: Sequence[effects.Effect], plates: int) -> None:
    if not feet:
        raise SettingError("feet", {}, "a body and its foot, at least")
    if plates < 4 or plates % 2:
        raise SettingError("plates", plates, "an even number from 4")
    if any(isinstance(effect, Slope) for effect in chosen):
        raise SettingError("effects", "slope", "one that MuJoCo has not", "Tilt model.opt.gravity.")
    if prints_of(chosen) is not None:
        raise SettingError("effects", "footprints", "an effect without a changing surface")


def _sole(foot: Foot, plates: int, chosen: Sequence[effects.Effect]) -> Array:
    """The faces of a sole, (10, plates), as `stage` takes them."""
    cut = foot.plates(plates // 2, directed=True, fill=filler(chosen))
    x, z, c2, s2, area, tx, tz = (np.tile(column[0], 2) for column in cut[:7] if column is not None)
    y = np.repeat([-1.0, 1.0], len(x) // 2) * foot.width / (2.0 * np.sqrt(3.0))
    half = 0.5 * area
    return np.array([x, y, z, half, tz, 0 * x, -tx, 0.5 - 0.5 * c2, -0.5 * s2, 0.5 + 0.5 * c2])


def _mesh(model: Any, body: int, name: str) -> Array:
    """The faces of a mesh geom, (10, faces), in the body's frame."""
    names = {model.geom(i).name: i for i in range(model.ngeom) if model.geom_bodyid[i] == body}
    if name not in names or model.geom_dataid[names[name]] < 0 or model.geom_type[names[name]] != 7:
        raise SettingError("feet", name, f"a Foot, or a mesh geom of the body: {', '.join(names) or 'none'}")
    import trimesh.transformations

    geom = names[name]
    mesh, matrix = model.geom_dataid[geom], trimesh.transformations.quaternion_matrix(model.geom_quat[geom])
    matrix[:3, 3] = model.geom_pos[geom]
    start, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    first, faces = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
    solid = trimesh.Trimesh(
        model.mesh_vert[start : start + count], model.mesh_face[first : first + faces], process=False
    )
    solid.apply_transform(matrix)
    n = solid.face_normals.T
    return np.array([*solid.triangles_center.T, solid.area_faces, *n, n[0] ** 2, n[0] * n[2], n[2] ** 2])


def _desk(
    model: Any, data: Any, rows: list[Any], tables: list[Array], laws: Array, clock: Array, length: float
) -> Desk:
    b, p, nv = len(rows), rows[-1][2], model.nv
    x, y, z = np.concatenate([t[:3] for t in tables], axis=1)
    reach = np.array([np.sqrt((t[:3] ** 2).sum(axis=0).max()) for t in tables])
    return Desk(
        places=data.xpos,
        attitude=data.xmat.reshape(-1, 9),
        velocity=data.qvel,
        passive=data.qfrc_passive,
        bodies=np.array(rows, np.int64),
        active=np.zeros(b, np.int64),
        counts=np.zeros(len(COUNTED), np.int64),
        clock=clock,
        length=np.array([length]),
        laws=laws,
        reach=reach,
        faces=np.concatenate([t.ravel() for t in tables]),
        moments=np.stack([x**0, x, y, z, x * x, x * y, x * z, y * y, y * z, z * z], axis=1),
        bristles=np.zeros((3, 3 * p)),
        forces=np.zeros(3 * p),
        slopes=np.zeros(9 * p),
        gravity=np.array(model.opt.gravity),
        **{name: np.zeros((b, 6)) for name in ("now", "twists", "gained", "free", "mean", "last")},
        **{name: np.zeros(b) for name in ("power", "pending", "work", "depths")},
        **{name: np.zeros((6 * b, nv)) for name in ("jacobian", "own", "answer")},
    )


def _install(mujoco: Any) -> None:
    """Have MuJoCo call the callbacks of all that is attached, or none."""
    for _, table in KERNELS.values():
        table[:] = 0
    for row, contact in enumerate(_ATTACHED.values()):
        KERNELS[contact._kernel][1][row] = contact.data._address, contact._spec.ctypes.data
    keys = tuple(sorted({contact._kernel for contact in _ATTACHED.values()}))
    mujoco.set_mjcb_passive(callback(keys).ctypes if keys else None)
