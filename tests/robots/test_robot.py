"""A robot in MuJoCo as a simulator: where it starts, what it measures, how it fails, what it refuses."""

from contextlib import ExitStack
from dataclasses import replace

import numpy as np
import pytest

import footopt as fo
from footopt.errors import SettingError
from footopt.mujoco.model import BIPED
from footopt.mujoco.walking import quiet
from footopt.walk import FIVE
from footopt.walk.checks import diagnose

mujoco = pytest.importorskip("mujoco")
SPACE = fo.Waypoints(n=5, K=4)
COARSE = fo.Accuracy(dt=2e-3, plates=16)
SOLES = [[1, 2, 3, 2, 1], [4, 3, 2, 3, 4], [4, 4, 4, 4, 4]]


def hold(model, data):
    """A controller that holds all joints straight."""
    data.ctrl[:] = 0.0


def no_such_motor(model, data):
    data.actuator("no_such_motor").ctrl = 0.0


def bend(model, data):
    """A controller that bends both knees by 80 degrees, and the hips by half of that."""
    for side in ("left", "right"):
        data.actuator(f"{side}_hip").ctrl = 0.7
        data.actuator(f"{side}_knee").ctrl = -1.4


@pytest.fixture(scope="module")
def biped():
    return fo.mujoco.Robot(duration=1.4)


