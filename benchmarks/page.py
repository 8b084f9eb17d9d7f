"""How long the page takes to open with 10,000 designs, and to follow a sole that is drawn on it.

python benchmarks/page.py            # chromium and chromedriver are on the PATH
python benchmarks/page.py --quick    # a small page, once: does it run?

An update is a new sole's walk, and all that shows it: script, layout and painting, in processor time of the
browser's main thread, with all else in its frame, such as the step that is looping. Between two updates there
is a frame without one, whose time is measured by itself and left out. Each number is a mean over ten updates.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import footopt as fo
from footopt.design import confirm
from footopt.report import page

sys.path.append(str(Path(__file__).parents[1] / "tests" / "report"))
from browsers import CHROMIUM, DRIVER, start

UPDATES = 5
MOVE = """
const [keys, done] = arguments;
const next = () => {
  if (!keys.length) { done(); return; }
  const [waypoint, key] = keys.pop();
  if (!key) { requestAnimationFrame(() => requestAnimationFrame(next)); return; }
  const grip = document.querySelector(`[role=slider][data-waypoint="${waypoint}"]`);
  grip.focus({ preventScroll: true });
  grip.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
  requestAnimationFrame(() => requestAnimationFrame(next));
};
next();
"""


def write(folder: Path, sand: str, designs: int) -> Path:
    """The page of a search for five objectives."""
    problem = fo.FootProblem(fo.Scene(sand=fo.Sand.named(sand)), objective="pareto", accuracy="draft")
    result = fo.search(problem, "nsga2", pop_size=100, n_gen=designs // 100, seed=1)
    confirmed = confirm(result, "standard", 2)
    best = fo.Foot.from_waypoints(result.k[confirmed.designs[0]], problem.space)
    walk, flat = (fo.simulate(foot, problem.scene, "standard") for foot in (best, fo.Foot.flat()))
    entry = {
        "flat": flat.objectives,
        "remarks": [],
        "accuracy": {"name": "standard"},
        "scene": {"effects": {}},
    }
    content = page.search_content(result, confirmed, walk, flat, entry)
    return page.write(folder / "report.html", content | {"folder": "outputs/optimize/one", "overrides": ""})


def busy(driver) -> float:
    """How long the main thread has worked so far, ms."""
    metrics = driver.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]
    return 1e3 * next(m["value"] for m in metrics if m["name"] == "TaskDuration")


def work(driver, keys: list[tuple[int, str]]) -> float:
    """How long the main thread works for each key and its two frames, ms."""
    began = busy(driver)
    driver.execute_async_script(MOVE, keys)
    return (busy(driver) - began) / len(keys)


def measured(driver, path: Path, sets: int) -> tuple[float, list[float]]:
    """Milliseconds until the page has opened, and those of an update in each set but the first."""
    driver.get(path.as_uri())
    time.sleep(1.0)
    opened = driver.execute_script("return performance.getEntriesByType('navigation')[0].duration")
    count = len(driver.find_elements("css selector", "[role=slider][data-waypoint]"))
    driver.execute_cdp_cmd("Performance.enable", {"timeDomain": "threadTicks"})
    rng, found = np.random.default_rng(1), []
    for _ in range(sets + 1):
        keys = [(int(rng.integers(count)), key) for _ in range(UPDATES) for key in ("ArrowUp", "ArrowDown")]
        with_updates = work(driver, keys)
        time.sleep(0.3)
        found.append(with_updates - work(driver, [(0, "")] * len(keys)) / 2)
    return opened, found[1:]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small and once: does it run?")
    quick = parser.parse_args().quick
    print("| sand | designs | page (MB) | opens in (ms) | an update (ms): median, 95 % |")
    print("| --- | --- | --- | --- | --- |")
    if not (CHROMIUM and DRIVER):
        sys.exit(print("| any | skipped: no chromium |"))
    with tempfile.TemporaryDirectory() as folder:
        driver = start(folder, Path(folder) / "profile")
        for sand in ("soft",) if quick else ("soft", "regular", "hard"):
            path = write(Path(folder), sand, 200 if quick else 10_000)
            opened, updates = measured(driver, path, 2 if quick else 30)
            size = path.stat().st_size / 1e6
            median, most = np.percentile(updates, [50, 95])
            count = "200" if quick else "10,000"
            print(f"| {sand} | {count} | {size:.1f} | {opened:.0f} | {median:.1f}, {most:.1f} |", flush=True)
        driver.quit()
