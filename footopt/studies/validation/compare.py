"""The comparison of ASME V&V 20: error E = S - D against the validation uncertainty u.

S is the simulation, D the data, and u^2 = u_num^2 + u_input^2 + u_exp^2. All uncertainties are standard
ones. u_num is the change under refinement, u_input the root sum of squares of half the change of S as each
input goes from its low to its high value.
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

from footopt.effects import EFFECTS, VARIANTS
from footopt.studies.validation import rig

Array = NDArray[np.float64]

COVERAGE = 2.0  # of u: an error beyond it is the model's
COARSE = 0.5  # of the data's scale: where COVERAGE u is more, agreement says nothing

#: Units of the files in SI.
UNITS = {"mm": 1e-3, "N": 1.0, "N/cm3": 1e6, "1": 1.0, "body weights": 1.0}

AGREES, DIFFERS, OPEN = "agrees", "differs", "cannot be told"


@dataclass(frozen=True, eq=False)
class Comparison:
    """One quantity of an experiment under one law, at M points, in the quantity's unit.

    Parameters
    ----------
    experiment, quantity, unit : str
        The experiment's name, and what is compared.
    law : tuple of str
        The effects that are on.
    points : sequence
        What tells the points apart: numbers of the experiment's x, or names.
    simulated, measured : (M,)
        S and D.
    numerical, inputs, experimental : (M,)
        The three parts of u.
    scale : float
        To which errors are related: the rms of D, or what the file states.
    """

    experiment: str
    quantity: str
    unit: str
    law: tuple[str, ...]
    points: Sequence[Any]
    simulated: Array
    measured: Array
    numerical: Array
    inputs: Array
    experimental: Array
    scale: float

    @property
    def error(self) -> Array:
        """E = S - D, (M,)."""
        return self.simulated - self.measured

    @property
    def uncertainty(self) -> Array:
        """u, (M,)."""
        return np.sqrt(self.numerical**2 + self.inputs**2 + self.experimental**2)

    @property
    def size(self) -> float:
        """Root mean square of E."""
        return rms(self.error)

    @property
    def bias(self) -> float:
        """Mean of E."""
        return float(self.error.mean())

    @property
    def band(self) -> float:
        """`COVERAGE` times the root mean square of u."""
        return COVERAGE * rms(self.uncertainty)

    @property
    def bar(self) -> Array:
        """`COVERAGE` times the data's uncertainty, (M,)."""
        return COVERAGE * self.experimental

    @property
    def spread(self) -> Array:
        """`COVERAGE` times what the prediction may be off for its inputs and numbers, (M,)."""
        return np.asarray(COVERAGE * np.sqrt(self.numerical**2 + self.inputs**2))

    @property
    def verdict(self) -> str:
        """Whether the error is larger than the band, or the band too wide to say more."""
        if self.size > self.band:
            return DIFFERS
        return OPEN if self.band > COARSE * self.scale else AGREES

    @property
    def says(self) -> str:
        """The verdict in words, with the error's size."""
        if self.verdict != DIFFERS:
            return self.verdict
        return f"differs by {100.0 * self.size / self.scale:.0f} %"


@dataclass(frozen=True, eq=False)
class Experiment:
    """One file of this folder; see `wheel.toml` for its entries."""

    name: str
    content: dict[str, Any]

    @property
    def title(self) -> str:
        """For figures and tables."""
        return str(self.content["title"])

    @property
    def laws(self) -> list[tuple[str, ...]]:
        """The sets of effects that it is compared under, the plain law first."""
        return [tuple(law) for law in self.content["laws"]]

    def compare(self, law: tuple[str, ...]) -> list[Comparison]:
        """Repeat it under a law."""
        content, given_effects = self.content, self.content.get("effects", {})
        effects = [VARIANTS.get(name) or EFFECTS[name](**given_effects.get(name, {})) for name in law]
        setup, given = content.get("setup", {}), content.get("inputs", {})
        nominal = {name: part["value"] for name, part in given.items()}

        def run(fine: bool, **changed: Any) -> dict[str, Array]:
            return rig.RIGS[content["rig"]](setup, as_arrays(nominal | changed), effects, fine)

        coarse, fine = run(False), run(True)
        spans = [
            (run(False, **{name: part["low"]}), run(False, **{name: part["high"]}))
            for name, part in given.items()
        ]
        other = rig.measured_map(setup) if content["rig"] == "plate" else {}
        points = list(setup[content["x"]]) if "x" in content else [""]
        if content["rig"] == "plate":
            points = [f"beta {b:.0f}, gamma {g:.0f}" for b, g in np.degrees(rig.angles(setup)).T]
        found = []
        for q in content["quantities"]:
            name, unit = q["name"], UNITS[q["unit"]]
            measured = np.asarray(other[name] / unit if name in other else q["measured"], float)
            halves = [0.5 * (high[name] - low[name]) / unit for low, high in spans]
            scale = float(q.get("scale", rms(measured)))
            spread = np.asarray(q["uncertainty"], float) * (scale if q.get("relative") else 1.0)
            found.append(
                Comparison(
                    experiment=self.name,
                    quantity=name,
                    unit=q["unit"],
                    law=law,
                    points=points,
                    simulated=fine[name] / unit,
                    measured=measured,
                    numerical=np.abs(fine[name] - coarse[name]) / unit,
                    inputs=np.sqrt(np.sum(np.square(halves), axis=0)) + 0.0 * measured,
                    experimental=np.broadcast_to(spread, measured.shape),
                    scale=scale,
                )
            )
        return found


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def as_arrays(inputs: dict[str, Any]) -> dict[str, Any]:
    """Inputs with lists as arrays."""
    return {name: np.asarray(v, float) if isinstance(v, list) else v for name, v in inputs.items()}


def experiments() -> list[Experiment]:
    """All experiments of this folder, in the order that their files state."""
    found = []
    for path in files(__package__).iterdir():
        if path.name.endswith(".toml"):
            content = tomllib.loads(path.read_text(encoding="utf-8"))
            found.append(Experiment(path.name.removesuffix(".toml"), content))
    return sorted(found, key=lambda e: e.content["order"])
