"""Engines: the same result everywhere, whatever dies on the way, and nothing left behind."""

import contextlib
import http.client
import itertools
import json
import multiprocessing
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import forkserver, resource_tracker
from pathlib import Path
from unittest import mock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from running import BRIEF, descendants, ended, folder_of, footopt, outcome, program, started, wait_for_designs
from searching import SMALL, assert_same, problem, stop_after

import footopt as fo
from footopt import design
from footopt.design import Dask, Evaluator, Renewing, Store, engines, make_executor, search
from footopt.design import executor as executor_module
from footopt.design.executor import EACH, KNOWN, LARGEST, Chunks, chunks, walk_chunk
from footopt.errors import FootoptError, SettingError

BUDGET = {"pop_size": 16, "n_gen": 6, "seed": 3}


class Deadly(fo.FootProblem):
    """Some soles end the process that walks with them, some raise; all others are good."""

    def walk(self, k):
        if os.getpid() != self.head:
            if (k[:, :3] == [2, 3, 3]).all(axis=1).any():
                os.kill(os.getpid(), signal.SIGKILL)
            if (k[:, :2] == [3, 2]).all(axis=1).any():
                raise ZeroDivisionError("a plate without length")
        return super().walk(k)


class Slow(fo.FootProblem):
    """Each walk takes a while, so that something can happen meanwhile."""

    def walk(self, k):
        time.sleep(0.01 * len(k))
        return super().walk(k)


class Wrong(fo.FootProblem):
    """A setting turns out to be wrong in a worker."""

    def walk(self, k):
        if os.getpid() != self.head:
            raise SettingError("sand.zeta", -1.0, "a number > 0")
        return super().walk(k)


def like(kind, base):
    """The same problem, with such walks."""
    made = kind(base.scene, base.names, base.space, base.accuracy, 1)
    made.head = os.getpid()  # goes along to the workers
    return made


@pytest.fixture(scope="module")
def processes():
    with design.processes(2) as executor:
        yield executor


@pytest.fixture(scope="module")
def undisturbed():
    return search(problem("pareto"), "nsga2", **BUDGET)


def killing_after(victims):
    """A search's progress that kills processes inside the generation after some of its generations."""

    def progress(generation):
        if pid := victims.get(generation.generation):
            threading.Timer(0.03, os.kill, (pid, signal.SIGKILL)).start()

    return progress


def pids():
    """Children of this process that are alive or zombies."""
    stats = [p.read_text() for p in Path("/proc").glob("[0-9]*/stat") if p.parent.exists()]
    return {int(s.split()[0]) for s in stats if int(s.rpartition(")")[2].split()[1]) == os.getpid()}


SCRIPT = """
import footopt as fo
from footopt.design import processes
with processes(1) as executor:
    fo.search(fo.FootProblem(accuracy="draft"), pop_size=4, n_gen=1, executor=executor)
"""

GUARDED = """
import footopt as fo
from footopt.design import Evaluator, processes
if __name__ == "__main__":
    with processes(3) as executor:
        p = fo.FootProblem(accuracy="draft")
        Evaluator(p, None, executor)(p.space.random(300, seed=1))
"""


def helpers():
    """multiprocessing's own, which live as long as this process."""
    return {resource_tracker._resource_tracker._pid, forkserver._forkserver._forkserver_pid}


def workers_now():
    """Processes that work for this one."""
    return {child.pid for child in multiprocessing.active_children()}


