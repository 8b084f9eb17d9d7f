"""What the paper says comes out: the words of claims.toml, each claim with the measure of its name."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from importlib.resources import files
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from footopt.studies.paper.evidence import Evidence
from footopt.studies.paper.measures import LIMITS, MEASURES


class Claim(NamedTuple):
    """One sentence of the paper.

    Parameters
    ----------
    margin : callable
        From the evidence to a number, > 0 where the claim holds.
    place, says, decided, unit : str
        Where the paper says or shows it, its sentence in other words, what the margin is, and its unit.
    """

    margin: Callable[[Evidence], float]
    place: str
    says: str
    decided: str
    unit: str

    @property
    def about(self) -> str:
        """Which walks it is about: the five "shapes", or the "optima"."""
        return "shapes" if self.place.startswith("Fig. 4") else "optima"


def _claims() -> dict[str, Claim]:
    words = tomllib.loads(files(__package__).joinpath("claims.toml").read_text(encoding="utf-8"))
    for said in words.values():
        said["decided"] = said["decided"].format(**LIMITS)
    return {name: Claim(MEASURES[name], **said) for name, said in words.items()}


CLAIMS = _claims()


def measure(evidence: Evidence) -> NDArray[np.float64]:
    """Return the margins of all claims, (claims,)."""
    with np.errstate(invalid="ignore"):
        return np.array([claim.margin(evidence) for claim in CLAIMS.values()])
