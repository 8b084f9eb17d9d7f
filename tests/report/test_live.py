"""A search that is watched: what is served, to whom, how the page grows, and how it all ends."""

import http.client
import json
import re
import signal
import socket
import struct
import threading
import time
import webbrowser
from urllib.parse import urlsplit

import numpy as np
import pytest
from browsers import Page, browser_needed
from running import BRIEF, footopt, started, wait_for
from searching import SMALL, problem

import footopt as fo
from footopt.report.page.live import Growth, Watched, live_content, watched
from footopt.studies.record import scene_entry
from footopt.walk import FIVE


@pytest.fixture(scope="module")
def searched(tmp_path_factory):
    """A problem, its result, and the folder with its store."""
    folder = tmp_path_factory.mktemp("run")
    sought = problem("pareto")
    return sought, fo.search(sought, "nsga2", store=folder / "designs.sqlite", pop_size=8, n_gen=2), folder


@pytest.fixture
def server(searched):
    sought, _, folder = searched
    made = Watched("the page", Growth(folder / "designs.sqlite", sought), folder / "report.html")
    yield made
    made.close()


def asked(address, path=None, host=None, method="GET"):
    """Status and text of what a server says."""
    parts = urlsplit(address)
    connection = http.client.HTTPConnection(parts.netloc, timeout=10)
    connection.request(method, parts.path if path is None else path, headers={"Host": host} if host else {})
    answer = connection.getresponse()
    return answer.status, answer.read().decode()


class TestServer:
    def test_serves_the_page_and_new_designs_to_who_has_the_token(self, searched, server):
        _, result, _ = searched
        assert asked(server.address) == (200, "the page")
        token = urlsplit(server.address).path
        status, text = asked(server.address, f"{token}news?from=0")
        designs = json.loads(text)["designs"]
        assert status == 200
        assert len(designs) == len(result.k)
        known = {tuple(k): values for k, values in zip(result.k.tolist(), result.values, strict=True)}
        for row in designs:
            values = np.array(row[SMALL.n : -1], float)
            assert values == pytest.approx(known[tuple(row[: SMALL.n])], rel=1e-12, nan_ok=True)
        rest = json.loads(asked(server.address, f"{token}news?from={len(designs) - 3}")[1])
        assert rest["designs"] == designs[-3:]
        assert rest["ended"] is False
        assert rest["hypervolume"] > 0.0  # of the box of the designs that were seen first

    def test_is_bound_to_this_machine(self, server):
        assert urlsplit(server.address).hostname == "127.0.0.1"
        assert server._server.server_address[0] == "127.0.0.1"

    @pytest.mark.parametrize(
        "path",
        ["/", "/x/", "{0}designs.sqlite", "{0}footopt.yaml", "{0}../run/designs.sqlite", "{0}news",
         "{0}news?from=x", "{0}%2e%2e/secret", "{0}/etc/passwd", "{0}report.html", "*", "x://[/",
         f"{{0}}news?from={5000 * '9'}"],
    )  # fmt: skip
    def test_serves_nothing_else_and_says_so(self, server, path, capfd):
        assert asked(server.address, path.format(urlsplit(server.address).path))[0] == 404
        assert capfd.readouterr().err == ""

    def test_a_browser_that_goes_away_leaves_the_terminal_alone(self, searched, capfd):
        sought, _, folder = searched
        large = Watched(30_000_000 * "x", Growth(folder / "designs.sqlite", sought), folder / "report.html")
        parts = urlsplit(large.address)
        for request in (f"GET {parts.path} HTTP/1.1\r\nHost: {parts.netloc}\r\n\r\n", "GET /"):
            with socket.create_connection((parts.hostname, parts.port)) as gone:
                gone.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # at once
                gone.sendall(request.encode())
                time.sleep(0.1)
        assert asked(large.address)[0] == 200
        large.close()
        assert capfd.readouterr().err == ""

    def test_serves_nothing_to_another_site_that_took_this_machines_address(self, server):
        assert asked(server.address, host="example.org")[0] == 404

    def test_takes_nothing(self, server):
        assert asked(server.address, method="POST")[0] == 501

    def test_serves_the_runs_own_page_once_it_has_ended_and_then_nothing(self, searched):
        sought, _, folder = searched
        made = Watched("the page", Growth(folder / "designs.sqlite", sought), folder / "ended.html")
        (folder / "ended.html").write_text("the report")
        assert asked(made.address)[1] == "the page"
        threading.Timer(0.2, asked, (made.address,)).start()
        made.end()  # waits for the browser
        assert asked(made.address)[1] == "the report"
        made.close()
        with pytest.raises(OSError):  # noqa: PT011  by whatever it is that the system refuses it
            asked(made.address)

    def test_after_a_run_without_a_page_there_is_no_other_to_go_to(self, searched, server):
        token = urlsplit(server.address).path
        assert asked(server.address)[0] == 200
        server.end()  # waits for nothing
        assert asked(server.address) == (200, "the page")
        assert json.loads(asked(server.address, f"{token}news?from=0")[1])["ended"] is False


