"""Tests with plates give zeta within its interval, what contradicts the law, or a clear refusal."""

import shutil

import numpy as np
import pytest
import yaml
from running import composed, footopt, tries

import footopt as fo
from footopt.errors import FileError
from footopt.studies.calibrate import SHALLOW, calibrate
from footopt.studies.runs import run_study

HEAD = "depth_mm,force_N,area_cm2,angle_deg,direction_deg,repeat\n"


def plates_in_sand(path, rng, zeta=0.8, exponent=1.0, repeats=5, scatter=0.12, noise=0.03, set_ups=None):
    """Write tests of a sand that is known: repeats differ by `scatter`, measurements by `noise`."""
    rows = []
    for r in range(repeats):
        own = zeta * np.exp(scatter * rng.standard_normal())
        for area, angle, direction in set_ups or [(25.0, 0.0, 90.0)]:
            x, z = fo.stress.alpha(*np.radians([angle, direction]))
            gamma = np.radians(direction)
            for depth in np.linspace(4.0, 48.0, 12):
                grown = 1e-3 * depth * (depth / 20.0) ** (exponent - 1.0)
                force = own * 1e-4 * area * (x * np.cos(gamma) + z * np.sin(gamma)) * grown
                force *= 1.0 + noise * rng.standard_normal()
                rows.append(f"{depth:.1f},{force:.3f},{area:g},{angle:g},{direction:g},{r + 1}\n")
    path.write_text(HEAD + "".join(rows))
    return path


def zeta_of(depth, exponent, zeta=1.0):  # by least squares of forces that grow with a power of depth, m
    return zeta * np.sum(depth**2 * (depth / 0.02) ** (exponent - 1)) / np.sum(depth**2)


@pytest.mark.slow
def test_intervals_hold_what_is_true_as_often_as_they_say(tmp_path):
    """Over sands, exponents of depth and numbers of repeats drawn at random."""
    rng, count = np.random.default_rng(1), tries(60)
    held = np.zeros(2)
    for _ in range(count):
        zeta, exponent, repeats = rng.uniform(0.2, 4.0), rng.uniform(0.9, 1.5), int(rng.integers(3, 9))
        found = calibrate(plates_in_sand(tmp_path / "t.csv", rng, zeta, exponent, repeats))
        shallow = found.depth[found.depth <= np.quantile(found.depth, SHALLOW)]
        ratio = zeta_of(shallow, exponent) / zeta_of(found.depth, exponent)
        (part,) = found.parts.values()
        true = zeta_of(found.depth, exponent, zeta)
        held += [found.zeta.low <= true <= found.zeta.high, part.low <= ratio <= part.high]
    assert (abs(held / count - 0.95) < 4.0 * np.sqrt(0.95 * 0.05 / count)).all(), held / count


def test_without_noise_zeta_is_exact_in_every_part(tmp_path):
    set_ups = [(25.0, 0.0, 90.0), (100.0, 30.0, 60.0), (50.0, 90.0, 0.0)]
    rng = np.random.default_rng(1)
    found = calibrate(plates_in_sand(tmp_path / "t.csv", rng, 2.0, 1.0, 2, 0.0, 0.0, set_ups))
    assert found.zeta.value == pytest.approx(2.0, rel=1e-4)  # forces are written to a millinewton
    assert [ratio.value for ratio in found.parts.values()] == pytest.approx([1.0] * 4, rel=1e-3)
    assert found.warnings == []


def test_the_spread_is_that_of_sand_prepared_anew(tmp_path):
    found = calibrate(plates_in_sand(tmp_path / "t.csv", np.random.default_rng(1), repeats=150, scatter=0.2))
    assert found.spread == pytest.approx(0.2, rel=0.1)


def test_rows_of_the_way_back_are_told(tmp_path):
    path = plates_in_sand(tmp_path / "t.csv", np.random.default_rng(1), repeats=1)
    head, *rows = path.read_text().splitlines()
    back = [",".join([row.split(",")[0], "-0.5", *row.split(",")[2:]]) for row in reversed(rows)]
    path.write_text("\n".join([head, *rows, *back]))
    assert any("on the way back" in warning for warning in calibrate(path).warnings)


