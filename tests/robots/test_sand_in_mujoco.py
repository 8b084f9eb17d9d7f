"""footopt's sand under MuJoCo's bodies: the same law, the same walk, and a robot that stands stands."""

import numpy as np
import pytest

import footopt as fo
from footopt.effects import Inertia, Layers, LeadingEdge, Rest
from footopt.gait import Pose
from footopt.mujoco import attach
from footopt.mujoco.faces import EDGE
from footopt.mujoco.implicit import TWISTS
from footopt.walk.plates import plate_states

mujoco = pytest.importorskip("mujoco")
walker = pytest.importorskip("mujoco_walker")
shared = pytest.importorskip("block_on_sand")
robots = pytest.importorskip("stiff_robots")

HARD, settle, feel = shared.HARD, shared.settle, shared.feel

HOLLOW = fo.Foot.from_waypoints([5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4])
#: Effects of all tests that have some: a callback is compiled for each choice of them, with their numbers.
SOME = (LeadingEdge(), Inertia(), Layers((0.01,), (3.0,)))
INTEGRATORS = [name.removeprefix("mjINT_") for name in mujoco.mjtIntegrator.__members__]
SPELLED = {"EULER": "Euler", "RK4": "RK4"}


@pytest.fixture
def block(request):
    """A function that puts a block of 60 kg on sand: model, data and contact."""
    return lambda *given, **options: shared.put_on_sand(request, *given, **options)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_drop_sinks_as_deep_at_every_step_and_with_every_integrator(block, integrator):
    depths = {}
    for dt in (1e-4, 5e-4, 1e-3, 2e-3, 4e-3):
        spelled = SPELLED.get(integrator, integrator.lower())
        model, data, contact = block(dt=dt, integrator=spelled if dt > 1e-4 else "Euler")
        settle(model, data, 1.2)
        depths[dt] = contact.depth["foot"]
        assert abs(data.qvel).max() < (1e-12 if dt > 1e-4 else 1e-3)  # bristles swing at 1e-4 s, undamped
        assert contact.counts["failures"] == 0
    for dt, depth in depths.items():
        assert depth == pytest.approx(depths[1e-4], rel=0.01), dt


def test_one_line_of_plates_stands_for_two_where_a_foot_cannot_roll(block):
    free, data, contact = block(dt=2e-3, foot=HOLLOW)
    joints = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint axis="0 -1 0"/>'
    held = mujoco.MjModel.from_xml_string(
        shared.BLOCK.replace("<freejoint/>", joints).format(dt=2e-3, integrator="Euler", height=0.05)
    )
    other = mujoco.MjData(held)
    with_one = attach(held, other, {"foot": HOLLOW}, HARD)
    data.qvel[:3], other.qvel[:2] = (0.3, 0.0, -0.2), (0.3, -0.2)
    settle(free, data, 0.3)
    settle(held, other, 0.3)
    with_one.detach()
    assert (contact.lines, with_one.lines) == (2, 1)
    np.testing.assert_allclose(np.add(other.qpos[:2], [0.0, 0.05]), data.qpos[[0, 2]], atol=1e-6)


@pytest.mark.parametrize("zeta", [0.2, 5.0, 50.0])
@pytest.mark.parametrize("pushed", [0.0, 40.0])
def test_who_stands_stays_for_a_minute(block, zeta, pushed):
    model, data, _ = block(fo.Sand(zeta), height=0.03, dt=4e-3)
    data.qfrc_applied[0] = pushed  # N, along the ground: friction holds it
    settle(model, data, 2.0)
    before = data.qpos.copy()
    settle(model, data, 60.0)
    assert abs(data.qpos - before).max() < 1e-4


def test_momentum_changes_by_the_impulse_and_energy_by_the_work(block):
    errors = []
    for dt in (2e-3, 5e-4):
        model, data, contact = block(fo.Sand(1.0), dt=dt, foot=HOLLOW, integrator="RK4")
        model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
        data.qvel[:] = 0.4, 0.2, -0.5, 0.3, 0.5, 0.2
        mujoco.mj_forward(model, data)
        energy, momentum, impulse = sum(data.energy), 60 * data.qvel[:3].copy(), np.zeros(3)
        for _ in range(round(0.4 / dt)):
            mujoco.mj_step(model, data)
            impulse += dt * (contact.wrench["foot"][:3] - [0, 0, 60 * 9.81])
        work = contact.work["foot"]  # up to the end of the last step
        mujoco.mj_forward(model, data)
        assert 60 * data.qvel[:3] - momentum == pytest.approx(impulse, abs=1e-9)
        errors.append(abs(sum(data.energy) - energy - work) / abs(work))
    assert errors[0] < 0.02
    assert errors[1] < 0.5 * errors[0]


