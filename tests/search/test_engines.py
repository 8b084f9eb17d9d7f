"""Engines: the same result everywhere, whatever dies on the way, and nothing left behind."""

import contextlib
import gc
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
from running import assert_gone, descendants
from searching import SMALL, assert_same, problem, stop_after

import footopt as fo
from footopt import design
from footopt.design import Dask, Evaluator, Renewing, Store, engines, make_executor, search
from footopt.design import executor as executor_module
from footopt.design.executor import EACH, LARGEST, Chunks, chunks, walk_chunk
from footopt.design.starting import interrupt_held
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


def killing_after(victims, sent=signal.SIGKILL):
    """A search's progress that ends processes inside the generation after some of its generations."""

    def progress(generation):
        if pid := victims.get(generation.generation):
            threading.Timer(0.03, os.kill, (pid, sent)).start()

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
        executor_module._loaded.cache_clear()
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

    def test_that_knows_several_problems_walks_with_each(self):
        k, problems = SMALL.random(3, seed=1), [problem(zeta=zeta) for zeta in (1.0, 2.0)]
        with ThreadPoolExecutor(1) as executor:
            for p in problems * 2:
                np.testing.assert_array_equal(Evaluator(p, None, executor)(k)[0], p.walk(k)[0])

    @pytest.mark.parametrize("error", [OSError(28, "No space left on device"), MemoryError("no memory")])
    def test_a_machine_that_fails_there_ends_the_run(self, error, monkeypatch):
        batch = Chunks(problem(), Here())
        walk = mock.Mock(wraps=batch.problem.walk)
        monkeypatch.setattr(fo.FootProblem, "walk", walk)
        assert batch._sent
        assert walk.call_count == 1  # which leaves compiled code on disk: workers load it
        walk.side_effect = error
        with pytest.raises(FootoptError, match=r"machine has failed .*(space|memory).* resume"):
            batch(SMALL.random(3, seed=1))

    def test_a_problem_that_cannot_be_sent_is_said(self):
        class Inner(fo.FootProblem):
            pass

        with pytest.raises(FootoptError, match=r"cannot be sent .* in a module"):
            search(problem(kind=Inner), "ga", executor=Here(), **BUDGET)


class TestAnyExecutor:
    def test_of_threads_finds_the_same_to_the_last_bit(self, undisturbed):
        with ThreadPoolExecutor(3) as executor:
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


