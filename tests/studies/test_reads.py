"""A setting has an effect, or is refused: found by changing each one and looking at what is walked."""

from copy import deepcopy

import pytest
from running import composed

from footopt.errors import SettingError
from footopt.foot import SHAPES
from footopt.studies import STUDIES, build
from footopt.studies.build import check_read
from footopt.studies.settings import known

#: Other values of settings that are no numbers.
OTHER = {
    "foot.k": [2, 3, 4, 5, 6, 7, 8, 9, 5, 4, 3], "foot.ankle": [0.01, 0.02], "foot.closed": True,
    "foot.top": 0.01, "foot.apex": "toe", "foot.upright": "heel", "gait.pitch": "measured", "scene.t_f": 2.0,
    "gait.start": 1.0, "accuracy.stepper": "rk4", "accuracy.rule": "chord", "accuracy.control": 1e-3,
    "accuracy.dt": 1e-3, "accuracy.plates": 50, "accuracy.creep": 1e-3, "accuracy.tolerance": 0.01,
    "accuracy.name": "draft", "gait.side": "left", "foot.units": "cm", "foot.layer": "SOLE",
    "foot.toe": "left", "foot.origin": "centre", "sand.name": "mine", "simulator.name": "biped",
}  # fmt: skip
#: Read where this test does not look: how a run is made, what it leaves, what it returns, files.
ELSEWHERE = ("study.", "plugins", "report", "engine.", "objective.", "foot.block", "foot.shape", "foot.path",
             "sand.spread", "foot.box_tolerance", "sand.table", "gait.path", "gait.name", "scene.name",
             "effects.", "constraint.")  # fmt: skip


def walked(config):
    """All that a walk with one foot is made of."""
    foot, accuracy = build.make_foot(config.foot), build.make_accuracy(config.accuracy)
    return str([vars(foot), build.make_simulator(config), accuracy])


@pytest.fixture(scope="module")
def simulate():
    return composed("study=simulate")


@pytest.mark.parametrize("shape", ["waypoints", *SHAPES])
def test_of_a_walk_every_setting_counts_or_is_refused(shape, simulate):
    plain = deepcopy(simulate)
    plain.foot.shape = shape
    base = walked(plain)
    names = [name for name in known() if not name.startswith(ELSEWHERE)]
    assert len(names) > 50
    for name in names:
        config = deepcopy(plain)
        *above, last = name.split(".")
        group = config
        for key in above:
            group = getattr(group, key)
        value = getattr(group, last)
        other = OTHER.get(name)
        if other is None and isinstance(value, (int, float)):
            other = type(value)(1.2 * value + 1e-3 + isinstance(value, int))
        setattr(group, last, other)
        try:
            counts = walked(config) != base
        except SettingError as error:
            assert error.setting.startswith(name), name  # noqa: PT017
            continue
        try:
            check_read(config, [f"{name}=1"])
            assert counts, (name, value, other)
        except SettingError as error:
            assert (error.setting, counts) == (name, False), (name, value, other)  # noqa: PT017


def test_every_study_says_what_it_reads_of_settings_that_there_are():
    for study, (settings, _) in STUDIES.items():
        for read in settings.reads:
            assert any(f"{name}.".startswith(f"{read}.") for name in known()), (study, read)
