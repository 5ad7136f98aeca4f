"""Times at a region, worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from sumo_reactive.driver.geometry.polyline import Polyline
from sumo_reactive.driver.nouns.plan import MOVE_SPEED, TURNAROUND_REACHED_M
from sumo_reactive.driver.nouns.snapshot import Conflict, Foe
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import FOLLOWER_STANDSTILL_GAP_M, Body, RoadUser
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.rules.gaps import (
    FEARED_DECELERATION,
    Passing,
    Threat,
    gap_for_follower,
    is_enough,
    threat,
    turning,
)
from sumo_reactive.driver.vehicle.travel_time import travel_time
from sumo_reactive.driver.world.junction import Connection, Control, Turn
from sumo_reactive.driver.world.regions import ConflictKind, ConflictRegion, Interval, PostConflictRegion

BOTH = Interval(5.0, 8.0)
CROSSING = ConflictRegion(
    id="r", kind=ConflictKind.CROSSING, own_id="a", other_id="b", own=BOTH, other=BOTH, polygon=np.zeros((4, 2)),
    post=PostConflictRegion("a", 8.0),
)  # fmt: skip
WAY = Connection(
    id="b", junction_id="j", index=0, from_lane="in_0", to_lane="out_0", parts=(),
    path=Polyline(np.array([(0.0, 0.0), (20.0, 0.0)])), turn=Turn.STRAIGHT, control=Control.MAJOR, speed_limit=14.0,
)  # fmt: skip
CAR_BODY, PERSON = Body(5.0, 1.8, 9.0, 12.0), Body(0.2, 0.5, 2.0, 1.5, is_person=True)


def foe(speed: float, to_region: float, kind: ConflictKind = ConflictKind.CROSSING, body: Body = CAR_BODY) -> Foe:
    """Somebody `to_region` m before a region of 3 m length."""
    user = RoadUser("x", 0.0, 0.0, 0.0, speed, "in_0", 0.0, body)
    conflict = Conflict(replace(CROSSING, kind=kind), WAY, must_yield=True, is_yielded_to=False)
    return Foe(user, 0, conflict, to_region - 5.0, to_region, to_region + 3.0 + body.length)


def test_who_turns_round_is_everywhere_for_as_long_as_that_takes():
    way = 12.0 + TURNAROUND_REACHED_M
    assert turning(to_start=way, speed=6.0, acceleration=2.0, duration=20.0) == pytest.approx((2.0, 22.0, 22.0, MOVE_SPEED))


def test_who_stands_where_it_turns_round_is_in_the_regions_at_once():
    assert turning(to_start=TURNAROUND_REACHED_M, speed=0.0, acceleration=2.0, duration=20.0).arrival == 0.0


@pytest.mark.parametrize(
    ("speed", "to_line", "turn", "clears"),
    [
        (10.0, 25.0, 14.0, 3.8),  # he does not turn
        (10.0, 25.0, 5.0, (2.5 + 5.0 / 4.5 - 7.5 / 9.0) + 13.0 / 5.0),  # he brakes to 5 m/s over 8.33 m before his line
        (10.0, 3.0, 5.0, (10.0 - 73.0**0.5) / 4.5 + 13.0 / 73.0**0.5),  # he comes to it faster than he should: √(100 − 27)
        (4.0, 25.0, 5.0, 9.5),
        (10.0, -1.0, 5.0, 1.2),  # over his line he has the speed that he has
    ],
)
def test_who_will_brake_for_his_turn_clears_the_region_later(speed, to_line, turn, clears):
    one = foe(speed, to_line + 5.0)
    turner = one._replace(conflict=replace_other(one.conflict, speed_limit=turn))
    assert threat(turner, USUAL).clearance == pytest.approx(clears)


@pytest.mark.parametrize(("speed", "arrival"), [(1.5, 4.0), (0.2, 12.0)])
def test_a_pedestrian_keeps_its_pace_and_is_not_taken_for_slower_than_half_a_metre_a_second(speed, arrival):
    other = threat(foe(speed, 6.0, body=PERSON), USUAL)
    assert other == pytest.approx((arrival, arrival * 9.2 / 6.0, arrival * 9.2 / 6.0))


@pytest.mark.parametrize(("can", "gains"), [(0.0, 1.5), (2.6, 1.5), (6.0, 3.42)])
def test_who_can_speed_up_faster_than_cars_may_come_sooner(can, gains):
    quick = foe(4.0, 16.0, body=CAR_BODY._replace(acceleration=can))
    assert threat(quick, USUAL).arrival == pytest.approx(travel_time(16.0, 4.0, gains, 12.0))


def test_a_car_may_come_sooner_than_at_its_speed_and_leave_no_sooner():
    one = foe(8.0, 16.0)
    other = threat(one, USUAL)
    assert other.arrival == pytest.approx(travel_time(16.0, 8.0, USUAL.foe_acceleration, 12.0))  # its own top speed
    assert (other.clearance, other.merged) == pytest.approx((24.0 / 8.0, 21.0 / 8.0))
    assert threat(one, USUAL, expects_ego=True).arrival == pytest.approx(2.0)


@pytest.mark.parametrize(("speed", "to_line", "arrival"), [(0.0, 60.0, 10.453), (0.0, 100.0, 13.787), (4.0, 30.0, 5.454)])
def test_a_car_far_from_a_narrow_turn_may_come_as_fast_as_the_road_before_it_allows(speed, to_line, arrival):
    """It speeds up by 1.5 m/s² to 11.9, 12 and 9.3 m/s, brakes by 4.5 to the 5 m/s of its turn, and goes on 5 m."""
    one = foe(speed, to_line + 5.0)
    one = one._replace(conflict=replace_other(one.conflict, speed_limit=5.0, approach_limit=12.0))
    assert threat(one, USUAL).arrival == pytest.approx(arrival, abs=0.001)


def test_a_car_nearer_than_it_takes_to_brake_comes_as_before():
    near, turn = foe(11.0, 12.0), {"speed_limit": 5.0, "approach_limit": 14.0}
    assert threat(near._replace(conflict=replace_other(near.conflict, **turn)), USUAL).arrival == pytest.approx(12.0 / 11.0)


def replace_other(conflict: Conflict, **limits: float) -> Conflict:
    """Return a conflict with the other's way under other limits."""
    return conflict._replace(other=replace(conflict.other, **limits))


