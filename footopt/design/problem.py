"""`FootProblem`: the design of a foot as a pymoo Problem with integer variables."""

from collections.abc import Mapping, Sequence
from copy import copy
from functools import partial
from typing import Any, NamedTuple, Self

import numpy as np
from pymoo.core.problem import Problem
from pymoo.core.variable import Integer

from footopt.arrays import Array, Bools, Ints, Words
from footopt.design.fronts import Choice, excess
from footopt.errors import check
from footopt.foot import Soles, Waypoints, as_space
from footopt.walk.accuracy import AnyAccuracy, resolve
from footopt.walk.ladder import numerics
from footopt.walk.objectives import FIVE, MEASURES, Objective, lookup, offered
from footopt.walk.simulate import as_simulator, evaluated
from footopt.walk.simulator import Simulator

#: Objectives by the name of a set; any sequence of names from `MEASURES` will do as well.
SETS: dict[str, tuple[str, ...]] = {"efficiency": ("efficiency",), "pareto": FIVE}

KNOWN = "known"  # in an algorithm's data: the designs so far, `Known`
#: Recorded of every design, whatever is optimised: the paper's five and J_W.
RECORD = (*FIVE, "efficiency")


class Evaluated(NamedTuple):
    """Evaluated designs, a row each."""

    values: Array  # (designs, record), with their natural signs; NaN for a failed walk
    reasons: Words  # (designs,), why a walk failed, or ""
    violation: Array  # (designs,), m, how far the sole leaves its box


class FootProblem(Problem):
    """Find waypoint heights k, whole numbers from 1 to K, that make a good foot.

    It is a pymoo Problem: ``pymoo.optimize.minimize(fo.FootProblem(scene), GA(...))`` works. One call walks
    a whole population. Designs are rounded to whole numbers within their bounds, so that algorithms over
    real numbers work at their defaults, and mixed-variable ones find integers in `vars`. F is `minimised`
    and G `constraints`, which are met where at most 0; beside them ``out`` has the fields of `Evaluated`.
    `fo.search` does more: it keeps every design, walks none twice, resumes, and uses any executor.

    Parameters
    ----------
    scene : Scene or Simulator, optional
        Where the feet walk: the paper's walk on hard sand by default, or under a robot.
    objective : str or sequence of str
        "efficiency" (the scalar J_W), "pareto" (the paper's five), one objective's name, or several.
    space : Waypoints, optional
        The soles to choose from; by default the paper's.
    accuracy : Accuracy or str
        Of the walks; a preset's name will do.
    threads : int, optional
        For one evaluation; by default as many as the process may run on.
    limits : dict of str to float, optional
        Of any measures: the largest value of one that is minimised ("peak_power", "hollow"), the smallest
        of one that is maximised ("distance", "thickness").
    choose : Choice or str
        Which design of a front is the best where there are several objectives.

    Raises
    ------
    SettingError
        The walk ends before its first heel strike, or an objective or a limit is not known.
    """

    def __init__(
        self,
        scene: Simulator | None = None,
        objective: str | Sequence[str] = "efficiency",
        space: Waypoints | None = None,
        accuracy: AnyAccuracy | str = "standard",
        threads: int | None = None,
        limits: Mapping[str, float] | None = None,
        choose: Choice | str = "knee",
    ) -> None:
        self.scene = as_simulator(scene)
        self.space = as_space(space)
        self.accuracy: AnyAccuracy = resolve(accuracy)
        self.threads = threads
        self.scene.check_comparable()
        names = SETS.get(objective, (objective,)) if isinstance(objective, str) else tuple(objective)
        self.objectives: list[Objective] = lookup(names, self.scene)
        known = offered(self.scene)
        self.limits = dict(limits or {})
        for name, limit in self.limits.items():
            check(name in known, "constraint", name, f"one of {', '.join(known)}")
            MEASURES[name].check_limit(f"constraint.{name}", limit)
        self.choice = choose if isinstance(choose, Choice) else Choice(choose)
        self.choice.check_names(self.names, known)
        usual = (name for name in RECORD if name in known)
        self.record = tuple(dict.fromkeys((*usual, *names, *self.limits)))
        self._sought = [self.record.index(name) for name in names]
        n, K = self.space.n, self.space.K
        variables = {f"k{i + 1}": Integer(bounds=(1, K)) for i in range(n)}
        super().__init__(n, len(names), 2 + len(self.limits), xl=1, xu=K, vtype=int, vars=variables)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the objectives."""
        return tuple(o.name for o in self.objectives)

    @property
    def ranking_objective(self) -> str:
        """Name of the value that ranks designs: the single objective, or J_W when there are several.

        The first one where a simulator has no J_W.
        """
        return self.names[0] if len(self.names) == 1 or "efficiency" not in self.record else "efficiency"

    @property
    def conditions(self) -> dict[str, Any]:
        """All that determines how a design walks: a store keeps it with the designs."""
        return {"scene": self.scene}

    def at(self, accuracy: AnyAccuracy) -> Self:
        """The same problem, evaluated at another accuracy."""
        other = copy(self)
        other.accuracy = accuracy
        return other

    def inside(self, k: Ints) -> Bools:
        """Which designs (designs, n) are inside their box: moves by runs propose no others."""
        return self.space.inside(k)

    def _evaluate(self, x: Any, out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
        k = as_heights(x, self)
        found = self.evaluate_designs(k)
        out.update(found._asdict(), F=self.minimised(found.values), G=self.constraints(*found))
        if np.ndim(x) == 2 and (k != x).any():  # a population holds the soles that have walked
            out["X"] = k

    def evaluate_designs(self, k: Any) -> Evaluated:
        """Walk with designs, (designs, n) heights; `SettingError` names a height that cannot be."""
        k = self.space.check(k)
        if not len(k):
            return Evaluated(np.empty((0, len(self.record))), np.empty(0, np.str_), np.empty(0))
        return Evaluated(*self.walk(k), self.space.box_violation(k))

    def walk(self, k: Ints) -> tuple[Array, Words]:
        """Walk with designs (designs, n): recorded values (designs, record), and why a walk failed."""
        soles, accuracy = Soles(k, self.space), numerics(self.accuracy, self.scene, self.space)
        table = evaluated(soles, self.scene, accuracy, self.record, self.threads)
        return table.values, table.reasons

    def column(self, values: Array, name: str) -> Array:
        """A recorded value by its name, (...), of values (..., record)."""
        return np.asarray(values[..., self.record.index(name)])

    def minimised(self, values: Array) -> Array:
        """F (designs, objectives) of values (designs, record); each objective's worst for a failed walk."""
        natural = values[:, self._sought]
        signs, worst = np.array([(o.sign, o.worst) for o in self.objectives], float).T
        return np.asarray(signs * np.where(np.isfinite(natural), natural, worst))

    def constraints(self, values: Array, reasons: Words, violation: Array) -> Array:
        """G of `Evaluated`, (designs, n_ieq_constr), met where at most 0.

        The walk succeeds, with all objectives; the sole stays in its box (in H); all `limits` are kept.
        """
        known = np.isfinite(values[:, self._sought]).all(axis=1)
        failed = np.where((reasons == "") & known, -1.0, 1.0)
        tolerance = self.space.box_tolerance
        box = violation / self.space.H - tolerance if np.isfinite(tolerance) else np.full_like(failed, -1.0)
        limits = [excess(name, limit, self.column(values, name)) for name, limit in self.limits.items()]
        return np.stack([failed, box, *limits], axis=1)

    def feasible(self, values: Array, reasons: Words, violation: Array) -> Bools:
        """Which designs meet all constraints, (designs,)."""
        return np.asarray((self.constraints(values, reasons, violation) <= 0.0).all(axis=1))

    def reasons(self, values: Array, reasons: Words, violation: Array) -> Words:
        """Why designs are infeasible, (designs,): their walk, "no value", "box", the first limit; or ""."""
        broken = self.constraints(values, reasons, violation) > 0.0
        names = np.array(["", "no value", "box", *self.limits])
        first = names[np.where(broken.any(axis=1), 1 + broken.argmax(axis=1), 0)]
        return np.where(reasons != "", reasons, first)

    def scores(self, values: Array) -> Array:
        """Designs (designs, record) of a front, or of one objective: the smaller, the better, (designs,)."""
        if self.n_obj == 1:
            scores = self.objectives[0].sign * self.column(values, self.names[0])
        else:
            scores = self.choice.scores(self.minimised(values), self.names, partial(self.column, values))
        return np.where(np.isfinite(scores), scores, np.inf)


