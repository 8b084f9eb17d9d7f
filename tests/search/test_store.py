"""The store: what is kept comes back to the last bit, a search goes on by replay, and no file is harmed."""

import contextlib
import dataclasses
import math
import sqlite3
import subprocess
import sys
import threading
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from searching import QUICK, SMALL, assert_same, problem

import footopt as fo
from footopt.design import Store, search
from footopt.design import store as store_module
from footopt.design.store import ERROR, LAYOUT, digest, key_of
from footopt.errors import FileError
from footopt.walk.steppers import STEPPERS
from footopt.walk.steppers.explicit import runge_kutta

BOTH = np.array([[1] * 5, [2] * 5])
ONE = BOTH[:1]


def keep(store, designs, reason=""):
    """Keep designs with one number each in place of six values."""
    values = np.repeat(np.array(list(designs.values()), float)[:, None], 6, axis=1)
    store.add(np.array(list(designs)), values, np.array([reason] * len(designs)))


@pytest.fixture
def path(tmp_path):
    return tmp_path / "designs.sqlite"


@pytest.fixture
def walked(monkeypatch):
    """The designs that are really walked, in order."""
    designs = []

    walk = fo.FootProblem.walk

    def counted(problem, k):
        designs.extend(map(tuple, k.tolist()))
        return walk(problem, k)

    monkeypatch.setattr(fo.FootProblem, "walk", counted)
    return designs


def factory(by):
    return lambda foot: {"work": by + foot.hollow}


def nested(by):
    def inner():
        return by

    return lambda foot: {"work": inner() * foot.hollow}


class Times:
    def __init__(self, by):
        self.by = by

    def work(self, foot):
        return {"work": self.by * foot.hollow}


def bound(foot, by):
    return {"work": by * foot.hollow}


def session(by, power=1):
    """A function of a notebook, whose names are of the session alone."""
    names = {"BY": by, "__name__": "__main__"}
    inner = f"def scaled(x): return BY * x**{power}"
    exec(f"{inner}\ndef of(foot): return {{'work': (lambda: scaled(foot.hollow))()}}", names)
    return names["of"]


class Own(fo.Inertia):
    """An effect by the law of another."""


def test_a_key_has_what_functions_are_bound_to_and_the_effects_of_every_scenario():
    functions = [factory(1.0), factory(2.0), partial(bound, by=1.0), partial(bound, by=2.0)]
    functions += [Times(1.0).work, Times(2.0).work, nested(1.0), nested(2.0)]
    functions += [session(1.0), session(2.0), session(1.0, power=2), session(1.0)]  # the last is the first
    made = [fo.FunctionSimulator(one, ["work"]) for one in functions]
    assert len({digest(key_of(fo.FootProblem(one, "work", SMALL, QUICK))) for one in made}) == 11
    own = [fo.Scene(), fo.Scene(effects=(Own(),))]
    robust = [
        fo.RobustProblem([*map(fo.Scenario, "ab", scenes)], "work", SMALL, QUICK, references=np.ones(2))
        for scenes in (own, made[:2], [fo.FunctionSimulator(factory(3.0), ["work"]), made[1]])
    ]
    keys = []
    for name in ("__main__", "__mp_main__"):  # a script's, and that of a worker process that runs it again
        function = factory(1.0)
        function.__module__ = name
        keys.append(key_of(fo.FootProblem(fo.FunctionSimulator(function, ["work"]), "work", SMALL, QUICK)))
    assert keys[0] == keys[1]
    assert f"{__name__}.Own" in key_of(robust[0])["own"]
    assert len({digest(key_of(one)) for one in robust}) == 3


