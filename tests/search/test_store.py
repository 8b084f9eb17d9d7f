"""The store: what is kept comes back to the last bit, a search goes on by replay, and no file is harmed."""

import contextlib
import dataclasses
import math
import re
import shutil
import sqlite3
import sys
import threading
import types
from typing import NamedTuple
from unittest import mock

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from running import tries
from searching import QUICK, SMALL, assert_same, objective_of, problem, stop_after

import footopt as fo
from footopt.design import Evaluation, Store, search
from footopt.design import context as context_module
from footopt.design import store as store_module
from footopt.design.archive import Archive
from footopt.design.context import context, digest, plain
from footopt.design.evaluator import walk_safely
from footopt.design.executor import Failed, Walked
from footopt.design.store import LAYOUT
from footopt.errors import FileError, FootoptError, SettingError


@pytest.fixture
def path(tmp_path):
    return tmp_path / "designs.sqlite"


@pytest.fixture
def walked(monkeypatch):
    """The designs that are really walked, in order."""
    designs = []

    def counted(k, *args, **named):
        designs.extend(map(tuple, k.tolist()))
        return fo.evaluate(k, *args, **named)

    monkeypatch.setattr("footopt.design.problem.evaluate", counted)
    return designs


class TestReplay:
    @pytest.mark.parametrize("name", ["memetic", "de", "nsga2", "rvea"])
    def test_a_search_that_was_stopped_goes_on_to_the_same_result(self, name, path, walked):
        p, budget = problem(objective_of(name)), {"pop_size": 12, "n_gen": 6, "seed": 3}
        undisturbed = search(p, name, **budget)
        count = len(walked)
        for generations in (1, 4):
            stopped = search(p, name, stop_after(generations), path, **budget)
            assert stopped.interrupted
            assert len(stopped.history) == generations
        resumed = search(p, name, store=path, **budget)
        assert not resumed.interrupted
        assert_same(undisturbed, resumed)
        assert len(walked) == 2 * count  # each design once in the undisturbed search and once in the rest
        assert resumed.reused == len(stopped.k)

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

        def front(archive, original=Archive._front):
            if len(archive.history) == 2:
                raise KeyboardInterrupt
            return original(archive)

        monkeypatch.setattr(Archive, "_front", front)  # walked and told, but not finished
        two = search(p, "nsga2", store=path, pop_size=12, n_gen=9, seed=3)
        assert len(two.history) == 2
        assert max(two.generation) == 2
        assert two.front.max() < len(two.k)
        assert two.evaluations == 24


