"""The parts of the field over the command space, each computed by hand (F&L 1991, §3.2, §3.3)."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers.cars import CAR, car_at
from helpers.curves import asked, on_curve, plan_along, seen, straight

from sumo_reactive.driver.field.command_grid import CommandGrid, gentlest_brake, steering_rate_limit, wide_grid
from sumo_reactive.driver.field.executor import execute
from sumo_reactive.driver.field.field import MIN_LOOK_AHEAD_M, driver_of, expand, leads_to, mapped_valley, ramped
from sumo_reactive.driver.nouns.completed_plan import Tuning
from sumo_reactive.driver.nouns.constraint import stop_at
from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.nouns.state import Command, Pose, VehicleState
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.vehicle.bicycle import advance_pose

ROAD = plan_along(straight())
NOTHING = np.empty((0, 2))
L = CAR.wheelbase


def limits(room_for_lateral: float = 0.0) -> np.ndarray:
    """The car's limits as the field takes them; `room_for_lateral`: present lateral acceleration, m/s²."""
    sizes = (L, CAR.front_to_rear_axle, CAR.length, CAR.width)
    return np.array([*sizes, 20.0, CAR.max_steering_angle, 4.0, CAR.emergency_deceleration, room_for_lateral])


@pytest.mark.parametrize("control_point", [0, 1], ids=["F", "R"])
def test_the_valley_of_the_bitmaps_is_the_worse_one_of_both_control_points(control_point):
    """Where only one of them is off its curve, that one counts (F&L 1991, §3.3.1: one valley a control point)."""
    bitmaps = np.zeros((2, 40, 40))
    bitmaps[control_point] = 3.0
    assert mapped_valley(0.0, 0.0, 0.0, 2.0, 0.0, 0.1, limits(), 0.5, bitmaps, -20.0, -20.0, 1.0) == 3.0


def test_each_control_point_is_looked_up_where_it_will_be():
    """Both bitmaps rise by 1 a metre along the way: F is a wheelbase ahead of R, and both drive for two periods."""
    columns = np.tile(np.arange(60.0), (60, 1))
    flat = np.zeros_like(columns)
    for bitmaps, at in (((columns, flat), 2.0 + L), ((flat, columns), 2.0)):
        found = mapped_valley(0.0, 0.0, 0.0, 2.0, 0.0, 0.0, limits(), 0.5, np.stack(bitmaps), -20.0, -20.0, 1.0)
        assert found == pytest.approx(20.0 + at)


def test_the_look_ahead_on_the_bitmaps_takes_the_best_of_the_steerings_that_are_allowed():
    """U rises to the right: steering left lowers it, as far as the lock and the lateral limit let it."""
    rows = np.tile(np.arange(60.0)[::-1, None], (1, 60))
    bitmaps = np.stack((rows, rows))

    def least(turn: float, lateral: float) -> float:
        return float(mapped_valley(0.0, 0.0, 0.0, 4.0, 0.0, turn, limits(lateral), 0.5, bitmaps, -20.0, -20.0, 1.0))

    assert least(0.2, 0.0) < least(0.1, 0.0) - 0.1 < least(0.0, 0.0) - 0.2
    assert least(0.649, 20.0) < least(0.2, 0.0) - 0.1
    assert least(0.66, 20.0) == least(0.649, 0.0) == least(0.0, 0.0)


def test_a_held_command_changes_speed_and_angle_in_equal_parts():
    x, y, heading = 1.0, 2.0, 0.3
    for share in (0.2, 0.4, 0.6, 0.8, 1.0):
        x, y, heading = advance_pose(x, y, heading, 4.0 + 2.0 * share, -0.1 + 0.3 * share, L, 0.1)
    assert ramped(1.0, 2.0, 0.3, 4.0, -0.1, 6.0, 0.2, L, 0.5) == pytest.approx((x, y, heading))


def led_to(d: float, heading: float, speed: float, angle: float, period: float = 0.1) -> float:
    """Where a car leads whose front axle is `d` m to the left of a straight C."""
    curve = ROAD.curve
    x, y = 50.0 - L * math.cos(heading), d - L * math.sin(heading)
    line = curve.x, curve.y, curve.heading, curve.step, 50.0
    return float(leads_to(x, y, heading, speed, angle, L, period, *line, driver_of(USUAL)))


