"""The reference of settings: ``python -m footopt.studies.reference > docs/reference.md`` writes the page.

Meanings are those of the library's docstrings where it has the setting, and `MEANINGS` where it has not. What
is allowed is what a refusal says: each setting is given a value that cannot be.
"""

from __future__ import annotations

import copy
import inspect
import math
import re
from collections.abc import Container, Iterator
from dataclasses import dataclass, fields, is_dataclass
from functools import cache
from typing import Any

from footopt.design import Choice, Solver, Stop
from footopt.design.result import check_finalists
from footopt.effects import EFFECTS
from footopt.errors import SettingError
from footopt.foot import Waypoints
from footopt.studies import build
from footopt.studies.reads import ALWAYS, READS, _in
from footopt.studies.settings import AllEffects, Config
from footopt.walk import MEASURES, Accuracy, Spread, Walker
from footopt.walk.scenarios import check_measure

#: Whose docstrings tell of the settings of a group.
TOLD_BY: dict[str, type] = {
    "walker": Walker, "foot": Waypoints, "solver": Solver, "stop": Stop, "choose": Choice,
    "accuracy": Accuracy, "study.spread": Spread,
    **{f"effects.{name}": kind for name, kind in EFFECTS.items()},
}  # fmt: skip

MEANINGS = {
    "plugins": "Files (.py) or modules of your own, which register effects, objectives, solvers or studies.",
    "report": "How much a run leaves: full; light, without figures; none, result.json and contour.csv only.",
    "study.name": "The question.",
    "study.confirm": "Accuracy at which finalists are walked again; null: the search's, under no other law.",
    "study.finalists": "How many of the best designs are walked again, and by other laws; a front whole.",
    "study.store": "File of evaluated designs that runs may share; null: designs.sqlite in the run's folder.",
    "study.reuse": "Whether to read what other code has walked from the store, which is said.",
    "study.feet": "How many random soles are walked.",
    "study.quick": "Whether a first look is enough.",
    "study.cases": "Names of the cases; null: all.",
    "study.methods": "Names of the steppers that are tried; null: all.",
    "study.seeds": "How many searches, each with its own seed.",
    "study.samples": "Random combinations of what the paper leaves open; samples of Sobol's indices.",
    "study.shape_sand": "Sand on which the paper's five shapes walk.",
    "study.mount": "Where the shank meets a shape: its centre, or its top.",
    "study.peak_power": "p_max from any instant of stance, or single: only while one foot stands alone.",
    "study.speed_loss": "dV_x over the whole walk, or in a window about each heel strike, or a narrow one.",
    "study.leading_edge": "Whether faces that trail feel no sand.",
    "study.shadowing": "Whether a groove of a sole counts with a part of its depth.",
    "study.solvers": "Names of the solvers that are compared; null: all.",
    "study.budget": "Evaluations of each search.",
    "study.scenarios": "What one foot is for: sands, laws, or drawn about the scene.",
    "study.draws": "How many scenarios are drawn.",
    "study.measure": "Of the loss over the scenarios: worst, mean, or tail, the mean of the worst share.",
    "study.tail": "The share of study.measure=tail.",
    "study.foot_spread.waypoint": "One standard deviation of a waypoint's height, m.",
    "study.foot_spread.width": "One standard deviation of the logarithm of the width.",
    "study.foot_spread.creep": "One standard deviation of the logarithm of the creep speed.",
    "study.run": "Folder of the run whose foot is meant.",
    "study.runs": "Folders of the runs that are compared; * and ** as in a shell.",
    "study.video": "Name of a film of the walk, .gif or .mp4; null: none.",
    "study.tests": "File of tests with plates, from which zeta is found.",
    "sand.name": "For tables and legends.",
    "sand.zeta": "Scale of the stress map on the Earth; 1 is the generic material.",
    "sand.coefficients": "Of the stress map, N/cm^3; Bm11 and Cm11 are the (-1, 1) terms.",
    "sand.table": "File of measured stresses, to which nine coefficients are fitted.",
    "gait.name": "human, or file.",
    "gait.path": "File of strides: TRC, C3D, MOT, STO, CSV or JSON.",
    "gait.period": "Of a stride, s; null: the file's own.",
    "gait.harmonics": "Of the Fourier series of each joint.",
    "gait.pitch": "How the foot turns: with the shank, or as measured.",
    "gait.start": "When the walker begins to walk, s; .inf: never.",
    "gait.side": "right or left; null: right, or left if it is the only one.",
    "gait.max_gap": "Longest gap of a marker that is filled, s.",
    "gait.units": "The file's unit of length (mm, cm, m, in) or of angle (deg, rad); null: what it says.",
    "gait.names": "The file's own name of this marker or column; null: a usual one.",
    "foot.shape": "waypoints, one of the five shapes, or outline.",
    "foot.closed": "Whether the whole contour feels the sand, not only the sole.",
    "foot.top": "Height of the contour's top in the foot frame, m.",
    "foot.k": "Heights of one sole, to walk with it.",
    "foot.length": "Contact length of a shape, m.",
    "foot.apex": "Where the triangle's apex is: middle or toe.",
    "foot.upright": "Where the L's upright is: toe or heel.",
    "foot.path": "File of a sole: DXF, SVG or CSV.",
    "foot.units": "Of the file: mm, cm, m, in, pt or px; null: as the file says.",
    "foot.scale": "Multiplies all lengths of the file.",
    "foot.layer": "Of the file; null: SOLE if there is one, else all.",
    "foot.toe": "Where the toe is in the file: right, or left.",
    "foot.origin": "Of the foot frame: file, or centre of the line's box.",
    "foot.block": "Length and height of a mounting block on the body for the workshop, m; null: none.",
    "effects.own": "Effects of a plugin, by name, with their parameters.",
    "effects.auto": "Whether to simulate the effects that matter.",
    "effects.tolerance": "Relative change that matters to effects=auto; null: the accuracy's own.",
    "scene.name": "For tables.",
    "scene.t_f": "End of the walk, s; null: two strides after the start.",
    "accuracy.tolerance": "Takes the cheapest measured setting within this relative error; null: the preset.",
    "objective.names": "What is optimised: one, or several for a front.",
    "choose.name": "Which design of a front is the answer.",
    "constraint": "Limit: the largest of what is minimised, the smallest of what is maximised; null: none.",
    "constraint.own": "Limits of a plugin's measures, by name.",
    "engine.name": "Where designs are walked: local, processes, dask.",
    "engine.threads": "Of this process; null: as many as it may run on.",
    "engine.workers": "Processes; null: as many as processors.",
    "engine.address": "Of a dask scheduler; null: one is started here.",
    "engine.timeout": "For a scheduler to answer and to have a worker, s.",
}  # fmt: skip


