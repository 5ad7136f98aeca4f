"""Leaving local minima: room, backing up, a new curve, more commands, and who is to blame (F&L 1991, §3.3)."""

import math
from dataclasses import replace

import pytest
from helpers.situations import before

from sumo_reactive.driver.nouns.completed_plan import Replanning
from sumo_reactive.driver.nouns.constraint import stop_at
from sumo_reactive.driver.nouns.decision import Instruction, Reason
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.behaviours.backing_up import escape, room_behind

STREET = ("eastbound", "eastbound_out")
STUCK = (Event(EventKind.NO_PROGRESS),)


def standing(gap: float, halted: bool = True, to_left: float = 0.0):
    """The ego behind somebody who stands, and what it sees."""
    ego = before("blocked_lane", STREET, 200.0, 0.0, to_left=to_left)
    return ego, ego.ahead("x", gap, 0.0, halted)


def test_room_is_kept_behind_somebody_who_has_halted():
    ego = before("blocked_lane", STREET, 300.0, 10.0)
    situation = ego.considered(ego.ahead("x", 50.0, 0.0, halted=True))
    stop = room_behind(situation)
    assert (stop.reason, stop.cause) == (Reason.BLOCKED, "x")
    assert stop.s == pytest.approx(situation.snapshot.front + 50.0 - USUAL.halted_room_m, abs=0.5)


def test_no_room_is_kept_behind_a_queue_nor_where_there_is_no_lane_to_pass_on():
    ego = before("blocked_lane", STREET, 300.0, 10.0)
    assert room_behind(ego.considered(ego.ahead("x", 50.0, 0.0))) is None
    left = before("multi_lane_road", ("road_before_exit", "road_after_exit"), 380.0, 10.0, lane=2)
    assert room_behind(left.considered(left.ahead("x", 50.0, 0.0, halted=True))) is None


def test_the_ego_stops_with_that_room_behind_somebody_who_has_halted():
    ego = before("blocked_lane", STREET, 300.0, 10.0)
    x = ego.ahead("x", 50.0, 0.0, halted=True)
    oncoming = [ego.other(f"o{k}", "westbound_0", 100.0 + 12.0 * k, 0.2, ("westbound",)) for k in range(20)]
    end = ego.driven(15.0, x, *oncoming)[-1]
    assert end.drive.ego.speed < 0.1
    gap = 50.0 + ego.seen().front - end.snapshot.front
    assert USUAL.halted_room_m - 0.5 < gap < USUAL.halted_room_m + 2.0


def test_too_near_behind_somebody_who_has_halted_the_ego_backs_up():
    ego, x = standing(3.0)
    way_out = escape(ego.considered(x))
    assert (way_out.instruction, way_out.stop.cause) == (Instruction.BACK_UP, "x")
    assert way_out.stop.s == pytest.approx(ego.seen().front + 3.0 - USUAL.halted_room_m, abs=0.5)


def test_backing_up_ends_with_room_to_swing_out():
    ego, x = standing(3.0)
    steps = ego.driven(12.0, x)
    gaps = [3.0 + ego.seen().front - step.snapshot.front for step in steps]
    assert min(step.drive.ego.speed for step in steps) >= -1.0 - 1e-6
    assert max(gaps) > 6.4
    assert max(gaps) < USUAL.halted_room_m + 0.5


def test_the_ego_does_not_back_up_into_somebody_behind_it():
    ego, x = standing(3.0)
    behind = ego.ahead("behind", -12.0, 0.0)
    way_out = escape(ego.considered(x, behind))
    assert way_out is None or way_out.instruction is not Instruction.BACK_UP


def test_far_enough_behind_somebody_who_has_halted_it_does_not_back_up():
    ego, x = standing(USUAL.halted_room_m)
    assert escape(ego.considered(x)) is None


def test_without_want_of_progress_there_is_nothing_to_escape_from():
    ego, _ = standing(3.0)
    assert escape(ego.considered()) is None


def test_who_blocks_the_ego_is_named():
    ego = before("multi_lane_road", ("road_before_exit", "road_after_exit"), 380.0, 0.0, lane=2)
    x = ego.ahead("x", 3.0, 0.0, halted=True)
    decision = escape(ego.considered(x, events=STUCK)).decision
    assert (decision.reason, decision.cause) == (Reason.BLOCKED, "x")


def test_past_somebody_who_waits_across_the_way_the_ego_squeezes_at_walking_speed():
    ego, x = standing(3.0, halted=False)
    across = x._replace(heading=x.heading + 0.7 * math.pi)
    way_out = escape(ego.considered(across, events=STUCK))
    assert (way_out.decision.reason, way_out.decision.cause) == (Reason.BLOCKED, "x")
    assert (way_out.instruction, way_out.top_speed) == (Instruction.WIDEN, 1.0)


