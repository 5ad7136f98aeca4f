"""Where the pilot's word turns over when it changes lanes or cuts into one: a scene each, of which one figure grows."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pytest
from helpers.cars import CAR
from helpers.situations import Situation, before
from helpers.turning_points import turns_at

from sumo_reactive.driver.nouns.plan import CALL_OFF_SHARE
from sumo_reactive.driver.nouns.snapshot import Neighbour, OffTracking
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.path.planner import PlanStart, plan
from sumo_reactive.driver.pilot.behaviours.changing_lanes import seek_gap, seeks
from sumo_reactive.driver.pilot.situation import LaneChanging
from sumo_reactive.driver.world.route import Route

TO_EXIT, ROAD = ("road_before_exit", "exit"), ("road_before_exit", "road_after_exit")
Holds = Callable[[float], bool]

ROUNDED_M = 0.01
"""C is shorter than the lanes by this (m): it rounds its way to the exit."""

ego_at = cache(before)


def beside(ego: Situation, ahead: float, speed: float) -> RoadUser:
    """Somebody on the lane of the exit, its front so far before the ego's."""
    at = ego.ahead("x", ahead - 4.7, speed).lane_position
    return ego.other("x", "road_before_exit_0", at, speed, TO_EXIT)


def changes(away: float, speed: float, other: float, side: float) -> Holds:
    """Whether the ego changes with somebody so far behind its front (`side` −1) or before it, `away` m before the end."""
    ego = ego_at("multi_lane_road", TO_EXIT, away, speed, 1)
    return lambda m: seek_gap(ego.seen(beside(ego, side * m, other)), ego.plan, CAR).side == -1


def alone(speed: float) -> Holds:
    """Whether the ego changes so far before the road's end with nobody there."""

    def holds(away: float) -> bool:
        ego = ego_at("multi_lane_road", TO_EXIT, away, speed, 1)
        return seek_gap(ego.seen(), ego.plan, CAR).side == -1

    return holds


def begun(left: float, speed: float = 15.0) -> Situation:
    """The ego that has just begun to change, `left` m before the road's end."""
    ego = ego_at("multi_lane_road", TO_EXIT, left, speed, 1)
    at = ego.graph.lanes["road_before_exit_1"].spine.length - left
    start = PlanStart(ego.ego.pose, speed, 0.0, 100.0, "road_before_exit_1", at, 0)
    return replace(ego, plan=plan(ego.graph, Route(TO_EXIT), CAR, start, change_now=-1))


def calls_off(ego: Situation, ahead: float, speed: float) -> bool:
    return seek_gap(ego.seen(beside(ego, ahead, speed)), ego.plan, CAR).calls_off


def seeks_after(share: float) -> bool:
    """Whether the pilot looks at a change of which this share is made."""
    ego = begun(200.0)
    return seeks(ego.seen()._replace(s=share * ego.plan.joins, front=share * ego.plan.joins + 1.0), ego.plan)


def cutting(start: float, ahead: float, other: float, waited: float = 0.0, speed: float = 10.0) -> LaneChanging:
    """What an ego does that will cut into the lane beside in `start` m, with somebody there."""
    ego = ego_at("multi_lane_road", ROAD, 380.0, speed)
    seen, user = ego.seen(), ego.other("x", "road_before_exit_1", 50.0, other, ROAD)
    cut = OffTracking(seen.front + start, seen.front + start + 10.0, True, "road_before_exit_1")
    return seek_gap(seen._replace(off_tracking=cut, neighbours=(Neighbour(user, ahead),)), ego.plan, CAR, waited)


def cuts_behind(waited: float, start: float = 30.0, other: float = 12.0, speed: float = 10.0) -> Holds:
    return lambda m: cutting(start, -m, other, waited, speed).stop is None


def cuts_before(waited: float) -> Holds:
    return lambda m: cutting(30.0, m, 5.0, waited).stop is None


