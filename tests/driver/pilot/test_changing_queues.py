"""How long a queue is expected to take, and which one it pays to leave."""

from __future__ import annotations

from dataclasses import replace

import pytest
from helpers.cars import CAR
from helpers.situations import before

from sumo_reactive.driver.nouns.decision import Behaviour, Instruction, Reason
from sumo_reactive.driver.nouns.forecast import Queue, Queued
from sumo_reactive.driver.nouns.plan import Aside, ParallelLane
from sumo_reactive.driver.nouns.snapshot import Neighbour
from sumo_reactive.driver.nouns.traffic import Body, RoadUser
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.behaviours.changing_queues import (
    SWING_OUT_M,
    TURNERS_FEARED,
    expected_wait,
    leave_queue,
    released,
)
from sumo_reactive.driver.pilot.memory import Overtaking, PilotMemory
from sumo_reactive.driver.pilot.situation import LaneChanging

BODY = Body(4.7, 1.8, 9.0, 50.0)


def queued(ahead: float, speed: float = 0.0, waiting: float = 60.0, yields: bool = False) -> Queued:
    name = f"x{ahead:g}"
    user = RoadUser(name, 0.0, 0.0, 0.0, speed, "a_0", 0.0, BODY, waiting_time=waiting if speed == 0.0 else 0.0)
    return Queued(user, ahead, yields)


def queue(*users: Queued) -> Queue:
    return Queue("a_0", tuple(sorted(users, key=lambda one: -one.ahead)))


def test_at_a_red_light_only_who_is_ahead_counts_and_not_how_long_he_stands():
    assert expected_wait(queue(queued(8), queued(15)), 0.0, USUAL) == 2 * USUAL.queue_headway_s
    assert expected_wait(queue(), 0.0, USUAL) == 0.0


def test_cars_that_drive_are_in_no_queue():
    assert expected_wait(queue(queued(8, 9.0), queued(30, 9.0)), 30.0, USUAL) == 0.0


def test_a_head_that_stands_though_it_may_go_will_stand_for_as_long_again():
    assert expected_wait(queue(queued(30)), 12.0, USUAL) == USUAL.queue_headway_s + 12.0
    assert expected_wait(queue(queued(30, waiting=7.0)), 12.0, USUAL) == USUAL.queue_headway_s + 7.0


def test_a_queue_that_drives_off_from_its_head_is_not_held_up():
    discharging = queue(queued(40, 4.0), queued(31), queued(23))
    assert expected_wait(discharging, 12.0, USUAL) == 2 * USUAL.queue_headway_s


def test_somebody_who_has_just_stopped_is_not_held_up():
    assert expected_wait(queue(queued(30, waiting=1.0)), 12.0, USUAL) == USUAL.queue_headway_s


@pytest.mark.parametrize("turners", [1, 2, 5])
def test_turners_who_have_to_let_others_go_first_add_to_the_wait(turners):
    users = [queued(10.0 + 8.0 * k, yields=True) for k in range(turners)]
    expected = turners * USUAL.queue_headway_s + min(turners, TURNERS_FEARED) * USUAL.turner_wait_s
    assert expected_wait(queue(*users), 0.0, USUAL) == expected


WAY = ParallelLane(from_lane="from_south_1", to_lane="from_south_0", side=-1, cost=1.0)


def at_the_lights(away=50.0):
    """The ego so far before the lights, on its curve."""
    ego = before("signalised_left_turns", ("from_south", "to_west"), away, 6.0)
    return replace(ego, plan=replace(ego.plan, joins=0.0))


EGO = at_the_lights()
GREEN, RED = {"centre": "G" * 12}, {"centre": "r" * 12}


