"""Where everybody waits for each other: whom the ego keeps from going, whom it lets go, and when it backs up for them."""

from dataclasses import replace

import pytest
from helpers.situations import before

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.nouns.decision import Behaviour, Instruction, Reason
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.nouns.forecast import Hindered
from sumo_reactive.driver.pilot.behaviours.giving_way import RULE, give_way
from sumo_reactive.driver.view.outlook import hindered_by

ROAD = ("road_before_exit", "road_after_exit")
LOCKED = (Event(EventKind.NO_PROGRESS), Event(EventKind.LOCKED))
FREE, BLOCKED = Hindered("x", is_waiting=True, is_free=True), Hindered("y", is_waiting=True, is_free=False)


def standing(**memory):
    """The ego, which stands on the middle lane, 380 m before the junction, and has come on 3 m further last."""
    ego = before("multi_lane_road", ROAD, 380.0, 0.0, lane=1)
    return ego.remembering(progress_s=ego.seen().s, progress_time=ego.time - 30.0, **memory)


def beside(ego, name="x", to_left=0.0, waiting=20.0, halted=False, along=0.0, lane="road_before_exit_2"):
    """Somebody on the lane beside, his front so far ahead of the ego's, so far to the left of the middle of his lane."""
    at = ego.graph.lanes["road_before_exit_1"].spine.length - 380.0 + along
    user = ego.other(name, lane, at, 0.0, ROAD, waiting, halted)
    return user._replace(y=user.y + to_left)


def kept(ego, *users):
    found = hindered_by(users, ego.seen(*users), ego.graph, ego.limits)
    return {one.user_id: (one.is_waiting, one.is_free) for one in found}


def situation(ego, *found, events=LOCKED, users=()):
    """What the behaviours look at when these are found near."""
    considered = ego.considered(*users, events=events)
    return considered._replace(outlook=considered.outlook._replace(hindered=found))


def test_who_stands_beside_and_could_drive_past_is_kept_and_free():
    ego = standing()
    assert kept(ego, beside(ego)) == {"x": (True, True)}
    assert kept(ego, beside(ego, waiting=5.0)) == {"x": (False, True)}


def test_who_would_touch_the_ego_if_he_went_on_is_not_free():
    ego = standing()
    assert kept(ego, beside(ego, to_left=-1.5, along=-2.0)) == {"x": (True, False)}


def test_who_has_halted_is_far_away_or_stands_behind_is_not_kept():
    ego = standing()
    behind = beside(ego, along=-9.0, lane="road_before_exit_1")
    assert kept(ego, beside(ego, halted=True), beside(ego, along=40.0), behind) == {}


def test_a_locked_ego_lets_those_go_who_would_not_touch_it_and_stays():
    found = situation(standing(), FREE)
    way = give_way(found)
    assert (way.instruction, way.let_go, way.stop.s) == (Instruction.BACK_UP, ("x",), found.snapshot.front)
    assert (way.decision.behaviour, way.decision.reason, way.decision.cause) == (
        Behaviour.GIVING_WAY, Reason.MUTUAL_WAIT, "x",
    )  # fmt: skip
    assert RULE.may_begin(found)


def test_for_those_who_would_touch_it_the_ego_backs_up_first():
    found = situation(standing(), FREE, BLOCKED)
    way = give_way(found)
    assert (way.let_go, way.stop.s, way.decision.cause) == ((), pytest.approx(found.snapshot.front - 2.0), "y")


def test_with_no_room_behind_the_ego_does_not_back_up():
    ego = standing()
    follower = ego.ahead("z", -(ego.limits.length + 0.5 + 5.0), 0.0)
    assert give_way(situation(ego, BLOCKED, users=(follower,))) is None
    assert give_way(situation(ego, FREE, BLOCKED, users=(follower,))).let_go == ("x",)


def test_who_has_begun_to_go_is_let_go_until_he_has_passed():
    goes = FREE._replace(is_waiting=False)
    ego = standing(behaviour=Behaviour.GIVING_WAY, let_go=("x",))
    assert give_way(situation(ego, goes, events=())).let_go == ("x",)
    assert give_way(situation(ego, goes._replace(user_id="z"), events=())) is None
    assert give_way(situation(ego, events=())) is None


def test_when_that_has_not_helped_the_ego_tries_to_get_on_again_and_so_on_by_turns():
    begun = standing(behaviour=Behaviour.GIVING_WAY, escapes=1)
    assert give_way(situation(begun, FREE)) is None
    assert give_way(situation(standing(escapes=1), FREE)) is None
    assert give_way(situation(standing(escapes=2), FREE)) is not None


def test_an_ego_that_a_rule_holds_or_that_waits_in_a_queue_gives_no_way():
    ego = standing()
    assert give_way(situation(ego, FREE, events=LOCKED[:1])) is None
    assert give_way(situation(ego, FREE, users=(ego.ahead("queue", 3.0, 0.0),))) is None


def test_without_escapes_from_local_minima_no_way_is_given():
    found = situation(standing(), FREE)
    parameters = replace(found.limits.parameters, without=Mechanism.ESCAPE)
    assert not RULE.may_begin(found._replace(limits=replace(found.limits, parameters=parameters)))


def test_an_ego_that_does_not_get_on_tells_whom_it_lets_go():
    ego = standing()
    drive = ego.step(beside(ego)).drive
    memory = drive.memory._replace(progress_s=drive.s, progress_time=ego.time - 100.0)
    step = ego.step(beside(ego), drive=drive._replace(ego=ego.ego, memory=memory), time=ego.time + 0.1)
    assert step.completed.let_go == step.drive.memory.let_go == ("x",)
    assert (step.completed.behaviour, step.drive.ego.speed) == (Behaviour.GIVING_WAY, 0.0)


@pytest.mark.parametrize(("lane", "waits", "lock"), [("other_0", True, True), ("other_0", False, False), ("", True, False)])
def test_who_comes_from_another_road_and_waits_for_the_ego_is_no_queue(lane, waits, lock):
    """Each has the other ahead; who is ahead on the ego's own way has it behind."""
    ego = standing()
    x = ego.ahead("x", 3.0, 0.0)
    found = situation(ego, FREE._replace(is_waiting=waits), Hindered("z", is_waiting=True, is_free=True), users=(x,))
    assert found.ahead_of_ego.user.id == "x"
    if lane:
        there = found.ahead_of_ego
        found = found._replace(ahead_of_ego=there._replace(user=there.user._replace(lane_id=lane)))
    assert (give_way(found) is not None) is lock
