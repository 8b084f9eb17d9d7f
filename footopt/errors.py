"""The errors a user can mend: each names the setting, its value, what is allowed and what to try."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable


class FootoptError(Exception):
    """Base of every error that footopt raises on purpose."""


class SettingError(FootoptError, ValueError):
    """A setting has a value that cannot be used.

    Parameters
    ----------
    setting : the setting's name as the user writes it, e.g. ``"sand.zeta"``.
    value : what was given.
    allowed : what is allowed, in words.
    hint : what to try; optional.
    """

    def __init__(self, setting: str, value: object, allowed: str, hint: str = "") -> None:
        self.setting, self.value, self.allowed, self.hint = setting, value, allowed, hint
        message = f"{setting} = {value!r}: must be {allowed}."
        _, listed, names = allowed.replace(" of: ", " of ").partition(" of ")
        close = meant(value, re.split("[,;] ", names)) if listed and isinstance(value, str) else ""
        if close and not hint:
            hint = f"Did you mean {close}?"
        super().__init__(f"{message} {hint}" if hint else message)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.setting, self.value, self.allowed, self.hint)


class FileError(FootoptError, OSError):
    """A file or folder cannot be read, understood or written."""


def meant(given: str, names: Iterable[str]) -> str:
    """The name that was probably meant, or ""."""
    lower = {name.lower(): name for name in names}
    word = given.lower()
    starts = [name for name in lower if len(word) > 2 and name.startswith(word)]
    close = starts or difflib.get_close_matches(word, lower, n=1, cutoff=0.6)
    return lower[close[0]] if close else ""


def check(condition: object, setting: str, value: object, allowed: str, hint: str = "") -> None:
    """Raise `SettingError` unless `condition` holds (a NaN comparison does not)."""
    if not condition:
        raise SettingError(setting, value, allowed, hint)
