"""Which gap on the other lane is enough for whoever comes behind, and what if it closes."""

from dataclasses import replace

import pytest
from helpers.cars import CAR
from helpers.situations import Situation, before

from sumo_reactive.driver.nouns.completed_plan import Replanning
from sumo_reactive.driver.nouns.decision import Behaviour, Reason
from sumo_reactive.driver.nouns.traffic import FOLLOWER_STANDSTILL_GAP_M, RoadUser
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.path.planner import PlanStart, plan
from sumo_reactive.driver.pilot.behaviours.changing_lanes import seek_gap, seeks
from sumo_reactive.driver.pilot.rules.gaps import gap_for_follower
from sumo_reactive.driver.world.route import Route

TO_THE_EXIT = ("road_in", "road_before_exit", "exit")


@pytest.mark.parametrize("speed", [8.0, 14.0, 28.0])
@pytest.mark.parametrize("slower", [0.0, 3.0, 8.0])
def test_a_follower_need_not_brake_hard_for_the_ego(speed, slower):
    """SUMO's cars brake 1.2 times as hard as they must to stop behind somebody who brakes with 4.5 m/s²."""
    ahead = speed - slower
    gap = gap_for_follower(speed, ahead, 0.15, USUAL.hard_stop_deceleration) - FOLLOWER_STANDSTILL_GAP_M
    assert 1.2 * speed * speed / (2.0 * (gap + ahead * ahead / 9.0)) < 4.6


def test_a_slower_ego_needs_a_longer_gap():
    gaps = [gap_for_follower(20.0, ahead, 0.8, USUAL.easy_stop_deceleration) for ahead in (20.0, 15.0, 5.0)]
    assert gaps == sorted(gaps)
    assert gaps[0] == pytest.approx(FOLLOWER_STANDSTILL_GAP_M + 16.2, abs=0.5)


def test_a_follower_that_stands_or_falls_behind_needs_none():
    assert gap_for_follower(0.0, 0.0, 0.8, USUAL.easy_stop_deceleration) == 0.0
    assert gap_for_follower(5.0, 15.0, 0.8, USUAL.easy_stop_deceleration) == 0.0


@pytest.mark.parametrize(("ahead", "is_free"), [(-70.0, True), (-45.0, True), (-5.0, False), (0.0, False), (4.0, False)])
def test_a_car_alongside_counts_where_the_lane_to_change_to_belongs_to_a_later_road(ahead, is_free):
    ego = before("multi_lane_road", TO_THE_EXIT, 5.0, 19.4, lane=1)
    seen = ego.seen(ego.other("x", "road_in_0", ahead - 5.0, 19.4, TO_THE_EXIT))
    assert seen.neighbours[0].ahead == pytest.approx(ahead, abs=0.1)
    assert (seek_gap(seen, ego.plan, CAR).stop is None) is is_free


def test_who_is_on_the_later_road_is_as_far_ahead_as_c_is_long():
    ego = before("multi_lane_road", TO_THE_EXIT, 5.0, 19.4, lane=1)
    seen = ego.seen(ego.other("x", "road_before_exit_0", 10.0, 19.4, TO_THE_EXIT))
    assert seen.neighbours[0].ahead == pytest.approx(15.0, abs=0.2)


FALLS_IN = [(-2.0, 19.4, True), (-12.0, 19.4, True), (-15.0, 24.0, True), (-40.0, 19.4, False), (-15.0, 10.0, False)]


@pytest.mark.parametrize(("ahead", "speed", "is_let_by"), FALLS_IN)
def test_the_ego_falls_in_behind_who_will_be_ahead_or_whom_it_cannot_leave_behind(ahead, speed, is_let_by):
    ego = before("multi_lane_road", TO_THE_EXIT, 5.0, 19.4, lane=1)
    blocks = ego.other("b", "road_in_0", -2.0, 19.4, TO_THE_EXIT)
    other = ego.other("x", "road_in_0", ahead - 5.0, speed, TO_THE_EXIT)
    assert seek_gap(ego.seen(blocks, other), ego.plan, CAR).slot == ("x" if is_let_by else "b")


