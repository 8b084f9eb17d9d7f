"""A map of feet: the best sole of every cell, of all walks that a store knows."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from running import composed, unrender
from searching import QUICK, SMALL, problem
from study_pages import check_page

import footopt as fo
from footopt import studies
from footopt.design import Evaluation, Store, search
from footopt.design.atlas import atlas
from footopt.errors import FileError, FootoptError, SettingError

NAMES = ("hollow", "maximum_sinkage")


@pytest.fixture(scope="module")
def searched(tmp_path_factory):
    """A store with all that a search walked with, and the search."""
    path = tmp_path_factory.mktemp("atlas") / "s.sqlite"
    return path, search(problem(), "ga", pop_size=30, n_gen=4, store=path)


@pytest.fixture(scope="module")
def found(searched):
    path, result = searched
    with Store(path, result.problem) as store:
        return atlas(result.problem, store, NAMES, 5)


def test_every_cell_has_the_best_of_its_designs(searched, found):
    """As a walk through all of them has it."""
    result = searched[1]
    k = result.k[result.feasible]
    table = fo.evaluate(k, result.problem.scene, QUICK, ("efficiency", *NAMES), SMALL)
    j, descriptors = table.values[:, 0], table.values[:, 1:]
    low, high = descriptors.min(axis=0), descriptors.max(axis=0)
    at = np.minimum((5 * (descriptors - low) / (high - low)).astype(int), 4)
    cells = {tuple(cell) for cell in at}
    assert {tuple(cell) for cell in found.cells} == cells
    for cell, heights, values, count in zip(found.cells, found.k, found.values, found.counts, strict=True):
        here = (at == cell).all(axis=1)
        assert count == here.sum()
        assert values[0] == j[here].min()
        assert tuple(heights) in {tuple(row) for row in k[here & (j == values[0])]}
        np.testing.assert_array_equal(values[1:], descriptors[here & (j == values[0])][0])
    assert found.walks == result.designs
    assert found.counts.sum() == result.feasible.sum()


def test_what_is_recorded_is_read_and_gives_the_same_map(searched):
    path, result = searched
    with Store(path, result.problem) as store:
        found = atlas(result.problem, store, ("distance", "work"), 4)
    column = [result.problem.record.index(name) for name in ("distance", "work")]
    best = result.values[result.best]
    assert best[column].tolist() in found.values[:, 1:].tolist()
    assert found.values[:, 0].min() == best[5]


def test_designs_that_broke_the_program_or_failed_are_in_no_cell(searched, tmp_path):
    p = searched[1].problem
    good = searched[1].k[searched[1].feasible][:6]
    with Store(tmp_path / "s.sqlite", p) as store:
        values, reasons = p.walk(good)
        known = [Evaluation(v, str(r)) for v, r in zip(values, reasons, strict=True)]
        nothing = np.full(len(p.record), np.nan)
        store.add(good.tolist(), known)
        store.add(
            [[4, 4, 4, 4, 4], [1, 2, 2, 2, 1]],
            [Evaluation(nothing, "sunk"), Evaluation(nothing, "error", "x")],
        )
        found = atlas(p, store, ("distance", "work"), 3)
    assert found.walks == 8
    assert found.counts.sum() == 6


@pytest.mark.parametrize("names", [("hollow",), ("hollow", "hollow"), ("hollow", "colour")])
def test_descriptors_are_two_different_measures(searched, names):
    path, result = searched
    with Store(path, result.problem) as store, pytest.raises(SettingError, match=r"study\.descriptors"):
        atlas(result.problem, store, names, 5)


def test_a_store_without_designs_of_the_search_says_why(searched, tmp_path):
    other = problem(zeta=4.0)
    with Store(searched[0], other) as store, pytest.raises(FootoptError, match=r"sand\.zeta"):
        atlas(other, store, NAMES, 5)
    with Store(tmp_path / "s.sqlite", other) as store, pytest.raises(FootoptError, match="is empty"):
        atlas(other, store, NAMES, 5)


def test_the_study_draws_the_map_of_a_run(tmp_path, monkeypatch):
    unrender(monkeypatch)
    words = (
        "foot.n=5",
        "foot.K=4",
        "accuracy=draft",
        "study.confirm=null",
        "solver.pop_size=20",
        "solver.n_gen=2",
    )
    run = tmp_path / "run"
    fo.run([*words, "report=none"], run)
    studies.run(composed("study=atlas", f"study.run={run}", "study.cells=4"), tmp_path / "atlas", {})
    found = json.loads((tmp_path / "atlas" / "result.json").read_text())
    result, walked = found["atlas"], fo.Accuracy(**found["accuracy"])
    assert found["model_error"]["work"] > 0.0
    assert walked == replace(fo.Accuracy.named("draft"), adapt=False)
    with open(tmp_path / "atlas" / "atlas.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(result["cells"]) > 4
    check_page(tmp_path / "atlas")
    for folder, error in ((None, SettingError), (str(tmp_path), FileError)):
        with pytest.raises(error, match=r"^run = "):
            studies.run(
                composed("study=atlas", *([f"study.run={folder}"] if folder else [])), tmp_path / "no", {}
            )
