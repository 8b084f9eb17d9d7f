"""The library's objects from the settings, which are checked before: what has no effect is refused."""

import os
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import asdict, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

from omegaconf import DictConfig, OmegaConf

from footopt.design import Choice, FootProblem
from footopt.effects import EFFECTS, Effect
from footopt.errors import SettingError, check, check_number
from footopt.files.gaits import read_gait, read_strides
from footopt.files.io import load_module
from footopt.files.soles import read_foot
from footopt.files.strides import Strides
from footopt.files.tables import read_controller, read_sand
from footopt.foot import SHAPES, Foot, Waypoints
from footopt.gait import Gait
from footopt.mujoco.controllers import Tracker
from footopt.mujoco.robot import Robot
from footopt.sand import GENERIC, MEDIA, Sand, StressMap
from footopt.studies import ALWAYS, ONLY, SETTING_OF_GROUP, SearchSettings, covers, not_read, read_by, within
from footopt.studies.settings import (
    PATHS,
    STUDIES,
    WRITTEN,
    Config,
    EffectsConfig,
    FootConfig,
    GaitConfig,
    SandConfig,
    leaves,
)
from footopt.walk import Accuracy, Scene, Simulator, Walker
from footopt.walk.accuracy import PRESETS, AnyAccuracy, Tolerance

GROUPS = tuple(field.name for field in fields(Config))


def absolute(settings: DictConfig) -> dict[str, Any]:
    """The settings as plain data with absolute paths, so that they can be read from any folder later."""

    def locate(name: str, value: Any) -> Any:
        if isinstance(value, Mapping):
            return {key: locate(f"{name}.{key}".lstrip("."), one) for key, one in value.items()}
        if isinstance(value, list | tuple):
            return [locate(name, one) for one in value]
        module = str(value).startswith("pkg://") or (name == "plugins" and not value.endswith(".py"))
        is_file = value and name in PATHS and not module
        return os.path.abspath(os.path.expanduser(value)) if is_file else value

    return dict(locate("", OmegaConf.to_container(settings, resolve=True)))


def load_plugins(plugins: Sequence[str]) -> None:
    """Import the user's files and modules, which register effects, solvers and so on: see `load_module`."""
    good = isinstance(plugins, Sequence) and not isinstance(plugins, str)
    good = good and all(isinstance(plugin, str) for plugin in plugins)
    check(good, "plugins", plugins, "a list of files and modules")
    for plugin in plugins:
        load_module(plugin, "plugins")


def check_trusted(
    folder: Path, settings: Mapping[str, Any], names: Iterable[str], own: Collection[str] = ()
) -> None:
    """Raise if a run's settings name code, or write outside its folder; `own` names settings not used."""
    there = OmegaConf.create(dict(settings))
    for name in names:
        value = OmegaConf.select(there, name)
        inside = name in WRITTEN and (folder / str(value)).resolve().parent == folder.resolve()
        hint = "If you know it, add --trust, or load the run with trust=True; or give your own."
        good = not value or inside or within(name, own)
        check(good, name, value, f"trusted: it comes from {folder}", hint)


def make_sand(config: SandConfig) -> Sand:
    """The sand of the settings; one of `MEDIA` that was changed no longer has its name."""
    check_number("sand.spread", config.spread, 0, 1, "a standard deviation >= 0 and <= 1")
    stress_map = StressMap(**asdict(config.coefficients))
    if config.table is None:
        own = MEDIA.get(config.name, config.zeta) != config.zeta or stress_map != GENERIC
        name = Sand.name if own and config.name in MEDIA else config.name
        return Sand(zeta=config.zeta, stress_map=stress_map, name=name)
    check(stress_map == GENERIC, "sand.table", config.table, "null when sand.coefficients are changed")
    multiplied = MEDIA.get(config.name) == config.zeta != 1.0  # by the zeta that sand=NAME brings
    check(not multiplied, "sand.table", config.table, f"null with sand={config.name}", "Try sand=custom.")
    fitted = read_sand(config.table, zeta=config.zeta)
    return fitted if config.name in (Sand.name, *MEDIA) else replace(fitted, name=config.name)


def make_gait(config: GaitConfig) -> Gait:
    """The gait of the settings."""
    if config.name == "human":
        gait = Gait.human(harmonics=config.harmonics)
    elif config.path is None:
        raise SettingError("gait.path", None, f"a file, with gait={config.name}", "Try gait.path=walk.csv.")
    else:
        gait = read_gait(config.path, config.harmonics, *_reading(config))
    period = gait.period if config.period is None else config.period
    name = gait.name if config.name in ("human", "file") else config.name
    return replace(gait, name=name, period=period, pitch=config.pitch, start=config.start)


