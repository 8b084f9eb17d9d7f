"""At home in pymoo: its algorithms take a problem, its tools a result, and a search takes its algorithms."""

import pickle
from importlib import import_module

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.core.evaluator import Evaluator
from pymoo.core.mixed import MixedVariableGA
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.decomposition.asf import ASF
from pymoo.optimize import minimize
from pymoo.termination import get_termination
from pymoo.util.ref_dirs import get_reference_directions
from searching import SMALL, assert_same, problem

from footopt.design import FootProblem, search
from footopt.design.fronts import nondominated
from footopt.design.solvers import WALKS, Solver, memetic
from footopt.design.solvers.memetic import Archive, Memetic
from footopt.errors import SettingError
from footopt.foot import Waypoints

WAYS = get_reference_directions("das-dennis", 2, n_partitions=11)
#: Algorithms of one objective, and of several, of pymoo 0.6.2 that take constraints, at their defaults; not
#: the three that are imported, or compiled, for many seconds.
SINGLE = (
    "ga:GA de:DE pso:PSO pso_ep:EPPSO es:ES cmaes:CMAES cmaes:BIPOPCMAES cmaes:SimpleCMAES nelder:NelderMead "
    "pattern:PatternSearch brkga:BRKGA g3pcx:G3PCX isres:ISRES sres:SRES direct:DIRECT nrbo:NRBO "
    "random_search:RandomSearch ga_niching:NicheGA"
)
SEVERAL = (
    "nsga2:NSGA2 nsga3:NSGA3 unsga3:UNSGA3 rnsga2:RNSGA2 rnsga3:RNSGA3 sms:SMSEMOA spea2:SPEA2 rvea:RVEA "
    "ctaea:CTAEA cmopso:CMOPSO mopso_cd:MOPSO_CD gde3:GDE3 gde3:GDE32NN gde3:GDE3MNN gde3:GDE3PCD nsde:NSDE "
    "nsder:NSDER omni:OmniOptimizer pinsga2:PINSGA2"
)
UNCONSTRAINED = "moead:MOEAD moead:ParallelMOEAD dnsga2:DNSGA2"
POINTS = np.zeros((1, 2))
ASKS = {  # what has no default
    **{module: {"ref_dirs": WAYS} for module in ("nsga3", "unsga3", "rvea", "ctaea", "nsder", "moead")},
    "rnsga2": {"ref_points": POINTS},
    "rnsga3": {"ref_points": POINTS, "pop_per_ref_point": 20},
}


def built(kind, path):
    """The algorithm at a path below `pymoo.algorithms`, at its defaults."""
    module, name = path.split(":")
    return getattr(import_module(f"pymoo.algorithms.{kind}.{module}"), name)(**ASKS.get(module, {}))


def check_found(p, x, f):
    """What an algorithm found are whole numbers, with the values of these."""
    x = list(x.values()) if isinstance(x, dict) else x  # of mixed variables
    k = np.atleast_2d(x).astype(float)
    assert (k == np.round(k)).all()
    np.testing.assert_array_equal(p.minimised(p.evaluate_designs(k).values), np.atleast_2d(f))


@pytest.mark.parametrize("path", SINGLE.split())
def test_an_algorithm_of_one_objective_works_at_its_defaults(path):
    p, algorithm = problem(), built("soo.nonconvex", path)
    found = minimize(p, algorithm, ("n_eval", 30), seed=1)
    check_found(p, found.X, found.F)
    ours = search(p, algorithm, walks=30, seed=1)
    assert ours.solver.name == type(algorithm).__name__
    assert 0 < ours.designs <= 30
    check_found(p, ours.X, ours.F)


@pytest.mark.parametrize("path", SEVERAL.split())
def test_an_algorithm_of_several_objectives_works_at_its_defaults(path):
    p, algorithm = problem(["distance", "work"]), built("moo", path)
    found = minimize(p, algorithm, ("n_gen", 2), seed=1)
    check_found(p, found.X, found.F)
    ours = search(p, algorithm, n_gen=2, seed=1)
    check_found(p, ours.X, ours.F)


