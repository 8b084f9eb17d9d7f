"""The stress law: the published map, its affine form, and the sands that use it."""

import math
from dataclasses import astuple, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import footopt as fo
from footopt.errors import FileError
from footopt.sand import GENERIC, Sand, StressMap
from footopt.sand.law import PER_CM3, power_taken
from footopt.walk.contact import Direction, resistance

ANGLE = st.floats(-2 * math.pi, 2 * math.pi)
COEFFICIENT = st.floats(-1.0, 1.0)
MAPS = st.builds(StressMap, *[COEFFICIENT] * 9)
LARGEST = PER_CM3 * sum(map(abs, astuple(GENERIC)))  # no stress of the generic map exceeds it


class TestGenericMap:
    @pytest.mark.parametrize(
        ("beta", "gamma", "alpha_x", "alpha_z"),
        [
            (0, 90, 0.0, 1.000),
            (0, -90, 0.0, -0.250),
            (0, 0, 0.136, 0.375),
            (90, 0, 0.370, 0.037),
            (30, 90, 0.1897, 0.7820),
            (60, 30, 0.4027, 0.3515),
        ],
    )
    def test_published_values(self, beta, gamma, alpha_x, alpha_z):
        ax, az = fo.stress.alpha(np.radians(beta), np.radians(gamma))
        assert ax / PER_CM3 == pytest.approx(alpha_x, abs=5e-5)
        assert az / PER_CM3 == pytest.approx(alpha_z, abs=5e-5)

    @given(ANGLE, ANGLE, MAPS)
    def test_reflection_in_a_vertical_mirror_turns_only_the_horizontal_stress(self, beta, gamma, stress_map):
        ax, az = fo.stress.alpha(beta, gamma, stress_map)
        mirrored_x, mirrored_z = fo.stress.alpha(-beta, math.pi - gamma, stress_map)
        assert mirrored_x == pytest.approx(-ax, abs=1e-14 * LARGEST * 9)
        assert mirrored_z == pytest.approx(az, abs=1e-14 * LARGEST * 9)

    @given(ANGLE, ANGLE)
    def test_a_plate_has_no_front_and_back(self, beta, gamma):
        """Turning a plate by half a turn leaves it the same plate."""
        np.testing.assert_allclose(
            fo.stress.alpha(beta + math.pi, gamma), fo.stress.alpha(beta, gamma), rtol=0, atol=1e-13 * LARGEST
        )

    def test_dissipates_in_every_direction(self):
        assert GENERIC.dissipation() == pytest.approx(0.054, abs=5e-4)

    def test_a_law_that_would_give_energy_shows_a_negative_dissipation(self):
        assert replace(GENERIC, C01=-0.253).dissipation() < 0

    @given(MAPS)
    def test_dissipation_is_the_least_power_at_any_angles(self, stress_map):
        beta, gamma = np.random.default_rng(1).uniform(-0.5, 0.5, (2, 20_000)) * [[np.pi], [2 * np.pi]]
        least, scale = stress_map.dissipation(), sum(map(abs, astuple(stress_map)))
        assert power_taken(beta, gamma, stress_map).min() / PER_CM3 >= least - 1e-3 * scale


class TestAffineForm:
    @given(ANGLE, st.tuples(ANGLE, ANGLE, ANGLE), MAPS | st.just(GENERIC))
    def test_compiled_for_the_mean_of_plates_is_the_mean_of_their_stresses(self, gamma, beta, stress_map):
        """So that a plate may stand for several chords by the mean of their cos 2 beta and sin 2 beta."""
        h = Direction(math.cos(gamma), -math.sin(gamma), 0.0, 1.0)
        c, s = np.cos(2 * np.array(beta)).mean(), np.sin(2 * np.array(beta)).mean()
        found = resistance(stress_map.law, c, s, h, 1.0, None)
        ax, az = fo.stress.alpha(beta, gamma, stress_map)
        scale = max(sum(map(abs, astuple(stress_map))), 1e-3)
        wanted = [-ax.mean() / PER_CM3, az.mean() / PER_CM3]
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-12 * scale)


class TestSand:
    def test_zeta_and_area_are_one_number(self, ramp_foot):
        """Twice the stiffness under half the width carries the same walk."""
        accuracy = fo.Accuracy(dt=5e-3, plates=40)
        narrow = replace(ramp_foot, width=0.05)
        a = fo.evaluate([ramp_foot], fo.Scene(sand=Sand(1.0)), accuracy)
        b = fo.evaluate([narrow], fo.Scene(sand=Sand(2.0)), accuracy)
        np.testing.assert_allclose(a.values, b.values, rtol=1e-9)


