"""Polylines: arc length, headings, projection."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sumo_reactive.driver.geometry.polyline import Polyline, joined, moved_aside

CORNER = Polyline(np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 5.0]]))


def test_length_is_the_sum_of_the_segments():
    assert CORNER.length == pytest.approx(15.0)


def test_positions_beyond_the_ends_are_clamped():
    assert CORNER.at(-3.0) == (0.0, 0.0)
    assert CORNER.at(99.0) == (10.0, 5.0)


def test_the_heading_is_that_of_the_segment_that_holds_the_position():
    assert CORNER.heading_at(5.0) == 0.0
    assert CORNER.heading_at(12.0) == pytest.approx(math.pi / 2)


def test_the_heading_beside_a_repeated_point_is_that_of_the_road():
    repeated = Polyline(np.array([[0.0, 0.0], [0.0, 5.0], [0.0, 5.0]]))
    assert repeated.heading_at(5.0) == pytest.approx(math.pi / 2)


def test_a_point_left_of_the_line_has_a_positive_distance():
    assert CORNER.project(4.0, 2.0) == pytest.approx((4.0, 2.0))
    assert CORNER.project(4.0, -2.0) == pytest.approx((4.0, -2.0))


def test_a_line_moves_aside_to_its_left_and_keeps_its_length_on_a_straight():
    line = np.array([[0.0, 0.0], [3.0, 4.0], [6.0, 8.0]])
    moved = moved_aside(line, np.array([0.0, 5.0, -5.0]))
    np.testing.assert_allclose(moved, [[0.0, 0.0], [-1.0, 7.0], [10.0, 5.0]], atol=1e-9)


def test_joining_drops_the_point_that_two_parts_share():
    chain = joined([np.array([[0.0, 0.0], [1.0, 0.0]]), np.array([[1.0, 0.0], [2.0, 0.0]])])
    np.testing.assert_array_equal(chain, [[0, 0], [1, 0], [2, 0]])


def test_a_single_point_is_no_polyline():
    with pytest.raises(ValueError, match="n ≥ 2"):
        Polyline(np.zeros((1, 2)))


@given(st.floats(0.0, 15.0))
def test_projecting_a_point_of_the_line_returns_its_position(s):
    found, distance = CORNER.project(*CORNER.at(s))
    assert found == pytest.approx(s, abs=1e-6)
    assert distance == pytest.approx(0.0, abs=1e-9)


@given(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
def test_the_distance_of_a_projection_is_the_distance_to_its_foot(x, y):
    s, distance = CORNER.project(x, y)
    assert abs(distance) == pytest.approx(math.dist((x, y), CORNER.at(s)), abs=1e-6)