@dataclass(frozen=True)
class Setting:
    """A setting as the reference has it; `studies` are those that read it."""

    name: str
    default: Any
    kind: str
    meaning: str
    allowed: str
    studies: tuple[str, ...]


def settings(groups: Container[str] | None = None) -> list[Setting]:
    """All settings, or those of some groups, in the order of the groups."""
    names = _leaves(_whole())
    return [_setting(name) for name in names if groups is None or name.partition(".")[0] in groups]


def _whole() -> Config:
    """The default settings, with those of all effects."""
    effects = {f.name: EFFECTS[f.name]() for f in fields(AllEffects) if f.name in EFFECTS}
    return Config(effects=AllEffects(**effects))


def _leaves(value: Any, name: str = "") -> Iterator[str]:
    for field in fields(value):
        path = f"{name}.{field.name}" if name else field.name
        inner = getattr(value, field.name)
        if is_dataclass(inner):
            yield from _leaves(inner, path)
        else:
            yield path


@cache
def _setting(name: str) -> Setting:
    value: Any = _whole()
    for key in name.split("."):
        value = getattr(value, key)
    kind, meaning = _told(name)
    readers = tuple(study for study, names in READS.items() if _in(name, names))
    return Setting(name, value, kind, meaning, _allowed(name, value), () if _in(name, ALWAYS) else readers)