def test_the_ego_does_not_squeeze_past_somebody_who_has_halted():
    ego = before("multi_lane_road", ("road_before_exit", "road_after_exit"), 380.0, 0.0, lane=2)
    assert escape(ego.considered(ego.ahead("x", 3.0, 0.0, halted=True), events=STUCK)).instruction is None


def test_a_queue_has_the_right_to_block_the_ego():
    ego, queue = standing(3.0, halted=False)
    assert escape(ego.considered(queue, events=STUCK)) is None


def test_a_red_light_has_the_right_to_block_the_ego():
    ego, _ = standing(3.0)
    assert escape(ego.considered(events=STUCK, stop=stop_at(5.0, Reason.RED_LIGHT))) is None


def test_when_nobody_blocks_the_ego_a_new_curve_comes_first_and_then_a_wider_grid():
    ego, _ = standing(3.0)
    first, second = (escape(ego.remembering(escapes=n).considered(events=STUCK)) for n in (0, 1))
    assert (first.replanning, first.instruction) == (Replanning.CURVE, None)
    assert (second.replanning, second.instruction) == (Replanning.NOTHING, Instruction.WIDEN)
    assert first.decision.reason is second.decision.reason is Reason.NO_PROGRESS


def test_an_ego_that_does_not_get_on_asks_for_a_curve_once_and_then_searches_more_commands():
    ego, _ = standing(3.0)
    drive, asked = ego.step().drive, []
    for escapes in (0, 1):
        memory = drive.memory._replace(progress_s=drive.s, progress_time=ego.time - 100.0, escapes=escapes)
        asked.append(ego.step(drive=drive._replace(ego=ego.ego, memory=memory), time=ego.time + 0.1))
    curve, wider = (step.completed for step in asked)
    assert (curve.request.what, curve.tuning.wide_grid) == (Replanning.CURVE, False)
    assert (wider.request.what, wider.tuning.wide_grid, wider.instruction) == (Replanning.NOTHING, True, Instruction.WIDEN)
    assert [step.drive.memory.escapes for step in asked] == [1, 2]


@pytest.mark.parametrize(
    ("gap", "aside", "backs_up"),
    [(-12.0, 0.0, False), (-12.0, 2.2, False), (-12.0, 2.5, True), (-16.0, 0.0, True), (-9.0, -2.2, False)],
)
def test_the_ground_behind_counts_as_far_as_the_ego_backs_up_and_a_bit_to_either_side(gap, aside, backs_up):
    """It stands 3 m behind, has to back up 5 m and leaves 2 m; its own length is 4 m."""
    ego, x = standing(3.0)
    behind = ego.ahead("behind", gap - 1.0, 0.0)
    behind = behind._replace(y=behind.y + aside)
    way_out = escape(ego.considered(x, behind))
    assert (way_out is not None and way_out.instruction is Instruction.BACK_UP) is backs_up


@pytest.mark.parametrize(("gap", "backs_up"), [(USUAL.halted_room_m - 1.6, True), (USUAL.halted_room_m - 1.4, False)])
def test_a_gap_that_is_nearly_room_enough_is_left_as_it_is(gap, backs_up):
    ego, x = standing(gap)
    way_out = escape(ego.considered(x))
    assert (way_out is not None and way_out.instruction is Instruction.BACK_UP) is backs_up


def test_the_ego_does_not_back_up_into_a_junction_that_it_has_passed():
    ego, x = standing(3.0)
    situation = ego.considered(x)
    front = situation.snapshot.front
    for behind, backs_up in ((2.0, False), (9.5, True)):
        (way, *_) = before("blocked_lane", STREET, 10.0, 5.0).considered().ways
        passage = replace(way.passage, start=front - behind - 8.0, end=front - behind)
        way_out = escape(situation._replace(plan=replace(situation.plan, passages=(passage,))))
        assert (way_out is not None and way_out.instruction is Instruction.BACK_UP) is backs_up


def test_what_is_far_ahead_does_not_keep_a_standing_ego_where_it_is():
    ego, _ = standing(3.0)
    front = ego.seen().front
    light = escape(ego.considered(events=STUCK, stop=stop_at(front + 40.0, Reason.RED_LIGHT)))
    queue = escape(ego.considered(ego.ahead("x", 40.0, 0.0), events=STUCK))
    assert light.replanning is queue.replanning is Replanning.CURVE
    assert escape(ego.considered(events=STUCK, stop=stop_at(front + 5.0, Reason.RED_LIGHT))) is None