def asking(away: float, *places: float, limits=CAR, x_speed: float = 15.0):
    """Return whom an ego at 15 m/s asks to let it in, its front `away` m before the end of its road, b beside it and x, y, …
    at these places behind its front (m)."""
    ego = before("multi_lane_road", TO_THE_EXIT[1:], away, 15.0, lane=1)
    there = zip("bxy", (1.0, *places), strict=False)
    speeds = {"x": x_speed}
    users = (
        ego.other(name, "road_before_exit_0", at - away, speeds.get(name, 15.0), TO_THE_EXIT[1:]) for name, at in there
    )
    found = seek_gap(ego.seen(*users), ego.plan, limits)
    assert found.stop is not None
    return found.why


BEHIND = [((-60.0, -90.0), "x"), ((-20.0, -60.0), "x"), ((-1.0, -60.0), "x"), ((), None)]


@pytest.mark.parametrize(("places", "asked"), BEHIND)
def test_the_next_one_is_asked_to_let_the_ego_in_where_a_gap_presses(places, asked):
    why = asking(70.0, *places)
    assert (why and (why.reason, why.region, why.cause, why.passes)) == (
        asked and (Reason.ASKS, "road_before_exit_0", asked, True)
    )


def test_who_stands_too_near_does_not_back_up_and_the_next_one_is_asked():
    assert asking(70.0, -5.0, -60.0, x_speed=0.0).cause == "y"
    assert asking(70.0, -5.0, -60.0, x_speed=5.0).cause == "x"


def test_nobody_is_asked_where_there_is_way_for_another_gap_nor_by_a_driver_that_asks_nobody():
    proud = replace(CAR, parameters=replace(USUAL, asked_deceleration=0.0))
    assert asking(200.0, -60.0) is asking(70.0, -60.0, limits=proud) is None


def changing(left: float, speed: float = 15.0) -> Situation:
    """The ego that has just begun to change to the lane of the exit, its front bumper `left` m before the road's end."""
    ego = before("multi_lane_road", TO_THE_EXIT[1:], left, speed, lane=1)
    at = ego.graph.lanes["road_before_exit_1"].spine.length - left
    start = PlanStart(ego.ego.pose, speed, 0.0, 100.0, "road_before_exit_1", at, 0)
    return replace(ego, plan=plan(ego.graph, Route(TO_THE_EXIT[1:]), CAR, start, change_now=-1))


def beside(ego: Situation, left: float, ahead: float, speed: float = 15.0) -> RoadUser:
    return ego.other("x", "road_before_exit_0", ahead - left, speed, TO_THE_EXIT[1:])


@pytest.mark.parametrize("ahead", [-5.0, 0.0, 4.0])
def test_a_change_that_has_just_begun_is_called_off_when_its_gap_has_closed(ahead):
    ego = changing(200.0)
    completed = ego.step(beside(ego, 200.0, ahead)).completed
    assert (completed.request.what, completed.request.change_lane) == (Replanning.CURVE, 0)
    assert completed.stop is None
    (decision,) = (one for one in completed.decisions if one.reason is Reason.GAP_CLOSED)
    assert (decision.behaviour, decision.cause) == (Behaviour.CHANGING_LANES, "x")


@pytest.mark.parametrize("ahead", [-40.0, 40.0])
def test_a_change_that_has_just_begun_goes_on_while_its_gap_is_open(ahead):
    ego = changing(200.0)
    assert ego.step(beside(ego, 200.0, ahead)).completed.request.what is Replanning.NOTHING


def test_a_change_at_its_last_place_is_not_called_off():
    ego = changing(40.0)
    assert not seek_gap(ego.seen(beside(ego, 40.0, -5.0)), ego.plan, CAR).calls_off


def test_a_change_is_not_called_off_when_the_body_is_over_the_line():
    ego = changing(200.0)
    seen = ego.seen(beside(ego, 200.0, -5.0))
    assert seeks(seen, ego.plan)
    later = seen._replace(s=0.35 * ego.plan.joins, front=0.35 * ego.plan.joins + CAR.front_overhang)
    assert not seek_gap(later, ego.plan, CAR).calls_off


def test_a_change_at_walking_pace_goes_on_when_who_is_behind_creeps_up():
    ego = changing(200.0, 0.5)
    near, beside_it = (seek_gap(ego.seen(beside(ego, 200.0, ahead, 0.6)), ego.plan, CAR) for ahead in (-6.0, -3.0))
    assert (near.calls_off, beside_it.calls_off) == (False, True)
