"""The comparison of ASME V&V 20: error E = S - D against the validation uncertainty u.

S is the simulation, D the data, and u^2 = u_num^2 + u_input^2 + u_exp^2. All uncertainties are standard
ones. u_num is the change under refinement, u_input the root sum of squares of half the change of S as each
input goes from its low to its high value.
"""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

import numpy as np

from footopt.arrays import Array, Bools
from footopt.effects import EFFECTS
from footopt.sand import Sand
from footopt.studies.validation import rig
from footopt.walk import Scene

COVERAGE = 2.0  # of u: an error beyond it is the model's
COARSE = 0.5  # of the data's scale: where COVERAGE u is more, agreement says nothing

#: Units of the files in SI.
UNITS = {"mm": 1e-3, "N": 1.0, "N/cm3": 1e6, "1": 1.0, "body weights": 1.0}

AGREES, DIFFERS, OPEN = "agrees", "differs", "undecided"


def rms(values: Array) -> float:
    """Return the root mean square of those that are not NaN."""
    return float(np.sqrt(np.nanmean(np.square(values))))


@dataclass(frozen=True, eq=False)
class Comparison:
    """One quantity of an experiment under one law, at M points, in the quantity's unit."""

    experiment: str
    quantity: str
    unit: str
    law: tuple[str, ...]  # the effects that are on
    points: Sequence[Any]  # of the experiment's x: numbers, names, or pairs of angles
    simulated: Array  # (M,), S
    measured: Array  # (M,), D
    numerical: Array  # (M,), u_num
    inputs: Array  # (M,), u_input
    experimental: Array  # (M,), u_exp
    scale: float  # to which errors are related: the rms of D, or the file's own
    inside: Bools | bool = True  # (M,), points within the range that the law was made for
    apart: str = ""  # why there is no verdict

    @property
    def error(self) -> Array:
        """E = S - D, (M,); NaN outside the range that the law was made for."""
        return np.where(self.inside, self.simulated - self.measured, np.nan)

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
        return float(np.nanmean(self.error))

    @property
    def band(self) -> float:
        """`COVERAGE` times the root mean square of u."""
        return COVERAGE * rms(np.where(self.inside, self.uncertainty, np.nan))

    @property
    def bar(self) -> Array:
        """`COVERAGE` times the data's uncertainty, (M,)."""
        return COVERAGE * self.experimental

    @property
    def spread(self) -> Array:
        """`COVERAGE` times the uncertainty of the prediction, (M,)."""
        return COVERAGE * np.hypot(self.numerical, self.inputs)

    @property
    def verdict(self) -> str:
        """Whether the error is larger than the band, or the band too wide to say more."""
        if self.apart:
            return self.apart
        if self.size > self.band:
            return DIFFERS
        return OPEN if self.band > COARSE * self.scale else AGREES


@dataclass(frozen=True, eq=False)
class Experiment:
    """One file of this folder; see `wheel_driven.toml` for its entries."""

    name: str
    content: dict[str, Any]

    def text(self, part: str) -> str:
        """Return a text of the file in one line."""
        return " ".join(self.content[part].split())

    def compare(self, law: Sequence[str]) -> list[Comparison]:
        """Repeat it under a law: the names of the effects that are on."""
        content, inputs, quantities = self.content, self.content.get("inputs", {}), self.content["quantities"]
        values = {q["name"]: np.asarray(q["measured"], float) for q in quantities}
        si = {q["name"]: values[q["name"]] * UNITS[q["unit"]] for q in quantities}
        setup = {**content.get("setup", {}), "measured": si}
        own = content.get("effects", {})
        effects = tuple(EFFECTS[name](**own.get(name, {})) for name in law)

        def run(fine: bool = False, changed: str = "", end: str = "value") -> dict[str, Any]:
            given = {name: np.asarray(part[end if name == changed else "value"], float)
                     for name, part in inputs.items()}  # fmt: skip
            scene = Scene(Sand(zeta=float(given.get("zeta", 1.0))), effects=effects)
            return rig.RIGS[content["rig"]](setup, given, scene, fine)

        coarse, fine = run(), run(fine=True)
        spans = [(run(changed=name, end="low"), run(changed=name, end="high")) for name in inputs]
        points = setup[content["x"]] if "x" in content else [""]
        found, none = [], np.zeros(len(points))
        inside = np.array([point not in content.get("outside", []) for point in points])
        for q in quantities:
            name, unit = q["name"], UNITS[q["unit"]]
            measured = values[name]
            scale = float(q.get("scale", rms(np.where(inside, measured, np.nan))))
            halves = [0.5 * (high[name] - low[name]) / unit for low, high in spans]
            comparison = Comparison(
                self.name, name, q["unit"], tuple(law), points, fine[name] / unit + none, measured,
                numerical=np.abs(fine[name] - coarse[name]) / unit + none,
                inputs=np.sqrt(np.sum(np.square(halves), axis=0)) + none,
                experimental=np.asarray(q["uncertainty"]) * (scale if q.get("relative") else 1.0) + none,
                scale=scale, inside=inside,
                apart=q.get("apart", ""),
            )  # fmt: skip
            found.append(comparison)
        return found


def experiments() -> dict[str, Experiment]:
    """Return all experiments of this folder by name, in the order that their files state."""
    paths = [path for path in files(__package__).iterdir() if path.name.endswith(".toml")]
    texts = {path.name.removesuffix(".toml"): path.read_text(encoding="utf-8") for path in paths}
    found = [Experiment(name, tomllib.loads(text)) for name, text in texts.items()]
    return {e.name: e for e in sorted(found, key=lambda e: e.content["order"])}