class TestTheRobot:
    @pytest.mark.slow
    def test_starts_where_sand_carries_it(self, biped):
        still = replace(biped, controller=hold, duration=1.0, after=0.0)
        walk = fo.simulate(fo.Foot.flat(), still, fo.Accuracy(dt=2e-3))
        load = walk.force[200:, :, 1].sum(axis=1)
        assert load.mean() == pytest.approx(biped.weight, rel=0.01)
        assert np.ptp(walk.com[:, 1]) < 3e-3

    def test_a_closed_foot_is_traced_as_it_is_evaluated(self, biped):
        foot = fo.Foot.shape("ellipse", closed=True)
        walk = fo.simulate(foot, biped, COARSE)
        assert walk.bristles.shape[2] == walk.sole.x.shape[1] > COARSE.plates
        assert walk.objectives["work"] == pytest.approx(
            fo.evaluate([foot], biped, COARSE, "work").values[0, 0]
        )

    def test_density_gives_feet_the_inertia_of_their_soles(self, biped):
        """A box, and a triangle whose legs are the side at the toe and the top; its corner is the ankle."""
        a, b, w, rho = 0.2, 0.03, 0.08, 700.0
        box = fo.Foot(np.array([[-a, -b], [a, -b]]), w)
        wedge = fo.Foot(np.array([[-a, 0.0], [0.0, -b]]), w)
        i = 0.5 * a * b * w * rho
        known = {
            box: (
                4.0 * i,
                [0.0, -b / 2.0],
                4.0 * i * np.array([b**2, 4.0 * a**2 + b**2, 4.0 * a**2, 0.0]) / 12.0,
            ),
            wedge: (i, [-a / 3.0, -b / 3.0], i * np.array([b**2, a**2 + b**2, a**2, a * b / 2.0]) / 18.0),
        }
        for foot, (mass, centre, (xx, yy, zz, xz)) in known.items():
            model = biped.model.wearing(foot, rho).compiled
            row, turn = model.body("right_foot").id, np.empty(9)
            mujoco.mju_quat2Mat(turn, model.body_iquat[row])
            turn = turn.reshape(3, 3)
            width = mass * w**2 / 12.0 * np.array([1.0, 0.0, 1.0])
            whole = np.diag(np.array([xx, yy, zz]) + width)
            whole[0, 2] = whole[2, 0] = xz
            np.testing.assert_allclose(model.body_mass[row], mass)
            np.testing.assert_allclose(model.body_ipos[row], [centre[0], 0.0, centre[1]], atol=1e-12)
            np.testing.assert_allclose(turn @ np.diag(model.body_inertia[row]) @ turn.T, whole, atol=1e-12)

    @pytest.mark.slow
    def test_plates_add_up_to_the_forces_of_the_trace(self, biped):
        walk = fo.simulate(fo.Foot.from_waypoints(SOLES[0], SPACE), biped, fo.Accuracy(dt=2e-3))
        index = np.flatnonzero(walk.force[:, 0, 1] > 100.0)[::25]
        np.testing.assert_allclose(
            walk.plates(index).force.sum(axis=2)[:, 0], walk.force[index, 0], atol=0.05 * biped.weight
        )
        np.testing.assert_allclose(walk.legs(walk.t[index])[:, :, -1], walk.joints[index, :, -1])

    @pytest.mark.slow
    def test_joints_give_what_the_sand_takes(self, biped):
        """Servos give at least what the sand takes: the boom only damps, and it begins and ends upright."""
        values = fo.evaluate(SOLES, biped, fo.Accuracy(dt=1e-3), ("work", "joint_work"), SPACE).values
        assert (values[:, 1] > values[:, 0]).all()

    @pytest.mark.slow
    @pytest.mark.parametrize(("integrator", "dt"), [("implicitfast", 2e-3), ("RK4", 1e-3)])
    def test_work_of_joints_hardly_depends_on_the_step(self, integrator, dt):
        """With the force at its beginning, the damping of servos would count for 13 and 20 % too much."""
        spec = mujoco.MjSpec.from_file(str(BIPED))
        spec.option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
        spec.option.timestep = dt
        robot = fo.mujoco.Robot(spec, duration=1.4)
        coarse, fine = (
            fo.evaluate(SOLES, robot, fo.Accuracy(dt=each, plates=16), "joint_work", SPACE).values
            for each in (dt, 2.5e-4)
        )
        np.testing.assert_allclose(coarse, fine, rtol=0.03)

    def test_counts_the_faces_that_trail_whatever_moves_it(self, biped):
        """Commands from a table, that of the gait which the servos track, have no heel strikes."""
        times = np.arange(0.0, 1.4, 2e-3)
        commands = biped.controller.commands(biped.model.compiled, times)
        names = [biped.model.compiled.actuator(i).name for i in range(biped.model.compiled.nu)]
        table = fo.mujoco.Commands(times, dict(zip(names, commands.T, strict=True)))
        shares = []
        for robot in (biped, replace(biped, controller=table)):
            walk = fo.simulate(fo.Foot.flat(), robot, COARSE)
            shares += [d.value for d in diagnose(walk) if d.name == "share of |W| on trailing faces"]
        assert min(shares) > 0.05

    @pytest.mark.slow
    def test_walks_are_the_same_to_the_bit_on_any_thread(self, biped):
        """Where arrays lie in memory decides nothing, either: it differs from thread to thread."""
        soles = SPACE.random(24, seed=3)
        alone = fo.evaluate(soles, biped, COARSE, space=SPACE, threads=1).values
        for _ in range(3):
            together = fo.evaluate(soles, biped, COARSE, space=SPACE, threads=2).values
            np.testing.assert_array_equal(together, alone)

    @pytest.mark.slow
    def test_a_tolerance_finds_its_time_step(self, biped):
        steps = []
        for name in ("draft", "standard"):
            table = fo.evaluate(SOLES, biped, name, space=SPACE)
            truth = fo.evaluate(SOLES, biped, fo.Accuracy(dt=2.5e-4), space=SPACE)
            walk = fo.simulate(fo.Foot.from_waypoints(SOLES[0], SPACE), biped, name)
            steps.append(walk.accuracy.dt)
            assert np.abs(table.values / truth.values - 1.0).max() < walk.accuracy.tolerance
        assert steps[1] < steps[0] <= 2e-3

    @pytest.mark.slow
    def test_a_fall_is_a_reason_and_survival_says_when(self, biped):
        names = (*FIVE, "survival")
        limp = replace(biped, controller=bend, duration=2.0, after=0.0, lowest=0.8)
        table = fo.evaluate([SOLES[2]], limp, fo.Accuracy(dt=2e-3), names, SPACE)
        assert table.reasons.tolist() == ["fallen"]
        assert np.isnan(table.values[0, :5]).all()
        assert 0.1 < table.column("survival")[0] < 2.0

    def test_a_model_that_is_unstable_in_the_air_is_refused(self, monkeypatch, tmp_path, capfd):
        """Explicit damping of light feet by stiff servos: MuJoCo resets such a simulation by itself."""
        monkeypatch.chdir(tmp_path)  # where MuJoCo would write its log
        explicit = (
            BIPED.read_text().replace("implicitfast", "Euler").replace('armature=".05"', 'armature=".001"')
        )
        with pytest.raises(SettingError, match=r"robot.model.*stable in the air"):
            fo.FootProblem(fo.mujoco.Robot(explicit))
        assert not [*tmp_path.iterdir()]
        assert capfd.readouterr() == ("", "")

    def test_walks_at_one_time_leave_mujocos_warnings_as_they_were(self):
        before, first = mujoco.get_mju_user_warning(), ExitStack()
        first.enter_context(quiet())
        with quiet():
            first.close()
        assert mujoco.get_mju_user_warning() is before

    def test_a_controller_that_fails_is_named_before_a_search(self, biped):
        with pytest.raises(SettingError, match=r"robot.controller = 'no_such_motor'.*KeyError"):
            fo.FootProblem(replace(biped, controller=no_such_motor))

    @pytest.mark.slow
    def test_commands_are_a_controller(self, biped):
        """A table of what the tracker tells, and a function that reads it, walk as the tracker does."""
        t = np.arange(0.0, 1.6, 2e-3)
        model = biped.model.compiled
        told = biped.controller.commands(model, t)
        names = [model.actuator(i).name for i in range(model.nu)]
        table = fo.mujoco.Commands(t, dict(zip(names, told.T, strict=True)))
        start = {name: float(biped.controller.angles(name, np.zeros(1))[0][0]) for name in names}
        pose = " ".join(str(start.get(model.joint(i).name, 0.0)) for i in range(model.njnt))
        text = BIPED.read_text().replace(
            "</mujoco>", f'<keyframe><key name="go" qpos="{pose}"/></keyframe></mujoco>'
        )
        other = fo.mujoco.Robot(text, biped.feet, table, duration=1.4, after=biped.after, key="go")
        names = ("distance", "work", "joint_work")
        one, two = (fo.evaluate(SOLES[:1], r, COARSE, names, SPACE).values for r in (biped, other))
        np.testing.assert_allclose(two, one, rtol=1e-3)

    @pytest.mark.slow
    def test_shorter_steps_are_no_faster_control(self, biped):
        """Else no walk with a controller in Python would converge, and its ladder would not end."""
        times = []

        def note(model, data):
            times.append(data.time)

        for dt in (4e-3, 2e-3, 5e-4):
            times.clear()
            fo.evaluate(
                SOLES[:1],
                replace(biped, controller=note, duration=0.2, after=0.0),
                fo.Accuracy(dt=dt),
                space=SPACE,
            )
            begun = np.flatnonzero(np.diff([np.inf, *times]) < 0.0)[-1]  # after it was tried in the air
            np.testing.assert_allclose(np.diff(times[begun:]), max(dt, 2e-3), rtol=1e-6)

    def test_two_functions_of_one_name_are_two_controllers(self, biped):
        one, other = (replace(biped, controller=lambda model, data: None) for _ in range(2))
        assert one.controller.name == other.controller.name
        assert one != other
        assert one == replace(one)

    @pytest.mark.parametrize(
        ("setting", "options"),
        [
            ("robot.feet", {"feet": ["left_hoof"]}),
            ("robot.feet", {"feet": []}),
            ("robot.feet", {"feet": ["left_foot", "left_foot"]}),
            ("robot.model", {"model": "no_such_model.xml"}),
            ("robot.model", {"model": "<mujoco><wordbody/></mujoco>"}),
            (
                "robot.model",
                {"model": BIPED.read_text().replace('slide" axis="0 0 1"', 'hinge" axis="0 0 1"')},
            ),
            ("robot.joints", {"controller": fo.mujoco.Tracker(joints={"left_hop": "left_hip"})}),
            ("commands", {"controller": fo.mujoco.Commands([0.0, 1.0], {"no_motor": [0.0, 0.0]})}),
            ("robot.controller", {"controller": 3}),
            ("robot.duration", {"duration": -1.0}),
            ("robot.after", {"after": 3.0}),
            ("robot.key", {"key": "home"}),
            ("robot.tilt", {"tilt": 0.0}),
            ("robot.density", {"density": 0.0}),
        ],
    )
    def test_what_is_not_in_the_model_is_refused_by_name(self, setting, options):
        with pytest.raises(SettingError, match=setting):
            fo.mujoco.Robot(**options)


