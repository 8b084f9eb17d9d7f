"""The traps that docs/mujoco.md names: the global callback, what is read once, pools, stops, the floor."""

import copy

import numpy as np
import pytest

import footopt as fo
from footopt.errors import SettingError
from footopt.mujoco import attach

mujoco = pytest.importorskip("mujoco")
rollout = pytest.importorskip("mujoco.rollout")
shared = pytest.importorskip("block_on_sand")
HARD, settle = shared.HARD, shared.settle


@pytest.fixture
def block(request):
    return lambda **options: shared.put_on_sand(request, **options)


def falls(model, data):
    """Whether it is in free fall."""
    before = data.qvel[2]
    mujoco.mj_step(model, data)
    return data.qvel[2] - before == pytest.approx(-9.81 * model.opt.timestep)


def test_sand_is_refused_while_there_is_another_passive_callback(block):
    model, data, contact = block(height=0.02)
    contact.detach()
    mujoco.set_mjcb_passive(nothing)
    try:
        with pytest.raises(SettingError, match="nothing"):
            attach(model, data, {"foot": fo.Foot.flat()}, HARD)
    finally:
        mujoco.set_mjcb_passive(None)


def nothing(model, data):
    """A passive callback."""


def test_what_cannot_be_attached_is_said():
    floor = "<worldbody><geom name='floor' type='plane' size='1 1 1'/>"
    text = shared.BLOCK.format(dt=1e-3, integrator="Euler", height=0.03).replace("<worldbody>", floor)
    model, on_floor = shared.block_model(), mujoco.MjModel.from_xml_string(text)
    flat = {"foot": fo.Foot.flat()}
    for of, data_of, feet, options, what in (
        (model, shared.block_model(), flat, {}, "data"),
        (on_floor, on_floor, flat, {}, "model"),
        (model, model, {"world": fo.Foot.flat()}, {}, "feet"),
        (model, model, {"hand": fo.Foot.flat()}, {}, "hand"),
        (model, model, {}, {}, "feet"),
        (model, model, {"foot": "sole"}, {}, "of type Foot"),
        (model, model, flat, {"effects": (fo.Slope(5.0),)}, "gravity"),
        (model, model, flat, {"plates": 7}, "even"),
    ):
        with pytest.raises(SettingError, match=what):
            attach(of, mujoco.MjData(data_of), feet, HARD, **options)
    on_floor.geom("floor").contype = on_floor.geom("floor").conaffinity = 0
    attach(on_floor, mujoco.MjData(on_floor), flat, HARD).detach()


def test_sand_that_loses_its_bristles_says_so(block, request):
    said, before = [], mujoco.get_mju_user_warning()
    request.addfinalizer(lambda: mujoco.set_mju_user_warning(before))
    mujoco.set_mju_user_warning(said.append)
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    for lose in ("time step", "chunks of rollouts"):
        model, data, _ = block(height=0.03)
        start = np.zeros((1, mujoco.mj_stateSize(model, kind)))
        settle(model, data, 0.3)
        mujoco.mj_getState(model, data, start[0], kind)
        settle(model, data, 0.1)
        assert not said
        if lose == "time step":
            model.opt.timestep *= 2.0
            settle(model, data, 0.1)
        else:
            rollout.rollout(model, [data], start, nstep=100)
        assert len(said) == 1
        assert "anew" in said.pop()
        mujoco.mj_resetData(model, data)
        settle(model, data, 0.1)
        assert not said


@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicitfast"])
def test_states_of_a_specifications_model_hold_the_sands_memory(request, integrator):
    """Restored, copied, reset, and in chunks of rollouts it goes on to the same bits."""
    spec = mujoco.MjSpec.from_string(shared.BLOCK.format(dt=1e-3, integrator=integrator, height=0.03))
    kind, feet, said = mujoco.mjtState.mjSTATE_FULLPHYSICS, {"foot": fo.Foot.flat()}, []
    before = mujoco.get_mju_user_warning()
    request.addfinalizer(lambda: mujoco.set_mju_user_warning(before))
    mujoco.set_mju_user_warning(said.append)

    def attached(model, data):
        contact = attach(model, data, feet, HARD)
        request.addfinalizer(contact.detach)
        return contact

    sand = attached(spec, None)
    model, data = sand.model, sand.data
    start = np.zeros((2, mujoco.mj_stateSize(model, kind)))
    data.qvel[:2] = 0.3, 0.1
    for state in start:
        mujoco.mj_step(model, data, nstep=300)
        mujoco.mj_getState(model, data, state, kind)
    mujoco.mj_setState(model, data, start[0], kind)
    copied, other = copy.copy(data), mujoco.MjData(model)
    for one in (data, copied):
        attached(model, one)
        mujoco.mj_step(model, one, nstep=300)
    attached(model, other)
    first, _ = rollout.rollout(model, [other], start[:1], nstep=100)
    second, _ = rollout.rollout(model, [data], first[:, -1], nstep=200)
    places = slice(1, 1 + model.nq)
    for place in (data.qpos, copied.qpos, second[0, -1, places]):
        np.testing.assert_array_equal(place, start[1, places])
    mujoco.mj_resetData(model, data)
    data.qvel[:2] = 0.3, 0.1
    mujoco.mj_step(model, data, nstep=600)
    np.testing.assert_array_equal(data.qpos, start[1, places])
    assert not said
    with pytest.raises(SettingError, match="feet"):
        attach(model, other, feet, HARD, plates=32)