@pytest.mark.slow
def test_planar_walker_agrees_with_simulate_on_random_soles_and_sands():
    rng = np.random.default_rng(20)
    worst = 0.0
    for k in fo.Waypoints().random(3, seed=4):
        scene = fo.Scene(sand=fo.Sand(float(np.exp(rng.uniform(*np.log([0.2, 5.0]))))), effects=(Rest(),))
        foot = fo.Foot.from_waypoints(k)
        walk = fo.simulate(foot, scene, "fine")
        found, counts = walker.walk(foot, scene, walk, dt=2e-4)
        assert counts["restarts"] == 1
        for name, value in found.items():
            worst = max(worst, abs(value / walk.objectives[name] - 1))
    assert worst < 0.01


@pytest.mark.parametrize("effects", [(), pytest.param(SOME, marks=pytest.mark.slow)], ids=["none", "some"])
def test_forces_are_those_of_the_planar_law_with_its_effects(block, effects):
    _, _, contact = block(effects=effects, foot=HOLLOW, plates=128)
    scene = fo.Scene(sand=HARD, effects=effects)
    plates, rng, tried = HOLLOW.plates(64), np.random.default_rng(3), 0
    while tried < 20:
        pitch, vx, vz, rate = rng.uniform(-0.6, 0.6), *rng.uniform(-1, 1, 2), rng.uniform(-4, 4)
        height = rng.uniform(-0.05, 0.04)
        cos, sin, none = np.cos(pitch), np.sin(pitch), np.zeros((1, 1))
        pose = Pose(none, none, none, none, none + pitch, none + rate)
        h, place, world = np.zeros((1, 1, 64, 2)), np.array([[0.0, height]]), scene.constants(fo.Accuracy())
        moving = plate_states(plates, pose, place, np.array([[vx, vz]]), world, 1e-4, h)
        h = moving.velocity / np.linalg.norm(moving.velocity, axis=-1, keepdims=True)
        states = plate_states(plates, pose, place, np.array([[vx, vz]]), world, 1e-4, h)
        each, (rx, rz) = states.force[0, 0], states.position[0, 0].T - [[0.0], [height]]
        gates = abs(np.sum(states.normal * h, axis=-1)) > EDGE  # of a robot they open more gradually
        if not (gates | (states.depth == 0.0)).all() and effects:
            continue
        tried += 1
        twist = (cos * vx + sin * vz, 0.0, -sin * vx + cos * vz, 0.0, -rate, 0.0)
        wrench, _ = feel(contact, np.array([sin, 0.0, cos]), twist, height)
        found = cos * wrench[0] - sin * wrench[2], sin * wrench[0] + cos * wrench[2]
        assert found == pytest.approx(each.sum(axis=0), rel=1e-9, abs=1e-7)
        assert -wrench[4] == pytest.approx(np.sum(rx * each[:, 1] - rz * each[:, 0]), rel=1e-9, abs=1e-7)
        assert wrench[[1, 3, 5]] == pytest.approx(0.0, abs=1e-8)


LEG = """
<mujoco><option timestep=".002" integrator="{integrator}"><flag {flags}/></option><worldbody>
  <body pos="0 0 .5">
  <joint type="slide" axis="0 0 1"/><geom size=".1" mass="59"/><body name="foot" pos="0 0 -.49">
    <joint name="leg" type="slide" axis="0 0 -1" {spring}/><geom type="box" size=".13 .05 .005" mass="1"/>
</body></body></worldbody><actuator><{servo} joint="leg"/></actuator></mujoco>
"""
SERVOS = (
    'motor gear="30000"', 'position kp="3e4" kv="300" ctrlrange="-.01 .01"', 'velocity kv="500" gear="-2"',
    'position kp="3e4" kv="300" forcerange="-400 400"', 'intvelocity kp="3e4" kv="100" actrange="-.02 .02"',
    'general gaintype="affine" gainprm="100 2e4 10" biastype="affine" biasprm="5 -3e4 -300"',
    'general dyntype="filter" dynprm=".01" gainprm="3e4" biastype="affine" biasprm="5 -3e4 -300"',
)  # fmt: skip
#: Of joints, and flags of the model.
SPRINGS = {
    "": "",
    'stiffness="3e4" damping="200"': "",
    'stiffness="3e4" damping="20" actuatorfrcrange="-300 300"': 'eulerdamp="disable" spring="disable"',
    'stiffness="3e4" damping="200" ': 'damper="disable" clampctrl="disable"',
}


