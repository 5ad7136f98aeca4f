"""When a lane beside gets on faster, and what a change to it must leave."""

from __future__ import annotations

from dataclasses import replace

import pytest
from helpers.situations import before

from sumo_reactive.driver.nouns.decision import Behaviour, Reason
from sumo_reactive.driver.nouns.event import EventKind
from sumo_reactive.driver.nouns.forecast import Queue, Queued
from sumo_reactive.driver.nouns.plan import Aside, ParallelLane
from sumo_reactive.driver.nouns.snapshot import Neighbour
from sumo_reactive.driver.nouns.traffic import Body, RoadUser
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.behaviours.changing_queues import OUTER_PASSING_SPEED, seek_faster
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.pilot import Style, decide
from sumo_reactive.driver.pilot.situation import LaneChanging

BODY = Body(4.7, 1.8, 9.0, 50.0)
WAY = ParallelLane(from_lane="from_south_1", to_lane="from_south_0", side=-1, cost=1.0, is_inner=True)
WISHES = LaneChanging(wishes=True)


def ego_at(away=100.0, speed=10.0):
    """The ego so far before the lights, on its curve."""
    ego = before("signalised_left_turns", ("from_south", "to_west"), away, speed)
    return replace(ego, plan=replace(ego.plan, joins=0.0, lane_changes=()))


EGO = ego_at()
TOP = EGO.plan.road_speed(EGO.seen().s)


def driving(ahead, speed, acceleration=0.0):
    """Somebody ahead, with the share of the road's speed that he drives at."""
    user = RoadUser(f"x{ahead:g}", 0.0, 0.0, 0.0, speed * TOP, "a_0", 0.0, BODY, acceleration=acceleration)
    return Queued(user, ahead, False)


def seeking(own, beside=(), *, ego=EGO, near=(), way=WAY, aside=None, limit=TOP, limit_beside=TOP, is_green=True):
    """What the ego makes of who is ahead on its lane and on the one beside."""
    queues = Queue("from_south_1", own, speed_limit=limit), Queue("from_south_0", beside, way, near, limit_beside)
    view, outlook = ego.considered().view, ego.outlook()._replace(queues=queues)
    memory = PilotMemory(released=("c" if is_green else "", 0.0))
    return seek_faster(view._replace(plan=replace(ego.plan, aside=aside)), outlook, memory)


SLOW = (driving(30.0, 0.7),)


def test_the_lane_of_somebody_slower_is_left_for_one_that_is_free():
    change = seeking(SLOW)
    assert change.side == WAY.side and change.stop is None
    assert (change.why.reason, change.why.region, change.why.cause) == (Reason.FASTER_LANE, WAY.to_lane, "x30")
    assert change.why.passes and change.why.behaviour is Behaviour.CHANGING_QUEUES


@pytest.mark.parametrize(
    "others",
    [
        {"own": (driving(30.0, 0.95),)},
        {"own": SLOW, "beside": (driving(40.0, 0.7),)},
        {"own": (driving(250.0, 0.7),)},
        {"own": (driving(30.0, 0.3, acceleration=2.0),)},
        {"own": SLOW, "limit_beside": 0.7 * TOP},
    ],
    ids=["hardly slower", "no better beside", "far ahead", "about to be faster", "less allowed beside"],
)
def test_it_is_not_left_where_little_is_gained(others):
    assert seeking(**others) == LaneChanging()


def test_each_further_change_must_gain_as_much_again():
    gained = 30.0 * 0.3 - 30.0 / TOP  # s, at most
    assert seeking(SLOW, way=replace(WAY, cost=1.0)).side == WAY.side
    assert seeking(SLOW, way=replace(WAY, cost=gained / USUAL.faster_gain_s + 1.0)) == LaneChanging()


@pytest.mark.parametrize("ego", [ego_at(20.0), ego_at(speed=0.5)], ids=["before the line", "creeping"])
def test_too_near_before_a_junction_or_in_a_queue_that_stands_the_ego_stays(ego):
    assert seeking(SLOW, ego=ego) == LaneChanging()


@pytest.mark.parametrize("own", [(driving(60.0, 0.0), *SLOW), (driving(40.0, 0.3, acceleration=-2.0),)])
def test_who_stands_or_is_about_to_is_nobody_slower(own):
    assert seeking(own) == LaneChanging()


def test_before_a_light_that_is_not_green_the_queues_decide():
    near = ego_at(50.0)
    assert seeking(SLOW, ego=near).side == WAY.side
    assert seeking(SLOW, ego=near, is_green=False) == LaneChanging()


def test_during_another_manoeuvre_the_ego_stays():
    assert seeking(SLOW, aside=Aside(3.0, 20.0, 40.0)) == LaneChanging()


def test_without_a_gap_the_ego_stays_and_neither_stops_nor_asks_for_room():
    beside = Neighbour(EGO.other("beside", "from_south_0", 20.0, 10.0, ()), -4.0)
    assert seeking(SLOW, near=(beside,)) == WISHES


def test_on_fast_roads_nobody_is_passed_on_the_outer_side():
    outer = replace(WAY, is_inner=False)
    assert seeking(SLOW, way=outer).side == WAY.side
    fast = OUTER_PASSING_SPEED + 1.0
    assert seeking(SLOW, way=outer, limit=fast, limit_beside=fast) == LaneChanging()
    assert seeking(SLOW, way=WAY, limit=fast, limit_beside=fast).side == WAY.side


def test_an_ego_that_wishes_to_change_looks_again_soon_and_one_that_changes_plans_to_stay_there():
    beside = Neighbour(EGO.other("beside", "from_south_0", 20.0, 10.0, ()), -4.0)

    def decided(near):
        queues = Queue("from_south_1", SLOW, speed_limit=TOP), Queue("from_south_0", (), WAY, near, TOP)
        return decide(EGO.considered().view, EGO.outlook()._replace(queues=queues), (), PilotMemory(), Style())

    waiting, memory = decided((beside,))
    assert memory.premises.due[EventKind.GAP_SOUGHT] == pytest.approx(EGO.time + USUAL.retry_s)
    assert waiting.request.change_lane == 0
    changing, _ = decided(())
    assert (changing.request.change_lane, changing.request.stays) == (WAY.side, True)
    assert changing.behaviour is Behaviour.CHANGING_QUEUES


def test_a_lane_on_which_nothing_is_allowed_to_drive_gets_nobody_on():
    assert seeking(SLOW, limit_beside=0.0) == LaneChanging()
    assert seeking(SLOW, limit=0.0).side == WAY.side
