"""Stopping at a location: where the route says, for as long as it says (F&L 1991, §2)."""

from itertools import pairwise

import pytest
from helpers.situations import PERIOD, before

from sumo_reactive.driver.nouns.decision import Behaviour, Reason
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.world.route import ScheduledStop

ROUTE = ("from_west", "to_east")
DURATION = 4.0


def standing_times(steps) -> list[float]:
    return [step.snapshot.time for step in steps if step.snapshot.ego.speed < STANDING_SPEED]


def stopping(until: float | None = None):
    return before("four_way_priority", ROUTE, 120.0, 10.0, stops=(ScheduledStop("from_west_0", 100.0, DURATION, until),))


def test_a_scheduled_stop_is_announced_as_what_it_is():
    completed = stopping().step().completed
    assert completed.behaviour is Behaviour.STOPPING
    assert (completed.stop.reason, completed.stop.cause) == (Reason.SCHEDULED_STOP, "from_west_0")
    assert completed.stop.s == pytest.approx(completed.plan.stops[0].s)


def test_a_scheduled_stop_is_served_for_its_duration_and_then_left():
    ego = stopping()
    steps = ego.driven(30.0)
    stands = standing_times(steps)
    place = ego.plan.stops[0].s
    halted = next(step for step in steps if step.snapshot.ego.speed < 0.05)
    assert 0.0 < place - halted.snapshot.front < 1.0
    assert DURATION <= stands[-1] - stands[0] < DURATION + 1.0
    assert steps[-1].snapshot.front > place + 5.0


def test_a_stop_just_behind_a_joint_where_nobody_crosses_is_seen_before_it_and_braked_for_softly():
    behind = (ScheduledStop("road_after_exit_0", 6.0, DURATION),)
    ego = before("multi_lane_road", ("road_before_exit", "road_after_exit"), 150.0, 13.0, stops=behind)
    steps = ego.driven(18.0)
    seen = next(step for step in steps if step.completed.stop is not None)
    assert seen.completed.behaviour is Behaviour.STOPPING
    assert seen.snapshot.front < ego.line
    speeds = [step.snapshot.ego.speed for step in steps]
    assert max(a - b for a, b in pairwise(speeds)) < USUAL.planned_deceleration * PERIOD
    assert min(speeds) < STANDING_SPEED


def test_a_scheduled_stop_lasts_at_least_until_its_time():
    stands = standing_times(stopping(until=125.0).driven(32.0))
    assert 125.0 <= stands[-1] < 126.0


def test_a_served_stop_is_not_served_again():
    ego = stopping()
    steps = ego.driven(30.0)
    assert steps[-1].drive.memory.served == (ego.plan.stops[0].stop,)
    after = [step.completed.stop for step in steps if step.drive.memory.served]
    assert all(stop is None or stop.reason is not Reason.SCHEDULED_STOP for stop in after)