def _told(name: str) -> tuple[str, str]:
    """Kind, with its unit, and meaning of a setting."""
    group, _, last = name.rpartition(".")
    known = MEANINGS.get(name) or MEANINGS.get(group)
    if group == "constraint" and last in MEASURES:
        return f"float, {MEASURES[last].unit}".removesuffix(", "), MEANINGS["constraint"]
    if known is not None:
        return "", known
    return described(TOLD_BY[group]).get(last, ("", "")) if group in TOLD_BY else ("", "")


def described(kind: type) -> dict[str, tuple[str, str]]:
    """Type with unit, and description, of each parameter in a class's numpydoc."""
    text = inspect.cleandoc(kind.__doc__ or "")
    part = text.partition("Parameters\n----------\n")[2]
    part = re.split(r"\n\n\w+\n-+\n", part)[0]
    found: dict[str, tuple[str, str]] = {}
    for names, told, words in re.findall(r"^(\w[\w, ]*) : (.*)\n((?:[ ]+.*\n?|\n)+)", part + "\n", re.M):
        found |= {n.strip(): (told, " ".join(words.split())) for n in names.split(",")}
    return found


def _allowed(name: str, default: Any) -> str:
    """What is allowed, as the refusal of a value that cannot be says it; "" where nothing refuses it."""
    for wrong in (math.nan, -1e30, -1, "?", ["?"]):
        if isinstance(default, (int, float)) and not isinstance(wrong, (int, float)):
            continue
        config = copy.deepcopy(_whole())
        *groups, last = name.split(".")
        owner: Any = config
        for key in groups:
            owner = getattr(owner, key)
        try:
            object.__setattr__(owner, last, wrong)
            if len(groups) == 2 and groups[0] == "effects":  # frozen: made again, so that it looks at itself
                type(owner)(**vars(owner))
            _use(config)
        except SettingError as error:
            if error.setting == name or error.setting == name.removesuffix(".name"):
                return error.allowed
        except Exception:  # of another kind than any value that settings can have
            continue
    return ""


def _use(config: Any) -> None:
    """Make everything of the settings that can refuse one of them."""
    config.effects = type(config.effects)()
    build.make_scene(config), build.make_space(config.foot), build.make_accuracy(config.accuracy)
    build.make_spread(config), build.make_choice(config), build.make_foot(config.foot)
    Solver(**vars(config.solver)), Stop(**vars(config.stop))
    for name, limit in build.make_limits(config).items():
        MEASURES[name].check_limit(f"constraint.{name}", limit)
    check_finalists(config.study.finalists)
    check_measure(config.study.measure, config.study.tail)


def text(groups: tuple[str, ...]) -> str:
    """The reference of some groups for a terminal."""
    lines = []
    for s in settings(groups):
        lines += [f"{s.name} = {_shown(s.default)}" + (f"  ({s.kind})" if s.kind else ""), f"    {s.meaning}"]
        lines += [f"    Allowed: {s.allowed}."] if s.allowed else []
        lines += [f"    Read by study={', '.join(s.studies)}."] if s.studies else []
    return "\n".join(lines)


def page() -> str:
    """The reference as Markdown."""
    lines = [
        "# Reference of settings",
        "",
        "This page is made from the program (`footopt/studies/reference.py`), and a test holds it to that.",
        "`footopt --help sand` shows a group of it. A setting that names no study is read by all.",
    ]
    group = None
    for s in settings():
        if s.name.partition(".")[0] != group:
            group = s.name.partition(".")[0]
            head = "| setting | default | kind | meaning | allowed | read by study= |"
            lines += ["", f"## `{group}`", "", head, "| --- | --- | --- | --- | --- | --- |"]
        cells = (f"`{s.name}`", f"`{_shown(s.default)}`", s.kind, s.meaning, s.allowed, ", ".join(s.studies))
        lines.append("| " + " | ".join(cell.replace("|", "\\|").replace("*", "\\*") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def _shown(value: Any) -> str:
    """A value as one writes it on the command line."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, float) and math.isinf(value):
        return ".inf"
    if isinstance(value, (list, tuple)):
        return f"[{','.join(map(_shown, value))}]"
    return f"{value:g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    print(page(), end="")