class TestReplay:
    @pytest.mark.slow
    def test_an_extended_search_is_the_longer_one(self, path):
        """Of RVEA, too, whose survival depends on how many generations there will be."""
        p = problem("pareto")
        search(p, "rvea", store=path, pop_size=12, n_gen=3, seed=3)
        longer = {"pop_size": 12, "n_gen": 6, "seed": 3}
        extended = search(p, "rvea", store=path, **longer)
        assert_same(extended, search(p, "rvea", **longer))
        assert extended.reused >= 12

    def test_another_objective_and_another_tolerance_use_the_same_walks(self, path, walked):
        search(problem(), "ga", store=path, pop_size=12, n_gen=3)
        before = len(walked)
        free = dataclasses.replace(SMALL, box_tolerance=math.inf)
        again = search(problem("pareto", space=free), "nsga2", store=path, pop_size=12, n_gen=1, operators={})
        assert (len(walked), again.reused) == (before, 12)  # the same seed starts from the same designs
        assert set(again.reasons) == {""}

    def test_a_search_that_is_stopped_inside_a_generation_reports_the_finished_ones(self, path, monkeypatch):
        p = problem("pareto")
        whole = search(p, "nsga2", pop_size=12, n_gen=3, seed=3)
        walk, calls = p.walk, []

        def interrupted(k):
            calls.append(k)
            if len(calls) == 4:
                raise KeyboardInterrupt
            return walk(k)

        monkeypatch.setattr(p, "walk", interrupted)
        assert_same(whole, search(p, "nsga2", store=path, pop_size=12, n_gen=9, seed=3))


