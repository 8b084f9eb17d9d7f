"""The command line as it is typed: each word is a setting that there is, or the error says what to try.

Hydra would refuse the same words, in its own terms. What only Hydra knows (its flags, sweeps, ~key,
groups of a user's own) is left to it.
"""

from __future__ import annotations

import dataclasses
import types
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Union, get_args, get_origin, get_type_hints

from footopt.errors import FootoptError, SettingError, meant
from footopt.studies.settings import Config

MULTIRUN = ("-m", "--multirun")
#: Flags of Hydra's that a word of their own follows.
WITH_WORD = ("-c", "--cfg", "-p", "--package", "-cp", "--config-path", "-cn", "--config-name", "-cd",
             "--config-dir", "--experimental-rerun")  # fmt: skip
#: With these nothing is run, or there are groups that are not in conf/.
LEFT = ("-h", "--help", "-sc", "--shell-completion", "--hydra-help", "--version", "-i", "--info", "-cp",
        "--config-path", "-cn", "--config-name")  # fmt: skip
OWN = ("-cd", "--config-dir")
SHORT = ("run", "resume")  # settings of the command line's own
KINDS = {int: "a whole number", float: "a number", bool: "true or false"}


def check_words(words: Sequence[str], conf: Path) -> None:
    """Raise a `FootoptError` for the first word that is no setting, or that has a value of another kind."""
    if any(word.partition("=")[0] in (*LEFT, "hydra.searchpath") for word in words):
        return
    roots = [conf, *folders_after(words, OWN)]
    if missing := [root for root in roots if not root.is_dir()]:
        raise FootoptError(f"--config-dir {missing[0]}: there is no such folder.")
    own = sorted((path.parent.name, path.stem) for root in roots for path in root.glob("*/*.yaml"))
    groups = {group: list(dict.fromkeys(stem for name, stem in own if name == group)) for group, _ in own}
    sweeps = any(word in MULTIRUN for word in words)
    rest = iter(range(len(words)))
    for i in rest:
        word, after = words[i], list(words[i + 1 :])
        if word in WITH_WORD:
            next(rest, None)
        elif word.startswith("-"):
            _check_flag(word, groups)
        elif "=" not in word and not word.startswith("~"):
            raise FootoptError(f"{word}: settings are given as name=value. {_instead(word, after, groups)}")
        elif word.startswith("+"):
            name, _, value = word.lstrip("+").partition("=")
            if name.partition(".")[0] in groups and "." in name:  # nothing would read another one
                _check_value(name, value, sweeps, groups)
        elif word[0] != "~" and not word.startswith(("hydra.", "hydra/")):
            name, _, value = word.partition("=")
            if name not in SHORT and "'" not in word and '"' not in word:
                _check_closed(word, after)
            if name in groups:
                _check_choice(name, value, groups[name], sweeps)
            elif name not in SHORT and "@" not in name and "/" not in name:
                _check_value(name, value, sweeps, groups)
    if not any(word.startswith("resume=") for word in words):  # its effects are those of that run
        _check_effects(words, roots)


def folders_after(words: Sequence[str], flags: Sequence[str]) -> list[Path]:
    """The folders that follow a flag, as its own word or after its =."""
    pairs = zip(words, [*words[1:], ""], strict=False)
    return [
        Path(after if word in flags else word.partition("=")[2])
        for word, after in pairs
        if word.partition("=")[0] in flags and (after or "=" in word)
    ]


def _check_flag(word: str, groups: Mapping[str, Sequence[str]]) -> None:
    name = word.lstrip("-")
    if name.partition("=")[0].partition(".")[0] in groups:
        tried = name if "=" in name else f"{name}=..."
        raise FootoptError(f"{word}: settings have no dashes. Try {tried}")


def _instead(word: str, after: Sequence[str], groups: Mapping[str, Sequence[str]]) -> str:
    """What a word without = may have been meant as."""
    owners = [group for group, choices in groups.items() if word in choices]
    if word in ("help", "?"):
        return "Try footopt --help"
    if word in groups and after and "=" not in after[0]:
        return f"Try {word}={after[0]}"
    if word in groups:
        return f"Try {word}={groups[word][0]}; there are {', '.join(groups[word])}."
    if owners:
        return f"Try {' or '.join(f'{group}={word}' for group in owners)}"
    choices = {choice: group for group, names in groups.items() for choice in names}
    if close := meant(word, choices):
        return f"Did you mean {choices[close]}={close}?"
    return "Such as sand=soft; footopt --help lists all settings."


def _check_closed(word: str, after: Sequence[str]) -> None:
    """A list with spaces in it comes as several words; one without its bracket never ends."""
    if word.count("[") <= word.count("]"):
        return
    whole = word
    for more in after:
        whole += f" {more}"
        if whole.count("[") <= whole.count("]"):
            raise FootoptError(f"{word}: the list has spaces in it. Leave them out, or quote it: '{whole}'")
    raise FootoptError(f"{word}: the list does not end. Try '{word}]'")