def test_a_car_that_is_seen_to_gain_speed_leaves_as_soon_as_that_takes_it():
    other = threat(foe(4.0, 6.0), USUAL, gaining=1.0)
    assert (other.clearance, other.merged) == pytest.approx(tuple(travel_time(way, 4.0, 1.0, 12.0) for way in (14.0, 11.0)))
    most = threat(foe(4.0, 6.0), USUAL, gaining=99.0)
    assert most.clearance == pytest.approx(travel_time(14.0, 4.0, USUAL.leaving_acceleration, 12.0))


def test_a_car_that_stands_in_the_region_is_there_for_long():
    other = threat(foe(0.0, -2.0), USUAL)
    assert other.arrival == 0.0 and other.clearance == pytest.approx(6.0 / STANDING_SPEED)


def enough(own: Passing, one: Foe, other: Threat, patience: float = 1.0) -> tuple[bool, bool]:
    """Whether it may pass before the foe, and whether before or after it."""
    return tuple(is_enough(own, one, other, USUAL, patience, may_follow=may) for may in (False, True))


@pytest.mark.parametrize("patience", [1.0, 0.5])
def test_in_a_crossing_region_one_is_gone_a_while_before_the_other_comes(patience):
    one, own = foe(8.0, 16.0), Passing(4.0, 6.0, 5.0, 8.0)
    before, after = USUAL.gap_before_s * patience, USUAL.gap_after_s * patience
    assert enough(own, one, Threat(6.0 + before + 0.01, 9.0, 8.0), patience) == (True, True)
    assert enough(own, one, Threat(6.0 + before - 0.01, 9.0, 8.0), patience) == (False, False)
    assert enough(own, one, Threat(1.0, 4.0 - after - 0.01, 8.0), patience) == (False, True)
    assert enough(own, one, Threat(1.0, 4.0 - after + 0.01, 8.0), patience) == (False, False)


@pytest.mark.parametrize(("own_speed", "foe_speed"), [(8.0, 8.0), (4.0, 10.0), (12.0, 6.0)])
def test_where_lanes_merge_whoever_comes_behind_has_time_to_adapt(own_speed, foe_speed):
    one, own = foe(foe_speed, 16.0, ConflictKind.MERGING), Passing(4.0, 9.0, 5.0, own_speed)

    def adapting(behind: float, ahead: float) -> float:
        return max(0.0, behind - ahead) ** 2 / (2.0 * USUAL.follower_deceleration) / behind

    before = USUAL.merge_gap_s + adapting(foe_speed, own_speed)
    after = USUAL.gap_after_s + adapting(own_speed, foe_speed)
    assert enough(own, one, Threat(5.0 + before + 0.01, 99.0, 99.0)) == (True, True)
    assert enough(own, one, Threat(5.0 + before - 0.01, 99.0, 99.0)) == (False, False)
    assert enough(own, one, Threat(0.0, 99.0, 4.0 - after - 0.01)) == (False, True)
    assert enough(own, one, Threat(0.0, 99.0, 4.0 - after + 0.01)) == (False, False)


def test_a_pedestrian_where_lanes_merge_counts_as_where_they_cross():
    one, own = foe(1.0, 6.0, ConflictKind.MERGING, PERSON), Passing(4.0, 9.0, 5.0, 8.0)
    assert enough(own, one, Threat(9.0 + USUAL.gap_before_s - 0.01, 20.0, 20.0)) == (False, False)
    assert enough(own, one, Threat(9.0 + USUAL.gap_before_s + 0.01, 20.0, 20.0)) == (True, True)


@pytest.mark.parametrize(
    ("speed", "ahead", "gap"),
    [
        (10.0, 0.0, max(10.0 * (1.0 + 5.0 / FEARED_DECELERATION), 25.0)),  # stops behind one that stands
        (10.0, 10.0, 25.0 - 50.0 / FEARED_DECELERATION),  # he too needs some way to stop
        (3.0, 3.0, 3.0),  # its headway alone
        (20.0, 20.0, max(20.0 + 200.0 / FEARED_DECELERATION, 100.0) - 200.0 / FEARED_DECELERATION),
    ],
)
def test_a_follower_feels_safe_where_it_can_react_and_stop(speed, ahead, gap):
    assert gap_for_follower(speed, ahead, headway=1.0, braking=2.0) == pytest.approx(FOLLOWER_STANDSTILL_GAP_M + gap)


def test_a_follower_that_is_much_slower_needs_no_gap():
    assert gap_for_follower(2.0, 15.0, headway=1.0, braking=2.0) == 0.0