class TestStore:
    @settings(max_examples=15)
    @given(
        st.dictionaries(
            st.tuples(*[st.integers(1, SMALL.K)] * 5),
            st.tuples(
                st.lists(st.floats().map(lambda x: math.nan if x != x else x), min_size=6, max_size=6),
                st.sampled_from(["", "sunk", "error"]),
                st.text(st.characters(exclude_categories=["Cs"])),
            ),
            min_size=1,
        )
    )
    def test_what_is_kept_comes_back_to_the_last_bit(self, tmp_path_factory, designs):
        path = tmp_path_factory.getbasetemp() / "round_trip.sqlite"
        path.unlink(missing_ok=True)
        k, kept = list(designs), [Evaluation(np.array(v), *words) for v, *words in designs.values()]
        with Store(path, problem()) as store:
            assert store.get(k) == [None] * len(k)
            store.add(k, kept)
        with Store(path, problem()) as store:
            found = store.get(k)
            assert len(store) == len(k)
        assert [(e.values.tobytes(), e[1:]) for e in found] == [(e.values.tobytes(), e[1:]) for e in kept]

    def test_a_batch_is_kept_whole_or_not_at_all(self, path):
        with Store(path, problem()) as store:
            good = Evaluation(np.zeros(6), "")
            with pytest.raises(ValueError, match="zip"):
                store.add([[1] * 5, [2] * 5], [good])
            with pytest.raises(FileError):
                store.add([[1] * 5, [2] * 5], [good, Evaluation(np.zeros(6), None)])
            assert len(store) == 0

    def test_a_file_that_many_open_and_write_at_once_holds_what_all_wrote(self, path):
        count, failures, many = 12, [], dataclasses.replace(SMALL, K=20)
        together = threading.Barrier(count)

        def work(i):
            try:
                together.wait()
                with Store(path, problem(zeta=1.0 + i % 2, space=many)) as store:
                    for j in range(1, 6):
                        store.add(
                            [[i + 1, j, 1, 1, 1], [20] * 5], [Evaluation(np.full(6, float(i % 2)), "")] * 2
                        )
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
                assert store.get([[20] * 5])[0].values.tolist() == [i] * 6

    @pytest.mark.parametrize("tolerance", [SMALL.box_tolerance, math.inf])
    def test_is_a_table_that_pandas_reads(self, path, tolerance):
        """The columns of designs.csv, with what the limits and the box say; NaN where there is no value."""
        pandas = pytest.importorskip("pandas", reason="needs footopt[pandas]")
        space, scene = dataclasses.replace(SMALL, box_tolerance=tolerance), fo.Scene(sand=fo.Sand(0.04))

        def limited(distance):
            limits = {"peak_power": 700.0, "distance": distance}
            return fo.FootProblem(scene, ["work", "thickness"], space, QUICK, limits=limits)

        Store(path, limited(9.0)).close()  # the limits that were asked for last count
        found = search(limited(0.1), "nsga2", store=path, pop_size=40, n_gen=2, operators={})
        with contextlib.closing(sqlite3.connect(path)) as connection:
            read = pandas.read_sql("SELECT * FROM designs_1", connection)
        frame, k = found.to_frame().drop(columns=["generation", "on_front"]), [f"k{i}" for i in range(1, 6)]
        assert read.columns.tolist() == [*frame.columns, "message"]
        read = read.set_index(k).loc[pandas.MultiIndex.from_frame(frame[k])]
        assert {"sunk", "", "peak_power" if math.isinf(tolerance) else "box"} <= {*read["reason"]}
        assert read["reason"].tolist() == frame["reason"].tolist()
        assert read["feasible"].astype(bool).tolist() == frame["feasible"].tolist()
        for name in (*found.problem.record, "box_violation"):
            np.testing.assert_allclose(read[name], frame[name], rtol=1e-14)

    def test_that_was_deleted_meanwhile_is_said(self, tmp_path):
        """SQLite would go on writing into a file that has no name any more."""
        path = tmp_path / "run" / "designs.sqlite"
        path.parent.mkdir()
        with pytest.raises(FileError, match=r"study\.store = .*is gone .* deleted or moved meanwhile"):
            search(problem(), "ga", lambda g: shutil.rmtree(path.parent), path, pop_size=4, n_gen=9)
        assert not path.parent.exists()

    def test_of_another_problem_is_refused(self, path):
        with Store(path, problem()) as store, pytest.raises(ValueError, match="another problem"):
            search(problem(zeta=1.0), "ga", store=store, pop_size=4, n_gen=1)

    def test_an_error_is_replaced_by_a_walk_and_replaces_none(self, path):
        good, error = Evaluation(np.ones(6), ""), Evaluation(np.full(6, np.nan), "error", "died")
        with Store(path, problem()) as store:
            for added in (error, good, error):
                store.add([[1] * 5], [added])
            assert store.get([[1] * 5])[0].reason == ""

    def test_a_run_sees_what_another_adds_meanwhile(self, path):
        with Store(path, problem()) as one, Store(path, problem()) as other:
            one.add([[1] * 5], [Evaluation(np.ones(6), "")])
            assert other.get([[1] * 5])[0].values.tolist() == [1.0] * 6


class Curve(NamedTuple):
    a: float
    b: tuple


@dataclasses.dataclass(frozen=True)
class Crust:
    depth: float
    table: np.ndarray
    curve: Curve | None = None


@dataclasses.dataclass(frozen=True)
class Pan:
    depth: float
    table: np.ndarray
    curve: Curve | None = None


