"""study=validate: experiments by other people, repeated without tuning: error, uncertainty, verdict.

As in ASME V&V 20 the error E = S - D, simulation less data, is held against the validation uncertainty u:
u^2 = u_num^2 + u_input^2 + u_exp^2. All uncertainties are standard ones. u_num is the change under
refinement, u_input the root sum of squares of half the change of S as each input goes from low to high.
"""

import tomllib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from importlib.resources import files
from typing import Any

import numpy as np
from rich.text import Text

from footopt.arrays import Array, Bools
from footopt.effects import EFFECTS
from footopt.report import terminal
from footopt.report.figures.studies import experiment, law_name, overview
from footopt.sand import Sand
from footopt.studies.runs import Study
from footopt.studies.validate import rig
from footopt.walk import Scene

HEAD = ("experiment", "quantity", "law", "E", "mean", "2 u", "verdict")
WORDS = ("experiment", "quantity", "law", "verdict")
#: How an experiment is predicted by the law that meets most of its quantities.
MET = ("in all quantities", "in some", "in none")

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
            found.append(Comparison(
                self.name, name, q["unit"], tuple(law), points, fine[name] / unit + none, measured,
                numerical=np.abs(fine[name] - coarse[name]) / unit + none,
                inputs=np.sqrt(np.sum(np.square(halves), axis=0)) + none,
                experimental=np.asarray(q["uncertainty"]) * (scale if q.get("relative") else 1.0) + none,
                scale=scale, inside=inside,
                apart=q.get("apart", ""),
            ))  # fmt: skip
        return found


def experiments() -> dict[str, Experiment]:
    """Return all experiments of this folder by name, in the order that their files state."""
    paths = [path for path in files(__package__).iterdir() if path.name.endswith(".toml")]
    texts = {path.name.removesuffix(".toml"): path.read_text(encoding="utf-8") for path in paths}
    found = [Experiment(name, tomllib.loads(text)) for name, text in texts.items()]
    return {e.name: e for e in sorted(found, key=lambda e: e.content["order"])}


def run(study: Study) -> None:
    """Repeat every experiment under its laws."""
    known = experiments()
    chosen = [known[name] for name in study.some_of(known)]
    found: list[Comparison] = []
    with study.progress(sum(len(e.content["laws"]) for e in chosen), "law") as step:
        for e in chosen:
            for law in e.content["laws"]:
                found += e.compare(law)
                step(news=f"{e.content['title']}, {law_name(law)}")
    titles = {e.name: e.content["title"] for e in chosen}
    judged = [c for c in found if not c.apart]
    caption = "Error of every comparison with a verdict, and the least error that it resolves."
    if judged:
        study.save("overview", lambda: overview(judged, titles), caption)
    for e in chosen:
        caption = f"{titles[e.name]}. {e.text('about')} {e.text('reading')} Source: {e.text('source')}."
        own = [c for c in found if c.experiment == e.name]
        study.save(e.name, partial(experiment, own, e.content.get("x", "")), caption)
    table = terminal.table(HEAD, WORDS)
    table.title = "E, simulation less data, and its uncertainty 2 u (ASME V&V 20), over the scale"
    for c in sorted(found, key=lambda c: bool(c.apart)):
        table.add_row(*(Text(cell, "bold" if c.verdict == DIFFERS else "") for cell in cells(c)))
    study.conclude(
        "The law against experiments",
        [table],
        {
            "counts": counts(found),
            "comparisons": [{**vars(c), "error": c.size, "verdict": c.verdict} for c in found],
        },
        summary=[summary(found)],
    )


def counts(found: Sequence[Comparison]) -> dict[str, int]:
    """Experiments by what their best law predicts."""
    agree: dict[str, dict[tuple[str, ...], list[bool]]] = {}
    for c in found:
        if not c.apart:
            agree.setdefault(c.experiment, {}).setdefault(c.law, []).append(c.verdict == AGREES)
    best = [max(sum(own) / len(own) for own in laws.values()) for laws in agree.values()]
    number_of = Counter(MET[0] if part == 1.0 else MET[1] if part else MET[2] for part in best)
    return {met: number_of[met] for met in MET}


def summary(found: Sequence[Comparison]) -> str:
    """The count of experiments."""
    own = counts(found)
    told = ", ".join(f"{number} {met}" for met, number in own.items())
    return f"Of {sum(own.values())} experiments with measured data the best of the laws predicts {told}."


def cells(c: Comparison) -> list[str]:
    """A comparison in tables: rms and mean of E, and 2 u, as parts of the scale."""
    size, bias, band = (100.0 * value / c.scale for value in (c.size, np.nanmean(c.error), c.band))
    shares = [f"{size:.0f} %", f"{round(bias):+d} %", f"{band:.0f} %"]
    return [c.experiment, c.quantity, law_name(c.law), *shares, c.verdict]