def _check_choice(group: str, value: str, choices: Sequence[str], sweeps: bool) -> None:
    if "(" in value or "$" in value or value in ("null", "[]"):
        return
    listed = value.startswith("[")
    given = [part.strip(" '\"") for part in value.strip("[]").split(",")]
    for choice in given:
        if choice not in choices:
            close = meant(choice, choices)
            hint = f"Did you mean {group}={close}?" if close else ""
            if choice.replace(".", "", 1).isdigit():
                hint = f"A number needs its name, such as {_number_of(group)}={choice}."
            raise SettingError(group, choice, f"one of {', '.join(choices)}", hint)
    if len(given) > 1 and not sweeps and not listed:
        both = f"{group}=[{value}]" if group == "effects" else f"footopt -m {group}={value}"
        what = "both at once" if group == "effects" else "a run of each"
        raise SettingError(group, value, "one choice", f"For {what}: {both}")


def _number_of(group: str) -> str:
    """The first setting of a group that is a number."""
    numbers = (name for name, kind in _settings().items() if _bare(kind) in (int, float))
    return next((name for name in numbers if name.startswith(f"{group}.")), f"{group}.NAME")


def _bare(kind: Any) -> Any:
    """A type without "or None"."""
    if get_origin(kind) in (Union, types.UnionType):
        (kind,) = (part for part in get_args(kind) if part is not type(None))
    return kind


def _settings(kind: Any = Config, prefix: str = "") -> dict[str, Any]:
    """Types of all settings by their full names."""
    found: dict[str, Any] = {}
    for name, inner in get_type_hints(kind).items():
        if dataclasses.is_dataclass(_bare(inner)):
            found |= _settings(_bare(inner), f"{prefix}{name}.")
        else:
            found[prefix + name] = inner
    return found


def _check_value(name: str, value: str, sweeps: bool, groups: Mapping[str, Sequence[str]]) -> None:
    known = _settings()
    if inside := [key for key in known if key.startswith(f"{name}.")]:
        if value == "null" or "$" in value or (value.startswith("{") and not name.startswith("effects.")):
            return
        raise FootoptError(f"{name}: holds several settings. Try {inside[0]}=...; all: {', '.join(inside)}.")
    if name not in known:
        raise FootoptError(f"{name}: there is no such setting. {_other_name(name, value, known, groups)}")
    kind = _bare(known[name])
    plain, nothing = value.strip("'\""), value == "null" and kind is not known[name]
    if nothing or "$" in value or "(" in value or (sweeps and "," in value):
        return
    if get_origin(kind) is list:
        if not value.startswith("["):
            raise SettingError(name, value, "a list in brackets", f"Try '{name}=[{value}]'")
        return
    if kind is str and "," in value and value == plain:
        raise SettingError(name, value, "in quotes, because of its comma", f"""Try '{name}="{value}"'""")
    if kind in KINDS and not _is(kind, plain):
        hint = f"Try {name}={value.replace(',', '.')}" if _is(kind, plain.replace(",", ".")) else ""
        raise SettingError(name, value, KINDS[kind], hint)


def _is(kind: type, value: str) -> bool:
    """Whether a word can be read as that kind."""
    if kind is bool:
        return value.lower() in ("true", "false", "yes", "no", "on", "off", "1", "0")
    try:
        kind(value.replace(".inf", "inf").replace(".nan", "nan"))  # as YAML writes them
    except ValueError:
        return False
    return True


def _other_name(name: str, value: str, known: Mapping[str, Any], groups: Mapping[str, Sequence[str]]) -> str:
    """What a setting that there is not may have been meant as."""
    group, _, last = name.rpartition(".")
    same = [key for key in known if key.rpartition(".")[2] == last]
    same = [key for key in same if key.count(".") == min(key.count(".") for key in same)]
    if same:
        return f"Did you mean {' or '.join(f'{key}={value}' for key in same)}?"
    if not group:
        close = meant(name, groups)
        return f"Did you mean {close}={value}?" if close else "footopt --help lists all settings."
    own = {key.rpartition(".")[2]: key for key in known if key.startswith(f"{group}.")}
    if close := meant(last, own):
        return f"Did you mean {own[close]}={value}?"
    if own:
        return f"Those of {group}: {', '.join(key.removeprefix(f'{group}.') for key in own.values())}."
    close = meant(name, known)
    return f"Did you mean {close}={value}?" if close else "footopt --help lists all settings."


def _check_effects(words: Sequence[str], roots: Sequence[Path]) -> None:
    """An effect's parameter needs the effect, by its name or by the scene's."""
    chosen = " ".join(word for word in words if word.startswith(("effects=", "+effects")))
    scenes = [word.partition("=")[2] for word in words if word.startswith("scene=")]
    for scene in scenes:
        paths = [root / "scene" / f"{scene}.yaml" for root in roots]
        chosen += "".join(path.read_text(encoding="utf-8") for path in paths if path.is_file())
    for word in words:
        name, _, value = word.partition("=")
        parts = name.split(".")
        if len(parts) == 3 and parts[0] == "effects" and parts[1] not in f"own {chosen}":
            effect = parts[1]
            raise SettingError(name, value, f"given with the effect {effect}", f"Try effects={effect} {word}")
