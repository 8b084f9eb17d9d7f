"""Settings: each choice is what the library calls so, and any value is used, or refused by its name."""

import math
import pickle
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path

import pytest
from hydra import compose, initialize_config_dir
from hydra.core.config_store import ConfigStore
from hydra.core.override_parser.overrides_parser import OverridesParser
from hypothesis import given
from hypothesis import strategies as st
from running import composed

import footopt as fo
from footopt import studies
from footopt.cli.compose import CONF, groups, hydra_overrides, register
from footopt.design import Solver
from footopt.effects import EFFECTS
from footopt.errors import SettingError
from footopt.sand import MEDIA
from footopt.studies import build
from footopt.studies.robust import make_spread
from footopt.studies.settings import AccuracyConfig, SandConfig
from footopt.walk import PRESETS

CHOICES = {group: [f"{group}={name}" for name in names] for group, names in groups().items()}
CHOICES["scene"] = [""] * len(CHOICES["effects"]) + CHOICES["scene"]  # some bring effects
#: All choices, one of each group in a row, because composing takes a while.
ROWS = [[choice for choice in row if choice] for row in zip_longest(*CHOICES.values())]
ROWS = [pytest.param(row, marks=[pytest.mark.slow] * (len(row) == 1)) for row in ROWS]


@pytest.mark.usefixtures("clean")
def test_launchers_send_plain_data_to_processes_that_have_no_plugins_yet():
    register([f"plugins=[{Path(__file__).parents[2] / 'examples' / 'custom' / 'effect.py'}]"])
    with initialize_config_dir(str(CONF), version_base="1.3"):
        found = compose("config", ["effects=floor", "study=robust", "foot.L=1"])
    assert found.effects.floor == {"depth": 0.1, "length": 0.01}
    assert b"footopt.studies" not in pickle.dumps((found, ConfigStore.instance().repo))


def test_infinity_is_what_the_pages_and_the_messages_say():
    assert composed(*hydra_overrides(["foot.box_tolerance=.inf"])).foot.box_tolerance == math.inf
    assert hydra_overrides(["foot.box_tolerance=0.05,.inf"]) == ["foot.box_tolerance=0.05,inf"]
    assert hydra_overrides(["sand.name=my.inf"]) == ["sand.name=my.inf"]


@given(st.text("aZ0 .-_+()&äßŁ@!;=", min_size=1))
def test_a_folder_is_named_as_a_shell_passes_it_on(text):
    folder = f"out/{text}x"
    (override,) = OverridesParser.create().parse_overrides(hydra_overrides([f"run={folder}"]))
    assert (override.key_or_group, override.value()) == ("study.run", folder)
    (override,) = OverridesParser.create().parse_overrides(hydra_overrides([f"foot.path=~/{folder}"]))
    assert override.value() == f"{Path.home().as_posix()}/{folder}"


class TestDefaults:
    def test_are_those_of_the_library(self):
        config = composed()
        assert build.make_scene(config) == fo.Scene()
        assert build.make_space(config.foot) == fo.Waypoints()
        assert build.make_accuracy(config.accuracy) == PRESETS["standard"]
        assert make_spread(composed("study=robust")) == fo.Spread()
        assert Solver(**vars(config.solver)) == Solver()
        assert set(groups()["study"]) == {*studies.STUDIES}
        assert {*EFFECTS} < {*groups()["effects"]}
        assert {*PRESETS} < {*groups()["accuracy"]}
        assert {*MEDIA} < {*groups()["sand"]}

    def test_of_a_planet_are_those_of_the_walker_but_for_g(self):
        """Of the sand, too: grains resist by their weight."""
        earth, moon = (build.make_scene(composed(f"planet={name}")) for name in ("earth", "moon"))
        assert earth == fo.Scene()
        assert earth.zeta == earth.sand.zeta
        assert moon == fo.Scene(walker=fo.Walker(g=1.62))
        assert moon.zeta == pytest.approx(moon.sand.zeta * 1.62 / 9.81)

    @pytest.mark.parametrize("row", ROWS, ids=" ".join)
    def test_every_choice_composes_and_is_what_the_library_calls_so(self, row):
        config = composed(*row)
        for group, name in (choice.split("=") for choice in row):
            if group == "effects" and name in EFFECTS:
                assert build.make_effects(config.effects) == (EFFECTS[name](),)
            if group == "accuracy" and name in PRESETS:
                assert build.make_accuracy(config.accuracy) == PRESETS[name]
            if group == "sand" and name in MEDIA:
                assert build.make_sand(config.sand) == fo.Sand.named(name)
            if group in ("study", "sand", "gait", "scene", "accuracy", "solver") and name not in UNNAMED:
                assert getattr(config, group).name == name
        if not {"gait=file", "effects=auto"} & {*row}:
            build.make_scene(config)
        build.make_accuracy(config.accuracy)
        if "foot=outline" not in row:
            build.make_foot(config.foot)

    def test_a_solver_brings_its_objective_and_the_command_line_wins(self):
        assert [len(composed(f"solver={name}").objective.names) for name in ("ga", "nsga2")] == [1, 5]
        assert composed("solver=nsga2", "objective.names=[work]").objective.names == ["work"]
        assert composed("solver=nsga2", "objective=efficiency").objective.names == ["efficiency"]
        assert composed("scene=stand", "gait.start=1.0").gait.start == 1.0


#: Choices of groups that are not names of what they choose.
UNNAMED = ("coarse",)


class TestBuild:
    def test_numbers_by_hand_are_held_and_others_found(self):
        for numbers, expected in (
            ({"name": "custom", "tolerance": 0.01}, fo.Tolerance(0.01)),
            ({"name": "fine", "plates": 300}, fo.Tolerance(0.0005, plates=300)),
            ({"name": "custom", "plates": 300}, fo.Accuracy(plates=300)),
        ):
            assert build.make_accuracy(AccuracyConfig(**numbers)) == expected

    def test_a_table_of_stresses_or_coefficients_make_a_sand(self):
        path = Path(__file__).parents[2] / "examples" / "sand" / "stresses.csv"
        sand = SandConfig("custom", zeta=2.0, table=str(path))
        assert build.make_sand(sand) == fo.read_sand(path, zeta=2.0)
        changed = SandConfig("custom")
        changed.coefficients.A00, changed.coefficients.Cm11 = 0.2, 0.01
        assert build.make_sand(changed).stress_map == fo.StressMap(A00=0.2, Cm11=0.01)
        with pytest.raises(SettingError, match=r"sand\.table = 'x\.csv': must be null when"):
            build.make_sand(replace(changed, table="x.csv"))