@pytest.mark.parametrize("path", ["soo.nonconvex.pso.PSO", "moo.ctaea.CTAEA"])
def test_it_goes_by_its_path_on_the_command_line_too(path):
    """With as many designs a generation as are asked for, and directions where it needs them."""
    several = path.startswith("moo.")
    r = search(problem(["distance", "work"] if several else "work"), path, pop_size=8, n_gen=2)
    assert (r.solver.name, r.evaluations) == (path, 16)
    with pytest.raises(SettingError, match=f"solver = '{path}': must be a solver of"):
        search(problem("work" if several else "pareto"), path)
    with pytest.raises(SettingError, match=r"solver.name = .* must be a class of pymoo.algorithms"):
        Solver(f"{path}2").build(1 + several)


@pytest.mark.parametrize("path", UNCONSTRAINED.split())
def test_one_without_constraints_says_once_why_it_cannot_and_what_can_be_done(path):
    p, algorithm = problem(["distance", "work"]), built("moo", path)
    with pytest.raises(SettingError, match=r"solver = '\w+': must be .*constraints.*Try solver=nsga2"):
        search(p, algorithm)
    with pytest.raises(AssertionError, match="constrain"):  # pymoo's own
        minimize(p, algorithm, ("n_gen", 2), seed=1)


def test_a_genetic_algorithm_of_mixed_variables_finds_integers():
    p = problem()
    found = minimize(p, MixedVariableGA(pop_size=10), ("n_gen", 3), seed=1)
    assert list(found.X) == ["k1", "k2", "k3", "k4", "k5"]
    check_found(p, found.X, found.F)
    start = [[1, 2, 3, 2, 1], [4, 4, 4, 4, 4]]
    ours = search(p, MixedVariableGA(pop_size=10), n_gen=3, start=start)
    check_found(p, ours.X, ours.F)
    assert ours.k[:2].tolist() == start


@pytest.mark.parametrize("objective", ["efficiency", "pareto"])
def test_no_rows_have_no_values(objective):
    p = problem(objective)
    f, g = p.evaluate(np.empty((0, 5)))
    assert (f.shape, g.shape) == ((0, p.n_obj), (0, 2))


def test_a_design_without_a_value_of_an_objective_is_infeasible():
    problem = FootProblem(objective=["distance", "work"], space=Waypoints(n=5), accuracy="draft")
    found = problem.evaluate_designs([[3] * 5, [5] * 5])
    found.values[0, problem.record.index("work")] = np.nan
    assert problem.feasible(*found).tolist() == [False, True]
    assert problem.reasons(*found).tolist() == ["no value", ""]


def test_a_problem_around_it_keeps_its_own_variables_and_one_that_evaluates_otherwise_is_refused():
    problem, out = FootProblem(space=Waypoints(n=5), accuracy="draft"), {}
    problem._evaluate(np.array([[1, 2, 3, 4, 5]])[:, ::-1], out)  # as of a mirror
    assert "X" not in out

    class Penalised(FootProblem):
        def _evaluate(self, x, out, *args, **kwargs):
            super()._evaluate(x, out)
            out["F"] = out["F"] + 1.0

    with pytest.raises(SettingError, match="Penalised"):
        search(Penalised(accuracy="draft"), walks=10)


