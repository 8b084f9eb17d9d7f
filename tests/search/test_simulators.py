"""What walks with a foot: the planar walker, a robot in MuJoCo, and a function, through the same doors."""

import numpy as np
import pytest

import footopt as fo
from footopt.errors import SettingError
from footopt.mujoco.model import BIPED
from footopt.walk import FIVE
from footopt.walk.objectives import offered

SPACE = fo.Waypoints(n=5, K=4)
COARSE = fo.Accuracy(dt=4e-3, plates=16)
SOLES = [[1, 2, 3, 2, 1], [4, 3, 2, 3, 4], [4, 4, 4, 4, 4]]


def ramp(foot):
    """A function of a foot: the steeper, the farther, and a sole that does not fit."""
    slope = float(np.polyfit(*foot.contour.T, 1)[0])
    if slope > 0.1:
        return "steep"
    return dict(zip(FIVE, (2.0 + slope, 1.0, 100.0, 200.0, 0.3), strict=True))


def other(foot):
    return dict.fromkeys(FIVE, 1.0)


@pytest.fixture(scope="module", params=["walker", "function", pytest.param("robot", marks=pytest.mark.slow)])
def simulator(request):
    if request.param == "robot":
        pytest.importorskip("mujoco")
        return fo.mujoco.Robot(duration=1.4)
    if request.param == "function":
        return fo.FunctionSimulator(ramp, FIVE)
    return fo.Scene(t_f=1.4)


class TestEverySimulator:
    def test_a_walk_does_not_depend_on_its_batch_or_on_threads(self, simulator):
        table = fo.evaluate(SOLES, simulator, COARSE, space=SPACE, threads=2)
        alone = [fo.evaluate([k], simulator, COARSE, space=SPACE, threads=1).values[0] for k in SOLES[::-1]]
        np.testing.assert_array_equal(table.values, alone[::-1])
        assert table.feasible.all()

    def test_is_searched_and_a_search_goes_on_to_the_same_result(self, simulator, tmp_path):
        problem = fo.FootProblem(simulator, space=SPACE, accuracy=COARSE)
        whole = fo.search(problem, "ga", walks=24, pop_size=8, seed=1)
        part = fo.search(problem, "ga", walks=16, pop_size=8, seed=1, store=tmp_path / "designs.sqlite")
        rest = fo.search(problem, "ga", walks=24, pop_size=8, seed=1, store=tmp_path / "designs.sqlite")
        assert part.designs < rest.designs
        assert rest.reused == part.designs
        np.testing.assert_array_equal(rest.values, whole.values)

    def test_another_simulator_is_another_problem_to_a_store(self, simulator, tmp_path):
        path = tmp_path / "designs.sqlite"
        fo.search(fo.FootProblem(simulator, space=SPACE, accuracy=COARSE), "ga", walks=8, store=path)
        another = fo.FunctionSimulator(other, FIVE)
        problem = fo.FootProblem(another, space=SPACE, accuracy=COARSE)
        assert fo.search(problem, "ga", walks=8, store=path).reused == 0

    def test_an_objective_that_it_does_not_measure_is_refused(self, simulator):
        absent = "joint_work" if "joint_work" not in offered(simulator) else "net_power"
        with pytest.raises(SettingError, match=absent):
            fo.FootProblem(simulator, absent)


class TestFunctions:
    def test_a_reason_in_place_of_values_is_a_failed_walk(self):
        table = fo.evaluate([[4, 3, 2, 1, 1], SOLES[2]], fo.FunctionSimulator(ramp, FIVE), space=SPACE)
        assert table.reasons.tolist() == ["steep", ""]

    def test_a_simulator_of_one_s_own_need_not_be_hashable(self):
        class Own(fo.FunctionSimulator):
            __hash__ = None

        assert fo.evaluate(SOLES, Own(ramp, FIVE), space=SPACE).feasible.all()

    def test_no_values_are_no_walk(self):
        with pytest.raises(TypeError, match="returned None"):
            fo.evaluate(SOLES, fo.FunctionSimulator(lambda foot: None, FIVE), space=SPACE)

    def test_walks_have_no_traces(self):
        with pytest.raises(SettingError, match="simulator"):
            fo.simulate(fo.Foot.flat(), fo.FunctionSimulator(ramp, FIVE))


class TestRobots:
    @pytest.mark.slow
    def test_bodies_outside_the_tree_of_the_feet_change_nothing(self):
        """A floor in a body, a rock, a target that is shown, and a ball that rolls away."""
        more = (
            '<body><geom type="plane" size="9 9 1"/></body><geom type="box" size="1 1 1" pos="2 0 0"/>'
            '<body mocap="true"><geom size=".3"/></body><body><freejoint/><geom size=".1"/></body>'
        )
        text = BIPED.read_text().replace('<geom contype="0" conaffinity="0"/>', "")
        texts = text, text.replace("<worldbody>", f"<worldbody>{more}")
        robots = [fo.mujoco.Robot(text, duration=1.4) for text in texts]
        alone, among = (fo.evaluate(SOLES, robot, COARSE, FIVE, SPACE).values for robot in robots)
        np.testing.assert_allclose(among, alone, rtol=1e-6)
        assert robots[1].weight == pytest.approx(robots[0].weight)

    @pytest.mark.parametrize("servo", ['gear="2"', 'biasprm="0 0 -120"', 'biasprm="0 -4200 -120"'])
    def test_a_gait_is_tracked_by_position_servos_without_a_gear(self, servo):
        text = BIPED.read_text().replace('<general name="left_hip"', f'<general {servo} name="left_hip"')
        with pytest.raises(SettingError, match="left_hip"):
            fo.mujoco.Robot(text)

    def test_a_controller_that_sets_no_numbers_is_refused(self):
        robot = fo.mujoco.Robot(controller=lambda model, data: data.ctrl.fill(np.nan), duration=1.0)
        with pytest.raises(SettingError, match=r"robot\.controller"):
            fo.FootProblem(robot)

    def test_gravity_that_is_not_down_is_refused(self):
        text = BIPED.read_text().replace("<option ", '<option gravity="0 -9.81 0" ')
        with pytest.raises(SettingError, match="gravity along -z"):
            fo.FootProblem(fo.mujoco.Robot(text))
