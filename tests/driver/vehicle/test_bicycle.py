"""The kinematic model against its own differential equations (F&L 1991, §3.1)."""

import math

import numpy as np
import pytest
from helpers.cars import CAR
from hypothesis import given
from hypothesis import strategies as st

from sumo_reactive.driver.nouns.state import Command, Pose, VehicleState
from sumo_reactive.driver.vehicle.bicycle import advance, advance_pose

speeds = st.floats(0.0, 40.0)
angles = st.floats(-0.65, 0.65)
headings = st.floats(-math.pi, math.pi)
wheelbases = st.floats(1.5, 7.0)
durations = st.floats(0.02, 1.0)


def integrated(
    pose: tuple[float, float, float], speed: float, angle: float, wheelbase: float, duration: float
) -> np.ndarray:
    """Fourth-order Runge–Kutta in 200 steps of ẋ = v cosφ cosθ, ẏ = v cosφ sinθ, θ̇ = v sinφ / L."""

    def slope(q: np.ndarray) -> np.ndarray:
        along, turn = speed * math.cos(angle), speed * math.sin(angle) / wheelbase
        return np.array([along * math.cos(q[2]), along * math.sin(q[2]), turn])

    q, h = np.array(pose), duration / 200
    for _ in range(200):
        a = slope(q)
        b = slope(q + 0.5 * h * a)
        c = slope(q + 0.5 * h * b)
        q = q + h / 6.0 * (a + 2.0 * b + 2.0 * c + slope(q + h * c))
    return q


@given(headings, speeds, angles, wheelbases, durations)
def test_the_pose_moves_as_a_fine_integration_of_the_equations_says(heading, speed, angle, wheelbase, duration):
    exact = advance_pose(3.0, -2.0, heading, speed, angle, wheelbase, duration)
    assert exact == pytest.approx(integrated((3.0, -2.0, heading), speed, angle, wheelbase, duration), abs=1e-8)


@given(speeds, angles, st.floats(-9.0, 3.0), st.floats(-1.0, 1.0), durations)
def test_a_command_holds_the_new_speed_and_the_new_angle_for_the_whole_period(speed, angle, acceleration, rate, duration):
    after = advance(VehicleState(Pose(0.0, 0.0, 0.4), speed, angle), Command(acceleration, rate), 2.8, duration)
    v, phi = max(0.0, speed + acceleration * duration), angle + rate * duration
    assert (after.speed, after.steering_angle) == pytest.approx((v, phi))
    expected = integrated((0.0, 0.0, 0.4), v, phi, 2.8, duration)
    assert (after.pose.x, after.pose.y, after.pose.heading) == pytest.approx(expected, abs=1e-8)


@given(speeds, angles, headings, st.floats(-30.0, 0.0), durations)
def test_a_braking_car_never_rolls_back(speed, angle, heading, acceleration, duration):
    after = advance(VehicleState(Pose(0.0, 0.0, heading), speed, angle), Command(acceleration, 0.0), 2.8, duration)
    chord = 0.5 * (heading + after.pose.heading)
    assert 0.0 <= after.speed <= speed
    assert after.pose.x * math.cos(chord) + after.pose.y * math.sin(chord) >= -1e-9


@given(speeds, st.floats(-9.0, 3.0), durations)
def test_the_state_tells_the_acceleration_that_was_achieved(speed, acceleration, duration):
    after = advance(VehicleState(Pose(0.0, 0.0, 0.0), speed, 0.0), Command(acceleration, 0.0), 2.8, duration)
    assert speed + after.acceleration * duration == pytest.approx(after.speed, abs=1e-9)


def test_a_car_that_stands_turns_its_wheels_on_the_spot():
    after = advance(VehicleState(Pose(1.0, 2.0, 0.3), 0.0, 0.0), Command(0.0, 1.0), 2.8, 0.5)
    assert (after.pose, after.steering_angle) == (Pose(1.0, 2.0, 0.3), 0.5)


def test_the_front_axle_can_follow_the_largest_curvature_for_ever():
    q = advance_pose(0.0, 0.0, 0.0, 2.0, CAR.max_steering_angle, CAR.wheelbase, math.pi / CAR.max_curvature)
    assert q[2] == pytest.approx(2.0 * math.pi)
    assert q[:2] == pytest.approx((0.0, 0.0), abs=1e-6)
