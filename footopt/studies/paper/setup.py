"""The paper's walks and searches for one configuration, and how much is searched."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from footopt.design import WALKS, Solver, search
from footopt.design.context import context, digest, plain
from footopt.effects import Effect, Footprints, LeadingEdge, Shadowing
from footopt.effects.shadowing import HULLS
from footopt.errors import SettingError, check
from footopt.foot import Foot
from footopt.sand import Sand
from footopt.studies import build
from footopt.studies.paper.claims import SANDS, Evidence
from footopt.studies.paper.quantities import filled
from footopt.studies.paper.readings import Readings, ReadProblem
from footopt.studies.paper.shapes import make_shapes
from footopt.studies.settings import Config
from footopt.walk import Accuracy, Scene, Walk, simulate

SOLVER = "ga"  # the paper's
QUICK_SEARCH, QUICK_SAMPLES = (20, 6), 4


def changed(config: Config, settings: Mapping[str, Any]) -> Config:
    """Return the configuration with some settings changed; the one given is left alone."""
    for setting, value in settings.items():
        group, name = setting.split(".")
        part = dataclasses.replace(getattr(config, group), **{name: value})
        config = dataclasses.replace(config, **{group: part})
    return config


def affordable(config: Config) -> Config:
    """Return the settings, checked, with fewer searches and combinations for a quick first look."""
    s = config.study
    check(1 <= s.seeds <= 1000, "study.seeds", s.seeds, "a whole number >= 1 and <= 1000")
    check(0 <= s.samples <= 10_000, "study.samples", s.samples, "a whole number from 0 (no sweep) to 10,000")
    solver = Solver(SOLVER, config.solver.pop_size, config.solver.n_gen, config.solver.seed)
    pop_size, n_gen = QUICK_SEARCH if s.quick else (solver.size, solver.n_gen or WALKS // solver.size)
    config = changed(config, {"solver.pop_size": pop_size, "solver.n_gen": n_gen})
    if not s.quick:
        return config
    few = {"study.seeds": 1}
    return changed(config, few | {"study.samples": min(s.samples, QUICK_SAMPLES)})


@dataclass(frozen=True, eq=False)
class Setup:
    """The library's own objects for one configuration."""

    config: Config

    @cached_property
    def readings(self) -> Readings:
        """How p_max and dV_x are read."""
        return Readings.of(self.config.study)

    @cached_property
    def accuracy(self) -> Accuracy:
        """Accuracy of the walks that claims are measured on."""
        confirm = self.config.study.confirm
        return Accuracy.named(confirm) if confirm else build.make_accuracy(self.config.accuracy)

    @cached_property
    def _scene(self) -> Scene:
        return build.make_scene(self.config)  # its files are read once for all sands

    def scene(self, sand: str) -> Scene:
        """Return the scene on one of the sands."""
        if sand not in SANDS:
            raise SettingError("study.shape_sand", sand, f"one of {', '.join(SANDS)}")
        scene = dataclasses.replace(self._scene, sand=Sand.named(sand))
        study = self.config.study
        on: list[Effect] = [LeadingEdge()] if study.leading_edge else []
        if study.shadowing is not None:
            check(
                study.shadowing in HULLS,
                "study.shadowing",
                study.shadowing,
                f"null, or one of {', '.join(HULLS)}",
            )
            on.append(Shadowing(hull=study.shadowing))
        on += [Footprints()] if study.footprints else []
        return dataclasses.replace(scene, effects=(*scene.effects, *on))

    def shapes(self) -> dict[str, Walk]:
        """Walk with the five shapes."""
        scene = self.scene(self.config.study.shape_sand)
        feet = make_shapes(self.config)
        return {name: simulate(foot, scene, self.accuracy) for name, foot in feet.items()}

    def problem(self, sand: str) -> ReadProblem:
        """Return what the GA searches for a sand."""
        return ReadProblem(
            self.readings,
            scene=self.scene(sand),
            space=build.make_space(self.config.foot),
            accuracy=build.make_accuracy(self.config.accuracy),
            threads=self.config.engine.threads,
        )

    def best(self, sand: str, seed: int) -> Foot:
        """Return the best foot that one run of the GA finds."""
        solver = self.config.solver
        return search(self.problem(sand), Solver(SOLVER, solver.pop_size, solver.n_gen, seed)).foot

    def heights(self, sand: str, seed: int) -> list[int]:
        """Return its heights."""
        return [int(height) for height in self.best(sand, seed).k or ()]

    def named(self, sand: str) -> str:
        """Return a digest of all that walks and searches on a sand depend on but the seed."""
        return digest([context(self.problem(sand)), plain(self.config)])

    def walk(self, foot: Foot, sand: str) -> Walk:
        """Walk with a foot on a sand, at the accuracy that claims are measured with."""
        return simulate(foot, self.scene(sand), self.accuracy)

    def evidence(self, feet: Mapping[str, Foot]) -> Evidence:
        """Walk all that claims need, with the best foot of each sand."""
        return Evidence(
            shapes=self.shapes(),
            optima={sand: self.walk(feet[sand], sand) for sand in SANDS},
            crossed=self.walk(feet["regular"], "hard"),
            filled=self.walk(filled(feet["hard"]), "hard"),
            readings=self.readings,
        )