def make_strides(config: GaitConfig) -> Strides | None:
    """The strides that a gait was fitted to; None where there are none."""
    return None if config.path is None else read_strides(config.path, *_reading(config))


def _reading(config: GaitConfig) -> tuple[dict[str, str], str | None, Any]:
    names = {key: name for key, name in vars(config.names).items() if name is not None}
    return names, config.side, None if config.window is None else tuple(config.window)


def make_space(config: FootConfig) -> Waypoints:
    """The design space of the settings."""
    return Waypoints(**{field.name: getattr(config, field.name) for field in fields(Waypoints)})


def check_searchable(config: FootConfig) -> None:
    """Raise unless the foot of the settings is a space to search, not one sole."""
    hint = "Use study=simulate to walk with one sole."
    check(config.shape == "waypoints", "foot", config.shape, "waypoints for a search", hint)
    check(config.k is None, "foot.k", config.k, "null for a search", hint)


def make_foot(config: FootConfig) -> Foot:
    """The one sole of the settings: foot.k, a shape, a drawing, or else the flat sole."""
    if config.shape == "waypoints":
        space = make_space(config)
        return Foot.flat(space) if config.k is None else Foot.from_waypoints(config.k, space)
    worn: dict[str, Any] = {name: getattr(config, name) for name in ("width", "ankle", "closed", "top")}
    if config.shape == "outline":
        if config.path is None:
            raise SettingError("foot.path", None, "a drawing, with foot=outline", "Try foot.path=sole.dxf.")
        drawing = {name: getattr(config, name) for name in ("units", "scale", "layer", "toe", "origin")}
        return read_foot(config.path, **worn, **drawing)
    allowed = f"waypoints, outline, or one of {', '.join(SHAPES)}"
    check(config.shape in SHAPES, "foot.shape", config.shape, allowed)
    if option := {"reversed_triangle": "apex", "reversed_l": "upright"}.get(config.shape):
        worn[option] = getattr(config, option)
    return Foot.shape(config.shape, config.length, **worn)


def make_effects(config: EffectsConfig) -> tuple[Effect, ...]:
    """The effects that the settings name, without those that an audit adds with `auto`."""
    found = {name: getattr(config, name) for name in EFFECTS}
    given = {name: vars(one).items() for name, one in found.items() if one is not None}
    plain = {n: {k: tuple(v) if isinstance(v, list) else v for k, v in one} for n, one in given.items()}
    return tuple(EFFECTS[name](**values) for name, values in plain.items())


def make_scene(config: Config) -> Scene:
    """The scene of the settings."""
    hint = "Name the effects: effects=[leading_edge,inertia]; study=effects says which matter."
    check(not config.effects.auto, "effects.auto", True, f"false for study={config.study.name}", hint)
    return Scene(
        effects=make_effects(config.effects),
        sand=make_sand(config.sand),
        gait=make_gait(config.gait),
        walker=Walker(**vars(config.walker)),
        t_f=config.scene.t_f,
    )


def make_simulator(config: Config) -> Simulator:
    """The simulator of the settings: the paper's walker in a scene, or a robot."""
    name, names = config.simulator.name, ("walker", "biped", "robot")
    check(name in names, "simulator.name", name, f"one of {', '.join(names)}")
    if name == "walker":
        return make_scene(config)
    given = {key: value for key, value in vars(config.robot).items() if value is not None}
    own, joints, table = name == "robot", given.pop("joints", None), given.pop("controller", None)
    check(own == ("model" in given), "robot.model", config.robot.model, "a file, with simulator=robot")
    hint = "From Python it may have any number."
    check(len(config.robot.feet) in (1, 2), "robot.feet", config.robot.feet, "one body or two", hint)
    tracked = (joints,) if joints else ()
    controller = read_controller(table) if table else Tracker(make_gait(config.gait), *tracked)
    sand, effects = make_sand(config.sand), make_effects(config.effects)
    robot = Robot(controller=controller, sand=sand, effects=effects, **given)
    robot.check_comparable()
    return robot


def make_limits(config: Config) -> dict[str, float]:
    """The limits of the settings, by the measures' names."""
    return {name: limit for name, limit in vars(config.constraint).items() if limit is not None}


