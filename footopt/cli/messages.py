"""Errors in the user's terms: those of Hydra and OmegaConf, too, name the setting and say what to try."""

from __future__ import annotations

import errno
import re
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError

from hydra.errors import HydraException, MissingConfigException, OverrideParseException
from omegaconf.errors import (
    ConfigAttributeError,
    ConfigKeyError,
    ConfigTypeError,
    OmegaConfBaseException,
    ValidationError,
)
from yaml import YAMLError

from footopt.cli.compose import groups
from footopt.errors import FootoptError, SettingError, meant
from footopt.studies.settings import known

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
NO_RIGHT = (errno.EACCES, errno.EROFS, errno.EPERM)
NO_MEMORY = ("start new thread", "failed to map segment")  # in what Python and its libraries say
NO_FOLDER = (errno.ENOENT, errno.ENOTDIR, errno.EEXIST, errno.ENAMETOOLONG)
FOLDERS = ("hydra.run.dir=", "hydra.sweep.dir=")
INTERVAL = re.compile(r"=(tag\(.*)?interval\(")
QUOTES = "'\""
MORE = "`footopt --help` lists all settings."

#: What OmegaConf's errors begin with or hold, and what is allowed instead.
KINDS = {
    "converted to Float": "a number",
    "converted to Integer": "a whole number",
    "not a valid bool": "true or false",
    "is not a ListConfig": "a list in brackets",
    "DictConfig with ListConfig": "a list in brackets",
    "to string": "a text",
}


def explain(error: BaseException, words: Sequence[str] = ()) -> str:
    """What a user is told of an error, whatever it is.

    Parameters
    ----------
    error : BaseException
        What was raised.
    words : sequence of str
        The command line.
    """
    if isinstance(error, FootoptError):
        return str(error)
    if (composed := refusal(error, words)) is not None:
        return str(composed)
    if isinstance(error, OSError):
        if error.errno in NO_ROOM:
            return f"a file cannot be written ({error.strerror}). Make room on the disk and run it again."
        said = f"{error.strerror or str(error) or type(error).__name__}: {error.filename or ''}".rstrip(": ")
        own = any(word.startswith(FOLDERS) for word in words) and error.errno in NO_FOLDER
        if error.errno == errno.ENOENT and not error.filename:
            return f"{said}. Is the working folder gone? Go to one that is there."
        if error.errno not in NO_RIGHT and not own:
            return said
        if any(word.startswith("resume=") for word in words):
            return f"{said}. Resume a copy that is yours."
        return f"{said}. Write to another folder with hydra.run.dir=FOLDER."
    if isinstance(error, PackageNotFoundError):
        return (
            f"the files of the package {error.name} cannot be found. May too few files be open at once "
            "(`ulimit -n`)? If not, install it again."
        )
    if isinstance(error, MemoryError) or any(said in str(error) for said in NO_MEMORY):
        return (
            f"there is too little memory ({str(error) or type(error).__name__}). Free some, or ask for less: "
            "engine.threads=1, a smaller solver.pop_size. A search goes on with resume=FOLDER."
        )
    return (
        f"unexpected {type(error).__name__}: {error}\n"
        "This is a bug in footopt; HYDRA_FULL_ERROR=1 shows where."
    )