class TestChunks:
    @given(st.integers(1, 10**6), st.integers(1, 1000), st.floats(0, 1), st.floats(1e-4, 1e-2))
    def test_are_the_whole_batch_in_its_order(self, designs, workers, cost, overhead):
        parts = chunks(designs, workers, cost, overhead)
        assert parts[0].start == 0
        assert parts[-1].stop >= designs > parts[-1].start
        assert all(a.stop == b.start for a, b in itertools.pairwise(parts))
        assert max(p.stop - p.start for p in parts) <= LARGEST

    @given(st.integers(1, 4000), st.integers(1, 300), st.floats(1e-4, 1e-2), st.floats(1e-4, 1e-2))
    def test_are_as_many_as_finish_soonest(self, designs, workers, cost, overhead):
        def time(count):
            return count * overhead + designs * cost / min(count, workers)

        best = min(map(time, range(1, min(designs, workers) + 1)))
        assert time(len(chunks(designs, workers, cost, overhead))) <= 1.06 * best + 2.0 * overhead + cost

    def test_of_a_first_batch_are_one_a_worker_and_of_a_large_one_many(self):
        assert len(chunks(2000, 10, 0.0, 1e-3)) == 10
        assert len(chunks(40_000, 10, 1e-2, 1e-3)) == 10 * EACH


class Here(Executor):
    """Has its calls done at once, by a worker whose memory is empty."""

    def submit(self, fn, /, *args, **kwargs):
        future = Future()
        executor_module._problems.clear()
        future.set_result(fn(*args, **kwargs))
        return future


class TestWorker:
    def test_of_other_versions_says_which(self, monkeypatch):
        class Elsewhere(Here):
            def submit(self, fn, /, *args, **kwargs):
                with monkeypatch.context() as there:
                    there.setattr("footopt.design.context.version", lambda name: "0.1")
                    return super().submit(fn, *args, **kwargs)

        with pytest.raises(FootoptError, match=r"versions\.numba \(0\.1 there, .* here\)") as error:
            search(problem(), "ga", executor=Elsewhere(), **BUDGET)
        assert socket.gethostname() in str(error.value)

    def test_says_what_it_cannot_load(self):
        refused = walk_chunk("0", b"cmissing\nThing\n.", SMALL.random(3, seed=1))
        assert "ModuleNotFoundError: No module named 'missing'" in refused.message

    def test_keeps_a_few_problems(self):
        k, problems = SMALL.random(3, seed=1), [problem(zeta=1.0 + i) for i in range(KNOWN + 1)]
        with ThreadPoolExecutor(1) as executor:
            found = [Evaluator(p, None, executor)(k)[0] for p in problems]
        assert len(executor_module._problems) == KNOWN
        np.testing.assert_array_equal(found, [p.walk(k)[0] for p in problems])

    @pytest.mark.parametrize("error", [OSError(28, "No space left on device"), MemoryError("no memory")])
    def test_a_machine_that_fails_there_ends_the_run(self, error, monkeypatch):
        p = problem()
        batch = Chunks(p, Here())
        assert batch._sent  # made before walks fail
        monkeypatch.setattr(fo.FootProblem, "walk", mock.Mock(side_effect=error))
        with pytest.raises(FootoptError, match=r"machine has failed .*(space|memory).* resume"):
            batch(SMALL.random(3, seed=1))

    def test_a_problem_that_cannot_be_sent_is_said(self):
        class Inner(fo.FootProblem):
            pass

        with pytest.raises(FootoptError, match=r"cannot be sent .* in a module"):
            search(problem(kind=Inner), "ga", executor=Here(), **BUDGET)