class TestGrowth:
    def test_before_the_first_design_there_is_nothing(self, tmp_path, searched):
        assert Growth(tmp_path / "designs.sqlite", searched[0]).since(0) == []
        assert not list(tmp_path.iterdir())

    def test_has_the_hypervolume_of_the_search(self, tmp_path):
        sought, path = problem("pareto"), tmp_path / "designs.sqlite"
        growth = Growth(path, sought)
        assert growth.hypervolume() is None
        found = fo.search(sought, "nsga2", store=path, pop_size=8, n_gen=1, seed=1)
        growth.since(0)
        assert growth.hypervolume() == pytest.approx(found.history[0].hypervolume, rel=1e-12)
        found = fo.search(sought, "nsga2", store=path, pop_size=8, n_gen=3, seed=1)
        growth.since(0)
        assert growth.hypervolume() == pytest.approx(found.history[-1].hypervolume, rel=1e-12)

    def test_designs_keep_the_order_in_which_they_were_seen(self, tmp_path):
        sought, path = problem(), tmp_path / "designs.sqlite"
        growth = Growth(path, sought)
        fo.search(sought, "ga", store=path, pop_size=8, n_gen=1, seed=1)
        first = growth.since(0)
        fo.search(sought, "ga", store=path, pop_size=8, n_gen=3, seed=2)
        assert growth.since(0)[: len(first)] == first
        assert len(growth.since(len(first))) > 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["study=watch"], "run = None"),
        (["study=watch", "run=nowhere"], "run = 'nowhere': not the folder of a run"),
        (["study=watch", "run=run"], "no run is at work"),
    ],
)
def test_without_a_run_at_work_watching_is_refused_and_leaves_nothing(words, message, tmp_path):
    run = footopt("study.watch=false", "accuracy=draft", "solver.pop_size=4", "solver.n_gen=1", "report=none",
                  "study.confirm=null", "hydra.run.dir=run", cwd=tmp_path)  # fmt: skip
    assert run.returncode == 0, run.stderr
    done = footopt(*words, cwd=tmp_path)
    assert done.returncode == 1
    assert message in done.stderr
    assert not (tmp_path / "outputs" / "watch").exists() or not list(
        (tmp_path / "outputs" / "watch").iterdir()
    )


def test_the_browser_is_opened_at_the_address_that_is_said(searched, monkeypatch):
    sought, _, folder = searched
    opened, said = [], []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    entry = scene_entry(sought.scene, sought.accuracy, sought.record)
    with watched(folder, folder / "designs.sqlite", sought, 16, entry, said.append) as server:
        assert opened == [server.address]
        assert server.address in said[0]
        assert asked(server.address)[0] == 200


class Live(Page):
    """A page by its address."""

    def __init__(self, driver, address):
        self.driver = driver
        driver.get(address)

    def until(self, words, what="return document.body.innerText"):
        for _ in range(400):
            if words in self.driver.execute_script(what):
                return
            time.sleep(0.1)
        raise AssertionError(f"never {words!r}")