class TestContext:
    def test_frozen_data_of_any_kind_is_told_apart(self):
        table, curve = np.arange(4.0).reshape(2, 2), Curve(1.0, (2.0,))
        kinds = [
            (),
            (Crust(0.1, table),),
            (Pan(0.1, table),),
            (Crust(0.2, table),),
            (Crust(0.1, table.T),),
            (Crust(0.1, table.astype(np.float32)),),
            (Crust(0.1, table.ravel()),),
            (Crust(0.1, table, curve),),
            (Crust(0.1, table, curve._replace(b=())),),
            (Crust(np.nextafter(0.1, 1.0), table),),
            (Crust(0.1, table), Crust(0.1, table)),
            None,
        ]
        assert len({digest(plain(kind)) for kind in kinds}) == len(kinds)
        assert plain(np.float64(0.1)) == 0.1
        with pytest.raises(TypeError, match="function"):
            plain({"law": plain})

    def test_all_that_changes_a_result_changes_the_context(self):
        scene, base = fo.Scene(sand=fo.Sand(5.0)), problem()
        replace = dataclasses.replace
        changed = [
            problem(zeta=4.0),
            problem(accuracy=replace(QUICK, dt=5e-3)),
            problem(accuracy=replace(QUICK, rule="chord")),
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
        digests = {digest(context(p)) for p in (base, *changed)}
        assert len(digests) == 1 + len(changed)
        same = problem("work", space=replace(SMALL, box_tolerance=1.0))
        assert digest(context(same)) == digest(context(base))

    @pytest.mark.parametrize(
        ("what", "name"), [("version", "versions.numpy"), ("machine", "machine"), ("_sources", "sources")]
    )
    def test_another_version_or_machine_or_source_is_not_reused_and_said(self, path, monkeypatch, what, name):
        with Store(path, problem()) as store:
            store.add([[1] * 5], [Evaluation(np.ones(6), "")])
            assert store.describe() == f"1 designs of this search are known from {path}"
        monkeypatch.setattr(context_module, what, lambda *of: "another")
        with Store(path, problem()) as store:
            assert store.get([[1] * 5]) == [None]
            said = store.describe()
        assert "can be used again" in said
        assert name in said
        assert "another here" in said

    def test_remarks_in_the_sources_discard_nothing_and_any_change_of_the_code_does(
        self, tmp_path, monkeypatch
    ):
        before, package = context_module._sources(), context_module.PACKAGE
        copy = shutil.copytree(package, tmp_path / "footopt", ignore=shutil.ignore_patterns("__pycache__"))
        monkeypatch.setattr(context_module, "PACKAGE", copy)
        for file, old, new, same in (
            ("walk/loop.py", "\n", "\n# a remark\n\n", True),
            ("design/robust.py", '"""', '"""Says: ', True),
            ("foot/foot.py", "import", "import  ", True),
            ("design/robust.py", "np.abs(references)", "references", False),
            ("design/problem.py", "natural = ", "natural = 2.0 * ", False),
            ("design/evaluator.py", "found[i].values", "-found[i].values", False),
            ("design/executor.py", "k[part]", "k[part[::-1]]", False),
            ("compiled.py", '"reassoc", ', "", False),
            ("sand/law.py", "return ", "return 2.0 * ", False),
        ):
            text = (copy / file).read_text()
            assert old in text
            (copy / file).write_text(text.replace(old, new, 1))
            assert (context_module._sources.__wrapped__() == before) == same, file
            (copy / file).write_text(text)

    @pytest.mark.parametrize("typed", [False, True])
    def test_a_changed_problem_of_ones_own_is_not_reused(self, tmp_path, path, typed):
        """Its class, in a file or typed into a session, makes the values."""

        def made(factor):
            text = f"""
import footopt as fo

class Doubled(fo.FootProblem):
    def walk(self, k):
        values, reasons = super().walk(k)
        return {factor} * values, reasons
"""
            (tmp_path / "mine.py").write_text(text)
            file = "<stdin>" if typed else str(tmp_path / "mine.py")
            space = {"__name__": "mine"}
            exec(compile(text, file, "exec"), space)
            if not typed:
                sys.modules["mine"] = types.SimpleNamespace(__file__=file)
            return space["Doubled"](scene=problem().scene, space=SMALL, accuracy=QUICK)

        try:
            with Store(path, made(2.0)) as store:
                store.add([[1] * 5], [Evaluation(np.ones(6), "")])
            with Store(path, made(2.0)) as store:
                assert store.get([[1] * 5]) != [None]
            with Store(path, made(3.0)) as store:
                assert store.get([[1] * 5]) == [None]
                assert "mine.Doubled" in store.describe()
        finally:
            sys.modules.pop("mine", None)

    def test_designs_walked_by_other_code_are_used_only_when_asked_for_and_said(self, path, monkeypatch):
        with Store(path, problem()) as store:
            store.add([[1] * 5, [2] * 5], [Evaluation(np.full(6, 1.0), "")] * 2)
            assert store.foreign == []
        with Store(path, problem(zeta=1.0)) as store:
            store.add([[1] * 5], [Evaluation(np.full(6, 3.0), "")])
        monkeypatch.setattr(context_module, "_sources", lambda: "another")
        with Store(path, problem()) as store:
            assert store.get([[1] * 5]) == [None]
            assert "another here" in store.foreign[0]
        with Store(path, problem(zeta=2.0), reuse=True) as store:  # other settings are never taken
            assert (store.get([[1] * 5]), store.foreign) == ([None], [])
        with Store(path, problem(), reuse=True) as store:
            assert [e.values[0] for e in store.get([[1] * 5, [2] * 5])] == [1.0, 1.0]
            assert "of other code are used again" in store.describe()
            store.add([[2] * 5], [Evaluation(np.full(6, 2.0), "")])
        with Store(path, problem(), reuse=True) as store:  # its own come first
            assert [e.values[0] for e in store.get([[1] * 5, [2] * 5])] == [1.0, 2.0]

    def test_where_a_recording_lies_does_not_matter(self):
        one, other = (
            fo.FootProblem(fo.Scene(gait=dataclasses.replace(fo.Gait.human(), source=source)))
            for source in ("here/walk.trc", "there/walk.trc")
        )
        assert context(one) == context(other)

    def test_a_new_file_needs_no_words_and_many_differences_are_few(self, path):
        with Store(path, problem()) as store:
            assert store.describe() == ""
            store.add([[1] * 5], [Evaluation(np.ones(6), "")])
        other = fo.FootProblem(fo.Scene(sand=fo.Sand(0.3)), "work", fo.Waypoints(n=6, L=0.1), "draft")
        with Store(path, other) as store:
            assert re.search(r"and \d more differ", store.describe())


def sqlite_of_another_program(path):
    with contextlib.closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("CREATE TABLE design (k, record)")


def store_of_another_layout(path):
    Store(path, problem()).close()
    with contextlib.closing(sqlite3.connect(path)) as connection, connection:
        connection.execute(f"PRAGMA user_version = {LAYOUT + 1}")


def a_full_store(path):
    with Store(path, problem()) as store:
        k = SMALL.random(200, seed=1).tolist()
        store.add(k, [Evaluation(np.random.default_rng(h).normal(size=6), "") for h in k])


def damaged_store(path):
    a_full_store(path)
    content = bytearray(path.read_bytes())
    content[4096:8192] = b"\xff" * 4096
    path.write_bytes(content)


UNUSABLE = {
    "is not a store of footopt": lambda path: path.write_text("k,distance\n1,2\n" * 100),
    "SQLite file of another program": sqlite_of_another_program,
    f"its layout is {LAYOUT + 1}, this version's {LAYOUT}": store_of_another_layout,
    "is damaged": damaged_store,
}


class Full:
    """A store's path, its designs and their values; hypothesis writes a tuple of them out, for minutes."""

    def __init__(self, *parts):
        self.parts = parts


@pytest.fixture(scope="module")
def full_store(tmp_path_factory):
    path = tmp_path_factory.mktemp("damage") / "original.sqlite"
    a_full_store(path)
    k = SMALL.random(200, seed=1).tolist()
    with Store(path, problem()) as store:
        return Full(path, k, [e.values.tobytes() for e in store.get(k)])


class TestUnusableFiles:
    @pytest.mark.parametrize("message", UNUSABLE)
    def test_are_refused_with_a_reason_and_left_as_they_are(self, path, message):
        UNUSABLE[message](path)
        before = path.read_bytes()
        for _ in range(2):
            with pytest.raises(FileError, match=r"study\.store = '.*designs\.sqlite': ") as error:
                search(problem(), "ga", store=path, pop_size=4, n_gen=1)
            assert message in str(error.value)
            assert "study.store." in str(error.value)  # what to try
        assert path.read_bytes() == before
        assert [p.name for p in path.parent.iterdir()] == [path.name]

    @pytest.mark.parametrize("place", ["file/designs.sqlite", "missing/designs.sqlite", "."])
    def test_a_place_where_no_file_can_be_is_named(self, tmp_path, place):
        (tmp_path / "file").write_text("in the way")
        with pytest.raises(FileError, match=r"cannot be opened .* in a folder that can be written"):
            Store(tmp_path / place, problem())

    def test_a_file_that_another_program_holds_is_waited_for_and_then_named(self, path, monkeypatch):
        monkeypatch.setattr(store_module, "PATIENCE", 0.05)
        with Store(path, problem()) as store, contextlib.closing(sqlite3.connect(path)) as other:
            other.execute("BEGIN IMMEDIATE")
            with pytest.raises(FileError, match="has been locked"):
                store.add([[1] * 5], [Evaluation(np.ones(6), "")])
            other.rollback()
            store.add([[1] * 5], [Evaluation(np.ones(6), "")])
            assert len(store) == 1

    def test_a_value_that_was_changed_is_found(self, path):
        with Store(path, problem()) as store:
            store.add([[1] * 5], [Evaluation(np.ones(6), "")])
            with contextlib.closing(sqlite3.connect(path)) as other, other:
                other.execute("UPDATE design SET record = replace(record, '1', '2')")
            with pytest.raises(FileError, match=r"design \[1,1,1,1,1\] fails its checksum"):
                store.get([[1] * 5])

    def test_an_empty_file_becomes_a_store(self, path):
        path.touch()  # what a run leaves that was killed in its first moment
        with Store(path, problem()) as store:
            assert len(store) == 0

    @settings(max_examples=tries(25))
    @given(data=st.data())
    def test_damage_to_the_file_is_found_or_does_no_harm(self, full_store, data):
        """The file is cut, a page is overwritten, or one bit is another: a value is never a wrong one."""
        path, k, expected = full_store.parts
        copy = path.with_name("copy.sqlite")
        content = bytearray(path.read_bytes())
        kind = data.draw(st.sampled_from(["cut", "page", "bit"]))
        if kind == "cut":
            del content[data.draw(st.integers(1, len(content) - 1)) :]
        elif kind == "bit":
            content[data.draw(st.integers(0, len(content) - 1))] ^= 1 << data.draw(st.integers(0, 7))
        else:
            page = 4096 * data.draw(st.integers(0, len(content) // 4096 - 1))
            content[page : page + 4096] = data.draw(st.sampled_from([b"\0", b"\xff", b"k"])) * 4096
        copy.write_bytes(content)
        try:
            with Store(copy, problem()) as store:
                store.describe()
                found = store.get(k)
        except FileError:
            return
        finally:
            for leftover in path.parent.glob("copy.sqlite-*"):
                leftover.unlink()
        assert all(e is None or e.values.tobytes() == x for e, x in zip(found, expected, strict=True))


class Fragile:
    """Walks in batches; some designs break the program, others end the worker, but not always."""

    def __init__(self, breaking=(), deadly=(), unlucky=()):
        self.breaking, self.deadly, self.unlucky = set(breaking), set(deadly), set(unlucky)
        self.calls = 0

    def __call__(self, k):
        self.calls += 1
        first, everything = set(k[:, 0].tolist()), np.arange(len(k))
        if len(k) == 1 and first & self.unlucky:
            self.unlucky -= first
            return [(everything, Failed("the worker has died", died=True))]
        if first & self.deadly:
            return [(everything, Failed("the worker has died", died=True))]
        if first & self.breaking:
            return [(everything, Failed("ZeroDivisionError"))]
        reasons = np.array(["sunk" if i % 7 == 3 else "" for i in k[:, 0]])
        return [(everything, Walked(k * 2.0, reasons))]


class TestBadDesigns:
    @given(count=st.integers(1, 60), bad=st.sets(st.integers(0, 59), max_size=5))
    def test_halving_finds_exactly_the_designs_that_break_a_batch(self, count, bad):
        k, batch = np.stack([np.arange(count), np.ones(count, int)], axis=1), Fragile(breaking=bad)
        values, reasons, messages = walk_safely(batch, k, 2)
        bad = {i for i in bad if i < count}
        assert messages == dict.fromkeys(bad, "ZeroDivisionError")
        for i in range(count):
            if i in bad:
                assert np.isnan(values[i]).all()
                assert reasons[i] == "error"
            else:
                assert values[i].tolist() == [2.0 * i, 2.0]
                assert reasons[i] == ("sunk" if i % 7 == 3 else "")
        assert batch.calls <= 1 + 2 * len(bad) * math.ceil(math.log2(count + 1))

    def test_only_a_design_that_ends_its_worker_alone_and_twice_is_at_fault(self):
        k = np.arange(40)[:, None]
        _, reasons, messages = walk_safely(Fragile(deadly=[7], unlucky=[6]), k, 1)
        assert messages == {7: "the worker has died"}
        assert np.flatnonzero(reasons == "error").tolist() == [7]

    @pytest.mark.parametrize("error", [SettingError("engine.threads", 0, "1"), KeyboardInterrupt()])
    def test_a_wrong_setting_and_the_user_are_no_bad_designs(self, error, monkeypatch):
        p = problem()
        monkeypatch.setattr(p, "walk", mock.Mock(side_effect=error))
        with pytest.raises(type(error), match=r"threads|before a feasible design was found"):
            search(p, "ga", pop_size=8, n_gen=2)

    @pytest.mark.parametrize("error", [OSError(28, "No space left on device"), MemoryError("no memory")])
    def test_a_machine_that_fails_ends_the_run_and_is_no_bad_design(self, error, path, monkeypatch):
        p = problem()
        monkeypatch.setattr(p, "walk", mock.Mock(side_effect=error))
        with pytest.raises(FootoptError, match=r"machine has failed .*(space|memory).* resume"):
            search(p, "ga", store=path, pop_size=8, n_gen=2)
        with Store(path, p) as store:
            assert len(store) == 0

    def test_the_search_goes_on_without_a_design_that_breaks_the_program(self, path, monkeypatch, caplog):
        p = problem()
        walk, tried = p.walk, []

        def fragile(k):
            tried.append(len(k))
            if (k[:, 0] == 2).any():
                raise ZeroDivisionError("a plate without length")
            return walk(k)

        monkeypatch.setattr(p, "walk", fragile)
        r = search(p, "ga", store=path, pop_size=12, n_gen=5, seed=1)
        failed = r.k[:, 0] == 2
        assert failed.any()
        assert (r.reasons[failed] == "error").all()
        assert "error" not in r.reasons[~failed]
        assert r.failures["error"] == failed.sum()
        assert not r.feasible[failed].any()
        assert np.isnan(r.values[failed]).all()
        assert len(r.history) == 5
        assert "ZeroDivisionError: a plate without length" in caplog.text
        assert caplog.text.count("has failed and is left out") == failed.sum()
        with Store(path, p) as store:
            (row,) = store.get([r.k[failed][0].tolist()])
        assert row.message == "ZeroDivisionError: a plate without length"

        resumed = search(p, "ga", store=path, pop_size=12, n_gen=5, seed=1)
        assert_same(r, resumed)  # what had broken the program was tried again, and does so still
        assert resumed.reused == (~failed).sum()
        monkeypatch.setattr(p, "walk", walk)  # the program is mended
        mended = search(p, "ga", store=path, pop_size=12, n_gen=5, seed=1)
        assert "error" not in mended.reasons
        assert search(p, "ga", store=path, pop_size=12, n_gen=5, seed=1).reused == len(mended.k)

    def test_when_all_designs_break_the_program_the_fault_is_not_theirs(self, path, monkeypatch):
        p = problem()
        monkeypatch.setattr(p, "walk", lambda k: 1 / 0)
        with pytest.raises(FootoptError, match=r"All 8 designs .* \(ZeroDivisionError: division by zero\)"):
            search(p, "ga", store=path, pop_size=8, n_gen=2)
        with Store(path, p) as store:
            assert len(store) == 0
