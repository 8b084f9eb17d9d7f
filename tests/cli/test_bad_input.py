"""The table of bad commands: each is refused by the name of its setting and its value, and leaves nothing."""

import re

import pytest
from numba import njit
from numba.core.errors import NumbaError
from running import footopt, program

import footopt as fo
from footopt.cli.messages import explain

#: Words of a command, and what the message names.
COMMANDS = {
    # names and choices that are not there
    "sand=quicksand": "sand = 'quicksand'",
    "sand=2.5": "sand.zeta=2.5",
    "solver=[ga,nsga2]": "footopt -m solver=ga,nsga2",
    "snad=soft": "sand=soft",
    "effects.slope.angle=5": "effects=slope effects.slope.angle=5",
    "foot.L=${foot.hight}": "foot.hight",
    # words that cannot be read
    "sand soft": "sand",
    "sand=soft,hard": "sand=soft,hard",
    "foot.k=[1, 2, 3]": "foot.k=[1,",
    "resume=": "resume = ''",
    # values of another kind
    "sand.zeta=loose": "sand.zeta = 'loose'",
    "sand.zeta=null": "sand.zeta = 'null'",
    "study=simulate sand.coefficients=3": "sand.coefficients.A00",
    # values that the library refuses
    "foot.block=[1,0.02]": "foot.block = [1.0, 0.02]",
    "study=compare": "study.runs = []",
    "solver=ga objective=pareto": "solver = 'ga'",
    "gait=file gait.path=broken.csv": "gait.path = 'broken.csv'",
    # what would take years or all memory
    "study=effects study.feet=1000000000": "study.feet",
    "study=simulate scene.t_f=1e6": "scene.t_f",
    "objective=torque": "objective",
    "study.draws=3": "study.draws",
}
#: Likewise, by a place of its own in the code.
LIKEWISE = {
    "gait=steps/human.csv": "gait = 'steps/human.csv'",
    "foot=outline foot.path=sole.dxf": "foot = 'outline'",
    "choose=limits objective=pareto": "choose.limits",
    "simulator=robot": "robot.model = None",
    "simulator=biped walker.mass=20": "walker.mass",
    "simulator=biped effects=auto": "effects = 'auto'",
    "objective=distance,work": "'objective=[distance,work]'. For a run of each: footopt -m",
    "simulator=biped robot.controller=broken.csv:f": "robot.controller = 'broken.csv:f'",
    "study=transfer study.sands=[mud]": "study.sands",
    "simulator=biped robot.joints={knee:left_hip}": "robot.joints = 'knee'",
    "accuracy=fine accuracy.tolerance=.01": "accuracy.name = 'fine'",
    "-cn nowhere": "nowhere",
}


@pytest.mark.parametrize(
    "arguments", [*COMMANDS, *(pytest.param(words, marks=pytest.mark.slow) for words in LIKEWISE)]
)
def test_a_command_that_is_refused_names_setting_and_value_and_leaves_nothing(arguments, tmp_path):
    (tmp_path / "broken.csv").write_text("time,hip\n0,1\n")
    done = footopt(*arguments.split(" "), cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr.startswith("footopt: error: ")
    assert done.stderr.count("\n") == 1
    assert (COMMANDS | LIKEWISE)[arguments] in done.stderr
    assert "unexpected" not in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["broken.csv"]


@pytest.mark.slow
def test_a_process_ends_with_the_message_and_its_exit_code(tmp_path):
    done = program("sand.zeta=0", cwd=tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (1, 1)
    assert done.stderr.startswith("footopt: error: sand.zeta = 0")
    done = program("--version", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, f"footopt {fo.__version__}\n")


@pytest.mark.parametrize(
    "place", ["results", pytest.param("..", marks=pytest.mark.slow), ".", "results/deep"]
)
def test_a_refused_run_removes_no_folder_that_was_there(place, tmp_path):
    """Not even one with nothing in it but folders and links."""
    here = tmp_path / "above" / "here"
    for folder in ("results/empty", "results/deep", "linked"):
        (here / folder).mkdir(parents=True)
    (here / "results" / "link").symlink_to(here / "linked")
    before = sorted(tmp_path.rglob("*"))
    done = footopt("study=simulate", "foot.width=-1", f"hydra.run.dir={place}", cwd=here)
    assert "foot.width" in done.stderr
    assert sorted(tmp_path.rglob("*")) == before


def test_a_law_that_cannot_be_compiled_is_named_by_its_line():
    @njit
    def load(x):
        return x.root

    with pytest.raises(NumbaError) as caught:
        load(1.0)
    assert re.match(r".*test_bad_input\.py, line \d+: cannot be compiled", explain(caught.value))
