"""How long a car needs to move aside."""

import math

from helpers.cars import CAR
from hypothesis import given
from hypothesis import strategies as st

from sumo_reactive.driver.vehicle.travel_time import (
    LANE_CHANGE_DURATION_S,
    MAX_START_BLEND_M,
    MIN_START_BLEND_M,
    QUINTIC_STEP_CURVATURE,
    START_CURVATURE_SHARE,
    side_step_length,
)

WIDTH = 3.2
offsets, speeds, errors = st.floats(0.0, 6.0), st.floats(0.0, 45.0), st.floats(0.0, 1.0)


@given(offsets, errors, speeds)
def test_it_keeps_between_the_shortest_and_the_longest(offset, error, speed):
    assert MIN_START_BLEND_M <= side_step_length(offset, error, speed, WIDTH, CAR) <= MAX_START_BLEND_M


@given(offsets, errors, speeds, st.floats(0.0, 3.0), st.floats(0.0, 0.5), st.floats(0.0, 20.0))
def test_farther_aside_more_turned_or_faster_takes_no_less(offset, error, speed, farther, turned, faster):
    less = side_step_length(offset, error, speed, WIDTH, CAR)
    assert side_step_length(offset + farther, error + turned, speed + faster, WIDTH, CAR) >= less


def test_a_whole_lane_takes_about_the_time_of_a_lane_change_in_a_city():
    assert math.isclose(side_step_length(WIDTH, 0.0, 12.0, WIDTH, CAR), 12.0 * LANE_CHANGE_DURATION_S, rel_tol=0.1)


def test_it_takes_longer_on_a_motorway():
    assert side_step_length(WIDTH, 0.0, 30.0, WIDTH, CAR) > 1.2 * 30.0 * LANE_CHANGE_DURATION_S


def test_half_a_lane_takes_less():
    assert side_step_length(0.5 * WIDTH, 0.0, 20.0, WIDTH, CAR) < 0.8 * side_step_length(WIDTH, 0.0, 20.0, WIDTH, CAR)


@given(offsets, st.floats(1.0, 20.0))
def test_its_lateral_acceleration_is_comfortable(offset, speed):
    length = side_step_length(offset, 0.0, speed, WIDTH, CAR)
    assert QUINTIC_STEP_CURVATURE * offset / length**2 * speed**2 <= CAR.comfort_lateral_acceleration


@given(offsets)
def test_a_slow_car_can_steer_it(offset):
    length = side_step_length(offset, 0.0, 0.0, WIDTH, CAR)
    assert QUINTIC_STEP_CURVATURE * offset / length**2 <= START_CURVATURE_SHARE * CAR.max_curvature + 1e-9