class TestStore:
    @settings(max_examples=15)
    @given(
        st.dictionaries(
            st.tuples(*[st.integers(1, SMALL.K)] * 5),
            st.tuples(
                st.lists(st.floats().map(lambda x: math.nan if x != x else x), min_size=6, max_size=6),
                st.text(st.characters(exclude_categories=["Cs"])),
            ),
            min_size=1,
        )
    )
    def test_what_is_kept_comes_back_to_the_last_bit(self, tmp_path_factory, designs):
        path = tmp_path_factory.getbasetemp() / "round_trip.sqlite"
        path.unlink(missing_ok=True)
        k, values = np.array(list(designs)), np.array([values for values, _ in designs.values()])
        reasons = np.array([why for _, why in designs.values()], object)
        with Store(path, problem()) as store:
            assert store.get(k)[1].tolist() == [ERROR] * len(k)
            store.add(k, values, reasons)
        with Store(path, problem()) as store:
            found = store.get(k)
            assert len(store) == len(k)
        assert found[0].tobytes() == values.tobytes()
        assert found[1].tolist() == reasons.tolist()

    def test_a_file_that_many_open_and_write_at_once_holds_what_all_wrote(self, path):
        count, failures, many = 12, [], dataclasses.replace(SMALL, K=20)
        together = threading.Barrier(count)

        def work(i):
            try:
                together.wait()
                with Store(path, problem(zeta=1.0 + i % 2, space=many)) as store:
                    for j in range(1, 6):
                        keep(store, {(i + 1, j, 1, 1, 1): i % 2, (20,) * 5: i % 2})
            except BaseException as error:
                failures.append(error)

        threads = [threading.Thread(target=work, args=(i,)) for i in range(count)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert failures == []
        for i in range(2):
            with Store(path, problem(zeta=1.0 + i, space=many)) as store:
                assert len(store) == count // 2 * 5 + 1
                assert store.get(np.full((1, 5), 20))[0].tolist() == [[i] * 6]

    def test_an_error_is_replaced_by_a_walk_and_replaces_none(self, path):
        with Store(path, problem()) as store:
            for reason in ("error: died", "errors of its own simulator", "error: died"):
                keep(store, {(1,) * 5: 1.0}, reason)
            assert store.get(ONE)[1].tolist() == ["errors of its own simulator"]


class TestContext:
    def test_all_that_changes_a_result_changes_the_key(self):
        scene, base = fo.Scene(sand=fo.Sand(5.0)), problem()
        replace = dataclasses.replace
        changed = [
            problem(zeta=4.0),
            problem(accuracy=replace(QUICK, dt=5e-3)),
            problem(["work", "maximum_sinkage"]),
            *(problem(space=replace(SMALL, **{n: 0.05})) for n in ("L", "H", "width")),
            problem(space=replace(SMALL, K=5)),
            problem(space=replace(SMALL, ankle=(0.0, 0.01))),
            *(
                fo.FootProblem(s, "efficiency", SMALL, QUICK)
                for s in (
                    replace(scene, walker=fo.Walker(mass=61.0)),
                    replace(scene, t_f=3.0),
                    replace(scene, gait=fo.Gait.human(period=1.3)),
                    replace(scene, gait=fo.Gait.human(harmonics=5)),
                    replace(scene, sand=replace(scene.sand, stress_map=fo.StressMap(A00=0.2))),
                )
            ),
        ]
        digests = {digest(key_of(p)) for p in (base, *changed)}
        assert len(digests) == 1 + len(changed)
        same = problem("work", space=replace(SMALL, box_tolerance=1.0))
        assert digest(key_of(same)) == digest(key_of(base))

    def test_a_stepper_of_one_s_own_counts_by_its_parameters(self, monkeypatch):
        keys = []
        for b in ((0.0, 1.0), (0.5, 0.5), (0.0, 1.0)):
            monkeypatch.setitem(STEPPERS, "own", runge_kutta(c=(0.0, 0.5), b=b))
            keys.append(key_of(problem(accuracy=dataclasses.replace(QUICK, stepper="own"))))
        assert keys[0] == keys[2] != keys[1]

    def test_designs_walked_by_other_code_are_used_only_when_asked_for_and_said(self, path, monkeypatch):
        with Store(path, problem()) as store:
            keep(store, {(1,) * 5: 1.0, (2,) * 5: 1.0})
            assert store.foreign == []
        with Store(path, problem(zeta=1.0)) as store:
            keep(store, {(1,) * 5: 3.0})
        monkeypatch.setattr(store_module, "_versions", lambda: {"footopt": "another"})
        with Store(path, problem()) as store:
            assert store.get(ONE)[1].tolist() == [ERROR]
            assert "another here" in str(store.foreign)
            assert "of other code are not used" in store.describe()
        with Store(path, problem(zeta=2.0), reuse=True) as store:  # other settings are never taken
            assert (store.get(ONE)[1].tolist(), store.foreign, store.describe()) == ([ERROR], [], "")
        with Store(path, problem(), reuse=True) as store:
            assert store.get(BOTH)[0][:, 0].tolist() == [1.0, 1.0]
            assert "of other code are used again" in store.describe()
            keep(store, {(2,) * 5: 2.0})
        with Store(path, problem(), reuse=True) as store:  # its own come first
            assert store.get(BOTH)[0][:, 0].tolist() == [1.0, 2.0]


def sqlite_of_another_program(path):
    with contextlib.closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("CREATE TABLE design (k, record)")


def store_of_another_layout(path):
    Store(path, problem()).close()
    with contextlib.closing(sqlite3.connect(path)) as connection, connection:
        connection.execute(f"PRAGMA user_version = {LAYOUT + 1}")


UNUSABLE = {
    "cannot be used (file is not a database)": lambda path: path.write_text("k,distance\n1,2\n" * 100),
    "SQLite file of another program": sqlite_of_another_program,
    f"its layout is {LAYOUT + 1}, not {LAYOUT}": store_of_another_layout,
}


class TestUnusableFiles:
    @pytest.mark.parametrize("message", UNUSABLE)
    def test_are_refused_with_a_reason_and_left_as_they_are(self, path, message):
        UNUSABLE[message](path)
        before = path.read_bytes()
        for _ in range(2):
            with pytest.raises(FileError, match=r"study\.store = '.*designs\.sqlite': ") as error:
                search(problem(), "ga", store=path, pop_size=4, n_gen=1)
            assert message in str(error.value)
            assert "Choose another study.store" in str(error.value)
        assert path.read_bytes() == before
        assert [p.name for p in path.parent.iterdir()] == [path.name]


def test_an_edit_of_footopts_own_code_is_other_code(tmp_path, monkeypatch):
    """Its version stays the same until a release."""
    file, found = tmp_path / "contact.py", []
    monkeypatch.setattr(store_module, "sources", lambda: [file])
    for text in ("f = a - M h", "f = a", "f = a - M h"):
        file.write_text(text)
        found.append(store_module._versions.__wrapped__())
    assert found[0] == found[2] != found[1]


def test_a_store_sees_the_variables_of_a_script_that_its_functions_read(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import footopt as fo\n"
        "CALLS = 0\n"
        "def depth(foot):\n"
        "    return SCALE * float(foot.contour[:, 1].mean())\n"
        "def work(foot):\n"
        "    global CALLS\n"
        "    CALLS += 1\n"
        "    return {'work': depth(foot)}\n"
        "for SCALE in (1.0, 2.0, 2.0):\n"
        "    problem = fo.FootProblem(fo.FunctionSimulator(work, ('work',)), 'work')\n"
        "    result = fo.search(problem, walks=40, store='s.sqlite')\n"
        "    print(result.reused, result.column('work')[result.best] / SCALE)\n"
    )
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=True)
    reused, best = zip(*(line.split() for line in done.stdout.splitlines()), strict=True)
    assert reused == ("0", "0", "40")
    assert len({*best}) == 1
