"""Every setting on the command line: any value works, or is refused by one message that names the setting."""

import copy
import math
import time
from dataclasses import fields, is_dataclass
from functools import cache

import numpy as np
import pytest
from hydra import compose, initialize_config_dir
from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra.core.global_hydra import GlobalHydra
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

import footopt as fo
from footopt import studies
from footopt.cli.compose import CONF
from footopt.cli.messages import explain
from footopt.design import Solver, make_executor
from footopt.design.exhaustive import check_size
from footopt.errors import FootoptError, SettingError
from footopt.studies import build
from footopt.studies.settings import Config

PATIENCE = 20.0  # s of processor time: a walk may have to be compiled first


def keys(config=Config, before=""):
    """Every setting of the schema, dotted."""
    for field in fields(config):
        default = field.default_factory() if callable(field.default_factory) else field.default
        if is_dataclass(default) and not isinstance(default, type):
            yield from keys(type(default), f"{before}{field.name}.")
        else:
            yield f"{before}{field.name}"


EFFECTS = {
    "layers": ("depths", "factors"), "patches": ("begins", "ends", "factors", "blur"),
    "inertia": ("factor", "rho"), "slope": ("angle",),
}  # fmt: skip
KEYS = [key for key in keys() if key.rpartition(".")[2] not in (*EFFECTS, "leading_edge")] + [
    f"effects.{effect}.{name}" for effect, names in EFFECTS.items() for name in names
]
#: What composing needs besides, so that the setting is there and is looked at.
WITH = {
    **{f"effects.{effect}.": [f"effects={effect}"] for effect in EFFECTS},
    "foot.length": ["foot=ellipse"], "foot.apex": ["foot=reversed_triangle"], "foot.upright": ["foot=reversed_l"],
    "sand.": ["sand=custom"], "gait.path": ["gait=file"], "foot.path": ["foot=outline"],
    "study.tail": ["study=robust"], "study.draws": ["study=robust", "study.scenarios=drawn"],
    "study.spread": ["study=robust", "study.scenarios=drawn"],
}  # fmt: skip
ABSURD = (
    "0", "-1", "1", "3", "0.5", "1e-12", "1e-300", "1e9", "1e300", "-1e300", "1000000", "1000000000", "10" * 40, "nan",
    ".nan", "inf", ".inf", "-.inf", "null", "true", "false", "", "''", "x", "'a b'", "'<script>'", "'../../etc'", "'\\n'",
    "'é∞\u202e'", "'[/red]'", "[]", "[1]", "[1,2,3]", "[0.1,-0.1]", "[nan,nan]", "[1e300,1e300]", "[x]", "[[1]]", "[null]",
    "{}", "{a: 1}", "'${oc.env:HOME}'", "${study}", "1e5", "0x10", "1_0", "'1'", "[" + ",".join("1" * 400) + "]",
)  # fmt: skip


@cache
def base(words):
    """The settings that a key is tried in."""
    GlobalHydra.instance().clear()
    with initialize_config_dir(str(CONF), version_base="1.3"):
        return compose("config", ["accuracy=draft", *words])


def composed(words, *overrides):
    """What Hydra makes of more overrides: a whole composition takes twenty times as long."""
    chosen = copy.deepcopy(base(tuple(words)))
    parsed = OverridesParser.create().parse_overrides(list(overrides))
    ConfigLoaderImpl._apply_overrides_to_config(parsed, chosen)
    return OmegaConf.to_object(chosen)


def used(config):
    """What a cheap run does with settings: build everything, check the search, and walk once."""
    study = config.study
    build.check_lists(config)
    if study.name not in studies.STUDIES:
        studies.run(config, None, {})
    scene, accuracy = build.make_scene(config), build.make_accuracy(config.accuracy)
    foot = build.make_foot(config.foot)
    build.make_strides(config.gait)
    solver = Solver(config.solver.name, config.solver.pop_size, config.solver.n_gen, config.solver.seed)
    if config.foot.shape == "waypoints":
        space = build.make_space(config.foot)
        problem = fo.FootProblem(scene, config.objective.names, space, accuracy, config.engine.threads)
        if solver.name == "exhaustive":
            check_size(problem)
        else:
            solver.build(problem.n_obj)
    engine = config.engine
    if engine.name != "local" and study.name not in studies.DISTRIBUTED:
        studies.run(config, None, {})
    if engine.name != "dask":
        with make_executor(engine.name, engine.workers, engine.address, engine.timeout):
            pass
    CHECKS.get(study.name, lambda config: None)(config)
    walk = fo.simulate(foot, scene, accuracy)
    compared = math.isfinite(scene.gait.start) and scene.duration > scene.gait.heel_strike
    table = (
        fo.evaluate([foot], scene, accuracy, threads=engine.threads) if walk.feasible and compared else None
    )
    return walk, table


def check_robust(config):
    from footopt.studies.robust import make_scenarios

    make_scenarios(config)


CHECKS = {"robust": check_robust}


