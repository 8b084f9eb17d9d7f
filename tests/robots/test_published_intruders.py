"""3D-RFT against what was published of single bodies: numbers, sands, a wheel, and the paper's own angles.

No force on a whole body is printed in the paper. Whole bodies are held against its formulae in their angles
beta, gamma and psi, integrated over finer triangles; the code under test has vectors.
"""

import numpy as np
import pytest
import trimesh

import footopt as fo
from footopt.mujoco import Grains, attach
from footopt.mujoco.intrusion import DOWN, TABLE, xi_of

mujoco = pytest.importorskip("mujoco")
shared = pytest.importorskip("block_on_sand")

MESH = """
<mujoco>
  <asset><mesh name="solid" vertex="{vertices}" face="{faces}"/></asset>
  <worldbody>
    <body name="solid"><freejoint/><geom name="solid" type="mesh" mesh="solid" mass="1"/></body>
  </worldbody>
</mujoco>
"""


def angle_form(n, v, surface):
    """The paper's stress per depth over xi, (..., 3), from the angles of unit vectors n and v, (..., 3)."""
    up = np.array([0.0, 0.0, 1.0])
    level = np.where(np.hypot(v[..., :1], v[..., 1:2]) > 1e-9, v, n) * [1.0, 1.0, 0.0]
    size = np.linalg.norm(level, axis=-1, keepdims=True)
    r = np.where(size > 1e-9, level / np.maximum(size, 1e-300), [1.0, 0.0, 0.0])
    t = np.cross(up, r)
    beta = np.arccos(np.clip(-n[..., 2], -1.0, 1.0))
    gamma = np.arcsin(np.clip(-v[..., 2], -1.0, 1.0))
    psi = np.arctan2(np.sum(n * t, axis=-1), np.sum(n * r, axis=-1))
    x1, x2 = np.sin(gamma), np.cos(beta)
    x3 = np.cos(psi) * np.cos(gamma) * np.sin(beta) + np.sin(gamma) * np.cos(beta)
    terms = [1 + 0 * x1, x1, x2, x3, x1**2, x2**2, x3**2, x1 * x2, x2 * x3, x3 * x1, x1**3, x2**3, x3**3,
             x1 * x2**2, x2 * x1**2, x2 * x3**2, x3 * x2**2, x3 * x1**2,
             x1 * x3**2, x1 * x2 * x3]  # fmt: skip
    f1, f2, f3 = (np.tensordot(row, terms, 1) for row in TABLE)
    along = f1 * np.sin(beta) * np.cos(psi) + f2 * np.cos(gamma)
    aside, lift = f1 * np.sin(beta) * np.sin(psi), -f1 * np.cos(beta) - f2 * np.sin(gamma) - f3
    alpha = along[..., None] * r + aside[..., None] * t + lift[..., None] * up
    normal = np.minimum(np.sum(alpha * n, axis=-1, keepdims=True), 0.0) * n
    tangent = alpha - np.sum(alpha * n, axis=-1, keepdims=True) * n
    sizes = (np.linalg.norm(part, axis=-1, keepdims=True) for part in (normal, tangent))
    most = surface * next(sizes) / np.maximum(next(sizes), 1e-300)
    return np.where(
        np.sum(n * v, axis=-1, keepdims=True) > 0.0, normal + np.minimum(most, 1.0) * tangent, 0.0
    )


def cone_mesh(low, high, length, n=256):
    """A frustum of triangles, its middle at the origin."""
    turn = np.exp(2j * np.pi * np.arange(n) / n)
    ring = np.stack([turn.real, turn.imag, 0 * turn.real], -1)
    bottom, top = low * ring - [0, 0, length / 2], high * ring + [0, 0, length / 2]
    return trimesh.convex.convex_hull(np.concatenate([bottom, top])).subdivide_to_size(length / 12, 20)


BODIES = {
    "sphere": trimesh.creation.icosphere(5, 0.025),
    "cylinder": cone_mesh(0.02, 0.02, 0.08),
    "cone": cone_mesh(0.001, 0.03, 0.06),
    "cube": trimesh.creation.box((0.05,) * 3).subdivide_to_size(0.005, 20),
}
SINK, DRAG, PLOUGH = (0, 0, -1, 0, 0, 0), (1, 0, -0.1, 0, 0, 0), (0.6, 0.5, -0.6, 0, 0, 0)
DRILL, ROLL, LIFT = (0, 0, -0.1, 0, 0, 5), (0.1, 0, 0, 0, 4, 0), (0.3, 0, 1, 0, 0, 0)