def test_a_second_attachment_takes_the_place_of_the_first(block):
    model, data, first = block(height=0.03)
    second = attach(model, data, {"foot": fo.Foot.flat()}, HARD)
    settle(model, data, 1.0)
    assert second.force["foot"][2] == pytest.approx(60 * 9.81)  # not half of it
    assert first.counts["steps"] == 0
    first.detach()  # it is over already
    settle(model, data, 0.5)
    assert second.force["foot"][2] == pytest.approx(60 * 9.81)
    second.detach()
    assert falls(model, data)


def test_a_callback_that_is_set_later_stays_when_the_sand_is_detached(block):
    _, _, contact = block(height=0.03)
    mujoco.set_mjcb_passive(lambda model, data: None)
    try:
        contact.detach()
        assert mujoco.get_mjcb_passive() is not None
    finally:
        mujoco.set_mjcb_passive(None)


def test_a_step_that_is_asked_for_again_gets_the_same_force(block):
    """As by `mj_forward` before a picture is drawn: nothing of the sand moves on."""
    for integrator in ("Euler", "RK4", "implicit", "implicitfast"):
        model, data, contact = block(integrator=integrator, height=0.0)
        mujoco.mj_step(model, data, nstep=100)
        forces = []
        for _ in range(3):
            mujoco.mj_forward(model, data)
            forces.append((*contact.wrench["foot"], *data.qfrc_passive))
        assert forces[0] == forces[1] == forces[2]
        assert forces[0][2] > 100.0


def test_rollouts_meet_sand_where_their_data_are_attached(request):
    model = shared.block_model(height=0.03, dt=2e-3)
    pool = [mujoco.MjData(model) for _ in range(2)]
    starts = np.zeros((4, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    for row, height in zip(starts, (0.03, 0.04, 0.05, 0.06), strict=True):
        mujoco.mj_getState(model, pool[0], row, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        row[3] = height  # time, then x, y, z
    free, _ = rollout.rollout(model, pool, starts, nstep=500)
    assert (free[:, -1, 3] < -4.0).all()
    for data in pool:
        request.addfinalizer(attach(model, data, {"foot": fo.Foot.flat()}, HARD).detach)
    together, _ = rollout.rollout(model, pool, starts, nstep=500)
    assert (abs(together[:, -1, 3]) < 0.03).all()
    alone = [rollout.rollout(model, pool[:1], start[None], nstep=500)[0][0, -1] for start in starts]
    assert together[:, -1] == pytest.approx(np.array(alone), abs=1e-13)


LEG = """
<mujoco>
  <option timestep="0.002" integrator="Euler"/>
  <worldbody>
    <body name="leg" pos="0 0 .5"><freejoint/><geom type="box" size=".05 .05 .2" mass="20"/>
      <body name="foot" pos="0 0 -.3"><joint name="ankle" axis="0 1 0"/>
        <geom type="box" size=".13 .05 .01" mass="1"/>
      </body>
    </body>
  </worldbody>
  <actuator><position joint="ankle" kp="300" kv="{kv}"/></actuator>
</mujoco>
"""


@pytest.mark.parametrize("kv", [1.0, 3.0, 4.5])
def test_sand_holds_an_ankle_whose_servo_is_explicit_as_long_as_it_is_stable_in_the_air(kv, request):
    model = mujoco.MjModel.from_xml_string(LEG.format(kv=kv))
    data = mujoco.MjData(model)
    contact = attach(model, data, {"foot": fo.Foot.flat()}, HARD)
    request.addfinalizer(contact.detach)
    mujoco.mj_step(model, data, nstep=2000)
    assert model.opt.timestep * kv / model.dof_M0[-1] > 0.35  # of 2
    assert abs(data.qvel).max() < 1e-9
