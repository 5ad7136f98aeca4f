"""The discretised command space K (F&L 1991, §3.2)."""

import inspect

import numpy as np
from helpers.cars import CAR
from hypothesis import given
from hypothesis import strategies as st

from sumo_reactive.driver.field.command_grid import PAPER_LATERAL_STEP, CommandGrid, lattice, paper_grid
from sumo_reactive.driver.field.field import around

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
    lattice,
    limits=st.just(CAR),
    speed=speeds,
    acceleration=st.floats(-9.0, 2.6),
    period=st.floats(0.02, 0.1),
)


@given(fine)
def test_the_first_lattice_has_at_most_42_commands_within_the_limits(grid):
    assert 21 <= size(grid) <= 42
    assert within_limits(grid)


@given(fine)
def test_both_axes_of_the_lattice_rise(grid):
    assert (np.diff(grid.accelerations) > 0.0).all()
    assert (np.diff(grid.steering_rates) > 0.0).all()


@given(fine)
def test_the_lattice_can_always_brake_as_hard_as_the_car_can(grid):
    assert grid.accelerations.min() == -CAR.emergency_deceleration


def test_the_lattice_knows_neither_the_desired_speed_nor_the_steering_that_the_curve_asks_for():
    assert set(inspect.signature(lattice).parameters) == {"limits", "speed", "acceleration", "period"}


@given(st.lists(st.floats(-9.0, 9.0), min_size=2, max_size=9, unique=True), st.data())
def test_a_finer_lattice_lies_between_the_neighbours_of_its_node_and_holds_it(nodes, data):
    axis = np.sort(np.array(nodes))
    i = data.draw(st.integers(0, len(axis) - 1))
    finer = around(axis, i)
    assert finer[2] == axis[i]
    assert axis[max(i - 1, 0)] <= finer.min()
    assert finer.max() <= axis[min(i + 1, len(axis) - 1)]
