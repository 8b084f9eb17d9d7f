"""The best foot of a search under every law that sand may follow, and the foot to print."""

from dataclasses import replace
from typing import Any, NamedTuple

from footopt.design import Confirmation, SearchResult, UnderLaws, under_laws
from footopt.design.laws import REACH, better_zetas, compare
from footopt.foot import Foot
from footopt.report import terminal
from footopt.report.numbers import change, number, percent, title
from footopt.report.output import foot_entry
from footopt.studies.runs import Study


class Laws(NamedTuple):
    """What is known of the best foot under other laws; all is empty where it is evaluated under none."""

    entry: dict[str, Any]  # in result.json
    ranges: dict[str, list[float]]  # of the best foot's changes from the flat one under the others, by name
    rank: str  # under how many laws, and at which zetas, it is better than the flat one; ends with a space
    to_print: Foot | None = None  # the foot that loses least under the worst law
    printed: tuple[str, ...] = ()  # that foot in two lines; in one if it is the best one


def evaluated(study: Study, result: SearchResult, confirmed: Confirmation) -> Laws:
    """The best foot, soles that should lose little under every law, and the flat one, under every law."""
    problem, under, rank, zetas = result.problem, _under(study, result, confirmed), "", None
    if len(under.laws) > 1 and problem.n_obj == 1:
        zetas = better_zetas(problem, under.k[0], under.k[-1])
        count = sum(int(losses[0] < losses[-1]) for losses in under.losses)
        rank = f"Beats flat under {count} of {len(under.laws)} laws{_at(zetas, problem.scene)}. "
    found = Laws({"laws": under.entry(0), "better_than_flat_zeta": zetas}, under.range_of(0), rank)
    chosen = None if study.options.laws is None else under.steadiest
    if chosen is None:
        return found
    foot = replace(Foot.from_waypoints(under.k[chosen], problem.space), name="to print")
    laws, name = under.entry(chosen), problem.ranking_objective
    worst, of_best = float(under.worst[chosen]), float(under.worst[0])
    losses = {"worst_loss": worst, "worst_loss_of_best": of_best}
    entry = found.entry | {"to_print": {**foot_entry(foot), "laws": laws, **losses}}
    same = f"To print: this foot. It loses at most {percent(worst)} to the best one known under each law."
    if chosen == 0:
        return found._replace(entry=entry, to_print=foot, printed=(same,))
    own, *others = (law["change"][name] for law in laws)
    gain = f"{title(name)} {change(name, 1.0 + own, 1.0)} ({terminal.span(name, others)})"
    told = f"{gain}; loses at most {percent(worst)} under any law, the first {percent(of_best)}."
    lines = (f"To print, chosen for all {len(laws)} laws: {terminal.describe_foot(foot)}", told)
    return found._replace(entry=entry, to_print=foot, printed=lines)


def _under(study: Study, result: SearchResult, confirmed: Confirmation) -> UnderLaws:
    """The feet under every law."""
    options, share = study.options, None if result.interrupted else study.options.laws
    if not (study.wants_report and options.confirm):
        return compare(result.problem, (), result.k[confirmed.designs[:1]])
    if share is not None and result.problem.n_obj == 1:
        study.say("Searching the foot to print, which loses least under the worst law")
    store = options.store or study.folder / "designs.sqlite"
    with study.executor() as executor, study.compiling("a walk for each law"):
        return under_laws(result, confirmed, study.config.sand.spread, share, store, executor)


def _at(zetas: tuple[float | None, float | None] | None, scene: Any) -> str:
    """On which sand the best foot is better than the flat one by the scene's own law; "" if it is not."""
    if zetas is None:
        return ""
    ends = *zetas, scene.sand.zeta / REACH, scene.sand.zeta * REACH
    low, high, least, most = (end and number(float(f"{end:.2g}")) for end in ends)
    if low and high:
        return f", for zeta {low} to {high}"
    if low or high:
        return f", for zeta >= {low}" if low else f", for zeta <= {high}"
    return f", for every zeta from {least} to {most}"