@pytest.fixture
def pushed(request):
    """From a mesh and sand a function of depth and twist: the wrench about the mesh's origin, N and N m."""

    def put(mesh, sand):
        text = {name: " ".join(f"{x:.9g}" for x in values.ravel()) for name, values in
                (("vertices", mesh.vertices), ("faces", mesh.faces))}  # fmt: skip
        model = mujoco.MjModel.from_xml_string(MESH.format(**text))
        data = mujoco.MjData(model)
        data.qpos[2] = 1.0
        contact = attach(model, data, {"solid": "solid"}, sand)
        request.addfinalizer(contact.detach)
        return lambda depth, twist: shared.feel(contact, np.array([0.0, 0.0, 1.0]), twist, -depth)[0]

    return put


@pytest.mark.parametrize("motion", [SINK, DRAG, PLOUGH, DRILL, ROLL, LIFT])
@pytest.mark.parametrize("body", BODIES)
def test_whole_bodies_feel_what_the_papers_angles_say(pushed, body, motion):
    mesh, grains, depth = BODIES[body], Grains(3000.0, 0.4, 0.4), 0.05
    fine = mesh.subdivide()
    place, n, area = fine.triangles_center, fine.face_normals, fine.area_faces
    v = np.array(motion[:3], float) + np.cross(np.array(motion[3:], float), place)
    v /= np.linalg.norm(v, axis=1, keepdims=True)
    below = np.maximum(depth - place[:, 2], 0.0)
    each = xi_of(grains.sand) * angle_form(n, v, grains.surface) * (below * area)[:, None]
    force, torque = each.sum(axis=0), np.cross(place, each).sum(axis=0)
    found = pushed(mesh, grains)(depth, motion)
    assert found[:3] == pytest.approx(force, abs=0.01 * np.linalg.norm(force))
    assert found[3:] == pytest.approx(torque, abs=0.01 * np.linalg.norm(force) * 0.03)


@pytest.mark.parametrize(
    ("rho", "friction", "published", "within"), [(3000.0, 0.4, 0.92e6, 0.01), (1310.0, 0.21, 0.12e6, 0.07)]
)
def test_sands_of_the_verification_studies_have_the_published_material_constant(
    rho, friction, published, within
):
    assert Grains(rho, friction).xi == pytest.approx(published, rel=within)


def test_a_level_face_that_sinks_feels_alpha_z_of_the_constant():
    found = angle_form(np.array([0.0, 0.0, -1.0]), np.array([0.0, 0.0, -1.0]), np.inf)
    assert found == pytest.approx([0.0, 0.0, DOWN], abs=1e-12)
    assert pytest.approx(0.87574, abs=1e-12) == DOWN


#: Yu, Pavlov, Kim & Johnson, J. Terramechanics 115 (2024): slip, sinkage (mm), drawbar pull and load (N).
WHEEL = [(-1, 50.0, -38.8, 19.5), (-0.7, 32.0, -24.1, 21.8), (-0.5, 23.3, -17.2, 23.2),
         (-0.2, 14.7, -7.3, 23.7), (0, 14.1, -1.3, 24.6), (0.23, 17.5, 0.7, 24.6), (0.5, 22.4, 1.0, 25.3),
         (0.75, 25.1, 0.8, 24.0), (0.9, 25.4, 1.5, 25.7)]  # fmt: skip


def test_a_wheel_at_the_measured_sinkage_is_pulled_as_measured_and_not_carried_so_at_high_slip(pushed):
    """Drawbar pull and load of 3D-RFT on their wheel, 125 x 60 mm, at their plate tests' mean zeta."""
    wheel = cone_mesh(0.0625, 0.0625, 0.06)
    wheel.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0]))
    roll, found = pushed(wheel, fo.Sand(0.95)), []
    for slip, sinkage, *_ in WHEEL:
        forward, rim = (1.0, 1.0 + slip) if slip < 0 else (1.0 - slip, 1.0)
        found.append(roll(sinkage / 1e3 - 0.0625, (forward, 0, 0, 0, rim / 0.0625, 0))[[0, 2]])
    found = np.array(found)
    measured = np.array(WHEEL)[:, 2:]
    assert np.abs(found - measured).mean(axis=0) == pytest.approx([1.7, 7.6], abs=0.1)  # N
    assert found[:, 1].sum() / measured[:, 1].sum() == pytest.approx(0.98, abs=0.02)
    assert np.corrcoef(found[:, 0], measured[:, 0])[0, 1] > 0.98