class TestAnyExecutor:
    @pytest.mark.parametrize("workers", [1, 3])
    def test_of_threads_finds_the_same_to_the_last_bit(self, undisturbed, workers):
        with ThreadPoolExecutor(workers) as executor:
            assert_same(undisturbed, search(problem("pareto"), "nsga2", executor=executor, **BUDGET))

    @pytest.mark.slow
    def test_of_the_standard_library_is_not_replaced_but_the_run_can_be_resumed(self, undisturbed, tmp_path):
        path, start = tmp_path / "designs.sqlite", multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(2, mp_context=start) as executor:
            executor.submit(os.getpid).result()
            kill = killing_after({3: next(iter(executor._processes))})
            with pytest.raises(FootoptError, match=r"cannot be used any more: a worker has died .* resume"):
                search(like(Slow, problem("pareto")), "nsga2", kill, path, executor, **BUDGET)
        with Renewing(lambda: ProcessPoolExecutor(2, mp_context=start)) as executor:
            resumed = search(like(Slow, problem("pareto")), "nsga2", None, path, executor, **BUDGET)
        assert resumed.reused > 0
        assert_same(undisturbed, resumed)

    @pytest.mark.slow
    def test_of_a_dask_client_finds_the_same(self, undisturbed):
        distributed = pytest.importorskip("distributed", reason="needs the extra footopt[dask]")
        settings = {"n_workers": 1, "threads_per_worker": 1, "dashboard_address": ":0"}
        with distributed.Client(**settings, set_as_default=False) as client:
            found = search(problem("pareto"), "nsga2", executor=client.get_executor(), **BUDGET)
        assert_same(undisturbed, found)


class TestSettings:
    def test_defaults_are_this_process(self):
        with make_executor() as executor:
            assert executor is None

    @pytest.mark.parametrize(
        ("settings", "words"),
        [
            ({"name": "mpi"}, "engine.name = 'mpi': must be one of local, processes, dask"),
            ({"workers": 2}, "engine.workers = 2: must be null"),
            ({"name": "processes", "workers": 0}, "engine.workers = 0: must be a whole number >= 1"),
            ({"name": "processes", "address": "tcp://a:1"}, "engine.address = 'tcp://a:1': must be null"),
            ({"name": "dask", "workers": 2, "address": "tcp://a:1"}, "engine.workers = 2: must be null"),
            ({"name": "dask", "timeout": 0.0}, "engine.timeout = 0.0: must be a time > 0"),
            *(
                ({"name": "dask", "address": a}, f"engine.address = {a!r}: must be tcp://host:port")
                for a in ("", "node7", "node7:8786", "http://node7:8786", "tcp://node7", "tcp://node7:x")
            ),
        ],
    )
    def test_that_do_not_fit_are_refused(self, settings, words):
        with pytest.raises(SettingError) as error:
            make_executor(**settings)
        assert words in str(error.value)

    @pytest.mark.parametrize(
        "error", [RuntimeError("Nanny failed to start."), OSError(24, "Too many open files")]
    )
    def test_a_cluster_that_cannot_start_is_said(self, error, monkeypatch):
        distributed = pytest.importorskip("distributed", reason="needs the extra footopt[dask]")
        monkeypatch.setattr(distributed, "LocalCluster", mock.Mock(side_effect=error))
        with pytest.raises(
            FootoptError, match=r"engine=dask: a worker cannot start \(.*(Nanny|files).*ulimit"
        ):
            Dask(workers=1)

    def test_a_missing_extra_is_named(self, monkeypatch):
        monkeypatch.setitem(sys.modules, "distributed", None)
        with pytest.raises(SettingError, match=r"pip install 'footopt\[dask\]'"):
            make_executor("dask")

    def test_studies_that_walk_here_refuse_another_engine(self, tmp_path):
        from footopt import studies
        from footopt.studies.settings import Config, EngineConfig, StudyConfig

        config = Config(study=StudyConfig(name="simulate"), engine=EngineConfig(name="dask"))
        with pytest.raises(SettingError, match=r"engine\.name = 'dask': must be local for study=simulate"):
            studies.run(config, tmp_path, {})


