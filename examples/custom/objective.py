"""An objective of your own: the work that the sand takes per metre of way, J/m."""

import numpy as np

import footopt as fo
from footopt.walk.objectives import objective


@objective("$|W|/x$", "J/m", maximise=False, worst=1e6)
def work_per_metre(raw, scene):
    """From the raw results of many walks, (designs,); NaN where there is no way forward."""
    return raw["work"] / np.where(raw["distance"] > 0.0, raw["distance"], np.nan)


if __name__ == "__main__":
    problem = fo.FootProblem(objective="work_per_metre", accuracy="draft")
    result = fo.search(problem, "memetic", pop_size=40, n_gen=15, seed=1)
    flat = fo.simulate(fo.Foot.flat(), accuracy="draft").objectives["work_per_metre"]
    best = result.column("work_per_metre")[result.best]
    print(f"flat {flat:.1f} J/m, best {best:.1f} J/m with k = {result.k[result.best].tolist()}")