def reach(speed: float) -> float:
    """The look-ahead, m."""
    return max(speed * (USUAL.look_ahead_s + USUAL.look_ahead_growth * speed), MIN_LOOK_AHEAD_M)


@pytest.mark.parametrize("speed", [0.0, 10.0, 20.0])
def test_a_command_leads_to_the_distance_after_the_look_ahead(speed):
    assert led_to(0.5, 0.0, speed, 0.0) == pytest.approx(0.5)
    assert led_to(0.0, 0.1, speed, 0.0) == pytest.approx(reach(speed) * math.sin(0.1))
    assert led_to(-0.4, 0.1, speed, 0.0) == pytest.approx(reach(speed) * math.sin(0.1) - 0.4)


def test_the_look_ahead_takes_the_velocity_of_the_front_axle_in_the_middle_of_the_period():
    turned = 0.5 * 10.0 * math.sin(0.05) / L * 0.1
    assert led_to(0.0, 0.0, 10.0, 0.05) == pytest.approx(reach(10.0) * math.sin(0.05 - turned))


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_an_obstacle_beside_the_body_makes_the_exact_valley_steeper(side):
    """The side of the body is 1.1 m from it on C, half a metre off C 0.6 m on its side and 1.6 m on the other."""
    static = np.array([(50.0, side * 2.0)])
    for off, left in ((0.5, 0.6), (-0.5, 1.6)):
        ego = on_curve(ROAD.curve, 50.0, 1.0)._replace(pose=Pose(50.0 - CAR.wheelbase, side * off, 0.0))
        found = execute(seen(ego, ROAD, 50.0, static=static), asked(ROAD), CAR, 0.01).potentials
        assert found.valley == pytest.approx(0.5 * (USUAL.valley_attraction + USUAL.valley_repulsion / left), rel=0.1)


def expanded(speed: float, angle: float, acceleration: float, rate: float, room: float = math.inf, lateral: float = 0.0):
    """Speed, angle, whether allowed, whether it stops in time, of one command held for 0.1 s."""
    state, out = np.array([0.0, 0.0, 0.0, speed, angle]), np.empty((1, 4))
    expand(state, np.array([acceleration]), np.array([rate]), limits(lateral), 0.1, room, out)
    return tuple(out[0].tolist())


def test_a_command_leads_to_the_speed_and_angle_that_it_says():
    assert expanded(10.0, 0.02, 2.0, 0.1) == pytest.approx((10.2, 0.03, 1.0, 1.0))


@pytest.mark.parametrize(
    ("speed", "acceleration", "after"), [(0.1, -5.0, 0.0), (19.9, 2.0, 20.0), (22.0, 2.0, 22.0), (22.0, -1.0, 21.9)]
)
def test_no_command_rolls_back_or_goes_beyond_the_top_speed(speed, acceleration, after):
    assert expanded(speed, 0.0, acceleration, 0.0)[0] == pytest.approx(after)


@pytest.mark.parametrize(("angle", "rate", "allowed"), [(0.6, 0.5, 1.0), (0.64, 0.5, 0.0), (-0.64, -0.5, 0.0)])
def test_wheels_turn_to_their_lock_and_no_farther(angle, rate, allowed):
    assert expanded(1.0, angle, 0.0, rate)[2] == allowed


@pytest.mark.parametrize(("angle", "present", "allowed"), [(0.094, 0.0, 1.0), (0.098, 0.0, 0.0), (0.098, 5.0, 1.0)])
def test_no_command_is_allowed_beyond_the_lateral_limit_unless_the_car_is_there_already(angle, present, allowed):
    """10² sin φ / 2.4 is 4 m/s² at φ = 0.0961 rad."""
    assert expanded(10.0, angle, 0.0, 0.0, lateral=present)[2] == allowed


@pytest.mark.parametrize(("room", "stops"), [(6.56, 1.0), (6.55, 0.0)])
def test_a_command_stops_in_time_if_the_hardest_brake_does_after_it(room, stops):
    """10 m/s for 0.1 s, and 10² / (2 · 9) = 5.556 m."""
    assert expanded(10.0, 0.0, 0.0, 0.0, room=room)[3] == stops


