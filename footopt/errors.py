"""Errors that a user can fix: each names the setting, its value, what is allowed and what to try."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from numbers import Integral, Real
from pathlib import Path
from typing import Any

TINY = 1e-300  # the least value of a number that has to be above 0
ERROR_FILE = "error.txt"  # left in the folder of a job of a multirun that failed, with the message


class FootoptError(Exception):
    """Base of every error that footopt raises on purpose."""


class SettingError(FootoptError, ValueError):
    """A setting has a value that cannot be used.

    Parameters
    ----------
    setting : str
        Its name as the user writes it, such as ``"sand.zeta"``.
    value : object
        What was given.
    allowed : str
        What is allowed, in words.
    hint : str, optional
        A way out of it.
    """

    def __init__(self, setting: str, value: object, allowed: str, hint: str = "") -> None:
        self.setting, self.value, self.allowed, self.hint = setting, value, allowed, hint
        message = f"{setting} = {shortened(repr(value), 160)}: must be {allowed}."
        super().__init__(f"{message} {hint}" if hint else message)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.setting, self.value, self.allowed, self.hint)


class FileError(FootoptError, OSError):
    """A file or folder cannot be read, understood or written."""


class Unusable(ValueError):
    """The content of a file cannot be used; `naming` adds the name of the file."""


class EngineError(FootoptError):
    """The workers that evaluate designs cannot go on; the finished generations are in the store."""


class MissingError(FootoptError, ImportError):
    """A library that only some features need is not installed."""


def needed(library: str, what: str, extra: str) -> Any:
    """Import a library that `what` needs; if it is missing, say which extra of footopt installs it."""
    try:
        return import_module(library)
    except ImportError as error:
        raise MissingError(f'{what} needs {library} ({error}): pip install "footopt[{extra}]"') from None


def shortened(text: str, most: int) -> str:
    """A text without its middle if it has more characters than `most`."""
    keep = (most - 5) // 2
    return text if len(text) <= most else f"{text[:keep]} ... {text[-keep:]}"


def check(condition: object, setting: str, value: object, allowed: str, hint: str = "") -> None:
    """Raise `SettingError` unless `condition` holds (a NaN comparison does not)."""
    if not condition:
        raise SettingError(setting, value, allowed, hint)


def is_number(value: object, kind: type = Real) -> bool:
    """Whether a value is a number; numpy's are, True is not."""
    return isinstance(value, kind) and not isinstance(value, bool)


def check_whole(setting: str, value: Any, least: int, most: int, hint: str = "") -> None:
    """Raise `SettingError` unless `value` is a whole number in a range."""
    good = is_number(value, Integral) and least <= value <= most
    check(good, setting, value, f"a whole number from {least} to {most:,}", hint)


def check_number(setting: str, value: Any, least: float, most: float, allowed: str, hint: str = "") -> None:
    """Raise `SettingError` unless `value` is a number in a range."""
    check(is_number(value) and least <= value <= most, setting, value, allowed, hint)


def check_free(name: str, taken: Any, new: Any) -> None:
    """Raise `SettingError` if a plugin registers `new` under a name that footopt has `taken`."""
    builtin = getattr(taken, "__module__", "").startswith("footopt.") and taken.__module__ != new.__module__
    check(not builtin, "plugins", name, "of another name", "footopt has one of this name.")


def check_kind(setting: str, value: object, kind: type, hint: str) -> None:
    """Raise `SettingError` unless `value` is a `kind`: otherwise it would fail later, and elsewhere."""
    check(isinstance(value, kind), setting, value, f"of type {kind.__name__}", hint)


def named(path: str | Path, setting: str) -> str:
    """How a message begins: the setting and the file."""
    return f"{setting} = {shortened(str(path), 160)!r}"


@contextmanager
def naming(path: str | Path, setting: str) -> Iterator[None]:
    """Within it, an `Unusable` becomes a `FileError` that names the setting and the file."""
    try:
        yield
    except Unusable as why:
        raise FileError(f"{named(path, setting)}: {why}") from None
