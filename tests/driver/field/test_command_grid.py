"""The discretised command space K (F&L 1991, §3.2)."""

import numpy as np
from helpers.cars import CAR
from hypothesis import given
from hypothesis import strategies as st

from sumo_reactive.driver.field.command_grid import CommandGrid, fine_grid, paper_grid
from sumo_reactive.driver.parameters import PAPER_LATERAL_STEP

speeds = st.floats(0.0, 50.0)


def size(grid: CommandGrid) -> int:
    return len(grid.accelerations) * len(grid.steering_rates)


def within_limits(grid: CommandGrid) -> bool:
    a, w = grid.accelerations, np.abs(grid.steering_rates)
    return bool(
        (a >= -CAR.emergency_deceleration).all() and (a <= CAR.max_acceleration).all() and (w <= CAR.max_steering_rate).all()
    )


@given(speeds, st.floats(0.02, 1.0))
def test_the_paper_has_nine_commands_that_brake_hold_or_accelerate_and_steer_left_straight_or_right(speed, period):
    grid = paper_grid(CAR, speed, period)
    assert size(grid) == 9
    assert list(np.sign(grid.accelerations)) == list(np.sign(grid.steering_rates)) == [-1.0, 0.0, 1.0]
    assert within_limits(grid)


@given(st.floats(4.0, 50.0), st.floats(0.02, 1.0))
def test_one_of_the_nine_commands_changes_the_lateral_acceleration_by_a_bounded_step(speed, period):
    turn = paper_grid(CAR, speed, period).steering_rates.max() * period
    assert speed**2 * turn / CAR.wheelbase <= PAPER_LATERAL_STEP + 1e-9


fine = st.builds(
    fine_grid,
    limits=st.just(CAR),
    speed=speeds,
    acceleration=st.floats(-9.0, 2.6),
    wanted=st.floats(-100.0, 100.0),
    steering=st.floats(-10.0, 10.0),
    period=st.floats(0.02, 0.1),
)


@given(fine)
def test_the_fine_grid_has_81_commands_within_the_limits(grid):
    assert size(grid) == 81
    assert within_limits(grid)


@given(fine)
def test_the_fine_grid_can_always_brake_as_hard_as_the_car_can(grid):
    assert grid.accelerations.min() == -CAR.emergency_deceleration


@given(st.floats(-0.2, 0.2), st.floats(-2.0, 2.0))
def test_the_fine_grid_holds_the_rate_that_the_curve_asks_for_and_the_acceleration_that_is_wanted(rate, wanted):
    grid = fine_grid(limits=CAR, speed=3.0, acceleration=wanted + 0.2, wanted=wanted, steering=rate, period=0.1)
    assert np.abs(grid.steering_rates - rate).min() == 0.0
    assert np.abs(grid.accelerations - wanted).min() == 0.0
