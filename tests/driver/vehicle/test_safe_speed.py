"""The speeds from which a driver stops in time: before a place, and behind a leader."""

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from sumo_reactive.driver.vehicle.safe_speed import following_speed, stopping_speed

periods = st.floats(0.05, 0.5)
decelerations = st.floats(1.0, 6.0)


@given(st.floats(0.0, 300.0), decelerations, periods)
def test_driving_at_the_stopping_speed_stops_within_the_distance_and_never_brakes_harder(distance, deceleration, period):
    left, speed = distance, stopping_speed(distance, deceleration, period)
    for _ in range(2000):
        left -= speed * period
        after = stopping_speed(left, deceleration, period)
        assert speed - after <= deceleration * period + 1e-9
        speed = after
        if speed < 1e-6:
            break
    assert speed < 1e-6
    assert -1e-9 <= left < 1e-3


@given(decelerations, periods, st.floats(-100.0, 0.0))
def test_the_stopping_speed_is_zero_at_and_behind_the_place(deceleration, period, distance):
    assert stopping_speed(distance, deceleration, period) == 0.0


@given(
    st.floats(0.0, 40.0), st.floats(0.0, 30.0), st.floats(2.0, 6.0), st.floats(0.5, 2.0), periods,
    st.lists(st.floats(-1.0, 1.0), max_size=30),
)  # fmt: skip
def test_a_follower_at_the_safe_speed_never_collides_nor_brakes_harder_than_the_leader(
    gap, leader_speed, deceleration, headway, period, leader_moods
):
    """The leader does as it likes (1: accelerates, −1: brakes as hard as the follower can), then brakes to a stop."""
    assume(period <= headway)
    speed = following_speed(gap, leader_speed, deceleration, headway)
    for mood in [*leader_moods, *[-1.0] * 200]:
        after = max(0.0, leader_speed + mood * deceleration * period)
        until_stop = leader_speed / (-mood * deceleration) if after == 0.0 and leader_speed > 0.0 else period
        gap += 0.5 * (leader_speed + after) * until_stop - speed * period
        leader_speed = after
        assert gap >= -1e-9
        safe = following_speed(gap, leader_speed, deceleration, headway)
        assert safe >= speed - deceleration * period - 1e-9
        speed = min(safe, speed + 3.0 * period)


@given(st.floats(0.0, 100.0), st.floats(0.0, 30.0), decelerations, st.floats(0.5, 2.0))
def test_the_safe_speed_leaves_room_to_stop_behind_a_leader_that_brakes_alike(gap, leader_speed, deceleration, headway):
    v = following_speed(gap, leader_speed, deceleration, headway)
    own, others = v * headway + v * v / (2.0 * deceleration), leader_speed**2 / (2.0 * deceleration)
    assert own == pytest.approx(gap + others, abs=1e-6)


def test_a_leader_that_is_too_near_leaves_no_speed():
    assert following_speed(-3.0, 0.0, 2.5, 1.0) == 0.0