class TestProcesses:
    def test_find_what_one_process_finds_to_the_last_bit(self, processes, undisturbed, tmp_path):
        path = tmp_path / "designs.sqlite"
        assert_same(undisturbed, search(problem("pareto"), "nsga2", executor=processes, store=path, **BUDGET))
        again = search(problem("pareto"), "nsga2", store=path, **BUDGET)
        assert again.reused == len(again.k)  # the store does not tell engines apart

    @pytest.mark.parametrize("designs", [1, 2, 7, 100])
    def test_any_batch_is_the_same_as_here(self, processes, designs):
        p, k = problem(zeta=0.05), SMALL.random(designs, seed=designs)  # some sink
        (values, reasons), (here, why) = Evaluator(p, None, processes)(k), p.walk(k)
        assert values.tobytes() == here.tobytes()
        assert reasons.tolist() == why.tolist()

    @pytest.mark.slow
    def test_a_design_that_kills_is_found_and_left_out(self, processes, tmp_path, caplog):
        p = like(Deadly, problem())
        # two that kill and one that raises, all in one generation
        budget = BUDGET | {"n_gen": 2, "seed": 69}
        r = search(p, "ga", executor=processes, store=tmp_path / "designs.sqlite", **budget)
        killing, raising = (r.k[:, :3] == [2, 3, 3]).all(axis=1), (r.k[:, :2] == [3, 2]).all(axis=1)
        assert (killing.sum(), raising.sum()) == (2, 1)
        assert len(set(r.generation[killing | raising])) == 1
        np.testing.assert_array_equal(r.reasons == "error", killing | raising)
        with Store(tmp_path / "designs.sqlite", p) as store:
            assert "the worker has died" in store.get(r.k[killing].tolist())[0].message
            assert "ZeroDivisionError: a plate" in store.get(r.k[raising].tolist())[0].message
        assert "has failed and is left out: the worker has died" in caplog.text

    @pytest.mark.slow
    def test_a_worker_that_is_killed_meanwhile_is_replaced(self, processes, undisturbed):
        p = like(Slow, problem("pareto"))
        victims = set()

        def kill(generation):
            if generation.generation in (1, 3):
                victims.add(min(workers_now()))
                threading.Timer(0.03, os.kill, (min(workers_now()), signal.SIGKILL)).start()

        assert_same(undisturbed, search(p, "nsga2", kill, executor=processes, **BUDGET))
        assert len(victims) == 2
        assert not workers_now() & victims

    @pytest.mark.slow
    def test_a_worker_that_is_stopped_is_named_and_others_do_its_work(self, processes, monkeypatch, caplog):
        monkeypatch.setattr(engines, "SILENT", 3)
        k, victims = SMALL.random(400, seed=1), []  # 2 s for each of two workers
        Evaluator(problem(), None, processes)(k[:4])  # they are there

        def stop():
            victims.append(min(workers_now()))
            os.kill(victims[0], signal.SIGSTOP)

        threading.Timer(0.5, stop).start()
        found = Evaluator(like(Slow, problem()), None, processes)(k)[0]
        assert found.tobytes() == problem().walk(k)[0].tobytes()
        assert f"worker process {victims[0]} has been silent for 3 s" in caplog.text
        assert not workers_now() & set(victims)

    @pytest.mark.slow
    def test_a_stopped_fork_server_is_replaced(self, monkeypatch):
        """It is the process that starts the workers: while it is stopped, none ever starts."""
        monkeypatch.setattr(executor_module, "PATIENCE", (3.0, 60.0))
        forkserver.ensure_running()
        server = forkserver._forkserver._forkserver_pid
        os.kill(server, signal.SIGSTOP)
        p, k = problem(), SMALL.random(5, seed=1)
        with design.processes(1) as executor:
            assert Evaluator(p, None, executor)(k)[0].tobytes() == p.walk(k)[0].tobytes()
        assert_gone({server})

    @pytest.mark.slow
    def test_a_worker_that_works_for_long_is_left_alone(self, processes, monkeypatch, caplog):
        monkeypatch.setattr(engines, "SILENT", 2)
        p = like(Slow, problem())
        k = SMALL.random(700, seed=1)  # 3.5 s for each of two workers
        assert Evaluator(p, None, processes)(k)[0].tobytes() == problem().walk(k)[0].tobytes()
        assert caplog.text == ""

    @pytest.mark.slow
    @pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")  # what loses them
    def test_results_that_are_lost_on_the_way_are_walked_again(self, monkeypatch, caplog):
        """As when a thread of the pool, in this process, has died for lack of memory."""
        monkeypatch.setattr(engines, "SILENT", 2)
        p, k = problem(), SMALL.random(20, seed=1)
        with design.processes(2) as executor:
            Evaluator(p, None, executor)(k[:2])
            pool = executor._executor
            monkeypatch.setattr(pool._work_ids, "put", lambda item: None)
            assert Evaluator(p, None, executor)(k)[0].tobytes() == p.walk(k)[0].tobytes()
            assert executor._executor is not pool
        assert "their results are missing: new ones walk again" in caplog.text

    @pytest.mark.parametrize(
        "error", [OSError(24, "Too many open files"), MemoryError(), RuntimeError("thread"), EOFError()]
    )
    def test_a_machine_that_is_short_of_something_for_a_while_is_asked_again(self, monkeypatch, error):
        monkeypatch.setattr(executor_module, "PAUSE", 0.0)
        left = [error, error]

        def make():
            if left:
                raise left.pop()
            return ThreadPoolExecutor(1)

        p, k = problem(), SMALL.random(5, seed=1)
        with Renewing(make) as executor:
            assert Evaluator(p, None, executor)(k)[0].tobytes() == p.walk(k)[0].tobytes()
            assert left == []
            executor.shutdown()
            left[:] = [error] * 3
            with pytest.raises(FootoptError, match=rf"a worker cannot start \({type(error).__name__}"):
                Evaluator(p, None, executor)(k)

    def test_a_pool_that_hangs_while_it_starts_is_made_again(self, monkeypatch):
        """Without memory, `Thread.start` of the standard library waits for ever."""
        monkeypatch.setattr(executor_module, "PATIENCE", (0.2, 30.0))
        hanging, end = [True], threading.Event()

        class Pool(ThreadPoolExecutor):
            def submit(self, fn, /, *args):
                if hanging:
                    hanging.clear()
                    end.wait()
                return super().submit(fn, *args)

        p, k = problem(), SMALL.random(5, seed=1)
        with Renewing(lambda: Pool(1)) as executor:
            assert Evaluator(p, None, executor)(k)[0].tobytes() == p.walk(k)[0].tobytes()
        end.set()

    @pytest.mark.slow
    def test_that_are_killed_while_they_start_are_started_again(self, undisturbed):
        """Twice, the first worker that there is dies at once."""
        stop, before = threading.Event(), workers_now()

        def kill():
            for _ in range(2):
                while not (new := workers_now() - before) and not stop.is_set():
                    time.sleep(0.001)
                for pid in new:
                    with contextlib.suppress(ProcessLookupError):
                        os.kill(pid, signal.SIGKILL)
                before.update(new)

        killer = threading.Thread(target=kill)
        killer.start()
        try:
            with design.processes(2) as executor:
                found = search(problem("pareto"), "nsga2", executor=executor, **BUDGET)
        finally:
            stop.set()
            killer.join()
        assert_same(undisturbed, found)

    @pytest.mark.slow
    def test_that_died_while_idle_are_replaced(self, processes):
        p, k = problem(), SMALL.random(20, seed=1)
        for _ in range(2):
            assert Evaluator(p, None, processes)(k)[0].tobytes() == p.walk(k)[0].tobytes()
            for pid in workers_now():
                os.kill(pid, signal.SIGKILL)

    def test_a_wrong_setting_is_no_bad_design(self, processes):
        with pytest.raises(FootoptError, match=r"^sand\.zeta = -1\.0: must be a number > 0"):
            search(like(Wrong, problem()), "ga", executor=processes, **BUDGET)

    def test_interrupted_leave_what_was_found_and_go_on(self, processes, undisturbed):
        p = problem("pareto")
        assert len(search(p, "nsga2", stop_after(2), executor=processes, **BUDGET).history) == 2
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        before = signal.signal(signal.SIGALRM, signal.default_int_handler)
        try:
            with pytest.raises(KeyboardInterrupt):
                Evaluator(like(Slow, p), None, processes)(SMALL.random(100, seed=1))
        finally:
            signal.signal(signal.SIGALRM, before)
        assert_same(undisturbed, search(p, "nsga2", executor=processes, **BUDGET))

    @pytest.mark.slow
    def test_leave_nothing_behind(self):
        before, others = pids(), workers_now()  # an executor that tests share may be at work
        p, k = problem(), SMALL.random(20, seed=1)
        with design.processes(2) as executor:
            Evaluator(p, None, executor)(k)
            assert workers_now() - others
        assert workers_now() <= others
        assert pids() - before <= helpers()

    @pytest.mark.slow
    def test_a_script_without_a_guard_is_told(self, tmp_path):
        (tmp_path / "study.py").write_text(SCRIPT)
        done = subprocess.run(
            [sys.executable, "study.py"], cwd=tmp_path, capture_output=True, text=True, timeout=120
        )
        assert done.returncode == 1
        assert "FootoptError: engine=processes: a worker cannot start (it dies at once)" in done.stderr
        assert '`if __name__ == "__main__":`' in done.stderr


