"""Arcs at walking speed: the moves of a turn, and backing up."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from helpers.cars import CAR, car_at
from helpers.curves import asked, plan_along, seen, straight

from sumo_reactive.driver.field.executor import BACK_UP_SPEED, LEFT_BEHIND_M, back_up, execute
from sumo_reactive.driver.field.moves import moved_on
from sumo_reactive.driver.nouns.constraint import stop_at
from sumo_reactive.driver.nouns.decision import Instruction, Reason
from sumo_reactive.driver.nouns.plan import MOVE_BACK_SPEED, MOVE_SPEED, TURNED_ON_M, WHEELS_TURNED_RAD, Move
from sumo_reactive.driver.nouns.state import Pose, VehicleState

ROAD = plan_along(straight())
LOCK, BEND = 0.6, math.sin(0.6) / CAR.wheelbase
FORWARDS = Move(gear=1, steering_angle=LOCK, bend=BEND, until=1.5)
BACKWARDS = Move(gear=-1, steering_angle=-LOCK, bend=-BEND, until=1.5)
PERIOD = 0.1


def standing(angle: float = LOCK, speed: float = 0.0, heading: float = 0.0) -> VehicleState:
    """The car with its rear axle at (40, 0)."""
    return VehicleState(Pose(40.0, 0.0, heading), speed, angle)


def moved(move: Move, ego: VehicleState, *users, calm: float = 2.0):
    """Command and state after a period of a move among `users`."""
    return moved_on(seen(ego, ROAD, 42.0, users), move, calm, CAR, PERIOD)


def carried_through(move: Move, ego: VehicleState, seconds: float = 20.0) -> list[VehicleState]:
    """The states until the move is over, or for some seconds."""
    states = [ego]
    while not move.is_over(states[-1]) and len(states) < seconds / PERIOD:
        states.append(moved(move, states[-1])[1])
    return states


@pytest.mark.parametrize(("move", "top"), [(FORWARDS, MOVE_SPEED), (BACKWARDS, -MOVE_BACK_SPEED)])
def test_a_move_turns_the_car_to_its_end_at_walking_speed_and_stops_there(move, top):
    states = carried_through(move, standing(move.steering_angle))
    speeds = [state.speed for state in states]
    assert states[-1].pose.heading == pytest.approx(1.5, abs=TURNED_ON_M * BEND)
    assert (max(speeds) if top > 0.0 else min(speeds)) == pytest.approx(top)
    assert abs(speeds[-1]) < 0.1
    gains = [abs(b.speed) - abs(a.speed) for a, b in pairwise(states)]
    assert max(gains) <= 2.0 * PERIOD + 1e-9
    assert min(gains) >= -CAR.comfort_deceleration * PERIOD - 1e-9


@pytest.mark.parametrize("then", [0.0, -LOCK])
def test_the_wheels_are_turned_on_to_the_next_move_while_one_ends_and_it_ends_once(then):
    states = carried_through(replace(FORWARDS, then=then), standing())
    turned_on = [state for state in states if state.steering_angle < LOCK - WHEELS_TURNED_RAD]
    assert turned_on[0].speed > 0.5
    assert all(b.speed < a.speed for a, b in pairwise(turned_on))
    assert FORWARDS.is_over(states[-1])
    assert states[-1].steering_angle < LOCK - 0.3


def test_who_is_kept_from_the_end_of_a_move_goes_on_with_its_own_wheels():
    move, heading = replace(FORWARDS, then=-LOCK), 1.5 - 0.3 * BEND
    assert moved(move, standing(0.0, heading=heading))[0].steering_rate == CAR.max_steering_rate
    assert carried_through(move, standing(0.0, heading=heading))[-1].pose.heading > heading


@pytest.mark.parametrize("angle", [-0.05, -0.6])
def test_the_wheels_are_turned_first_at_a_stand(angle):
    command, state = moved(FORWARDS, standing(angle))
    assert state.speed == 0.0
    assert command.steering_rate == pytest.approx(min((LOCK - angle) / PERIOD, CAR.max_steering_rate))


def test_a_move_begins_with_its_wheels_turned_and_gains_speed_calmly():
    command, state = moved(FORWARDS, standing(LOCK - 0.02), calm=1.5)
    assert state.speed == pytest.approx(0.15)
    assert command.acceleration == pytest.approx(1.5)
    assert command.steering_rate == pytest.approx(0.02 / PERIOD)


def test_after_the_last_move_the_wheels_are_straightened_and_not_before():
    over = 1.5 - 0.03 * BEND
    last, other = replace(FORWARDS, is_last=True), FORWARDS
    assert moved(last, standing(heading=over))[0].steering_rate == -CAR.max_steering_rate
    assert moved(other, standing(heading=over))[0].steering_rate == 0.0
    assert moved(last, standing(heading=0.5))[0].steering_rate == 0.0


def test_the_last_move_rolls_out_with_its_wheels_straight_when_the_car_is():
    states = carried_through(replace(FORWARDS, is_last=True, rolls_out=True), standing())
    assert states[-1].pose.heading == pytest.approx(1.5, abs=0.03)
    assert abs(states[-1].steering_angle) < WHEELS_TURNED_RAD
    assert states[-1].speed == pytest.approx(MOVE_SPEED)
    rates = [abs(b.steering_angle - a.steering_angle) / PERIOD for a, b in pairwise(states)]
    assert max(rates) <= CAR.max_steering_rate + 1e-9


@pytest.mark.parametrize(("rolls_out", "goes"), [(False, True), (True, False)])
def test_who_rolls_out_looks_straight_on_beyond_the_end_of_the_move(rolls_out, goes):
    move = replace(FORWARDS, is_last=True, rolls_out=rolls_out)
    heading = 1.5 - 0.3 * BEND
    x, y = 40.0 + (CAR.front_to_rear_axle + 0.7) * math.cos(1.5), (CAR.front_to_rear_axle + 0.7) * math.sin(1.5)
    beyond = car_at("x", x + 4.7 * math.cos(1.5), y + 4.7 * math.sin(1.5), 1.5, 0.0)
    before = standing(speed=1.0, heading=heading)
    assert (moved(move, before, beyond)[1].speed > 1.0 - CAR.comfort_deceleration * PERIOD + 1e-6) is goes


@pytest.mark.parametrize(
    ("gap", "left", "speed", "goes"),
    [
        (0.5, 0.0, 0.0, False),  # a body before the bumper
        (3.0, 0.0, 0.0, True),  # farther than it looks ahead at a stand
        (0.5, -4.0, 0.0, True),  # beside the arc, which leads to the left
        (5.0, 0.0, -4.5, False),  # one who comes and will be there in a second
        (5.0, 0.0, 4.5, True),  # one who drives away
    ],
)
def test_a_move_waits_while_somebody_is_in_its_way_or_soon_will_be(gap, left, speed, goes):
    front = 40.0 + CAR.front_to_rear_axle + gap
    one = car_at("x", front + 4.7 if speed >= 0.0 else front, left, 0.0 if speed >= 0.0 else math.pi, abs(speed))
    assert (moved(FORWARDS, standing(), one)[1].speed > 0.0) is goes


def test_backwards_the_ground_behind_counts():
    behind, ahead = (car_at("x", x, 0.0, 0.0, 0.0) for x in (40.0 - 0.8 - 0.4, 40.0 + CAR.front_to_rear_axle + 0.4 + 4.7))
    assert moved(BACKWARDS, standing(-LOCK), behind)[1].speed == 0.0
    assert moved(BACKWARDS, standing(-LOCK), ahead)[1].speed < 0.0


def test_whom_the_ego_touches_already_does_not_keep_it_from_leaving():
    over_the_rear = car_at("x", 40.5, 0.0, 0.0, 0.0)
    assert moved(FORWARDS, standing(), over_the_rear)[1].speed > 0.0


def test_a_car_under_way_that_finds_somebody_in_its_way_brakes_in_comfort():
    one = car_at("x", 40.0 + CAR.front_to_rear_axle + 0.6 + 4.7, 0.0, 0.0, 0.0)
    command, _ = moved(FORWARDS, standing(speed=1.5), one)
    assert command.acceleration == pytest.approx(-CAR.comfort_deceleration)


def backed(ego: VehicleState, to: float | None, *others):
    """The execution of backing up to a stop, None: none is named."""
    completed = replace(
        asked(ROAD, None if to is None else stop_at(to, Reason.NO_ROOM_TO_PASS)), instruction=Instruction.BACK_UP
    )
    snapshot = seen(ego, ROAD, 42.0, others)
    return execute(snapshot, completed, CAR, PERIOD), back_up(snapshot, completed, CAR, PERIOD)


def test_backing_up_ends_with_the_bumper_at_the_stop():
    ego, slowest, to = standing(0.0), 0.0, 40.0
    for _ in range(200):
        execution, same = backed(ego, to)
        assert execution == same and not execution.emergency
        ego, slowest = execution.state, min(slowest, execution.state.speed)
    assert ego.pose.x + CAR.front_to_rear_axle == pytest.approx(to, abs=0.15)
    assert slowest == pytest.approx(-BACK_UP_SPEED)


def test_backing_up_gains_speed_calmly_with_the_wheels_straightened():
    execution, _ = backed(standing(0.05), 30.0)
    assert execution.state.speed == pytest.approx(-CAR.max_acceleration * PERIOD)
    assert execution.command.steering_rate == pytest.approx(-0.5)
    assert execution.desired_speed == pytest.approx(-CAR.max_acceleration * PERIOD)
    assert backed(standing(0.5), 30.0)[0].command.steering_rate == -CAR.max_steering_rate
    assert backed(standing(-0.5), 30.0)[0].command.steering_rate == CAR.max_steering_rate


@pytest.mark.parametrize("to", [None, 60.0])
def test_without_a_stop_behind_the_bumper_it_does_not_back_up(to):
    assert backed(standing(0.0), to)[0].state.speed == 0.0


def test_backing_up_ends_before_whoever_has_come_up_behind():
    ego, behind = standing(0.0), 40.0 - CAR.rear_overhang - 3.0
    for _ in range(200):
        ego = backed(ego, 20.0, car_at("x", behind, 0.0, 0.0, 0.0))[0].state
    assert ego.pose.x - CAR.rear_overhang - behind == pytest.approx(LEFT_BEHIND_M, abs=0.1)
    assert ego.speed == pytest.approx(0.0, abs=0.05)