def outcome(words, setting, value):
    """What is wrong with what a user sees of a setting's value, or ""."""
    started = time.process_time()
    try:
        walk, table = used(composed(words, f"{setting}={value}"))
    except (FootoptError, HydraException, OmegaConfBaseException) as error:
        said = explain(error)
        names = (setting, setting.rpartition(".")[2], setting.partition(".")[0])
        if not any(name in said for name in names):
            return f"does not name the setting: {said}"
        if "unexpected" in said or "Traceback" in said or len(said) > 1500:
            return f"is no clear message: {said}"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    else:
        if walk.feasible and table is not None:
            values = walk.objectives
            if not np.isfinite([values[name] for name in table.names]).all():
                return f"a walk without a reason has {values}"
        elif not walk.feasible and not walk.reason:
            return "a walk failed for no reason"
    lasted = time.process_time() - started
    return f"took {lasted:.1f} s" if lasted > PATIENCE else ""


def context(key):
    return [word for start, words in WITH.items() if key.startswith(start) for word in words]


ANY_VALUE = st.one_of(
    st.sampled_from(ABSURD),
    st.integers().map(str),
    st.floats().map(repr),
    st.lists(st.floats(-3, 12) | st.integers(-3, 12), max_size=12).map(repr),
    st.text(max_size=30).map(lambda text: "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"),
    st.text(alphabet="[]{}()=:,.$\\'\"!*&#%@ae1", max_size=12),
)


@pytest.mark.slow
@settings(max_examples=600, suppress_health_check=list(HealthCheck))
@given(st.sampled_from(KEYS), ANY_VALUE)
def test_any_value_of_any_setting(key, value):
    assert not outcome(context(key), key, value)


#: Settings that are numbers, none of them so that a walk takes long.
NUMBERS = [key for key in KEYS if key.partition(".")[0] in ("foot", "gait", "sand", "walker")]


@settings(max_examples=60, suppress_health_check=list(HealthCheck))
@given(
    st.lists(
        st.tuples(st.sampled_from(NUMBERS), st.floats(1e-3, 3).map(repr) | st.integers(0, 12).map(str)),
        max_size=6,
    )
)
def test_several_at_once(chosen):
    """They may clash, and then one of them is named."""
    words = sorted({word for key, _ in chosen for word in context(key)})
    try:
        walk, _ = used(composed(words, *(f"{key}={value}" for key, value in chosen)))
    except (FootoptError, HydraException, OmegaConfBaseException) as error:
        said = explain(error)
    else:
        said = "" if walk.feasible else walk.reason
        assert walk.feasible or said
    assert "unexpected" not in said


HUGE = [
    ("effects", "study.feet=1000000000"), ("trust", "study.seeds=1000000000"), ("trust", "study.budget=100000000000"),
    ("sensitivity", "study.samples=1073741824"), ("robust", "study.draws=1000000000"),
    ("paper", "study.samples=1000000000"), ("paper", "study.seeds=1000000000"), ("robust", "study.finalists=1000000000"),
    ("optimize", "study.finalists=1000000000"), ("optimize", "solver.pop_size=1000000000"),
    ("optimize", "solver.n_gen=1000000000"), ("optimize", "accuracy.dt=1e-12"), ("simulate", "accuracy.dt=1e-8"),
    ("simulate", "accuracy.plates=1000000000"), ("simulate", "scene.t_f=1e6"), ("simulate", "gait.period=1e6"),
    ("simulate", "gait.harmonics=1000000"), ("simulate", "foot.n=1000000"), ("optimize", "foot.n=1000000"),
    ("optimize", "foot.K=1000000000000"), ("optimize", "engine.threads=1000000000"), ("shapes", "foot.length=1e9"),
    ("robust", "study.spread.zeta=1e9"), ("sensitivity", "study.foot_spread.creep=1e9"), ("simulate", "sand.zeta=1e300"),
    ("simulate", "walker.mass=1e300"), ("optimize", "scene.t_f=1e5"),
]  # fmt: skip


DRAWN = {"robust": ["study.scenarios=drawn"]}


@pytest.mark.parametrize(("study", "word"), HUGE, ids=lambda name: name)
def test_what_would_take_years_or_all_memory_is_refused_at_once(study, word, tmp_path):
    config = composed([f"study={study}", *DRAWN.get(study, [])], word)
    started = time.process_time()
    with pytest.raises(SettingError) as caught:
        studies.run(config, tmp_path, {})
    assert time.process_time() - started < PATIENCE
    allowed = ("accuracy.dt", "scene.t_f") if word.startswith(("scene.t_f", "gait.period")) else ()
    assert any(name in str(caught.value) for name in (word.partition("=")[0], *allowed))
    assert not list(tmp_path.glob("*.json"))


def test_reference_directions_for_very_many_are_refused():
    with pytest.raises(SettingError, match=r"solver\.pop_size = 5000: must be at most 1000"):
        Solver("nsga3", 5000).build(5)


@pytest.mark.slow
@pytest.mark.parametrize("group", sorted({key.partition(".")[0] for key in KEYS}))
def test_absurd_values_of_every_setting(group):
    wrong = []
    for key in KEYS:
        if key.partition(".")[0] == group:
            for value in ABSURD[KEYS.index(key) % 2 :: 2]:
                said = outcome(context(key), key, value)
                wrong += [f"{key}={value[:40]}: {said}"] if said else []
    assert not wrong, "\n".join(wrong)