def test_a_car_that_stands_needs_no_room():
    assert expanded(0.0, 0.0, -1.0, 0.0, room=-1.0)[3] == 1.0


def test_the_steering_rate_falls_with_the_square_of_the_speed():
    for speed, limit in ((0.0, CAR.max_steering_rate), (20.0, USUAL.max_lateral_jerk * L / 400.0)):
        assert steering_rate_limit(CAR.max_steering_rate, USUAL.max_lateral_jerk, L, speed) == pytest.approx(limit)


def test_the_gentlest_brake_is_one_comfortable_jerk_from_what_the_car_does_or_from_coasting():
    assert gentlest_brake(2.0, 0.1, 8.0) == pytest.approx(-0.1 * 8.0)
    assert gentlest_brake(-1.0, 0.1, 8.0) == pytest.approx(-1.0 - 0.1 * 8.0)


def test_the_wide_grid_reaches_all_that_the_car_can_do():
    grid = wide_grid(CAR)
    assert (grid.accelerations[0], grid.accelerations[-1]) == (-CAR.emergency_deceleration, CAR.max_acceleration)
    assert (grid.steering_rates[0], grid.steering_rates[-1]) == (-CAR.max_steering_rate, CAR.max_steering_rate)
    assert (len(grid.accelerations), len(grid.steering_rates)) == (9, 21)


def test_the_wide_grid_is_taken_where_the_instruction_says_so(monkeypatch):
    taken: list[CommandGrid] = []

    def noted(limits):
        taken.append(wide_grid(limits))
        return taken[-1]

    monkeypatch.setattr("sumo_reactive.driver.field.executor.wide_grid", noted)
    completed = asked(ROAD)
    snapshot = seen(VehicleState(Pose(40.0, 0.0, 0.0), 5.0, 0.0), ROAD, 42.0)
    for is_wide in (False, True):
        execute(snapshot, replace(completed, tuning=Tuning(completed.tuning.weights, wide_grid=is_wide)), CAR, 0.1)
        assert bool(taken) is is_wide


def test_when_no_command_is_admissible_it_brakes_as_hard_as_it_can_along_the_curve():
    """A body over its front: whatever it does, it touches."""
    ego = VehicleState(Pose(40.0, 0.0, 0.0), 10.0, 0.0)
    wall = car_at("x", 40.0 + CAR.front_to_rear_axle + 1.0, 0.0, 0.0, 0.0)
    found = execute(seen(ego, ROAD, 42.0, [wall]), asked(ROAD), CAR, 0.1)
    assert (found.emergency, found.hazard) == (True, "")
    assert found.command.acceleration == -CAR.emergency_deceleration
    assert abs(found.command.steering_rate) < 0.01
    assert found.state.speed == pytest.approx(10.0 - 0.1 * CAR.emergency_deceleration)


def test_the_wheels_are_held_where_no_steering_keeps_the_limits():
    """0.3 rad at 20 m/s is far beyond the lateral limit, and beyond what it is after any one command."""
    ego = VehicleState(Pose(40.0, 0.0, 0.0), 20.0, 0.3)
    wall = car_at("x", 40.0 + CAR.front_to_rear_axle + 1.0, 0.0, 0.0, 0.0)
    found = execute(seen(ego, ROAD, 42.0, [wall]), asked(ROAD), CAR, 0.1)
    assert found.command.acceleration == -CAR.emergency_deceleration
    assert found.state.speed < 20.0


def test_who_stands_and_has_to_stay_chooses_nothing():
    ego = on_curve(ROAD.curve, 10.0, 0.0)._replace(steering_angle=0.1, acceleration=-1.0)
    found = execute(seen(ego, ROAD, 9.0), asked(ROAD, stop_at(10.0, Reason.RED_LIGHT)), CAR, 0.1)
    assert found.command == Command(0.0, 0.0) and found.state == ego._replace(acceleration=0.0)
    assert found.potentials == (0.0, 0.0, 0.0, 0.0)
