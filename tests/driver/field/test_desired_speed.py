"""v_d and the room to stop, each source of them by itself (F&L 1991, §3.3.3)."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers.cars import CAR, car_at
from helpers.curves import STEP, asked, driven, on_curve, plan_along, seen, straight, turning

from sumo_reactive.driver.field.desired_speed import desired_speed, room_to_brake
from sumo_reactive.driver.field.executor import COARSE_STOP_MARGIN_M, execute
from sumo_reactive.driver.field.velocity import cruise_speed
from sumo_reactive.driver.nouns.completed_plan import Tuning, VelocityProfile, Weights
from sumo_reactive.driver.nouns.constraint import TimeConstraint, stay_behind, stop_at
from sumo_reactive.driver.nouns.decision import Instruction, Reason
from sumo_reactive.driver.nouns.record import STOP_PLACE
from sumo_reactive.driver.nouns.snapshot import Neighbour
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.vehicle.safe_speed import HARD_STOP_MARGIN_M, SAFE_GAP_M, following_speed, stopping_speed

ROAD = plan_along(straight())
FRONT = 10.0
PERIOD = 0.1


def snapshot(speed: float, **what):
    """What a car sees with its front bumper at FRONT."""
    return seen(on_curve(ROAD.curve, FRONT, speed), ROAD, FRONT - CAR.front_overhang, **what)


def stopping_at(s: float):
    """The plan with a stop at `s`."""
    return asked(ROAD, stop_at(s, Reason.RED_LIGHT))


def falling_in_behind(user_id: str):
    """The plan with a slot behind somebody on the lane beside."""
    return replace(asked(ROAD), constraints=(TimeConstraint(FRONT, reason=Reason.NO_GAP, behind=user_id),))


def in_time(s: float, time: float):
    """The plan with the constraint (s, time)."""
    return replace(asked(ROAD), constraints=(TimeConstraint(s, time),))


def test_a_free_road_leaves_any_room_to_stop():
    assert room_to_brake(snapshot(10.0), asked(ROAD)) == math.inf


@pytest.mark.parametrize("margin", [HARD_STOP_MARGIN_M, COARSE_STOP_MARGIN_M])
def test_the_room_to_stop_ends_a_margin_before_the_stop(margin):
    assert room_to_brake(snapshot(10.0), stopping_at(50.0), margin) == pytest.approx(50.0 - margin - FRONT)


def test_the_room_to_stop_behind_a_leader_counts_the_way_in_which_he_can_stop_himself():
    leader = stay_behind("x", 40.0, 12.0, 8.0)
    found = room_to_brake(snapshot(10.0, leaders=(leader,)), asked(ROAD))
    assert found == pytest.approx(30.0 - SAFE_GAP_M + 12.0**2 / 16.0)


def test_half_of_a_narrow_gap_to_a_leader_is_room():
    leader = stay_behind("x", FRONT + 0.6, 0.0, 9.0)
    assert room_to_brake(snapshot(1.0, leaders=(leader,)), asked(ROAD)) == pytest.approx(0.3)


def test_the_nearest_of_stop_and_leaders_bounds_the_room():
    near, far = stay_behind("near", 30.0, 0.0, 9.0), stay_behind("far", 60.0, 0.0, 9.0)
    for leaders in ((near, far), (far, near)):
        assert room_to_brake(snapshot(10.0, leaders=leaders), stopping_at(90.0)) == pytest.approx(20.0 - SAFE_GAP_M)
        assert room_to_brake(snapshot(10.0, leaders=leaders), stopping_at(20.0)) == pytest.approx(10.0 - HARD_STOP_MARGIN_M)


@pytest.mark.parametrize("profile", [{}, {"nine_commands": True}], ids=["fine grid", "nine commands"])
def test_no_command_is_admissible_that_leaves_too_little_room_behind_a_leader(profile):
    """Without the leader in the room to stop the nine commands would hold their speed: none of them is v_d."""
    leader = stay_behind("x", FRONT + 13.0, 0.0, 9.0)
    found = execute(snapshot(14.0, leaders=(leader,)), asked(ROAD), CAR, 0.5, **profile)
    assert found.command.acceleration <= -CAR.service_deceleration
    assert found.emergency


def test_the_next_time_constraint_bounds_the_speed():
    away, left = 200.0, 25.0
    wish = desired_speed(snapshot(8.0), in_time(FRONT + away, left + USUAL.time_tolerance_s), CAR, PERIOD)
    assert wish.speed == pytest.approx(away / left)


def test_a_time_constraint_that_is_behind_bounds_nothing():
    passed, ahead = TimeConstraint(FRONT - 1.0, 1000.0), TimeConstraint(FRONT + 200.0, 25.0 + USUAL.time_tolerance_s)
    completed = replace(asked(ROAD), constraints=(passed, ahead))
    assert desired_speed(snapshot(8.0), completed, CAR, PERIOD).speed == pytest.approx(8.0)


def test_the_time_that_is_left_counts_from_now():
    completed = in_time(FRONT + 200.0, 125.0 + USUAL.time_tolerance_s)
    assert desired_speed(snapshot(8.0, time=100.0), completed, CAR, PERIOD).speed == pytest.approx(8.0)


def test_a_car_that_has_time_comes_when_it_should_and_not_before():
    trace = driven(ROAD, on_curve(ROAD.curve, FRONT, 10.0), lambda _: in_time(160.0, 24.0), 30.0)
    there = next(seen.time for seen, _ in trace if seen.front >= 160.0)
    assert 24.0 - USUAL.time_tolerance_s - 0.2 <= there <= 24.0


@pytest.mark.parametrize("longer", [1.0, 1.25])
def test_a_slow_bend_before_the_place_slows_nobody_before_it(longer):
    """The mean speed to a place behind a bend is not the speed to drive at before the bend, on schedule or too early."""
    road = plan_along(turning([120.0, 12.0, 40.0], [0.0, 0.12, 0.0]))
    here, there = FRONT - CAR.front_overhang, 135.0 - CAR.front_overhang
    passed = np.interp([here, there], STEP * np.arange(len(road.times)), road.times)
    planned = float(passed[1] - passed[0])
    speed = road.road_speed(here) / longer
    place = TimeConstraint(135.0, longer * planned + USUAL.time_tolerance_s)
    assert speed > 1.2 * (135.0 - FRONT) / (longer * planned)
    now = seen(on_curve(road.curve, FRONT, speed), road, here)
    wish = desired_speed(now, replace(asked(road), constraints=(place,)), CAR, PERIOD)
    assert wish.speed == pytest.approx(speed)


def test_a_car_that_is_late_accelerates_towards_the_speed_that_is_in_time():
    wanted = cruise_speed(8.0, 200.0, 18.0, 13.9, CAR.max_acceleration)
    assert wanted < 13.9
    wish = desired_speed(snapshot(8.0), in_time(FRONT + 200.0, 18.0 + USUAL.time_tolerance_s), CAR, PERIOD)
    assert 8.0 < wish.speed < wanted


def test_the_speed_before_a_stop_is_the_one_that_comfortable_braking_ends_before_its_line():
    away = 30.0
    asked_for = stopping_speed(away - USUAL.stop_line_margin_m, CAR.comfort_deceleration, PERIOD)
    wish = desired_speed(snapshot(asked_for), stopping_at(FRONT + away), CAR, PERIOD)
    assert wish == (pytest.approx(asked_for), False, "")


def test_the_speed_behind_a_leader_keeps_the_headway_and_the_gap_of_a_stand():
    leader = stay_behind("x", FRONT + 20.0, 6.0, 8.0)
    asked_for = following_speed(20.0 - CAR.standstill_gap, 6.0, CAR.comfort_deceleration, CAR.time_headway)
    wish = desired_speed(snapshot(asked_for, leaders=(leader,)), asked(ROAD), CAR, PERIOD)
    assert wish == (pytest.approx(asked_for), False, "")


@pytest.mark.parametrize(("speed", "free"), [(0.0, True), (0.5, False)])
def test_who_stands_is_no_leader_of_an_ego_that_squeezes_past_him_and_who_moves_is(speed, free):
    leader = stay_behind("x", FRONT + 2.0, speed, 8.0)
    squeezing = replace(asked(ROAD), instruction=Instruction.WIDEN)
    seen_now = snapshot(0.0, leaders=(leader,))
    wish = desired_speed(seen_now, squeezing, CAR, PERIOD)
    assert (wish == desired_speed(snapshot(0.0), squeezing, CAR, PERIOD)) is free
    assert desired_speed(seen_now, asked(ROAD), CAR, PERIOD).speed < wish.speed or not free
    assert (room_to_brake(seen_now, squeezing) == math.inf) is free


def test_a_longer_headway_is_kept_where_the_instruction_says_so():
    profile = VelocityProfile(headway=2.0)
    leader = stay_behind("x", FRONT + 20.0, 6.0, 8.0)
    calm = replace(asked(ROAD), tuning=Tuning(Weights(1.0, 1.0, 1.0), profile))
    asked_for = following_speed(20.0 - CAR.standstill_gap, 6.0, CAR.comfort_deceleration, 2.0 * CAR.time_headway)
    assert desired_speed(snapshot(asked_for, leaders=(leader,)), calm, CAR, PERIOD).speed == pytest.approx(asked_for)


def test_the_instructions_top_speed_is_kept():
    calm = replace(asked(ROAD), constraints=(TimeConstraint(FRONT, speed=5.0, reason=Reason.GAP_LOST),))
    assert desired_speed(snapshot(5.0), calm, CAR, PERIOD).speed == 5.0


def test_who_drives_ahead_in_the_slot_that_the_ego_seeks_is_followed_closely():
    other = car_at("x", FRONT + 12.0, 3.2, 0.0, 5.0)
    around = snapshot(9.0)._replace(neighbours=(Neighbour(car_at("y", 0.0, 3.2, 0.0, 1.0), -5.0), Neighbour(other, 12.0)))
    completed = falling_in_behind("x")
    asked_for = following_speed(12.0 - other.body.length, 5.0, CAR.comfort_deceleration, USUAL.slot_headway_s)
    wish = desired_speed(around, completed, CAR, PERIOD)
    assert wish.speed == pytest.approx(max(asked_for, 9.0 - CAR.comfort_deceleration * PERIOD))
    assert desired_speed(around, falling_in_behind("gone"), CAR, PERIOD).speed > 9.0


def test_beside_the_slot_that_the_ego_seeks_it_is_slower_by_what_it_regains_on_the_way_that_is_missing():
    other = car_at("x", FRONT + 1.0, 3.2, 0.0, 12.0)
    around = snapshot(7.4)._replace(neighbours=(Neighbour(other, 1.0),))
    missing = USUAL.slot_headway_s * 12.0 + other.body.length - 1.0
    wish = desired_speed(around, falling_in_behind("x"), CAR, PERIOD)
    assert wish.speed == pytest.approx(12.0 - (CAR.comfort_deceleration * missing) ** 0.5)
    assert desired_speed(around, asked(ROAD), CAR, PERIOD).speed > 7.4


@pytest.mark.parametrize("away", [1.0, 6.0])
def test_a_stop_that_planned_braking_misses_is_named_and_does_not_wait(away):
    wish = desired_speed(snapshot(13.0), stopping_at(FRONT + away), CAR, PERIOD)
    assert (wish.is_pressing, wish.hazard) == (True, STOP_PLACE)
    assert wish.speed < 13.0 - CAR.planned_deceleration * PERIOD


def test_the_nearest_hazard_is_the_one_that_is_named():
    leader = stay_behind("x", FRONT + 4.0, 0.0, 9.0)
    assert desired_speed(snapshot(13.0, leaders=(leader,)), stopping_at(FRONT + 15.0), CAR, PERIOD).hazard == "x"


def test_the_desired_speed_is_never_negative():
    assert desired_speed(snapshot(0.0), stopping_at(FRONT - 1.0), CAR, PERIOD).speed == 0.0