GRID = np.stack(np.meshgrid(np.arange(-90, 91, 30), np.arange(-90, 91, 30)), axis=-1).reshape(-1, 2)
HEAD = "beta,gamma,alpha_x,alpha_z\n"


def write_table(path, angles=GRID, noise=0.0):
    """A table of the generic map's stresses, with noise of a given standard deviation (N/cm^3)."""
    ax, az = fo.stress.alpha(*np.radians(angles).T)
    rng = np.random.default_rng(1)
    columns = [*angles.T, *(a / PER_CM3 + noise * rng.standard_normal(len(angles)) for a in (ax, az))]
    rows = [",".join(repr(float(v)) for v in row) for row in zip(*columns, strict=True)]
    path.write_text(HEAD + "\n".join(rows) + "\n")
    return path


class TestTableFit:
    def test_recovers_the_map_that_made_the_table(self, tmp_path):
        sand = fo.read_sand(write_table(tmp_path / "mine.csv"), zeta=2.0)
        np.testing.assert_allclose(astuple(sand.stress_map), astuple(GENERIC), rtol=0, atol=1e-9)
        assert max(sand.fit_error) < 1e-9
        assert (sand.name, sand.zeta) == ("mine", 2.0)

    def test_the_fit_error_is_the_size_of_the_noise(self, tmp_path):
        """Relative to the rms of the column; less the freedom that nine coefficients take up."""
        angles = np.repeat(GRID, 8, axis=0)
        noise = 0.05
        sand = fo.read_sand(write_table(tmp_path / "noisy.csv", angles, noise))
        rms = np.sqrt(np.mean(np.square(fo.stress.alpha(*np.radians(angles).T)), axis=1)) / PER_CM3
        np.testing.assert_allclose(sand.fit_error, noise / np.hypot(rms, noise), rtol=0.1)
        np.testing.assert_allclose(astuple(sand.stress_map), astuple(GENERIC), rtol=0, atol=0.02)
        with pytest.raises(FileError, match="misfit"):
            fo.read_sand(write_table(tmp_path / "noise.csv", angles, 0.6 * rms.min()))

    def test_other_columns_and_a_byte_order_mark_are_ignored(self, tmp_path):
        path = write_table(tmp_path / "t.csv")
        lines = path.read_text().splitlines()
        path.write_text("\ufeff" + "\n".join(f"{line}, note" for line in lines), encoding="utf-8")
        np.testing.assert_allclose(
            astuple(fo.read_sand(path).stress_map), astuple(GENERIC), rtol=0, atol=1e-9
        )

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("beta,gamma,alpha_x,force\n", r"lacks alpha_z.*must be beta .deg., gamma .deg., alpha_x"),
            (f"{HEAD}0,0,1,1\n0,much,1,1\n", "row 2: gamma is 'much'"),
            (f"{HEAD}0,0,1\n", "row 1 has 3 cells, the header 4"),
            (f"{HEAD}0,0,nan,1\n", "row 1: alpha_x is 'nan'"),
            (HEAD, "0 rows do not determine"),
        ],
    )
    def test_what_is_wrong_with_one_is_named(self, tmp_path, text, message):
        (tmp_path / "t.csv").write_text(text)
        with pytest.raises(FileError, match=rf"t\.csv.*{message}"):
            fo.read_sand(tmp_path / "t.csv")

    @pytest.mark.parametrize(
        ("wrong", "message"),
        [
            (lambda b, g, x, z: (-b, -g, x, -z), "a level plate that is lifted"),
            (lambda b, g, x, z: (np.pi / 2 - b, g, x, z), "a vertical plate that is pushed in"),
        ],
        ids=["z down", "beta from the vertical"],
    )
    def test_of_other_axes_is_refused(self, tmp_path, wrong, message):
        b, g = np.radians(GRID).T
        b, g, *stresses = wrong(b, g, *fo.stress.alpha(b, g))
        rows = np.stack([np.degrees(b), np.degrees(g), *(a / PER_CM3 for a in stresses)], axis=1)
        np.savetxt(tmp_path / "t.csv", rows, delimiter=",", header=HEAD.strip(), comments="")
        with pytest.raises(FileError, match=message):
            fo.read_sand(tmp_path / "t.csv")

    @pytest.mark.parametrize("angles", [GRID[:4], GRID[GRID[:, 0] == 0]], ids=["few rows", "one angle"])
    def test_too_few_angles_cannot_determine_nine_coefficients(self, tmp_path, angles):
        with pytest.raises(FileError, match="do not determine"):
            fo.read_sand(write_table(tmp_path / "t.csv", angles))
