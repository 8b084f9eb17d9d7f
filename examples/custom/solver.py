"""A solver of your own: hill climbing with random restarts, as many climbers as designs in a generation.

A climber tries one waypoint a step up or down and keeps what is better; after 30 misses it starts anew.
"""

import numpy as np
from pymoo.core.algorithm import Algorithm
from pymoo.core.population import Population

import footopt as fo
from footopt.design.solvers import register


class HillClimbing(Algorithm):
    def _initialize_infill(self):
        self.x = np.zeros((self.climbers, self.problem.n_var), int)
        self.cost, self.misses = np.full(self.climbers, np.inf), np.full(self.climbers, 30)
        return self._infill()

    def _infill(self):
        draw, low, high, step = self.random_state, self.problem.xl, self.problem.xu, self.x.copy()
        some, anew = draw.integers(step.shape[1], size=len(step)), draw.integers(low, high + 1, step.shape)
        step[np.arange(len(step)), some] += draw.choice([-1, 1], len(step))
        return Population.new(X=np.where(self.misses[:, None] < 30, np.clip(step, low, high), anew))

    def _advance(self, infills=None, **kwargs):
        self.pop, cost = infills, infills.get("F")[:, 0] + 1e9 * infills.get("CV")[:, 0]
        better = (self.misses >= 30) | (cost < self.cost)
        self.x[better], self.cost[better] = infills.get("X")[better], cost[better]
        self.misses = np.where(better, 0, self.misses + 1)

    _initialize_advance = _advance


def hill_climbing(solver, n_obj):
    algorithm = HillClimbing()
    algorithm.climbers = solver.size
    return algorithm


register(hill_climbing, single=True)

if __name__ == "__main__":
    result = fo.search(fo.FootProblem(accuracy="draft"), "hill_climbing", pop_size=40, n_gen=50, seed=1)
    print(f"best {result.foot.name}: J_W {result.column('efficiency')[result.best]:.4g}")
