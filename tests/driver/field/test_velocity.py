"""U₃ and the speed that a time constraint asks for (F&L 1991, §3.3.3)."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from sumo_reactive.driver.field.velocity import carried_out, cruise_speed, rolling_speed, velocity_potential


def covered(speed: float, cruise: float, acceleration: float, time: float) -> float:
    """Way (m) of accelerating from `speed` to `cruise` and keeping it, within `time` s."""
    rising = min(time, max(0.0, cruise - speed) / acceleration)
    return rising * (speed + 0.5 * acceleration * rising) + (time - rising) * (speed + acceleration * rising)


@given(st.floats(0.0, 40.0), st.floats(0.0, 40.0))
def test_the_potential_is_the_difference_to_the_desired_speed(speed, desired):
    assert velocity_potential(speed, desired) == abs(speed - desired)


@given(st.floats(0.0, 20.0), st.floats(1.0, 500.0), st.floats(0.5, 60.0), st.floats(0.5, 3.0))
def test_the_cruising_speed_covers_the_distance_in_the_time_that_is_left(speed, distance, time, acceleration):
    cruise = cruise_speed(speed, distance, time, 1e6, acceleration)
    assume(cruise < 1e6)
    if cruise >= speed:
        assert covered(speed, cruise, acceleration, time) == pytest.approx(distance, rel=1e-6)
    else:
        assert cruise == pytest.approx(distance / time)


@given(st.floats(0.0, 20.0), st.floats(-5.0, 500.0), st.floats(-5.0, 60.0), st.floats(0.0, 30.0))
def test_the_cruising_speed_never_exceeds_the_top_speed(speed, distance, time, top):
    assert cruise_speed(speed, distance, time, top, 2.0) <= top


@given(st.floats(0.0, 20.0), st.floats(0.0, 300.0), st.floats(0.5, 60.0), st.floats(0.5, 5.0), st.floats(1.0, 3.0))
def test_a_rolling_car_is_in_time_as_near_as_it_can_still_stop(speed, room, time, lag, braking):
    rolling = rolling_speed(speed, room, time, lag, braking)
    assume(rolling > 0.0)
    way = rolling * time + (speed - rolling) * lag * (1.0 - np.exp(-time / lag))
    assert way + rolling**2 / (2.0 * braking) == pytest.approx(room, rel=1e-6, abs=1e-6)


def test_a_car_too_fast_to_be_in_time_is_asked_to_stop_and_one_whose_time_is_over_for_nothing():
    assert rolling_speed(20.0, 5.0, 20.0, 3.0, 2.5) == 0.0
    assert rolling_speed(10.0, 50.0, 0.0, 3.0, 2.5) == np.inf


def test_without_enough_time_the_car_goes_as_fast_as_it_may():
    assert cruise_speed(5.0, 100.0, 0.0, 13.9, 2.0) == 13.9
    assert cruise_speed(0.0, 100.0, 3.0, 13.9, 2.0) == 13.9


@given(st.floats(5.0, 30.0), st.floats(0.02, 0.3))
def test_a_car_that_heads_off_a_straight_line_is_carried_as_far_as_its_tightest_arc(speed, error):
    tightest = speed**2 / 4.0
    away = carried_out(np.zeros(2000), 0.05, 0.0, 0.0, error, speed, 0.0, 4.0)
    assert away == pytest.approx(tightest * (1.0 - np.cos(error)), rel=0.1, abs=0.05)


@given(st.floats(-1.0, 1.0), st.floats(0.0, 20.0), st.floats(0.0, 9.0))
def test_a_car_that_heads_back_to_a_line_is_not_carried_out(d, speed, deceleration):
    error = -np.sign(d) * 0.02
    assert carried_out(np.zeros(100), 0.5, 0.0, d, error, speed, deceleration, 4.0) <= 0.3
