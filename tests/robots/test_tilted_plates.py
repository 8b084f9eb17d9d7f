"""The planar law on plates that are tilted across their motion: what it keeps, how near to 3D-RFT it is."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import footopt as fo
from footopt.mujoco.faces import planar
from footopt.sand import alpha

LAW = fo.Sand().stress_map.law
UP = (0.0, 0.0, 1.0)
TURN = st.floats(0.0, 2 * np.pi)
RISE = st.floats(-np.pi / 2, np.pi / 2)


def unit(azimuth, rise):
    return np.array([np.cos(rise) * np.cos(azimuth), np.cos(rise) * np.sin(azimuth), np.sin(rise)])


def stress(n, h):
    """Of a flat plate, N/cm^3. Its normal is turned into x and z, as in a foot, and all else with it."""
    side = np.hypot(n[0], n[1])
    c, s = (n[0] / side, n[1] / side) if side > 1e-12 else (1.0, 0.0)
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    x, _, z = turn @ n
    p, _ = planar(LAW, x * x, x * z, z * z, UP, tuple(turn @ h))
    return turn.T @ p


def rolled(roll, pitch, h):
    """The same of a plate of a foot that is rolled, found in the foot's own axes and turned back."""
    axes = np.array([[1, 0, 0], [0, np.cos(roll), -np.sin(roll)], [0, np.sin(roll), np.cos(roll)]])
    x, z = np.sin(pitch), -np.cos(pitch)
    p, _ = planar(LAW, x * x, x * z, z * z, tuple(axes[2]), tuple(axes.T @ h))
    return axes @ p, axes @ np.array([x, 0.0, z])


@given(st.floats(-1.5, 1.5), st.floats(-3.1, 3.1), TURN)
def test_without_roll_it_is_the_planar_map_in_every_compass_direction(beta, gamma, azimuth):
    ax, az = alpha(beta, gamma)
    forward = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    n, h = (a * forward + b * np.array(UP) for a, b in
            ((np.sin(beta), -np.cos(beta)), (np.cos(gamma), -np.sin(gamma))))  # fmt: skip
    assert stress(n, h) == pytest.approx((-ax * forward + az * np.array(UP)) / 1e6, abs=1e-9)


@given(TURN, RISE, TURN, RISE, TURN)
def test_all_turns_with_the_compass(azimuth, rise, course, dive, turn):
    n, h = unit(azimuth, rise), unit(course, dive)
    c, s = np.cos(turn), np.sin(turn)
    about = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    assert stress(about @ n, about @ h) == pytest.approx(about @ stress(n, h), abs=1e-9)


@given(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), TURN, RISE)
def test_a_rolled_foot_feels_what_its_plates_feel(roll, pitch, course, dive):
    h = unit(course, dive)
    found, n = rolled(roll, pitch, h)
    assert found == pytest.approx(stress(n, h), abs=1e-9)


@given(TURN, RISE, TURN, RISE)
def test_sand_never_gives_energy(azimuth, rise, course, dive):
    h = unit(course, dive)
    assert stress(unit(azimuth, rise), h) @ h <= -0.054  # N/cm^3: the planar map's least dissipation


def test_a_wall_slides_along_itself_as_hard_sideways_as_up_and_down():
    wall, up = np.array([0.0, 1.0, 0.0]), np.array(UP)
    rise, sink = stress(wall, up) @ up, -stress(wall, -up) @ up
    sideways = -stress(wall, np.array([1.0, 0.0, 0.0]))[0]
    assert sideways == pytest.approx(-0.5 * (rise + sink), abs=1e-12)
    assert sideways == pytest.approx(LAW.B01 - LAW.B_sum)
    assert -stress(wall, wall)[1] == pytest.approx(0.37)  # broadside
