"""What is given in Python is used, or refused by its name."""

import inspect
import pickle
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

import footopt as fo
from footopt.errors import FootoptError, SettingError

#: What else a call needs.
BESIDE = {
    "Foot": {"contour": [(0.0, 0.0), (0.1, 0.0)]},
    "Scenario": {"name": "a", "scene": fo.Scene()},
    "PymooProblem": {"problem": fo.FootProblem()},
    "RobustProblem": {"scenarios": [fo.Scenario("a", fo.Scene())]},
    "estimate_error": {"foot": fo.Foot.flat()},
    "evaluate": {"feet": [[4] * 11]},
    "search": {"problem": fo.FootProblem(), "walks": 2},
    "simulate": {"foot": fo.Foot.flat()},
}
ASKED = [
    (name, parameter)
    for name in sorted({*dir(fo)} - {"Gait", "animate"})  # a gait is made of Fourier series, a film of a walk
    for whole in [getattr(fo, name)]
    if hasattr(whole, "__wrapped__") or hasattr(getattr(whole, "__init__", None), "__wrapped__")
    for parameter, declared in inspect.signature(whole).parameters.items()
    if declared.kind is not inspect.Parameter.VAR_KEYWORD and parameter != "store"  # the name of a file
]
ANYTHING = st.one_of(
    st.sampled_from(["x", "", b"x", -1, True, 3.5, float("nan"), 1j, {}, {"a": 1}, object(), print, int]),
    st.lists(st.sampled_from([1, "x", None, 2.5, ()]), max_size=2),
)


@given(ANYTHING)
@pytest.mark.parametrize(("name", "parameter"), ASKED)
def test_whatever_is_given_is_used_or_refused_by_its_name(name, parameter, value):
    with suppress(FootoptError):  # any other error is one that names nothing
        getattr(fo, name)(**{**BESIDE.get(name, {}), parameter: value})


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fo.Walker(mass="60"), "Walker.mass = '60': must be a number."),
        (lambda: fo.RobustProblem(fo.Scene()), "RobustProblem.scenarios = Scene(.*: must be a list."),
        (lambda: fo.PymooProblem(fo.Scene()), "PymooProblem.problem = Scene(.*: must be a FootProblem."),
        (lambda: fo.FootProblem(limits=0.3), "FootProblem.limits = 0.3: must be a mapping."),
        (lambda: fo.Layers(0.1, 2.0), "Layers.depths = 0.1: must be a list."),
    ],
)
def test_what_is_of_another_kind_is_named(call, message):
    with pytest.raises(SettingError, match=message.replace("(", r"\(")):
        call()


def test_what_python_itself_says_of_a_call_is_left_to_it():
    with pytest.raises(TypeError, match="unexpected keyword"):
        fo.Walker(weight=60)
    with pytest.raises(TypeError, match="missing"):
        fo.simulate()


def test_heights_of_one_sole_are_one_sole():
    assert (
        fo.evaluate([4] * 11, objectives=["work"]).values
        == fo.evaluate([[4] * 11], objectives=["work"]).values
    )


def test_what_asks_is_found_by_its_name():
    assert pickle.loads(pickle.dumps(fo.evaluate)) is fo.evaluate