class Cluster:
    """A scheduler and workers as processes of their own, on loopback."""

    def __init__(self, folder, count):
        self.file = folder / "scheduler.json"
        self.env = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
        self.scheduler = self.start("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")
        self.workers = [self.add() for _ in range(count)]
        deadline = time.monotonic() + 60
        while not (self.file.is_file() and self.file.stat().st_size):
            assert time.monotonic() < deadline
            time.sleep(0.05)
        self.address = json.loads(self.file.read_text())["address"]

    def start(self, kind, *arguments):
        """`dask scheduler` or `dask worker`."""
        command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", "--scheduler-file", str(self.file)]
        return subprocess.Popen([*command, *arguments], env=self.env, stderr=subprocess.DEVNULL)

    def add(self, **env):
        """One more worker."""
        self.env |= env
        options = ("--nthreads", "1", "--host", "127.0.0.1", "--no-dashboard", "--no-nanny")
        worker = self.start("worker", *options, "--local-directory", str(self.file.parent))
        return worker

    def close(self):
        """End all of it."""
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()


@pytest.fixture
def cluster(tmp_path):
    pytest.importorskip("distributed", reason="needs the extra footopt[dask]")
    started = Cluster(tmp_path, 2)
    yield started
    started.close()


@pytest.mark.slow
class TestDask:
    def test_a_worker_that_is_killed_meanwhile_changes_nothing(self, cluster, undisturbed, tmp_path):
        p = like(Slow, problem("pareto"))
        with Dask(cluster.address, timeout=30) as engine:
            engine._client.wait_for_workers(2, timeout=30)
            assert engine.workers == 2
            kill = killing_after({2: cluster.workers[0].pid})
            assert_same(undisturbed, search(p, "nsga2", kill, executor=engine, **BUDGET))
            assert engine.workers == 1
            assert cluster.workers[0].wait() == -signal.SIGKILL

    def test_without_workers_it_is_said_and_the_search_resumes(self, cluster, undisturbed, tmp_path):
        p, path = like(Slow, problem("pareto")), tmp_path / "designs.sqlite"
        with Dask(cluster.address, timeout=30) as engine:
            engine._client.wait_for_workers(2, timeout=30)
            engine._timeout = 2.0
            kill = killing_after({2: cluster.workers[0].pid, 3: cluster.workers[1].pid})
            with pytest.raises(FootoptError, match=r"no worker is left since 2 s .* resume"):
                search(p, "nsga2", kill, path, engine, **BUDGET)
            cluster.workers.append(cluster.add())
            engine._client.wait_for_workers(1, timeout=30)
            resumed = search(p, "nsga2", None, path, engine, **BUDGET)
        assert resumed.reused > 0
        assert_same(undisturbed, resumed)

    def test_a_lost_scheduler_is_said(self, cluster, tmp_path):
        p = like(Slow, problem("pareto"))
        with Dask(cluster.address, timeout=5) as engine:
            kill = killing_after({2: cluster.scheduler.pid})
            with pytest.raises(FootoptError, match=r"the connection to the scheduler is lost.* resume"):
                search(p, "nsga2", kill, executor=engine, **BUDGET)

    def test_a_worker_that_is_stopped_is_named_and_others_do_its_work(
        self, cluster, undisturbed, monkeypatch, caplog
    ):
        monkeypatch.setattr(engines, "SILENT", 4)
        with Dask(cluster.address, timeout=30) as engine:
            engine._client.wait_for_workers(2, timeout=30)

            def stop(generation):
                if generation.generation == 2:
                    os.kill(cluster.workers[0].pid, signal.SIGSTOP)

            p = like(Slow, problem("pareto"))
            assert_same(undisturbed, search(p, "nsga2", stop, executor=engine, **BUDGET))
        assert "has been silent for 4 s" in caplog.text

    def test_a_scheduler_that_is_stopped_is_said(self, cluster):
        p = like(Slow, problem("pareto"))
        with Dask(cluster.address, timeout=3) as engine:

            def stop(generation):
                if generation.generation == 2:
                    os.kill(cluster.scheduler.pid, signal.SIGSTOP)

            with pytest.raises(FootoptError, match=r"the scheduler has not answered for 3 s .* resume"):
                search(p, "nsga2", stop, executor=engine, **BUDGET)

    def test_a_cluster_of_its_own_lets_nobody_else_in(self):
        """Its ports are on loopback; none runs code, or says anything, for who has not its keys."""
        with Dask(workers=1, timeout=30) as engine:
            address = engine._client.scheduler.address
            assert address.startswith("tls://127.0.0.1:")
            ports = listening({os.getpid(), *descendants(os.getpid())})
            assert len(ports) >= 2
            assert {host for host, _ in ports} == {"127.0.0.1"}
            with pytest.raises(OSError, match=r"closed|Timed out"):
                distributed_client(address.replace("tls://", "tcp://"))
            for host, port in ports:
                with contextlib.closing(http.client.HTTPConnection(host, port, timeout=5)) as web:
                    try:
                        web.request("GET", "/json/identity.json")
                        assert web.getresponse().status == 404
                    except (OSError, http.client.HTTPException):
                        pass  # it speaks TLS only

    def test_a_cluster_of_its_own_leaves_out_what_kills_and_leaves_nothing_behind(self, undisturbed):
        before = pids()
        with Dask(workers=2, timeout=30) as engine:
            assert_same(undisturbed, search(problem("pareto"), "nsga2", executor=engine, **BUDGET))
            p, k = like(Deadly, problem()), np.array([[1, 2, 3, 4, 1], [2, 3, 3, 1, 1], [1, 1, 1, 2, 1]])
            values, reasons = Evaluator(p, None, engine)(k)
        assert reasons.tolist() == ["", "error", ""]
        np.testing.assert_array_equal(values[[0, 2]], problem().walk(k[[0, 2]])[0])
        assert pids() - before <= helpers()

    def test_no_scheduler_or_no_worker_is_said_in_time(self, tmp_path):
        with pytest.raises(FootoptError, match=r"'tcp://127\.0\.0\.1:1': no scheduler answers within 0\.5 s"):
            Dask("tcp://127.0.0.1:1", timeout=0.5)
        alone = Cluster(tmp_path, 0)
        try:
            with pytest.raises(FootoptError, match=r"the scheduler has no worker after 2 s"):
                Dask(alone.address, timeout=2.0)
        finally:
            alone.close()


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    """The folder of a run from the command line that nothing stopped, in one process."""
    return folder_of(tmp_path_factory, *BRIEF, "solver=nsga2")


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["processes", "dask"])
class TestCommandLine:
    def test_finds_the_same(self, here, engine, tmp_path):
        if engine == "dask":
            pytest.importorskip("distributed", reason="needs the extra footopt[dask]")
        done = program(
            *BRIEF, "solver=nsga2", f"engine={engine}", "engine.workers=2", "hydra.run.dir=run", cwd=tmp_path
        )
        assert done.returncode == 0, done.stderr
        assert done.stderr == ""
        there, alone = outcome(tmp_path / "run"), outcome(here)
        assert there[0] | {"settings": 0} == alone[0] | {"settings": 0}
        assert there[1:] == alone[1:]

    def test_ctrl_c_is_heard_by_one_process_only(self, here, engine, tmp_path):
        if engine == "dask":
            pytest.importorskip("distributed", reason="needs the extra footopt[dask]")
        settings = (*BRIEF, "solver=nsga2", f"engine={engine}", "engine.workers=2", "hydra.run.dir=run")
        run = started(*settings, cwd=tmp_path, start_new_session=True)
        wait_for_designs(run, tmp_path / "run", 5 * 16)
        family = descendants(run.pid)
        os.killpg(run.pid, signal.SIGINT)  # as a terminal does
        _, err = ended(run)
        assert run.returncode == 130
        assert err.startswith("footopt: stopped after generation ")
        assert "Traceback" not in err
        assert len(family) >= 2
        assert_gone(family)
        done = footopt("resume=run", "engine=local", "engine.workers=null", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert outcome(tmp_path / "run")[1:] == outcome(here)[1:]

    def test_workers_end_with_a_run_that_is_killed(self, engine, tmp_path):
        if engine == "dask":
            pytest.importorskip("distributed", reason="needs the extra footopt[dask]")
        run = started(*BRIEF, f"engine={engine}", "engine.workers=2", "hydra.run.dir=run", cwd=tmp_path)
        wait_for_designs(run, tmp_path / "run", 5 * 16)
        family = descendants(run.pid)
        assert len(family) >= 2
        run.kill()
        ended(run)
        assert_gone(family)


def distributed_client(address):
    """A client without keys."""
    import distributed

    return distributed.Client(address, timeout=2, set_as_default=False)


def listening(family):
    """Hosts and ports at which processes listen."""
    sockets = set()
    for pid in family:
        for number in Path(f"/proc/{pid}/fd").glob("*"):
            with contextlib.suppress(OSError):
                sockets.add(os.readlink(number))
    found = set()
    for table, size in (("tcp", 4), ("tcp6", 16)):
        for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]:
            words = line.split()
            if words[3] == "0A" and f"socket:[{words[9]}]" in sockets:
                host, port = words[1].split(":")
                raw = bytes.fromhex(host)
                text = ".".join(map(str, reversed(raw))) if size == 4 else raw.hex()
                found.add((text, int(port, 16)))
    return found


def assert_gone(family):
    """Wait for processes to end; those that nobody has asked about yet (zombies) have."""
    deadline = time.monotonic() + 30
    while left := [pid for pid in family if alive(pid)]:
        assert time.monotonic() < deadline, left
        time.sleep(0.05)


def alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.slow
def test_workers_load_what_the_head_has_compiled(tmp_path):
    (tmp_path / "study.py").write_text(GUARDED)
    env = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache"), "NUMBA_DEBUG_CACHE": "1"}
    done = subprocess.run([sys.executable, "study.py"], cwd=tmp_path, env=env, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stdout.splitlines() if "walk_range" in line]
    assert sum("data saved to" in line for line in lines) == 1
    assert sum("data loaded from" in line for line in lines) == 3