@pytest.mark.parametrize("repeats", [1, 5])
def test_growth_with_another_power_is_said_of_shallow_tests(repeats, tmp_path):
    rng = np.random.default_rng(1)
    straight = calibrate(plates_in_sand(tmp_path / "t.csv", rng, repeats=repeats))
    assert not any("above" in w for w in straight.warnings)
    bent = calibrate(plates_in_sand(tmp_path / "t.csv", rng, 0.8, 1.34, repeats))
    assert "zeta of the tests less than 18.7 mm deep is 0.7" in bent.warnings[0]


@pytest.mark.parametrize("least", [4, 18])  # mm: also without rows near the surface
def test_forces_that_do_not_grow_with_depth_are_told_or_said_to_be_no_test(least, tmp_path):
    depth, path = np.linspace(least, 50, 10), tmp_path / "t.csv"
    for exponent in (0.0, 1.0, 2.0):
        force = 1.3 * 2.5 * 40.0 * (depth / 40.0) ** exponent
        np.savetxt(path, np.transpose([depth, force]), delimiter=",", header="depth_mm,force_N", comments="")
        text = path.read_text().splitlines()
        path.write_text("\n".join([f"{text[0]},area_cm2", *(f"{line},25" for line in text[1:])]))
        told = any("zeta of the tests less than" in warning for warning in calibrate(path).warnings)
        assert told == (exponent != 1.0), exponent


def test_labels_with_gaps_and_angles_in_no_unit_are_refused(tmp_path):
    path = plates_in_sand(tmp_path / "t.csv", np.random.default_rng(1))
    good = path.read_text()
    path.write_text(good.replace("90,2\n", "90,\n"))
    with pytest.raises(FileError, match="without a repeat"):
        calibrate(path)
    path.write_text(good.replace("angle_deg", "angle"))
    with pytest.raises(FileError, match="angle_deg is in degrees"):
        calibrate(path)


@pytest.mark.parametrize("mark", [";", "\t"])
def test_a_table_from_a_spreadsheet_with_decimal_commas_and_units_in_its_head_is_the_same(tmp_path, mark):
    path = plates_in_sand(tmp_path / "t.csv", np.random.default_rng(1))
    table = path.read_text().replace(
        HEAD, "Depth [mm],Force (N),Area [cm²],Angle_deg,direction [deg],Repeat\n"
    )
    other = tmp_path / "other.csv"
    other.write_text("\ufeff" + table.replace(",", mark).replace(".", ","), encoding="utf-8")
    assert calibrate(other).repeats == calibrate(path).repeats
    path.write_text(path.read_text().replace("repeat", "Trial"))
    assert calibrate(path).unread == ["Trial"]
    path.write_text(HEAD + "0.01,20,25,0,90,1\n")
    with pytest.raises(FileError, match="depth_mm is in mm"):
        calibrate(path)


def test_the_study_leaves_a_sand_that_runs_use(tmp_path):
    plates_in_sand(tmp_path / "my beach.csv", np.random.default_rng(1), 0.8, 1.3)
    for name in ("custom", "2026-11-28", "hard", "inf"):  # no name that Hydra or footopt knows otherwise
        assert shutil.copy(tmp_path / "my beach.csv", tmp_path / f"{name}.csv")
        run_study(composed("study=calibrate", f"study.tests={tmp_path}/{name}.csv"), tmp_path / name, {})
        (sand,) = (tmp_path / name / "sand").iterdir()
        assert sand.stem == f"sand_{name.replace('-', '_')}"
    done = footopt("study=calibrate", "study.tests=my beach.csv", "hydra.run.dir=found", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    file = yaml.safe_load((tmp_path / "found" / "sand" / "my_beach.yaml").read_text())
    assert file["zeta"] == pytest.approx(0.94, rel=0.15)
    words = ["study=simulate", "sand=my_beach", "accuracy=draft", "report=none"]
    used = footopt("--config-dir", "found", *words, "hydra.run.dir=walk", cwd=tmp_path)
    assert used.returncode == 0, used.stderr
    run = fo.run([*words, f"hydra.searchpath=[{tmp_path}/found]"], tmp_path / "in Python")
    assert run.objectives == fo.load(tmp_path / "walk").objectives
    assert run.scene.sand.zeta == pytest.approx(file["zeta"])
    assert run.config.sand.spread == pytest.approx(file["spread"])
