"""Sands: a stress map and its scale zeta; media from the literature by name."""

from dataclasses import dataclass
from typing import Self

from footopt.errors import check, is_number
from footopt.sand.law import GENERIC, StressMap

#: zeta of sands by name: the paper's three, and media measured in the literature
#: (Agarwal et al., J. Terramechanics 85, 2019; Treers, Cao & Stuart, IEEE RA-L 6, 2021).
MEDIA: dict[str, float] = {
    "soft": 0.2,
    "regular": 1.0,
    "hard": 5.0,
    "poppy_loose": 0.35,
    "poppy_close": 0.55,
    "glass_beads": 0.33,
    "medium_sand": 2.02,
    "mars_simulant": 3.05,
}


@dataclass(frozen=True)
class Sand:
    """A dry granular medium: a stress map and its scale.

    Parameters
    ----------
    zeta : float > 0
        Scale of the map (1 is the generic material).
    stress_map : StressMap
        Nine coefficients, N/cm^3.
    name : str
        For tables and legends.
    fit_error : (x, z), optional
        Rms misfit of a fitted table over the table's own rms, per component; None if the map was not
        fitted.

    Raises
    ------
    SettingError
        zeta is not a number from 1e-6 to 1e6.
    """

    zeta: float = 1.0
    stress_map: StressMap = GENERIC
    name: str = "custom"
    fit_error: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        allowed = "a number > 0, from 1e-6 to 1e6 (soft sand 0.2, the generic material 1, hard sand 5)"
        good = is_number(self.zeta) and 1e-6 <= self.zeta <= 1e6
        check(good, "sand.zeta", self.zeta, allowed, "Try sand=regular or sand.zeta=1.")

    @classmethod
    def named(cls, name: str) -> Self:
        """A sand of `MEDIA` by its name."""
        check(name in MEDIA, "sand", name, f"one of {', '.join(MEDIA)}", "Or give sand.zeta.")
        return cls(zeta=MEDIA[name], name=name)
