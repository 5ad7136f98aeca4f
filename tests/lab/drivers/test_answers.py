"""Where an answer leaves the car."""

import math

import pytest
from helpers.cars import CAR

from sumo_reactive.driver.nouns.state import Command, Pose, VehicleState
from sumo_reactive.errors import DriverError
from sumo_reactive.lab.drivers.answers import at_time, placed, plan_after, speed_after, steered
from sumo_reactive.lab.drivers.protocol import LaneCommand, Placement, Waypoint

STATE = VehicleState(Pose(0.0, 0.0, 0.0), 10.0, 0.0)


def test_a_command_is_carried_out_as_far_as_the_car_can():
    after = steered(Command(99.0, 99.0), STATE, CAR, 0.1)
    assert math.isclose(after.speed, 10.0 + 0.1 * CAR.max_acceleration)
    assert math.isclose(after.steering_angle, 0.1 * CAR.max_steering_rate)
    assert math.isclose(steered(Command(-99.0, 0.0), STATE, CAR, 0.1).speed, 10.0 - 0.1 * CAR.emergency_deceleration)


def test_the_wheels_turn_no_farther_than_they_can():
    state = STATE._replace(steering_angle=CAR.max_steering_angle)
    assert steered(Command(0.0, 1.0), state, CAR, 0.1).steering_angle == CAR.max_steering_angle


def test_a_speed_on_rails_stays_within_what_the_car_can():
    assert speed_after(LaneCommand(-50.0), 1.0, CAR, 0.1) == 0.0
    assert speed_after(LaneCommand(50.0), CAR.max_speed, CAR, 0.1) == CAR.max_speed
    with pytest.raises(DriverError, match="acceleration of 101"):
        speed_after(LaneCommand(101.0), 1.0, CAR, 0.1)


def test_a_plan_is_straight_between_its_waypoints_and_turns_the_short_way():
    plan = (Waypoint(0.0, 0.0, 0.0, 3.0, 0.0), Waypoint(2.0, 4.0, 2.0, -3.0, 2.0))
    middle = at_time(plan, 1.0)
    assert (middle.x, middle.y, middle.speed) == (2.0, 1.0, 1.0)
    assert math.isclose(abs(middle.heading), math.pi)
    assert at_time(plan, -1.0)[1:] == plan[0][1:]
    assert at_time(plan, 9.0) == plan[1]


def test_the_front_bumper_is_where_a_placement_says():
    plan = plan_after(Placement(5.0, 1.0, 0.5, 9.0), (), 0.1)
    after = placed(plan, STATE, CAR, 0.1, 0.1)
    x, y = after.pose.ahead(CAR.front_to_rear_axle)
    assert (round(x, 9), round(y, 9), after.speed) == (5.0, 1.0, 9.0)
    assert math.isclose(after.acceleration, -10.0)


@pytest.mark.parametrize("place", [(5.0, 1.0, math.nan, 9.0), (5.0, 1.0, 0.5, "9")])
def test_a_place_that_is_no_number_is_refused(place):
    with pytest.raises(DriverError, match="finite number"):
        placed(plan_after(Placement(*place), (), 0.1), STATE, CAR, 0.1, 0.1)