def leaving(own, beside, *, go=20.0, ego=EGO, near=(), way=WAY, lights=GREEN, aside=None, users=(), **memory):
    """What the ego makes of its own queue and that on the lane beside, at a light that has let it go for a while."""
    snapshot, ways = ego.seen(*users, lights=lights), ego.considered(lights=lights).ways
    queues = Queue("from_south_1", own), Queue("from_south_0", beside, way, near)
    outlook = ego.outlook()._replace(queues=queues)
    plan = replace(ego.plan, aside=aside, lane_changes=())
    remembered = PilotMemory(released=(ways[0].connection.id, ego.time - go) if go else ("", ego.time), **memory)
    return leave_queue(snapshot, plan, outlook, ways, remembered, CAR)


STUCK = (queued(30.0), queued(22.0))
"""Somebody who stands though he may go, and one behind him."""


def test_a_queue_that_is_held_up_is_left_for_a_lane_that_is_free():
    change = leaving(STUCK, ())
    assert change.side == WAY.side
    assert (change.why.reason, change.why.region, change.why.cause) == (Reason.QUEUE_CHANGE, WAY.to_lane, "x30")
    assert change.why.passes and change.why.behaviour is Behaviour.CHANGING_QUEUES
    assert change.stop is None


def test_who_has_to_let_others_go_is_to_blame_where_nobody_just_stands():
    turner = queued(20.0, 1.0, yields=True)
    assert leaving((queued(40.0, 6.0), turner), ()).why.cause == "x20"


@pytest.mark.parametrize("wait", [2.0, 40.0])
def test_a_queue_is_not_left_for_one_that_takes_as_long(wait):
    beside = tuple(queued(10.0 + 8.0 * k) for k in reversed(range(8)))
    assert leaving(STUCK, beside, go=wait) == LaneChanging()


def test_a_change_that_costs_more_must_save_more():
    assert leaving(STUCK, (), way=replace(WAY, cost=1.0)).side == -1
    assert leaving(STUCK, (), way=replace(WAY, cost=9.0)) == LaneChanging()
    near_cost = (expected_wait(Queue("", STUCK), 20.0, USUAL) - 1.0) / USUAL.queue_gain_s
    assert leaving(STUCK, (), way=replace(WAY, cost=near_cost)).side == -1
    assert leaving(STUCK, (), way=replace(WAY, cost=near_cost + 2.0 / USUAL.queue_gain_s)) == LaneChanging()


def test_a_change_that_the_route_asks_for_anyway_still_costs_something():
    one = (queued(20.0, 1.0),)
    assert expected_wait(Queue("", one), 20.0, USUAL) < 0.5 * USUAL.queue_gain_s
    assert leaving(one, (), way=replace(WAY, cost=-3.0)) == LaneChanging()


def test_nobody_leaves_where_there_is_no_queue_or_nobody_in_it():
    assert leaving((), ()) == LaneChanging()
    nothing = EGO.outlook()._replace(queues=())
    assert leave_queue(EGO.seen(), EGO.plan, nothing, EGO.considered().ways, PilotMemory(), CAR) == LaneChanging()


def test_an_ego_that_stands_at_a_red_light_stays_and_one_that_drives_towards_it_does_not():
    assert leaving(tuple(queued(20.0 + 8.0 * k) for k in range(9)), (), go=0.0, ego=EGO.at_speed(0.5)) == LaneChanging()
    assert leaving(tuple(queued(20.0 + 8.0 * k) for k in range(9)), (), go=0.0).side == -1


@pytest.mark.parametrize(
    "what",
    [
        {"overtaking": Overtaking(("x",), 0.0, Instruction.OVERTAKE)},
        {"aside": Aside(3.0, 20.0, 40.0)},
    ],
    ids=["overtaking", "aside"],
)
def test_in_another_manoeuvre_the_ego_stays_in_its_queue(what):
    assert leaving(STUCK, (), **what) == LaneChanging()


def test_an_ego_that_is_not_yet_on_its_curve_stays():
    late = replace(EGO, plan=replace(EGO.plan, joins=EGO.seen().s + 1.0))
    assert leaving(STUCK, (), ego=late) == LaneChanging()