def refusal(error: BaseException, words: Sequence[str]) -> FootoptError | None:
    """What Hydra or OmegaConf refuse, in footopt's terms; None for another error."""
    given = {name.lstrip("+"): value for name, _, value in (word.partition("=") for word in words)}
    cause = error.__cause__ or error
    said = str(cause).partition("\n")[0]
    path = getattr(cause, "full_key", None) or ""
    key = path.partition("[")[0]  # of a list, without the place in it
    if word := next((word for word in words if word.startswith("=")), ""):
        return FootoptError(f"{word}: settings are given as name=value. {MORE}")
    if isinstance(error, MissingConfigException) and "/" in (error.missing_cfg_file or ""):
        group, _, choice = str(error.missing_cfg_file).rpartition("/")
        return _no_choice(group, choice, error.options or groups().get(group, []), given.get(group, ""))
    if isinstance(error, ValueError) and "Config group override must be" in said:
        for group in given.keys() & groups().keys():
            if given[group] not in groups()[group]:
                return _no_choice(group, given[group], groups()[group], given[group])
        return FootoptError(said)
    if isinstance(error, OverrideParseException):
        return _unreadable(error.override, words)
    if ambiguous := re.match(r"Ambiguous value for argument '(.*)'", str(error)):
        return _several(ambiguous[1])
    if isinstance(error, (AssertionError, AttributeError)) and any(n.startswith("effects.") for n in given):
        return _not_chosen(given)
    if isinstance(cause, (ConfigAttributeError, ConfigKeyError)) and key:
        return _unknown(key, given)
    if isinstance(cause, (ValidationError, ConfigTypeError)) and key:
        return _wrong_kind(key, given.get(key), said, listed=path != key)
    if isinstance(error, OmegaConfBaseException):
        if nothing := re.match(r"Interpolation key '(.*)' not found", said):
            place = next((word for word in words if f"${{{nothing[1]}}}" in word), key)
            return FootoptError(f"{place}: there is no setting {nothing[1]} to refer to. {MORE}")
        place = key or next((word for word in words if "${" in word), "")
        return FootoptError(f"{place}: {said}" if place else said)
    if isinstance(error, HydraException):
        if "does not support sweep type" in said and (word := next(filter(INTERVAL.search, words), "")):
            return FootoptError(f"{word}: a multirun needs single values. Try 1,2,3 or range(1,10,2)")
        lines = [line.strip() for line in str(error).partition("\nConfig search path:")[0].splitlines()]
        where = ("full_key", "reference_type", "object_type")
        return FootoptError(" ".join(line for line in lines if not line.startswith(where)))
    if isinstance(error, (YAMLError, UnicodeDecodeError)):
        return FootoptError(f"a file of settings cannot be read as YAML: {' '.join(str(error).split())}")
    return None


def _no_choice(group: str, choice: str, choices: Sequence[str], given: str) -> FootoptError:
    """A group has no such choice as is given, alone or in a list."""
    own = [name for name in known() if name.startswith(f"{group}.") and name != f"{group}.name"]
    is_number = own and re.fullmatch(r"[-+\d.e]+", choice)
    hint = f"A number needs its name, such as {own[0]}={choice}." if is_number else ""
    if group == "objective" and not meant(choice, choices):
        from footopt.walk.objectives import MEASURES

        names = [meant(name.strip(), MEASURES) for name in given.strip("[]").split(",")]
        hint = f"Or yours: 'objective.names=[{','.join(filter(None, names)) or 'work'}]'."
    return SettingError(group, choice, f"one of {', '.join(choices)}", hint)


def _unreadable(word: str, words: Sequence[str]) -> FootoptError:
    """A word is no setting."""
    name, equals, value = word.partition("=")
    later = list(words)[list(words).index(word) + 1 :] if word in words else []
    if value.count("[") > value.count("]"):
        if more := next((later[: i + 1] for i, other in enumerate(later) if "]" in other), []):
            whole = " ".join([word, *more])
            return FootoptError(f"{word}: the list has spaces in it. Leave them out, or quote it: '{whole}'")
        return FootoptError(f"{word}: the list does not end. Try '{word}]'")
    if value.endswith("]") and value.count("]") > value.count("["):
        return FootoptError(f"{word}: the list does not begin. Try '{name}=[{value}'")
    if equals:
        return FootoptError(f"{word}: the value cannot be read. Try quotes around it: {name}=\"'...'\"")
    choices = groups()
    owners = {choice: group for group in choices for choice in choices[group]}
    close = meant(word, owners)
    if word == "help":
        hint = "Try footopt --help"
    elif word == "resume":
        hint = "Try resume=FOLDER, of a run"
    elif word in choices:
        hint = f"Try {word}={later[0] if later and later[0] in choices[word] else choices[word][0]}"
    elif word in owners:
        hint = f"Try {' or '.join(f'{group}={word}' for group in choices if word in choices[group])}"
    else:
        hint = f"Did you mean {owners[close]}={close}?" if close else f"Such as sand=soft; {MORE}"
    return FootoptError(f"{word}: settings are given as name=value. {hint}")