def as_heights(X: Any, problem: Problem) -> Ints:
    """An algorithm's proposals as heights (designs, n): rounded, within bounds, dictionaries as rows."""
    X = [X] if isinstance(X, dict) else X  # of one individual
    if len(X) and isinstance(X[0], dict):
        X = [[row[name] for name in problem.vars] for row in X]
    rows = np.asarray(X, float).reshape(-1, problem.n_var)
    return np.clip(np.round(rows), problem.xl, problem.xu).astype(np.int64)


class Known(dict[bytes, int]):
    """Designs by their heights, with their places in the order in which they were added."""

    def places(self, k: Ints) -> Ints:
        """The place of each of some designs (designs, n), -1 where there is none."""
        return np.array([self.get(key, -1) for key in rows_as_bytes(k)], np.int64)

    def fresh(self, k: Ints) -> Ints:
        """The rows of those of some designs (designs, n) that are not known, each once, in their order."""
        keys = rows_as_bytes(k)
        # of equal rows, the first one is set last
        first = dict(zip(reversed(keys), range(len(keys) - 1, -1, -1), strict=True))
        for known in first.keys() & self.keys():
            del first[known]
        return np.sort(np.fromiter(first.values(), np.int64, len(first)))

    def add(self, k: Ints) -> None:
        """Add designs (designs, n) that are `fresh`."""
        keys = rows_as_bytes(k)
        self.update(zip(keys, range(len(self), len(self) + len(keys)), strict=True))


def rows_as_bytes(rows: Array | Ints, kind: str = "<i4") -> list[bytes]:
    """Rows of numbers of a kind (numpy's), such as heights, as bytes: to find them by, and to store."""
    columns = np.ascontiguousarray(np.atleast_2d(rows), kind)
    return columns.view(f"V{columns.itemsize * columns.shape[1]}").ravel().tolist()
