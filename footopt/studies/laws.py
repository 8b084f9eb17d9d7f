"""The best foot of a search under every law that sand may follow, and the foot to print."""

from dataclasses import replace
from typing import Any

from footopt.design import Confirmation, FootProblem, SearchResult
from footopt.design.laws import REACH, UnderLaws, better_zetas, under_laws
from footopt.foot import Foot
from footopt.report import terminal
from footopt.report.numbers import change, number, percent, title
from footopt.report.output import foot_entry
from footopt.studies.runs import Study


def evaluated(study: Study, result: SearchResult, confirmed: Confirmation) -> UnderLaws:
    """The best foot, soles that should lose little under every law, and the flat one, under every law."""
    options, share = study.options, None if result.interrupted else study.options.laws
    if share is not None and result.problem.n_obj == 1:
        study.say("Searching the foot to print, which loses least under the worst law")
    store = options.store or study.folder / "designs.sqlite"
    with study.executor() as executor, study.compiling("a walk for each law"):
        return under_laws(result, confirmed, study.config.sand.spread, share, store, executor)


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


def describe_rank(problem: FootProblem, under: UnderLaws, better: Any) -> str:
    """Under how many laws, and at which zetas, the best foot is better than the flat one, with a space."""
    if problem.n_obj > 1 or len(under.laws) < 2:
        return ""
    count = sum(int(losses[0] < losses[-1]) for losses in under.losses)
    return f"Better than flat under {count} of {len(under.laws)} laws{_zetas(problem, better)}. "


def describe_printed(problem: FootProblem, under: UnderLaws, printed: int) -> list[str]:
    """The foot to print, in two lines; in one if it is the best one."""
    best, most = (percent(under.worst[i]) for i in (0, printed))
    if printed == 0:
        return [f"To print: this foot. It loses at most {most} to the best one known under each law."]
    name = problem.ranking_objective
    own, *others = (law["change"][name] for law in under.entry(printed))
    gain = f"{title(name)} {change(name, 1.0 + own, 1.0)} ({terminal.span(name, others)})"
    return [
        f"To print: {terminal.describe_foot(to_print(problem, under.k[printed]))}",
        f"{gain}; loses at most {most} under any law, the foot above {best}.",
    ]


def _zetas(problem: FootProblem, better: tuple[float | None, float | None] | None) -> str:
    """On which sand the best foot is better than the flat one by the run's own law; "" if it is not."""
    if better is None:
        return ""
    scene: Any = problem.scene
    low, high = (end and _two_digits(end) for end in better)
    if low and high:
        return f", from zeta {low} to {high}"
    if low or high:
        return f", from zeta {low} on" if low else f", up to zeta {high}"
    least, most = map(_two_digits, (scene.sand.zeta / REACH, scene.sand.zeta * REACH))
    return f", at every zeta from {least} to {most}"


def _two_digits(zeta: float) -> str:
    return number(float(f"{zeta:.2g}"))