@browser_needed
class TestInABrowser:
    @pytest.fixture(autouse=True)
    def quiet(self, monkeypatch):
        monkeypatch.setenv(
            "BROWSER", "true"
        )  # of processes that are started: this test opens the page itself

    def test_a_search_grows_ends_in_its_own_page_and_rewinds(self, tmp_path, browser):
        words = [*BRIEF, "study.watch=true", "report=light", "hydra.run.dir=run", "solver.name=nsga2",
                 "solver.n_gen=100", "accuracy.dt=2e-4",  # for some seconds
                 f"objective.names=[{','.join(FIVE[2:])}]"]  # fmt: skip
        run = started(*words, cwd=tmp_path)
        try:
            for line in run.stdout:
                if found := re.search(r"http://\S+", line):
                    break
            shown = Live(browser, found[0])
            shown.until("of at most 1600 designs walked")
            few = int(re.search(r"(\d+) of at most", shown.text("#live"))[1])
            while (more := re.search(r"(\d+) of at most", shown.text("#live"))) and int(more[1]) == few:
                time.sleep(0.1)
            assert int(more[1]) > few
            shown.until("true", "return String(shownBest >= 0)")  # drawn in the frame after
            best, drawn = shown.js("[heights(data.best), heights(shownBest)]")
            assert best == drawn
            assert shown.js("[...front].every((i) => feasible[i])")
            volumes = shown.js("data.history.slice(1).map((row) => row.best)")
            assert 0.0 < volumes[0]
            assert volumes == sorted(volumes)
            run.communicate(timeout=120)
            assert run.returncode == 0
            shown.until("less", "return document.title")  # what became of the foot
            assert shown.js("data.live === undefined")
            last = shown.js("data.history.length")
            designs = shown.counts()[1]

            def rewind(to):
                slider = shown["#rewind"]
                browser.execute_script(
                    "arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('input'))",
                    slider,
                    to,
                )

            rewind(1)
            time.sleep(0.6)
            assert shown.js("generation[shownBest]") == 1
            first = set(shown.js("[...front]"))
            assert first == set(
                shown.js(
                    "undominated([...Array(COUNT).keys()].filter((i) => feasible[i] && generation[i] <= 1))"
                )
            )
            rewind(last)
            assert shown.counts()[1] == designs
            assert shown.errors() == []
        finally:
            run.kill()
            run.communicate()

    def test_ctrl_c_ends_the_search_and_its_server(self, tmp_path):
        run = started(
            *BRIEF, "solver.n_gen=400", "study.watch=true", "report=none", "hydra.run.dir=run", cwd=tmp_path
        )
        for line in run.stdout:
            if found := re.search(r"http://\S+", line):
                break
        assert asked(found[0])[0] == 200
        time.sleep(2)
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=120)
        assert run.returncode == 130
        with pytest.raises(OSError):  # noqa: PT011
            asked(found[0])

    def test_a_search_that_runs_already_is_watched_from_another_terminal(self, tmp_path):
        run = started(*BRIEF, "solver.n_gen=400", "report=none", "hydra.run.dir=run", cwd=tmp_path)
        wait_for(run, "Searching")
        other = started("study=watch", "run=run", cwd=tmp_path)
        for line in other.stdout:
            if found := re.search(r"http://\S+", line):
                break
        token = urlsplit(found[0]).path
        for _ in range(100):
            if designs := json.loads(asked(found[0], f"{token}news?from=0")[1])["designs"]:
                break
            time.sleep(0.1)
        assert len(designs[0]) == 7 + len(FIVE) + 2
        other.send_signal(signal.SIGINT)
        assert "the run goes on" in other.communicate(timeout=60)[0]
        assert other.returncode == 0
        assert run.poll() is None
        assert [path.name for path in tmp_path.iterdir() if path.name != "run"] in ([], ["outputs"])
        assert not list(tmp_path.glob("outputs/watch/*"))
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=120)


def test_the_page_has_room_for_all_that_may_be_walked(searched):
    sought, _, _ = searched
    content = live_content(sought, 500, scene_entry(sought.scene, sought.accuracy, sought.record))
    assert content["designs"]["values"]["shape"] == (500, len(sought.record))
    assert content["entry"]["flat"]["work"] > 0.0
