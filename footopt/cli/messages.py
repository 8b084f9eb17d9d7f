"""Errors of Hydra and OmegaConf in footopt's terms: the setting, its value, what is allowed, what to try."""

import re
from collections.abc import Sequence
from difflib import get_close_matches

from hydra.errors import HydraException
from numba.core.errors import NumbaError
from omegaconf.errors import ConfigAttributeError, ConfigKeyError, OmegaConfBaseException
from yaml import YAMLError

from footopt.cli.compose import groups
from footopt.errors import FootoptError, SettingError
from footopt.studies import not_read, studies_that_read
from footopt.studies.settings import known
from footopt.walk.own_code import own_line

MORE = "`footopt --help` lists all settings."
NO_NAME = re.compile(r"\[?[-.\d]|(null|true|false)$")  # values that no choice of a group has

#: Parts of OmegaConf's errors of types, and what is allowed instead.
KINDS = {
    "converted to Float": "a number",
    "converted to Integer": "a whole number",
    "not a valid bool": "true or false",
    "not a ListConfig": "a list in brackets, such as [1,2]",
    "to string": "one word",
    "is not Optional": "given a value",
    "Incompatible value 'None'": "given a value",
}


def explain(error: BaseException, overrides: Sequence[str] = ()) -> str:
    """The message for any error; `overrides` are those of the command line."""
    if (translated := translate(error, overrides)) is not None:
        return str(translated)
    if isinstance(error, (OSError, MemoryError)):
        return str(error) or type(error).__name__
    if isinstance(error, NumbaError) and (place := own_line(str(error))):
        return f"{place}: cannot be compiled. A law takes + - * / and what footopt.effects.dual has."
    if type(error).__module__.partition(".")[0] in ("submitit", "joblib"):
        hint = "footopt resume=FOLDER, with that of the multirun, finishes the jobs without a result."
        return f"a job was lost ({error}). Others may still run. {hint}"
    return f"unexpected {type(error).__name__}: {error}\nA bug of ours or yours; HYDRA_FULL_ERROR=1 shows it."


def translate(error: BaseException, overrides: Sequence[str]) -> FootoptError | None:
    """An error of Hydra or OmegaConf in footopt's terms, with a hint for usual mistakes; None for others."""
    if isinstance(error, FootoptError):
        return error
    given = {name.lstrip("+"): value for name, _, value in (one.partition("=") for one in overrides)}
    cause, names = error.__cause__ or error, known()
    text = str(cause).partition("\n")[0]
    key = (getattr(cause, "full_key", None) or "").partition("[")[0]  # of a list, without the place in it
    group, choice = re.findall(r"(hydra/\w+|[^/]*)/?(.*)", getattr(error, "missing_cfg_file", None) or "")[0]
    # footopt =soft, footopt study=simulate foot.k=[1, 2]
    if bad := next((one for one in overrides if one.startswith("=")), getattr(error, "override", "")):
        return FootoptError(f"{bad}: {_syntax(*bad.partition('='))}")
    if "Config group override must be" in text or isinstance(error, TypeError):  # footopt sand=2.5, sand=[2]
        pairs = [(name, part) for name in given if name in groups() for part in given[name].split(",")]
        group, choice = next((pair for pair in pairs if NO_NAME.match(pair[1])), ("", ""))
    if text.startswith("Ambiguous value for argument"):  # footopt sand.zeta=1,2
        name, _, value = text.split("'")[1].partition("=")
        hint = f"For a run of each: footopt -m '{name}={value}'"
        if name in ("effects", "objective") or name not in groups():
            hint = f"For a list: '{name}=[{value}]'. {hint}"
        return SettingError(name, value, "one value", hint)
    if group and not choice and group not in groups():  # footopt -cn nothere
        return SettingError("--config-name", group, "a settings file", f"There is no {group}.yaml.")
    if group:  # footopt sand=mud
        own = next((name for name in names if name.startswith(f"{group}.") and name != f"{group}.name"), "")
        hint = "Others of pymoo go by class: solver.name=soo.nonconvex.de.DE" if group == "solver" else ""
        if own and choice.lstrip("-")[:1].isdigit():
            hint = f"A number needs its name, such as {own}={choice}."
        return SettingError(group, choice, f"one of {', '.join(groups().get(group, []))}", hint)
    # footopt snad=soft; footopt study=compare sand=soft; footopt effects.slope.angle=4, without effects=slope
    if isinstance(cause, (ConfigAttributeError, ConfigKeyError)) and key:
        key = next((name for name in given if f"{name}.".startswith(f"{key}.")), key)
        if key.startswith("effects.") and key in names:
            name = key.split(".")[1]
            hint = f"Try effects={name} {key}={given[key]}"
            return SettingError(key, given[key], f"given with the effect {name}", hint)
        return _unknown(key, given.get(key, ""), given.get("study", "optimize"))
    # footopt sand.coefficients=3
    parts = [name for name in given if name not in groups()]
    inner = ((name, one) for name in parts for one in names if one.startswith(f"{name}."))
    if "is not a subclass of" in text and (found := next(inner, None)):
        return SettingError(found[0], given[found[0]], f"set by its parts, such as {found[1]}")
    if kind := next((KINDS[part] for part in KINDS if part in text and key in given), ""):  # foot.width=wide
        return SettingError(key, given[key], kind)
    if isinstance(error, OmegaConfBaseException) and key:
        return FootoptError(f"{key}: {text}")
    if isinstance(error, (HydraException, OmegaConfBaseException, YAMLError)):
        return FootoptError(" ".join(str(error).partition("\nConfig search path:")[0].split()))
    return None


def _syntax(name: str, equals: str, value: str) -> str:
    """Why an override is no setting, and what to try."""
    if name and equals:
        return f"the value cannot be read. Try '{name}=[a, b]' for a list, {name}=\"'{value}'\" for a text"
    owners = {choice: group for group, choices in groups().items() for choice in choices}
    close = get_close_matches(name, owners, n=1)
    hint = f"Try {owners[close[0]]}={close[0]}" if close else f"Such as sand=soft; {MORE}"
    return f"settings are given as name=value. {hint}"


def _unknown(name: str, value: str, study: str) -> FootoptError:
    """A setting that there is not, or not for this study."""
    names = known()
    if name in names and studies_that_read(name):
        return not_read(name, value, study)
    same = [other for other in reversed(names) if other.endswith(f".{name.rpartition('.')[2]}")]
    typo, near = get_close_matches(name, names, 1, 0.9), get_close_matches(name, [*groups(), *names], 1)
    close, group = [*typo, *same, *near], name.partition(".")[0]
    more = MORE if group not in groups() else f"`footopt --help {group}` lists those of {group}."
    hint = f"Did you mean {close[0]}={value}?" if close and value else more  # no value of solver={a:1}
    return FootoptError(f"{name}: there is no such setting. {hint}")