@pytest.mark.parametrize("integrator", [name for name in INTEGRATORS if name != "RK4"])
@pytest.mark.parametrize("spring", SPRINGS)
@pytest.mark.parametrize("servo", SERVOS)
def test_sand_foresees_where_servos_and_springs_bring_a_light_foot(servo, spring, integrator, request):
    integrator = SPELLED.get(integrator, integrator.lower())
    leg = LEG.format(integrator=integrator, spring=spring, servo=servo, flags=SPRINGS[spring])
    model = mujoco.MjModel.from_xml_string(leg)
    data, random = mujoco.MjData(model), np.random.default_rng(3)
    contact = attach(model, data, {"foot": fo.Foot.flat()}, HARD)
    request.addfinalizer(contact.detach)
    settle(model, data, 0.04)
    for _ in range(100):
        data.ctrl[:] = random.uniform(-0.02, 0.02)
        mujoco.mj_step(model, data)
        assert contact.depth["foot"] > 0.0
        assert contact._space.room[TWISTS, 2] == pytest.approx(data.qvel @ [1.0, -1.0], abs=1e-12)


@pytest.mark.parametrize("zeta", [50.0, 2000.0])
def test_hard_sand_throws_no_light_block_up_at_any_time_step(block, zeta):
    random = np.random.default_rng(1)
    for _ in range(20):
        model, data, contact = block(
            height=0.03, dt=random.choice([1e-3, 2e-3, 4e-3]), sand=fo.Sand(zeta), integrator="implicitfast"
        )
        model.body_mass[1] *= (light := 10 ** random.uniform(-3.0, -1.0))
        model.body_inertia[1] *= light
        data.qpos[2] += 10 ** random.uniform(-4.0, -2.0)
        data.qpos[3:7] = np.cos(lean := random.uniform(-0.15, 0.15)), 0.0, np.sin(lean), 0.0
        before = data.qpos[2]
        settle(model, data, 0.3)
        assert contact.counts["failures"] == 0
        assert data.qpos[2] < before + 1e-3
        contact.detach()


def test_stiffness_is_the_derivative_of_the_wrench(block):
    _, _, contact = block(effects=SOME, foot=HOLLOW)
    rng = np.random.default_rng(5)
    for _ in range(10):
        up = rng.normal(size=3) * 0.3 + [0, 0, 1]
        up /= np.linalg.norm(up)
        twist, bristles = rng.uniform(-1, 1, 6), 0.2 * rng.normal(size=contact._space.bristles.shape[1])
        state = {"height": -0.2, "c": 1e-3, "turn": 3.0, "bristles": bristles}
        _, stiffness = feel(contact, up, twist, **state)
        steps = np.eye(6) * 1e-6
        slopes = [(feel(contact, up, twist + e, **state)[0] - feel(contact, up, twist - e, **state)[0]) / 2e-6
                  for e in steps]  # fmt: skip
        assert stiffness == pytest.approx(np.stack(slopes, axis=1), abs=2e-4 * abs(stiffness).max())


@pytest.mark.slow
def test_stiff_robots_drawn_at_random_stay_stable_and_stand_still(request):
    rng, stood = np.random.default_rng(3), 0
    for _ in range(8):
        model, foot, sand = robots.draw(rng)
        data = mujoco.MjData(model)
        contact = attach(model, data, {"a_foot": foot, "b_foot": foot}, sand)
        request.addfinalizer(contact.detach)
        settle(model, data, 12.0)
        before = data.qpos.copy()
        settle(model, data, 2.0)
        assert np.isfinite(data.qpos).all()
        assert contact.counts["restarts"] == 1  # MuJoCo resets what diverges
        assert contact.counts["failures"] == 0
        assert contact.counts["evaluations"] < 4 * contact.counts["steps"]
        if data.xmat[1, 8] > 0.95:  # not toppled from its hump, or over on sand too soft
            stood += 1
            assert abs(data.qpos - before)[:3].max() < 1e-4 / 30
    assert stood >= 7


@pytest.mark.slow
def test_robots_that_flail_lying_on_sand_leave_no_stage_unsolved(request):
    rng = np.random.default_rng(4)
    for _ in range(6):
        model, foot, sand = robots.draw(rng)
        data = mujoco.MjData(model)
        contact = attach(model, data, {"a_foot": foot, "b_foot": foot}, sand)
        request.addfinalizer(contact.detach)
        for _ in range(80):
            data.ctrl[:] = rng.uniform(-1.0, 1.0, model.nu)
            mujoco.mj_step(model, data, nstep=round(0.05 / model.opt.timestep))
        assert contact.counts["failures"] == 0
        assert contact.counts["evaluations"] < 8 * contact.counts["steps"]
        assert max(contact.work.values()) < 0.0


def test_an_attitude_turns_the_motion_with_it(block):
    ends = []
    for yaw in (0.0, 1.1):
        model, data, _ = block(foot=HOLLOW)
        c, s = np.cos(yaw), np.sin(yaw)
        data.qpos[3:7] = np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)
        data.qvel[:] = c * 0.5 - s * 0.2, s * 0.5 + c * 0.2, -0.3, 0.4, 0.2, 0.1
        settle(model, data, 0.5)
        x, y = data.qpos[:2]
        ends.append((c * x + s * y, c * y - s * x, data.qpos[2]))
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)
    assert abs(ends[0][1]) > 1e-3