def test_too_near_before_the_line_the_ego_stays():
    assert leaving(STUCK, (), ego=at_the_lights(12.0)) == LaneChanging()


def ahead_of(gap, speed=0.0):
    """A body before the ego."""
    return EGO.ahead("near", gap, speed)


def test_without_room_to_swing_out_the_ego_keeps_that_room():
    x = ahead_of(SWING_OUT_M + 6.0**2 / (2.0 * CAR.comfort_deceleration) - 0.5)
    change = leaving(STUCK, (), users=(x,))
    front = EGO.seen().front
    assert change.side == 0 and change.why is None
    nearest = front + 6.0**2 / (2.0 * CAR.comfort_deceleration)
    assert change.stop is None or change.stop.s >= nearest


def test_without_a_gap_the_ego_keeps_room_behind_the_one_ahead():
    blocker = Neighbour(EGO.other("beside", "from_south_0", 20.0, 6.0, ()), -4.0)
    x = ahead_of(30.0)
    change = leaving(STUCK, (), near=(blocker,), users=(x,))
    assert (change.side, change.stop.reason, change.stop.region) == (0, Reason.QUEUE_CHANGE, WAY.to_lane)
    assert change.stop.cause == "x30"
    assert change.stop.s == pytest.approx(EGO.seen().front + 30.0 - USUAL.halted_room_m, abs=0.3)
    assert leaving(STUCK, (), near=(blocker,)) == LaneChanging()  # nobody ahead to keep room behind


@pytest.mark.parametrize("speed", [3.0, 6.0])
def test_room_is_kept_from_where_who_still_rolls_up_to_the_queue_can_stop(speed):
    blocker = Neighbour(EGO.other("beside", "from_south_0", 20.0, 6.0, ()), -4.0)
    change = leaving(STUCK, (), near=(blocker,), users=(EGO.ahead("x", 14.0, speed),))
    stops = 14.0 + speed * speed / (2.0 * CAR.comfort_deceleration)
    nearest = 6.0**2 / (2.0 * CAR.comfort_deceleration)
    place = max(stops - USUAL.halted_room_m, 0.0)
    assert (change.stop is not None) is (place >= nearest)
    assert change.stop is None or change.stop.s == pytest.approx(EGO.seen().front + place, abs=0.3)


def test_an_ego_too_near_already_drives_up_to_where_it_can_stop_and_a_standing_one_stays():
    blocker = Neighbour(EGO.other("beside", "from_south_0", 20.0, 0.0, ()), -1.0)
    near = ahead_of(4.0)
    assert leaving(STUCK, (), near=(blocker,), users=(near,)) == LaneChanging()
    standing = EGO.at_speed(0.0)
    stop = leaving(STUCK, (), near=(blocker,), users=(near,), ego=standing).stop
    assert stop is not None and stop.s == pytest.approx(standing.seen().front)
    creeping = EGO.at_speed(0.5)
    stop = leaving(STUCK, (), near=(blocker,), users=(near,), ego=creeping).stop
    assert stop.s == pytest.approx(creeping.seen().front + 0.25 / (2.0 * CAR.comfort_deceleration) + 0.5)


def test_it_is_remembered_since_when_the_light_lets_the_ego_go():
    ways, now = EGO.considered(lights=GREEN).ways, EGO.time
    name = ways[0].connection.id
    green, red = EGO.seen(lights=GREEN), EGO.seen(lights=RED)
    assert released(green, ways, PilotMemory()) == (name, now)
    assert released(green, ways, PilotMemory(released=(name, 7.0))) == (name, 7.0)
    assert released(green, ways, PilotMemory(released=("another", 7.0))) == (name, now)
    assert released(red, ways, PilotMemory(released=(name, 7.0))) == ("", now)
    assert released(green, (), PilotMemory(released=(name, 7.0))) == ("", now)