ROWS: dict[str, tuple[Holds, float, float, float]] = {
    "m behind at the same speed": (changes(200.0, 15.0, 15.0, -1.0), 4.0, 120.0, 18.501),
    "m ahead at the same speed": (changes(200.0, 15.0, 15.0, 1.0), 4.0, 90.0, 14.200),
    "m behind who is faster": (changes(200.0, 15.0, 20.0, -1.0), 4.0, 120.0, 42.106),
    "m behind who is slower": (changes(200.0, 15.0, 10.0, -1.0), 4.0, 120.0, 6.5),
    "m behind who stands": (changes(200.0, 15.0, 0.0, -1.0), 4.0, 120.0, 5.999),
    "m ahead who is slower": (changes(200.0, 15.0, 10.0, 1.0), 4.0, 90.0, 20.450),
    "m behind near the end": (changes(60.0, 10.0, 10.0, -1.0), 4.0, 120.0, 12.332),
    "m ahead near the end": (changes(60.0, 10.0, 10.0, 1.0), 4.0, 90.0, 10.200),
    "m behind who is faster near the end": (changes(40.0, 10.0, 14.0, -1.0), 4.0, 120.0, 22.361),
    "m ahead who is faster near the end": (changes(40.0, 10.0, 14.0, 1.0), 4.0, 90.0, 8.700),
    "m behind who is slower near the end": (changes(40.0, 8.0, 5.0, -1.0), 4.0, 120.0, 6.5),
    "m ahead who is slower near the end": (changes(40.0, 8.0, 5.0, 1.0), 4.0, 90.0, 9.667),
    "m before the last place in time": (alone(15.0), 30.0, 390.0, 20.0 + ROUNDED_M + 15.0 * USUAL.lane_change_look_ahead_s),
    "m before the last place in way": (alone(5.0), 30.0, 390.0, 20.0 + ROUNDED_M + USUAL.lane_change_look_ahead_m),
    "m of lane that a fast change needs": (alone(15.0), 12.0, 100.0, 20.0),
    "m of lane that a slow change needs": (alone(3.0), 10.0, 100.0, 13.514),
    "m before the end to wait for another gap": (lambda m: calls_off(begun(m), -5.0, 15.0), 40.0, 200.0, 64.849),
    "m behind of a gap that has closed": (lambda m: calls_off(begun(200.0), -m, 15.0), 4.0, 40.0, 11.105),
    "m ahead of a gap that has closed": (lambda m: calls_off(begun(200.0), m, 15.0), 4.0, 40.0, 7.95),
    "m behind of who creeps": (lambda m: calls_off(begun(200.0, 0.5), -m, 0.6), 3.0, 6.0, 5.0),
    "share of a change that may be called off": (seeks_after, 0.1, 0.9, CALL_OFF_SHARE),
    "m behind of a cut": (cuts_behind(0.0), 5.0, 120.0, 26.988),
    "m behind of a cut after half the patience": (cuts_behind(0.5 * USUAL.off_tracking_patience_s), 5.0, 120.0, 23.089),
    "m behind of a cut after all patience": (cuts_behind(USUAL.off_tracking_patience_s), 5.0, 120.0, 20.336),
    "m behind of a cut long after": (cuts_behind(2.0 * USUAL.off_tracking_patience_s), 5.0, 120.0, 20.336),
    "m before of a cut": (cuts_before(0.0), 16.0, 120.0, 32.951),
    "m before of a cut after all patience": (cuts_before(USUAL.off_tracking_patience_s), 16.0, 120.0, 25.771),
    "m before a cut that are too short to stop": (
        lambda m: cutting(m, -10.0, 12.0).stop is None, 2.0, 40.0, 100.0 / (2.0 * CAR.service_deceleration),
    ),
    "m behind of a cut by who creeps, passed by then": (cuts_behind(0.0, 5.0, 6.0, 0.2), 10.0, 30.0, 17.8),
    "m behind of a cut by who creeps": (cuts_behind(0.0, 5.0, 6.0, 0.2), 30.0, 80.0, 40.189),
    "m behind of a cut by who is faster than the road": (cuts_behind(0.0, 90.0, 25.0, 22.0), 20.0, 160.0, 84.947),
}  # fmt: skip


@pytest.mark.parametrize("name", ROWS)
def test_beside_another_lane_the_pilots_word_turns_over_at(name):
    holds, low, high, figure = ROWS[name]
    assert turns_at(holds, low, high) == pytest.approx(figure, abs=0.005)


def test_a_stop_before_a_cut_tells_where_it_cuts_into_which_lane_and_who_is_there():
    stop = cutting(30.0, -10.0, 12.0).stop
    front = ego_at("multi_lane_road", ROAD, 380.0, 10.0).seen().front
    assert stop is not None
    assert (stop.s - front, stop.reason.name, stop.region, stop.cause) == (30.0, "NO_GAP", "road_before_exit_1", "x")


@pytest.mark.parametrize(
    ("lane", "speed", "waits"),
    [("from_east_0", 0.0, False), ("from_east_0", 0.3, True), ("from_south_0", 0.0, True), ("to_west_0", 0.0, True)],
)
def test_a_cut_behind_a_junction_does_not_wait_for_who_stands_before_it_on_another_road(lane, speed, waits):
    ego = ego_at("four_way_priority", ("from_south", "to_west"), 12.0, 0.0)
    seen, user = ego.seen(), ego.other("x", lane, 5.0, speed, ("from_east", "to_west"))
    line = ego.plan.passages[0].start
    cut = OffTracking(line + 2.0, line + 9.0, True, "to_west_0")
    seen = seen._replace(off_tracking=cut, neighbours=(Neighbour(user, -1.5),))
    assert (seek_gap(seen, ego.plan, replace(CAR, length=16.0)).stop is not None) is waits
