"""The best foot of a search under every law that sand may follow, and the foot to print."""

from dataclasses import replace
from typing import Any

import numpy as np

from footopt.design import Confirmation, FootProblem, SearchResult
from footopt.design.laws import REACH, UnderLaws, better_zetas, candidates, possible_laws, under_laws
from footopt.foot import Foot
from footopt.report import terminal
from footopt.report.numbers import percent
from footopt.report.output import foot_entry
from footopt.studies.runs import Study


def evaluated(study: Study, result: SearchResult, confirmed: Confirmation) -> UnderLaws:
    """The finalists, soles that should lose little under every law, and the flat one, under every law."""
    problem, options = result.problem, study.options
    laws = possible_laws(problem.scene, study.config.sand.spread)
    feet = [result.k[confirmed.designs[: options.finalists]]]
    with study.compiling("a walk for each law"):
        if options.laws is not None and len(laws) > 1 and problem.n_obj == 1 and not result.interrupted:
            study.say(f"Searching the foot to print, which loses least under the worst of {len(laws)} laws")
            with study.executor() as executor:
                store = options.store or study.folder / "designs.sqlite"
                feet.append(candidates(result, laws, options.laws, store=store, executor=executor))
        feet.append(np.full((1, problem.space.n), problem.space.K))
        return under_laws(problem.at(study.finer_accuracy), laws, np.concatenate(feet))


def to_print(problem: FootProblem, k: Any) -> Foot:
    """The foot to print, of heights (n,)."""
    return replace(Foot.from_waypoints(k, problem.space), name="to print")


def entry(problem: FootProblem, under: UnderLaws, printed: int | None) -> dict[str, Any]:
    """The laws in result.json: the best foot under each, the scene's own first, and the foot to print."""
    single = len(under.laws) > 1 and problem.n_obj == 1
    found = {
        "laws": under.entry(0),
        "better_than_flat_zeta": better_zetas(problem, under.k[0], under.k[-1]) if single else None,
    }
    if printed is None:
        return found
    foot = {
        **foot_entry(to_print(problem, under.k[printed])),
        "laws": under.entry(printed),
        "worst_loss": float(under.worst[printed]),
        "worst_loss_of_best": float(under.worst[0]),
    }
    return found | {"to_print": foot}


def describe(
    problem: FootProblem, under: UnderLaws, printed: int | None, record: dict[str, Any]
) -> list[str]:
    """How sure it is that the best foot is better than the flat one, and the foot to print."""
    if problem.n_obj > 1 or len(under.laws) < 2:
        return []
    name = problem.ranking_objective
    better = sum(int(losses[0] < losses[-1]) for losses in under.losses)
    where = _zetas(problem, record["better_than_flat_zeta"])
    told = [f"It is better than the flat foot under {better} of {len(under.laws)} laws{where}."]
    if printed is None:
        return told
    best, most = (percent(under.worst[i]) for i in (0, printed))
    if printed == 0:
        return [*told, f"To print: this foot. It loses at most {most} to the best one known under each law."]
    foot, changes = to_print(problem, under.k[printed]), under.entry(printed)[0]["change"]
    gain = terminal.headline(name, 1.0 + changes[name], 1.0, under.range_of(printed))
    return [
        *told,
        f"To print: {terminal.describe_foot(foot)}; {gain}",
        f"It loses at most {most} to the best foot known under each law; the one above loses {best}.",
    ]


def _zetas(problem: FootProblem, better: tuple[float | None, float | None] | None) -> str:
    """On which sand the best foot is better than the flat one by the run's own law; "" if it is not."""
    if better is None:
        return ""
    scene: Any = problem.scene
    low, high = (end and f"{end:.2g}" for end in better)
    if low and high:
        where = f"from zeta {low} to {high}"
    elif low or high:
        where = f"from zeta {low} on" if low else f"up to zeta {high}"
    else:
        where = f"at every zeta from {scene.sand.zeta / REACH:.2g} to {scene.sand.zeta * REACH:.2g}"
    return f", and by its own law {where}"