class TestSettings:
    def test_defaults_are_this_process(self):
        with make_executor() as executor:
            assert executor is None

    @pytest.mark.parametrize(
        ("settings", "words"),
        [
            ({"name": "mpi"}, "engine = 'mpi': must be one of local, processes, dask"),
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

    def test_too_few_files_for_a_cluster_are_said_before_it_hangs(self, monkeypatch):
        pytest.importorskip("distributed", reason="needs the extra footopt[dask]")
        monkeypatch.setattr("resource.getrlimit", lambda kind: (79, 4096))
        with pytest.raises(FootoptError, match="allows 79 open files; 80 are needed for 2 workers"):
            make_executor("dask", workers=2)

    def test_too_few_files_for_processes_are_said_before_one_cannot_start(self, monkeypatch):
        monkeypatch.setattr("resource.getrlimit", lambda kind: (35, 4096))
        with pytest.raises(FootoptError, match="allows 35 open files; 36 are needed for 2 workers"):
            make_executor("processes", workers=2)

    def test_a_missing_extra_is_named(self, monkeypatch):
        monkeypatch.setitem(sys.modules, "distributed", None)
        with pytest.raises(SettingError, match=r"pip install 'footopt\[dask\]'"):
            make_executor("dask")


class TestProcesses:
    def test_find_what_one_process_finds_to_the_last_bit(self, processes, undisturbed, tmp_path):
        path = tmp_path / "designs.sqlite"
        assert_same(undisturbed, search(problem("pareto"), "nsga2", executor=processes, store=path, **BUDGET))
        again = search(problem("pareto"), "nsga2", store=path, **BUDGET)
        assert again.reused == len(again.k)  # the store does not tell engines apart

    @pytest.mark.parametrize("designs", [1, 100])
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
    def test_that_died_while_idle_are_replaced(self, processes):
        p, k = problem(), SMALL.random(20, seed=1)
        for _ in range(2):
            assert Evaluator(p, None, processes)(k)[0].tobytes() == p.walk(k)[0].tobytes()
            for pid in workers_now():
                os.kill(pid, signal.SIGKILL)

    def test_a_wrong_setting_is_no_bad_design(self, processes):
        with pytest.raises(FootoptError, match=r"^sand\.zeta = -1\.0: must be a number > 0"):
            search(like(Wrong, problem()), "ga", executor=processes, **BUDGET)

    def test_are_started_whole_though_a_library_s_thread_hears_ctrl_c(self):
        """BLAS has threads that do; Python interrupts the main one, whatever that has blocked."""
        ended, reached = threading.Event(), []
        other = threading.Thread(target=ended.wait)
        heard, told = socket.socketpair()

        def start():
            with interrupt_held():
                signal.pthread_kill(other.ident, signal.SIGINT)
                heard.recv(1)
                reached.append("the end")

        other.start()
        told.setblocking(False)
        before = signal.set_wakeup_fd(told.fileno())
        try:
            with pytest.raises(KeyboardInterrupt):
                start()
        finally:
            signal.set_wakeup_fd(before)
            ended.set()
            other.join()
            heard.close()
            told.close()
        assert reached
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler

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

    def add(self):
        """One more worker."""
        options = ("--nthreads", "1", "--host", "127.0.0.1", "--no-dashboard", "--no-nanny")
        return self.start("worker", *options, "--local-directory", str(self.file.parent))

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
    def test_work_of_a_killed_worker_is_done_by_others_and_without_any_it_is_said(
        self, cluster, undisturbed, tmp_path
    ):
        p, path = like(Slow, problem("pareto")), tmp_path / "designs.sqlite"
        with Dask(cluster.address, timeout=30) as engine:
            engine._client.wait_for_workers(2, timeout=30)
            assert engine.workers == 2
            kill = killing_after({2: cluster.workers[0].pid})
            assert_same(undisturbed, search(p, "nsga2", kill, executor=engine, **BUDGET))
            assert engine.workers == 1
            engine._timeout = 5.0
            kill = killing_after({3: cluster.workers[1].pid})
            with pytest.raises(FootoptError, match=r"no worker is left since 5 s .* resume"):
                search(p, "nsga2", kill, path, engine, **BUDGET)
            cluster.workers.append(cluster.add())
            engine._client.wait_for_workers(1, timeout=30)
            resumed = search(p, "nsga2", None, path, engine, **BUDGET)
        assert resumed.reused > 0
        assert_same(undisturbed, resumed)

    @pytest.mark.parametrize(
        ("sent", "said"),
        [
            (signal.SIGKILL, r"the connection to the scheduler is lost.* resume"),
            (signal.SIGSTOP, r"the scheduler has not answered for 3 s .* resume"),
        ],
    )
    def test_a_scheduler_that_is_killed_or_stopped_is_said(self, cluster, sent, said):
        with Dask(cluster.address, timeout=30) as engine:
            engine._timeout = 3.0
            hit = killing_after({2: cluster.scheduler.pid}, sent)
            with pytest.raises(FootoptError, match=said):
                search(like(Slow, problem("pareto")), "nsga2", hit, executor=engine, **BUDGET)

    def test_a_scheduler_of_its_own_that_is_lost_is_said_with_what_is_too_few(self):
        """As with 40 to 60 file handles: no word of a library, nothing to start that the run has started."""

        def lost():
            raise RuntimeError("IOLoop is closed")

        with (
            Dask(workers=1, timeout=30) as engine,
            pytest.raises(FootoptError, match=r"engine=dask: .* is lost\. .*ulimit -n.* kept: resume\.$"),
        ):
            engine._ask(lost)

    def test_a_worker_that_is_stopped_is_named_and_others_do_its_work(
        self, cluster, undisturbed, monkeypatch, caplog
    ):
        monkeypatch.setattr(engines, "SILENT", 4)
        with Dask(cluster.address, timeout=30) as engine:
            engine._client.wait_for_workers(2, timeout=30)
            stop = killing_after({2: cluster.workers[0].pid}, signal.SIGSTOP)
            p = like(Slow, problem("pareto"))
            assert_same(undisturbed, search(p, "nsga2", stop, executor=engine, **BUDGET))
        assert "has been silent for 4 s" in caplog.text

    def test_results_that_cannot_be_fetched_are_said(self, cluster, monkeypatch):
        """As when the process that searches has no file left for a connection to a worker."""
        monkeypatch.setattr(engines, "SILENT", 2)
        with Dask(cluster.address, timeout=30) as engine:
            monkeypatch.setattr(engine._executor, "submit", lambda *call: Future())
            with pytest.raises(FootoptError, match=r"workers are idle, but .*ulimit -n.* resume"):
                search(problem(), "ga", executor=engine, **BUDGET)

    def test_a_cluster_of_its_own_lets_nobody_else_in(self):
        """Its ports are on loopback; none runs code, or says anything, for who has not its keys."""
        others = listening({os.getpid(), *descendants(os.getpid())})  # as a browser's driver of other tests
        with Dask(workers=1, timeout=30) as engine:
            address = engine._client.scheduler.address
            assert address.startswith("tls://127.0.0.1:")
            assert "GCDiagnosis" not in str(gc.callbacks)  # it needs a file each time
            ports = listening({os.getpid(), *descendants(os.getpid())}) - others
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