def _several(word: str) -> FootoptError:
    """A value has a comma, and is no list, no text in quotes, and no sweep."""
    name, _, value = word.partition("=")
    each = f"footopt -m {word}"
    if name in groups():
        both = f"For both at once: effects=[{value}]. " if name == "effects" else ""
        return SettingError(name, value, "one choice", f"{both}For a run of each: {each}")
    dot = f"{name}={value.replace(',', '.')} for a number, " if re.fullmatch(r"[-+]?\d*,\d+", value) else ""
    hint = (
        f"Try {dot}'{name}=[{value}]' for a list, '{name}=\"{value}\"' for a text; {each} is a run of each."
    )
    return SettingError(name, value, "without a comma", hint)


def _not_chosen(given: Mapping[str, str]) -> FootoptError:
    """OmegaConf cannot assign a setting of an effect that is not chosen."""
    setting = next(
        n for n in given if n.startswith("effects.") and n.split(".")[1] not in given.get("effects", "")
    )
    if setting not in known():
        return _unknown(setting, given)
    value, effect = given[setting], setting.split(".")[1]
    hint = f"Try effects={effect} {setting}={value}"
    return SettingError(setting, value, f"given with the effect {effect}", hint)


def _unknown(key: str, given: Mapping[str, str]) -> FootoptError:
    """There is no such setting; where a part of its name is wrong, its whole name says best what is meant."""
    group, _, last = key.rpartition(".")
    names = known()
    whole = next((name for name in given if name.startswith(f"{key}.")), "")
    if whole and (close := meant(whole, names)):
        return FootoptError(f"{whole}: there is no such setting. Did you mean {close}={given[whole]}?")
    value = given.get(key, "")
    own = {name.removeprefix(f"{group}."): name for name in names if name.startswith(f"{group}.")}
    same = [name for name in names if name.rpartition(".")[2] == last]
    same = [name for name in same if name.count(".") == min(name.count(".") for name in same)]
    close = meant(last, own) if own else ""
    if close:
        hint = f"Did you mean {own[close]}={value}?"
    elif same and not (own and "." in group):  # such as effects.slope: who knows it looks for one of its own
        hint = f"Did you mean {' or '.join(f'{name}={value}' for name in same)}?"
    elif own:
        hint = f"Those of {group}: {', '.join(own)}."
    else:
        close = meant(key, [*groups(), *names])
        hint = f"Did you mean {close}={value}?" if close else MORE
    return FootoptError(f"{key}: there is no such setting. {hint}")


def _wrong_kind(key: str, value: str | None, said: str, listed: bool) -> FootoptError:
    """A setting's value is of another kind."""
    if inside := [name for name in known() if name.startswith(f"{key}.")]:
        return FootoptError(f"{key}: holds several settings. Try {inside[0]}=...; all: {', '.join(inside)}.")
    kind = next((kind for words, kind in KINDS.items() if words in said), "")
    if "is not Optional" in said:
        return SettingError(key, value, "given a value", "Leave it out for its default.")
    if not kind or value is None:
        return FootoptError(f"{key}: {said}")
    if listed:
        kind = f"a list of {kind.removeprefix('a ')}s"
    hint = f"Try '{key}=[{value.strip(QUOTES)}]'" if kind == "a list in brackets" else ""
    return SettingError(key, value, kind, hint)