HOPPER = """
<mujoco>
  <option timestep="0.002" integrator="implicitfast"/>
  <worldbody>
    <geom type="plane" size="9 9 1"/>
    <body name="trunk" pos="0 0 1">
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>
      <geom type="box" size=".1 .1 .1" mass="10"/>
      <body name="foot" pos=".1 0 -.5" euler="{euler}">
        <joint name="ankle" axis="0 -1 0" pos="-.1 0 .05" stiffness="500" damping="20"/>
        <geom type="box" size=".1 .05 .01" mass="1"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


SHORT = {"duration": 0.1, "after": 0.05}


class TestOneFoot:
    @pytest.mark.slow
    def test_walks_and_is_drawn(self):
        """Its ankle is the joint, wherever the body's origin is, and the figures have one row."""
        from footopt.report import figures

        robot = fo.mujoco.Robot(HOPPER.format(euler="0 0 0"), "foot", hold, duration=0.4)
        walk = fo.simulate(fo.Foot.flat(), robot, COARSE)
        np.testing.assert_allclose(walk.legs(walk.t)[:, 0, -1, 0], walk.com[-1, 0], atol=0.02)
        assert walk.force[-20:, 0, 1].mean() == pytest.approx(robot.weight, rel=0.05)
        assert len(figures.forces({"hop": walk}).axes) == 2
        assert "force_single_z" in walk.to_frame()

    def test_neither_a_pair_with_the_floor_nor_names_nor_a_key_s_time_change_the_walk(self):
        plain = HOPPER.format(euler="0 0 0")
        other = plain.replace('<geom type="plane"', '<geom name="floor" type="plane"')
        other = other.replace(' name="trunk"', "").replace(
            '<geom type="box" size=".1 .05', '<geom name="sole" type="box" size=".1 .05'
        )
        more = '<contact><pair geom1="floor" geom2="sole"/></contact>'
        more += '<keyframe><key name="up" time="2"/></keyframe>'
        other = other.replace("</mujoco>", f"{more}</mujoco>")
        found = [
            fo.evaluate(
                [SOLES[0]], fo.mujoco.Robot(text, "foot", hold, key=key, **SHORT), COARSE, space=SPACE
            )
            for text, key in ((plain, None), (other, "up"))
        ]
        np.testing.assert_array_equal(found[0].values, found[1].values)
        assert np.isfinite(found[0].values).all()

    def test_a_controller_sees_sensors_of_the_pose_in_which_the_robot_starts(self):
        seen = []
        text = HOPPER.format(euler="0 0 0").replace(
            "</mujoco>", '<sensor><framequat objtype="body" objname="foot"/></sensor></mujoco>'
        )
        robot = fo.mujoco.Robot(
            text, "foot", lambda model, data: seen.append(data.sensordata[:4].copy()), **SHORT
        )
        fo.evaluate([SOLES[0]], robot, COARSE, space=SPACE)
        assert np.linalg.norm(seen, axis=1) == pytest.approx(1.0)

    def test_with_axes_that_are_no_foots_is_refused(self):
        robot = fo.mujoco.Robot(HOPPER.format(euler="0 90 0"), "foot", hold, duration=0.4)
        with pytest.raises(SettingError, match=r"robot.feet = 'foot'.*x forward and z up"):
            fo.evaluate([SOLES[0]], robot, COARSE, space=SPACE)
        for angle, told in ((20, True), (0, False)):
            tipped = fo.mujoco.Robot(
                HOPPER.format(euler=f"0 {angle} 0"), "foot", hold, duration=0.1, after=0.05
            )
            names = {d.name for d in diagnose(fo.simulate(fo.Foot.flat(), tipped, COARSE))}
            assert any("pitch" in name for name in names) == told
