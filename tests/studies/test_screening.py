"""Screening of a scene by dimensionless numbers."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

import footopt as fo
from footopt.studies.screening import bearing_factor, screening

ABSOLUTE = ("cohesion", "grains")  # sand has a strength and a size of its own


def numbers(scene, foot):
    return {c.name: c for c in screening(scene, [foot])}


def scaled(size):
    """The walk of a body that is `size` times as large and walks dynamically alike."""
    human = fo.Walker()
    walker = replace(human, mass=human.mass * size**3, l1=human.l1 * size, l2=human.l2 * size)
    gait = replace(fo.Gait.human(), period=1.2 * size**0.5, start=0.5 * size**0.5)
    foot = fo.Foot.from_waypoints(
        [5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4], fo.Waypoints(L=0.13 * size, H=0.03 * size, width=0.1 * size)
    )
    return fo.Scene(walker=walker, gait=gait), foot


@given(st.floats(0.2, 5.0))
def test_bodies_that_walk_alike_have_the_same_numbers(size):
    own, other = numbers(*scaled(1.0)), numbers(*scaled(size))
    for name in set(own) - set(ABSOLUTE):
        assert other[name].value == pytest.approx(own[name].value, rel=1e-6), name


@pytest.mark.parametrize(("degrees", "factor"), [(10, 8.35), (20, 14.83), (30, 30.14)])
def test_the_bearing_factor_is_that_of_textbooks(degrees, factor):
    assert bearing_factor(math.radians(degrees)) == pytest.approx(factor, abs=0.01)


def test_a_convex_sole_shadows_nothing_and_a_hollow_one_calls_for_it():
    hollow = fo.Foot.from_waypoints([2, 8, 2, 2, 2, 2, 2, 2, 2, 8, 2])
    assert numbers(fo.Scene(), fo.Foot.flat())["shadowing"].verdict == "small"
    assert numbers(fo.Scene(), hollow)["shadowing"].verdict == "called for"
