"""From settings to the library's own objects: sand, gait, foot, scene, accuracy."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import asdict, fields, is_dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

from footopt.effects import EFFECTS, Effect
from footopt.errors import SettingError, check
from footopt.files.gaits import Strides, read_strides
from footopt.foot import Foot, Waypoints
from footopt.gait import Gait
from footopt.sand import GENERIC, MEDIA, Sand, StressMap
from footopt.studies.settings import AccuracyConfig, Config, EffectsConfig, FootConfig, GaitConfig, SandConfig
from footopt.walk import PRESETS, Accuracy, Scene, Spread, Walker


def load_plugins(plugins: Sequence[str]) -> None:
    """Import files (of the user's own, .py) and modules, which register what they bring.

    A file's folder joins the module path, which worker processes are given too, and its name there is
    that of the file.

    Raises
    ------
    SettingError : a file or module is not there, fails, or has the name of another module.
    """
    for plugin in plugins:
        path = Path(plugin).absolute()
        name = path.stem if path.suffix == ".py" else plugin
        if path.suffix == ".py":
            check(path.is_file(), "plugins", plugin, "a file that is there, or an importable module")
            if str(path.parent) not in sys.path:
                sys.path.append(str(path.parent))
        try:
            module = import_module(name)
        except Exception as error:
            why = f"something that can be imported ({type(error).__name__}: {error})"
            raise SettingError("plugins", plugin, why) from error
        file = getattr(module, "__file__", None)
        if path.suffix == ".py" and (file is None or not path.samefile(file)):
            raise SettingError(
                "plugins", plugin, "a file whose name is not that of another module", f"Rename {path.name}."
            )


def check_lists(config: Any, name: str = "") -> None:
    """Raise unless lists hold plain values: OmegaConf lets lists in lists and interpolations through."""
    for field in fields(config):
        value, key = getattr(config, field.name), f"{name}{field.name}"
        if is_dataclass(value):
            check_lists(value, f"{key}.")
        if "list" in str(field.type) and value is not None:
            plain = isinstance(value, list) and all(isinstance(v, (int, float, str)) for v in value)
            check(plain, key, value, "a list of plain values")


def make_sand(config: SandConfig) -> Sand:
    """The sand of a configuration; one of `MEDIA` that was changed no longer has its name."""
    stress_map = StressMap(**asdict(config.coefficients))
    if config.table is None:
        own = MEDIA.get(config.name, config.zeta) != config.zeta or stress_map != GENERIC
        name = "custom" if own and config.name in MEDIA else config.name
        return Sand(zeta=config.zeta, stress_map=stress_map, name=name)
    if stress_map != GENERIC:
        raise SettingError("sand.table", config.table, "null when sand.coefficients are changed")
    fitted = Sand.from_table(config.table, zeta=config.zeta)
    return fitted if config.name in ("custom", *MEDIA) else replace(fitted, name=config.name)


def make_gait(config: GaitConfig) -> Gait:
    """The gait of a configuration."""
    if config.name not in ("human", "file"):
        raise SettingError("gait.name", config.name, "human or file")
    if config.name == "file":
        if config.path is None:
            raise SettingError("gait.path", None, "a file, with gait=file", "Try gait.path=walk.csv.")
        gait = Gait.from_file(config.path, config.harmonics, *_reading(config))
        period = gait.period if config.period is None else config.period
        return replace(gait, period=period, pitch=config.pitch, start=config.start)
    if config.path is not None:
        raise SettingError("gait.path", config.path, "null with gait=human", "Use gait=file with a path.")
    period = 1.2 if config.period is None else config.period
    return Gait.human(period, config.harmonics, config.pitch, config.start)


def make_strides(config: GaitConfig) -> Strides | None:
    """The strides that a gait was fitted to; None where there are none."""
    if config.name != "file" or config.path is None or Path(config.path).suffix.lower() == ".json":
        return None
    return read_strides(config.path, *_reading(config))


def make_spread(config: Config) -> Spread:
    """How far a configuration's scenarios lie apart. A period or angles that are null are measured: how the
    strides of the gait's file differ.
    """
    values = vars(config.study.spread)
    unknown = [name for name, value in values.items() if value is None]
    if not unknown:
        return Spread(**values)
    strides = make_strides(config.gait)
    if strides is None or len(strides.periods) < 3:
        raise SettingError(
            f"study.spread.{unknown[0]}",
            None,
            "a number, unless gait.path records three strides or more",
        )
    period, angles = strides.variation()
    return Spread(**values | {name: {"period": period, "angles": angles}[name] for name in unknown})


def _reading(config: GaitConfig) -> tuple[dict[str, str], str | None, float]:
    names = {key: name for key, name in vars(config.names).items() if name is not None}
    return names, config.side, config.max_gap


def make_space(config: FootConfig) -> Waypoints:
    """The design space of a configuration."""
    return Waypoints(
        n=config.n,
        K=config.K,
        L=config.L,
        H=config.H,
        width=config.width,
        ankle=_point(config.ankle),
        box_tolerance=config.box_tolerance,
        closed=config.closed,
        top=config.top,
    )


def check_searchable(config: FootConfig) -> None:
    """Raise unless a configuration's foot is a space to search, not one sole."""
    if config.shape != "waypoints":
        raise SettingError("foot.shape", config.shape, "waypoints for a search", "Or use study=simulate.")
    if config.k is not None:
        raise SettingError(
            "foot.k", config.k, "null for a search", "Use study=simulate to walk with one sole."
        )


def make_foot(config: FootConfig) -> Foot:
    """The one sole of a configuration: foot.k, a shape, a drawing, or else the flat sole."""
    if config.path is not None and config.shape != "outline":
        raise SettingError("foot.path", config.path, "null without foot=outline", "Add foot=outline.")
    if config.shape == "waypoints":
        space = make_space(config)
        return Foot.flat(space) if config.k is None else Foot.from_waypoints(config.k, space)
    if config.k is not None:
        raise SettingError("foot.k", config.k, f"null with foot.shape={config.shape}")
    ankle = _point(config.ankle)
    if config.shape == "outline":
        if config.path is None:
            raise SettingError("foot.path", None, "a drawing, with foot=outline", "Try foot.path=sole.dxf.")
        drawing = {name: getattr(config, name) for name in ("units", "scale", "layer", "toe", "origin")}
        return Foot.from_file(config.path, config.width, ankle, config.closed, config.top, **drawing)
    options = {
        "reversed_triangle": {"apex": config.apex},
        "reversed_l": {"upright": config.upright},
    }.get(config.shape, {})
    return Foot.shape(config.shape, config.length, config.width, ankle, config.closed, config.top, **options)


def make_effects(config: EffectsConfig) -> tuple[Effect, ...]:
    """The effects that a configuration names; what `auto` adds is up to the effect audit."""
    named = {name: getattr(config, name, None) for name in EFFECTS}
    chosen: dict[str, Any] = {name: vars(v) for name, v in named.items() if v is not None}
    own: dict[str, Any] = config.own or {}
    check(isinstance(own, dict), "effects.own", own, "effects by name: {my_effect: {size: 1.0}}")
    for name in own:
        if name not in EFFECTS or hasattr(config, name):
            known = [other for other in EFFECTS if not hasattr(config, other)]
            raise SettingError(
                "effects.own", name, f"an effect of a plugin ({', '.join(known) or 'none is loaded'})",
                "Give its file: plugins=[my_effect.py]; it has to add its class to effects.EFFECTS.",
            )  # fmt: skip
    try:
        return tuple(EFFECTS[name](**(v or {})) for name, v in (chosen | own).items())
    except TypeError as error:
        allowed = f"made of parameters that the effect has ({error})"
        raise SettingError("effects.own", own, allowed) from None


def make_scene(config: Config) -> Scene:
    """The scene of a configuration."""
    if config.effects.auto:
        raise SettingError(
            "effects.auto",
            True,
            f"false for study={config.study.name}",
            "Name the effects: effects=[leading_edge,inertia]; study=effects says which matter.",
        )
    w = config.walker
    return Scene(
        effects=make_effects(config.effects),
        sand=make_sand(config.sand),
        gait=make_gait(config.gait),
        walker=Walker(w.mass, w.l1, w.l2, w.g),
        t_f=config.scene.t_f,
    )


def make_accuracy(config: AccuracyConfig) -> Accuracy:
    """The accuracy of a configuration: a preset or a tolerance, and what is set by hand over it."""
    names = (*PRESETS, "custom")
    check(config.name in names, "accuracy.name", config.name, f"one of {', '.join(names)}")
    if config.tolerance is not None:
        accuracy = Accuracy.within(config.tolerance)
    else:
        accuracy = PRESETS.get(config.name, Accuracy())
    by_hand = {
        name: getattr(config, name)
        for name in ("stepper", "dt", "control", "plates", "creep", "rule")
        if getattr(config, name) is not None
    }
    return replace(accuracy, **by_hand, name="custom") if by_hand else accuracy


def _point(values: list[float]) -> tuple[float, float]:
    if len(values) != 2:
        raise SettingError("foot.ankle", values, "two numbers [x_p, z_p], in m")
    return values[0], values[1]