def test_a_search_takes_an_algorithm_a_termination_and_designs_to_start_with():
    p, start = problem(), [[1, 2, 3, 2, 1], [4, 4, 4, 4, 4]]
    algorithm = GA(pop_size=10)
    r = search(p, algorithm, stop=get_termination("n_gen", 3), start=start, seed=2)
    assert r.k[:2].tolist() == start
    assert (len(r.history), r.stopped, r.solver.name, r.solver.pop_size) == (3, "", "GA", 10)
    assert algorithm.pop is None  # a copy of it has searched
    assert_same(r, search(p, algorithm, stop=("n_gen", 3), start=start, seed=2))
    assert len(search(p, "memetic", stop=get_termination("n_gen", 2)).history) == 2
    with pytest.raises(SettingError, match=r"start = 11: must be at most 10 designs"):
        search(p, algorithm, start=SMALL.random(11, seed=1))
    with pytest.raises(SettingError, match=r"solver = 'GA': must be an algorithm that has its pop_size"):
        search(p, algorithm, pop_size=20)
    with pytest.raises(SettingError, match=r"solver = 3: must be .* Try solver='memetic'"):
        search(p, 3)


def test_one_s_own_algorithm_goes_on_from_a_store(tmp_path):
    p, whole = (
        problem(["distance", "work"]),
        search(problem(["distance", "work"]), NSGA2(pop_size=12), n_gen=5),
    )
    part = search(p, NSGA2(pop_size=12), n_gen=2, store=tmp_path / "feet.sqlite")
    again = search(p, NSGA2(pop_size=12), n_gen=5, store=tmp_path / "feet.sqlite")
    assert again.reused == part.designs
    assert_same(again, whole)


def test_a_result_has_what_pymoo_s_tools_take():
    p = problem(["distance", "work"])
    r = search(p, "archive", walks=80)
    check_found(p, r.X, r.F)
    assert (r.G <= 0.0).all()
    assert (r.F == [-1, 1] * r.values[r.front][:, [p.record.index(n) for n in p.names]]).all()
    assert 0 <= ASF().do(r.F, np.array([0.5, 0.5])).argmin() < len(r.X)
    one = search(problem(), walks=40)
    assert (one.X.shape, one.F.shape, one.G.shape) == ((5,), (1,), (2,))


def test_everything_can_be_pickled():
    p = problem()
    r = search(p, walks=40)
    copied = pickle.loads(pickle.dumps(r))
    assert repr(copied) == repr(r)
    assert copied.values.tobytes() == r.values.tobytes()
    k = SMALL.random(3, seed=1)
    again = pickle.loads(pickle.dumps(p))
    np.testing.assert_array_equal(again.evaluate(k)[0], p.evaluate(k)[0])
    for kind in (Memetic, Archive):
        algorithm = kind().setup(p, termination=("n_gen", 4), seed=1)
        algorithm.next()
        other = pickle.loads(pickle.dumps(algorithm))
        for each in (algorithm, other):
            each.run()
        np.testing.assert_array_equal(algorithm.opt.get("X"), other.opt.get("X"))


class Sphere(Problem):
    """Whole numbers about 5, with walks that cost nothing, and without a box."""

    def __init__(self, n_obj=1):
        super().__init__(n_var=6, n_obj=n_obj, n_ieq_constr=1, xl=1, xu=10, vtype=int)

    def _evaluate(self, x, out, *args, **kwargs):
        out["F"] = np.stack([((x - 4 - 2 * j) ** 2).sum(axis=1) for j in range(self.n_obj)], axis=1)
        out["G"] = x[:, 0] - 8.5


@pytest.mark.slow
def test_where_a_front_stalls_another_population_begins_and_later_joins_the_first():
    """The optimum is the front of all designs throughout, and none is proposed twice."""
    walked = []

    class Noted(Sphere):
        def _evaluate(self, x, out, *args, **kwargs):
            super()._evaluate(x, out)
            walked.append(np.column_stack([x, out["F"], out["G"]]))

    algorithm, apart = Archive().setup(Noted(n_obj=2), termination=("n_eval", 4000), seed=1), []
    while algorithm.has_next():
        algorithm.next()
        apart.append(algorithm.every is not algorithm.front)
    changes = np.flatnonzero(np.diff(apart))
    assert len(changes) >= 2
    assert not apart[0]
    designs = np.concatenate(walked)
    assert len(np.unique(designs[:, :6], axis=0)) == len(designs)
    f = designs[designs[:, 8] <= 0, 6:8]
    best = {tuple(point) for point in f[nondominated(f)]}
    assert best == {tuple(point) for point in algorithm.opt.get("F")}