def make_start(heights: list[int] | None, space: Waypoints) -> list[list[int]] | None:
    """The soles that a search begins with, or None; a `SettingError` names study.start."""
    if heights is None:
        return None
    try:
        rows = [heights[i : i + space.n] for i in range(0, len(heights), space.n)]
        return [space.check(row)[0].tolist() for row in rows]
    except SettingError as error:
        raise SettingError("study.start", heights, error.allowed, error.hint) from None


def make_choice(config: Config) -> Choice:
    """Which design of a front the settings choose."""
    choose = config.choose
    return Choice(choose.name, choose.weights or {}, choose.limits or {})


def make_problem(config: Config, scene: Simulator) -> FootProblem:
    """The problem of study=optimize."""
    names, space, threads = config.objective.names, make_space(config.foot), config.engine.threads
    accuracy, limits, choice = make_accuracy(config.accuracy), make_limits(config), make_choice(config)
    return FootProblem(scene, names, space, accuracy, threads, limits, choice)


def make_accuracy(config: Any) -> AnyAccuracy:
    """The accuracy of the settings: a preset or a tolerance, and the parameters that are set by hand."""
    names = (*PRESETS, "custom")
    check(config.name in names, "accuracy.name", config.name, f"one of {', '.join(names)}")
    parts = {name: value for name, value in vars(config).items() if name not in ("name", "tolerance")}
    by_hand = {name: value for name, value in parts.items() if value is not None}
    if config.tolerance is None and config.name not in PRESETS:
        return Accuracy(**by_hand)
    preset = PRESETS.get(config.name, Tolerance())
    changed = by_hand if config.tolerance is None else {"error": config.tolerance, "refinements": 0} | by_hand
    return replace(preset, **changed, name="custom") if changed else preset


def check_read(config: Config, overrides: Iterable[str]) -> None:
    """Raise if an override, of a setting or a group, has no effect; the message says where it has one."""
    study, shape = config.study.name, config.foot.shape
    for override in overrides:
        name, _, text = override.lstrip("+~/").partition("=")
        given = name.partition("@")[0]
        group, dot, _ = given.partition(".")
        if group not in (*GROUPS, *SETTING_OF_GROUP):
            continue  # of the user's own
        one = dot or group in ("effects", "plugins") or not text.startswith("[")  # Hydra merges several
        check(one, given, text, "one name", f"For a run of each: footopt -m {given}={text.strip('[]')}")
        if group == "foot" and shape != "waypoints" and isinstance(config.study, SearchSettings):
            continue  # `check_searchable` refuses that foot
        name = given if dot else SETTING_OF_GROUP.get(given, f"{given}.name")
        if given == "foot" and shape == "waypoints":
            name = "foot.n"  # a space, which its choice describes
        value: Any = config
        for key in name.split("."):
            value = getattr(value, key, None)
        value = text if is_dataclass(value) else value
        if not covers(name, (*ALWAYS, *read_by(study))):
            raise not_read(name, value, study)
        for names, where, holds in ONLY:
            if within(name, names) and not holds(config):
                raise SettingError(name, value, "left out: it has no effect here", f"It is read by {where}.")


def check_plain(config: Config) -> None:
    """Raise if the items of a list or of a dictionary are lists or dictionaries, which OmegaConf accepts."""
    for name, value, *_ in leaves(config):
        items = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
        nested = any(isinstance(one, (list, dict)) for one in items)
        check(not nested, name, value, "made of plain values")


def checked(config: Config, overrides: Iterable[str]) -> Config:
    """The settings; `SettingError` if they do not go together."""
    check_plain(config)
    name = config.study.name
    check(name in STUDIES, "study.name", name, f"one of {', '.join(STUDIES)}")
    check(isinstance(config.study, STUDIES[name][0]), "study.name", name, f"chosen as a group: study={name}")
    check_read(config, overrides)
    reads, simulator = read_by(name), config.simulator.name
    if simulator != "walker" and covers("walker", reads) and not covers("simulator", reads):
        raise SettingError("simulator", simulator, f"walker for study={name}")
    named, hint = not config.effects.auto or simulator == "walker", "Try effects=[leading_edge,shadowing]."
    check(named, "effects", "auto", f"a list of effects with simulator={simulator}", hint)
    if name != "optimize" and (limits := make_limits(config)):
        raise SettingError("constraint", limits, f"left out for study={name}", "study=optimize keeps limits.")
    return config
