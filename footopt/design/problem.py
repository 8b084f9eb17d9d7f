"""`FootProblem`: the walk as a pymoo problem with integer variables, the waypoints' heights."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.problem import Problem

from footopt.errors import check_kind
from footopt.foot import Waypoints
from footopt.walk.accuracy import Accuracy
from footopt.walk.objectives import FIVE, OBJECTIVES, Objective, lookup
from footopt.walk.scene import Scene
from footopt.walk.simulate import evaluate, resolve

Array = NDArray[np.float64]

#: Objectives by the name of a set; any sequence of names from `OBJECTIVES` will do as well.
SETS: dict[str, tuple[str, ...]] = {"efficiency": ("efficiency",), "pareto": FIVE}

#: What is recorded of every design, whatever is optimised: the paper's five and J_W.
RECORD = (*FIVE, "efficiency")


class FootProblem(Problem):  # type: ignore[misc]
    """Find waypoint heights k, whole numbers from 1 to K, that make a good foot.

    A vectorised pymoo problem: one call walks a whole population. All objectives are minimised
    (those to be maximised change sign); a failed walk gets each objective's worst value and
    violates the first constraint, a sole that leaves its box violates the second.

    Parameters
    ----------
    scene : where the feet walk. space : the waypoints' space, the paper's by default.
    objective : "efficiency" (the scalar J_W), "pareto" (the paper's five), one objective's name,
        or a sequence of names.
    accuracy : an `Accuracy` or a preset's name.
    threads : for one evaluation; by default as many as the process may run on.

    Notes
    -----
    ``out`` also carries, one row a design: ``values`` (natural signs, columns `record`; NaN for a
    failed walk), ``reasons`` and ``violation`` (of the box, m).
    """

    def __init__(
        self,
        scene: Scene | None = None,
        objective: str | Sequence[str] = "efficiency",
        space: Waypoints | None = None,
        accuracy: Accuracy | str = "standard",
        threads: int | None = None,
    ) -> None:
        self.scene = Scene() if scene is None else scene
        check_kind(self.scene, Scene, "scene", "Try fo.Scene(sand=...)")
        self.space = space or Waypoints()
        self.accuracy = resolve(accuracy)
        self.threads = threads
        self.scene.need_heel_strike()
        names = SETS.get(objective, (objective,)) if isinstance(objective, str) else tuple(objective)
        self.objectives: list[Objective] = lookup(names)
        self.record = (*RECORD, *(name for name in names if name not in RECORD))
        super().__init__(
            n_var=self.space.n,
            n_obj=len(self.objectives),
            n_ieq_constr=2,
            xl=1,
            xu=self.space.K,
            vtype=int,
        )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the objectives."""
        return tuple(o.name for o in self.objectives)

    @property
    def guide(self) -> str:
        """Name of the value that ranks designs: the single objective, or J_W when there are several."""
        return self.objectives[0].name if self.n_obj == 1 else "efficiency"

    @property
    def conditions(self) -> dict[str, Any]:
        """What is walked through: a store keeps it with the designs."""
        return {"scene": self.scene}

    def minimised(self, values: Array) -> Array:
        """Recorded values (designs, record), natural signs, as the F that is minimised."""
        columns = []
        for o in self.objectives:
            natural = values[:, self.record.index(o.name)]
            natural = np.where(np.isfinite(natural), natural, OBJECTIVES[o.name].worst)
            columns.append(-natural if o.maximise else natural)
        return np.stack(columns, axis=1)

    def walk(self, k: NDArray[np.int64]) -> tuple[Array, NDArray[np.str_]]:
        """Walk with designs (designs, n): recorded values (designs, record), and why a walk failed."""
        table = evaluate(k, self.scene, self.accuracy, self.record, self.space, self.threads)
        return table.values, table.reasons

    def judge(self, k: NDArray[np.int64], values: Array, reasons: NDArray[np.str_]) -> dict[str, Any]:
        """What pymoo is to know of walked designs: ``out`` of the notes above, with F and G."""
        violation = self.space.box_violation(k)
        box = violation / self.space.H - self.space.box_tolerance
        return {
            "F": self.minimised(values),
            "G": np.stack(
                [
                    np.where(reasons == "", -1.0, 1.0),
                    box if np.isfinite(self.space.box_tolerance) else np.full(len(k), -1.0),
                ],
                axis=1,
            ),
            "values": values,
            "reasons": reasons,
            "violation": violation,
        }

    def _evaluate(self, x: NDArray[Any], out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
        k = self.space.check(x)
        out.update(self.judge(k, *self.walk(k)))
