"""Errors in the user's terms: those of Hydra and OmegaConf, too, name the setting and say what to try."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from hydra.errors import HydraException, MissingConfigException, OverrideParseException
from omegaconf.errors import ConfigAttributeError, ConfigKeyError, OmegaConfBaseException
from yaml import YAMLError

from footopt.cli.compose import groups
from footopt.errors import FootoptError, SettingError, meant
from footopt.studies.settings import known

MORE = "`footopt --help` lists all settings."

#: What OmegaConf's errors of types hold, and what is allowed instead.
KINDS = {
    "converted to Float": "a number",
    "converted to Integer": "a whole number",
    "not a valid bool": "true or false",
    "ListConfig": "a list in brackets, such as [1,2]",
    "is not Optional": "given a value",
}


def explain(error: BaseException, words: Sequence[str] = ()) -> str:
    """The message for any error; `words` are those of the command line."""
    if (translated := translate(error, words)) is not None:
        return str(translated)
    if isinstance(error, (OSError, MemoryError)):
        said = getattr(error, "strerror", None) or str(error) or type(error).__name__
        where = getattr(error, "filename", None)
        return f"{said}: {where}" if where else said
    return (
        f"unexpected {type(error).__name__}: {error}\n"
        "This is a bug in footopt; HYDRA_FULL_ERROR=1 shows where."
    )


def translate(error: BaseException, words: Sequence[str]) -> FootoptError | None:
    """An error of Hydra or OmegaConf in footopt's terms; None if it is of neither.

    The usual mistakes have a message of their own, and all others have Hydra's words in one line.
    """
    given = {name.lstrip("+"): value for name, _, value in (word.partition("=") for word in words)}
    cause = error.__cause__ or error
    said = str(cause).partition("\n")[0]
    key = (getattr(cause, "full_key", None) or "").partition("[")[0]  # of a list, without the place in it
    effect = next((name for name in given if name.startswith("effects.") and name in known()), "")
    if isinstance(error, FootoptError):
        return error
    if isinstance(error, OverrideParseException):
        return _unreadable(error.override, words)
    if isinstance(error, MissingConfigException) and "/" in (error.missing_cfg_file or ""):
        group, _, choice = str(error.missing_cfg_file).rpartition("/")
        return _no_choice(group, choice, error.options or groups().get(group, []))
    if "Config group override must be" in said:
        group = next(name for name in given if name in groups() and given[name] not in groups()[name])
        return _no_choice(group, given[group], groups()[group])
    if said.startswith("Ambiguous value for argument"):
        return _several(said.split("'")[1])
    if isinstance(error, (AssertionError, AttributeError)) and effect:
        name = effect.split(".")[1]
        hint = f"Try effects={name} {effect}={given[effect]}"
        return SettingError(effect, given[effect], f"given with the effect {name}", hint)
    if isinstance(cause, (ConfigAttributeError, ConfigKeyError)) and key:
        return _unknown(next((name for name in given if f"{name}.".startswith(f"{key}.")), key), given)
    if kind := next((KINDS[words] for words in KINDS if words in said and key in given), ""):
        return SettingError(key, given[key], kind)
    if isinstance(error, OmegaConfBaseException) and key:
        return FootoptError(f"{key}: {said}")
    if isinstance(error, (HydraException, OmegaConfBaseException, YAMLError)):
        return FootoptError(" ".join(str(error).partition("\nConfig search path:")[0].split()))
    return None


def _unreadable(word: str, words: Sequence[str]) -> FootoptError:
    """A word is no setting."""
    name, equals, value = word.partition("=")
    later = list(words)[list(words).index(word) + 1 :] if word in words else []
    if value.count("[") > value.count("]"):
        rest = next((later[: i + 1] for i, other in enumerate(later) if "]" in other), ["]"])
        whole = " ".join([word, *rest])
        return FootoptError(f"{word}: the list has spaces in it. Leave them out, or quote it: '{whole}'")
    if name and equals:
        return FootoptError(f"{word}: the value cannot be read. Try quotes around it: {name}=\"'{value}'\"")
    owners = {choice: group for group, choices in groups().items() for choice in choices}
    close = meant(word, owners)
    hint = f"Try {owners[close]}={close}" if close else f"Such as sand=soft; {MORE}"
    return FootoptError(f"{word}: settings are given as name=value. {hint}")


def _no_choice(group: str, choice: str, choices: Sequence[str]) -> FootoptError:
    """A group has no such choice."""
    own = next((name for name in known() if name.startswith(f"{group}.") and name != f"{group}.name"), "")
    is_number = own and choice.lstrip("-")[:1].isdigit()
    hint = f"A number needs its name, such as {own}={choice}." if is_number else ""
    if group == "objective" and not meant(choice, choices):
        hint = "For others give a list: objective.names=[work]."
    return SettingError(group, choice, f"one of {', '.join(choices)}", hint)


def _several(word: str) -> FootoptError:
    """A value has a comma, and is no list, no text in quotes, and no sweep."""
    name, _, value = word.partition("=")
    each = f"footopt -m {word}"
    if name == "effects":
        return SettingError(name, value, "one choice", f"Both: effects=[{value}]. For a run of each: {each}")
    if name in groups():
        return SettingError(name, value, "one choice", f"For a run of each: {each}")
    hint = f"Try '{name}=[{value}]' for a list; {each} is a run of each."
    return SettingError(name, value, "without a comma", hint)


def _unknown(name: str, given: Mapping[str, str]) -> FootoptError:
    """There is no such setting."""
    value, names = given.get(name, ""), known()
    group, _, last = name.rpartition(".")
    own = {other.rpartition(".")[2]: other for other in names if group and other.startswith(f"{group}.")}
    same = [other for other in names if other.endswith(f".{last}")]
    close = own.get(meant(last, own)) or next(iter(same), "") or meant(name, [*groups(), *names])
    hint = f"Did you mean {close}={value}?" if close else MORE
    return FootoptError(f"{name}: there is no such setting. {hint}")