@pytest.mark.slow
def test_no_front_that_is_remembered_grows_without_end(monkeypatch):
    """Neither a population's nor that of all of them, while there are two."""
    algorithm = Archive().setup(Sphere(n_obj=2), termination=("n_eval", 2000), seed=1)
    algorithm.next()
    while algorithm.every is algorithm.front:
        algorithm.next()
    assert len(algorithm.every.X) > 6
    monkeypatch.setattr(memetic, "REMEMBERED", 6)
    algorithm.next()
    assert algorithm.every is not algorithm.front
    assert max(len(algorithm.front.X), len(algorithm.every.X), len(algorithm.opt)) <= 6


OURS = pytest.mark.parametrize(("kind", "n_obj"), [(Memetic, 1), (Archive, 2)])


@OURS
class TestAsInPymoo:
    """pymoo's own tests of algorithms (tests/algorithms), of ours."""

    def test_minimize_a_loop_and_ask_and_tell_agree(self, kind, n_obj):
        p, ends = Sphere(n_obj), ("n_gen", 8)
        whole = minimize(p, kind(), ends, seed=1)
        loop = kind().setup(p, termination=ends, seed=1)
        while loop.has_next():
            loop.next()
        told = kind().setup(p, termination=ends, seed=1)
        while told.has_next():
            infills = told.ask()
            told.evaluator.eval(p, infills)
            told.tell(infills=infills)
        for other in (loop.result(), told.result()):
            np.testing.assert_array_equal(other.X, whole.X)
            np.testing.assert_array_equal(other.F, whole.F)

    def test_it_goes_on_after_its_end(self, kind, n_obj):
        whole = minimize(Sphere(n_obj), kind(), ("n_gen", 8), seed=1)
        part = kind().setup(Sphere(n_obj), termination=("n_gen", 4), seed=1)
        part.run()
        part.termination = get_termination("n_gen", 8)
        np.testing.assert_array_equal(part.run().F, whole.F)

    def test_its_optimum_is_feasible_and_whole(self, kind, n_obj):
        r = minimize(Sphere(n_obj), kind(), ("n_gen", 20), seed=1)
        assert (r.CV <= 0).all()
        if n_obj == 1:
            assert (r.X.tolist(), r.F.tolist()) == ([4] * 6, [0.0])
        else:
            assert {4, 6} <= set(np.unique(r.X))

    def test_it_begins_with_a_population_that_is_given(self, kind, n_obj):
        given = np.full((3, 6), 7)
        for sampling in (given, Population.new(X=given)):
            r = minimize(Sphere(n_obj), kind(sampling=sampling), ("n_gen", 1), seed=1)
            assert r.pop.get("X").tolist() == [[7] * 6]
        assert r.algorithm.evaluator.n_eval == 1  # none is asked for twice

    def test_an_evaluated_population_is_not_evaluated_again(self, kind, n_obj):
        p, given = Sphere(n_obj), Population.new(X=np.arange(18).reshape(3, 6) % 8 + 1)
        Evaluator().eval(p, given)
        r = minimize(p, kind(sampling=given), ("n_gen", 1), seed=1)
        assert r.algorithm.evaluator.n_eval == 0
        assert {tuple(x) for x in r.opt.get("X")} <= {tuple(x) for x in given.get("X")}
        assert given.get("n_gen").tolist() == [None] * 3  # the user's own are left alone

    def test_its_own_end_is_a_number_of_evaluations(self, kind, n_obj):
        """pymoo's tolerances would end it before its first restart."""
        algorithm = kind().setup(Sphere(n_obj), seed=1)
        assert algorithm.termination.n_max_evals == WALKS
        ends = get_termination("n_gen", 3)
        assert kind(termination=ends).setup(Sphere(n_obj)).termination is ends
