"""Turning round in several moves: stop, arcs forwards and backwards by turns, then C from the lane turned into."""

from dataclasses import replace
from itertools import pairwise

import pytest
from helpers.cars import CAR
from helpers.situations import before

from sumo_reactive.driver.controller import Controller, replanned
from sumo_reactive.driver.nouns.completed_plan import Replanning
from sumo_reactive.driver.nouns.constraint import stop_at
from sumo_reactive.driver.nouns.decision import Behaviour, Reason
from sumo_reactive.driver.nouns.forecast import TurningGround
from sumo_reactive.driver.nouns.plan import MOVE_BACK_SPEED, MOVE_SPEED, WHEELS_TURNED_RAD, Move, Turnaround
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.behaviours.turning_round import is_behind_queue, place_to_begin, turn_round

STREET = ("eastbound", "eastbound_out")
LOCK, PATIENCE_S = 0.6, USUAL.queue_patience_s
COMING, STAYING = TurningGround(comes_over="x"), TurningGround(stays="x")


def turning(away: float = 30.0, speed: float = 8.0):
    """The ego before a turn in three moves, `away` m ahead of its bumper."""
    ego = before("blocked_lane", STREET, 300.0, speed)
    heading, bend = ego.ego.pose.heading, 0.56 / CAR.wheelbase
    arcs = ((1, LOCK, 0.9), (-1, -LOCK, 1.6), (1, LOCK, 3.1))
    moves = [Move(gear=gear, steering_angle=angle, bend=bend * gear, until=heading + until) for gear, angle, until in arcs]
    moves[2] = replace(moves[2], is_last=True)
    start = ego.seen().front + away
    turn = Turnaround(
        start=start, line=start + 1.0, end=start + 6.0, from_lane="eastbound_0", from_index=0, to_lane="eastbound_out_0",
        route_index=1, moves=tuple(moves), duration=20.0, into=5.0,
    )  # fmt: skip
    return replace(ego, plan=replace(ego.plan, turnarounds=(turn,))), turn


def test_the_ego_stops_where_it_turns_round_and_says_why():
    ego, turn = turning()
    stop = ego.stop()
    assert (stop.s, stop.reason) == (turn.start, Reason.NARROW_TURN)


def test_moves_follow_one_another_each_from_a_stand_with_its_wheels_turned():
    ego, turn = turning()
    steps = ego.driven(45.0)
    steps = steps[: next(k for k, step in enumerate(steps) if step.completed.request.onto)]
    first = next(k for k, step in enumerate(steps) if step.completed.move is not None)
    assert steps[first].snapshot.ego.speed < STANDING_SPEED
    assert 0.0 < turn.start - steps[first].snapshot.front < 1.5
    under_way = [step for step in steps if step.completed.move is not None]
    order = [step.completed.move for step in under_way]
    moves = [*turn.moves[:2], replace(turn.moves[2], rolls_out=True)]
    assert [move for k, move in enumerate(order) if k == 0 or move != order[k - 1]] == moves
    for step in under_way:
        move, after = step.completed.move, step.drive.ego
        assert -MOVE_BACK_SPEED - 1e-6 <= after.speed <= MOVE_SPEED + 1e-6
        assert after.speed * move.gear > -1e-6
        if abs(after.speed) > 1.5 and not move.is_last:
            assert after.steering_angle == pytest.approx(move.steering_angle, abs=WHEELS_TURNED_RAD)


def test_after_the_last_move_the_pilot_asks_for_a_curve_on_the_lane_turned_into():
    ego, turn = turning()
    asked = [step for step in ego.driven(45.0) if step.completed.request.onto]
    assert asked
    request = asked[0].completed.request
    assert (request.what, request.onto, request.route_index) == (Replanning.CURVE, "eastbound_out_0", 1)
    ego_then = asked[0].snapshot.ego
    assert ego_then.pose.heading == pytest.approx(turn.moves[2].until, abs=0.03)
    assert abs(ego_then.steering_angle) < WHEELS_TURNED_RAD
    assert ego_then.speed == pytest.approx(MOVE_SPEED)


@pytest.mark.parametrize(("room", "rolls_out"), [(None, True), (2.0, False), (4.0, True)])
def test_the_last_move_rolls_out_where_the_next_stop_leaves_room(room, rolls_out):
    ego, turn = turning(1.0, 0.0)
    stop = None if room is None else stop_at(turn.end + turn.into + room, Reason.RED_LIGHT)
    for number, expected in ((1, False), (2, rolls_out)):
        asked = turn_round(ego.seen(), ego.plan, stop, ego.memory._replace(move=(0, number)))
        assert asked is not None
        assert asked.move == replace(turn.moves[number], rolls_out=expected)


def test_the_ego_does_not_begin_while_another_place_keeps_it_there():
    ego, turn = turning(1.0, 0.0)
    snapshot = ego.seen()
    stops = (stop_at(turn.line, Reason.RED_LIGHT), stop_at(turn.end + 3.0, Reason.RED_LIGHT), stop_at(60.0, Reason.YIELD_TO))
    for stop, begins in zip((None, *stops), (True, False, False, True), strict=True):
        assert (turn_round(snapshot, ego.plan, stop, ego.memory) is not None) is begins


def test_a_move_waits_while_somebody_is_in_its_way_and_goes_on_then():
    ego, _ = turning(1.0, 0.0)
    blocker = ego.ahead("x", 1.0, 0.0)
    steps = ego.driven_among(lambda past: [blocker] if past < 8.0 else [], 14.0)
    moved = [step.snapshot.front - ego.seen().front for step in steps]
    assert max(moved[:79]) < 0.9
    assert steps[-1].drive.ego.pose.heading > ego.ego.pose.heading + 0.3


def test_the_ego_makes_its_full_stop_where_it_turns_round():
    ego = before("blocked_lane", STREET, 10.0, 5.0)
    passage = ego.plan.passages[0]
    turn = Turnaround(
        start=passage.start - 4.0, line=passage.start, end=passage.end, from_lane="eastbound_0", from_index=0,
        to_lane="eastbound_out_0", route_index=1, moves=(), duration=20.0, into=5.0,
    )  # fmt: skip
    (way,) = replace(ego, plan=replace(ego.plan, turnarounds=(turn,))).considered().ways
    assert (way.turn, way.line) == (turn, turn.start)
    assert ego.considered().ways[0].line == passage.start


def test_an_ego_that_is_kept_from_a_move_for_long_goes_on_in_one_sweep():
    ego, _ = turning(1.0, 0.0)
    blocker = ego.ahead("x", 0.6, 0.0, halted=True)
    steps = ego.driven(30.0, blocker)
    asked = [step.completed for step in steps if step.completed.request.what is Replanning.CURVE]
    assert asked
    assert not asked[0].request.onto
    (decision,) = (one for one in asked[0].decisions if one.reason is Reason.NO_PROGRESS)
    assert decision.behaviour is Behaviour.TURNING_ROUND


@pytest.mark.parametrize(
    ("halted", "stood", "waits"),
    [(False, 30.0, True), (True, 30.0, False), (False, PATIENCE_S - 0.1, True), (False, PATIENCE_S, False)],
)
def test_in_a_move_the_ego_waits_behind_a_queue_but_not_for_ever(halted, stood, waits):
    ego, _ = turning(1.0, 0.0)
    ego = ego.remembering(move=(0, 0), standing_since=ego.time - stood)
    situation = ego.considered(ego.ahead("x", 0.6, 0.0, halted=halted))
    assert is_behind_queue(situation) is waits
    assert not is_behind_queue(ego.considered())


def test_who_comes_over_the_ground_is_let_pass_but_not_for_ever():
    ego, turn = turning(1.0, 0.0)
    snapshot = ego.seen()
    assert turn_round(snapshot, ego.plan, None, ego.memory) is not None
    assert turn_round(snapshot, ego.plan, None, ego.memory, ground=COMING) is None
    stop = place_to_begin(snapshot, ego.plan, ego.memory, COMING)
    assert (stop.s, stop.reason, stop.cause) == (turn.start, Reason.COMES_OVER, "x")
    patient = ego.memory._replace(standing_since=snapshot.time - USUAL.turnaround_patience_s)
    assert turn_round(snapshot, ego.plan, None, patient, ground=COMING) is not None


def test_who_stays_where_the_turn_ends_is_waited_for_as_long_as_he_does():
    ego, turn = turning(1.0, 0.0)
    patient = ego.memory._replace(standing_since=ego.time - 100.0)
    stop = place_to_begin(ego.seen(), ego.plan, patient, STAYING)
    assert (stop.s, stop.reason, stop.cause) == (turn.start, Reason.STAYS_THERE, "x")
    assert turn_round(ego.seen(), ego.plan, None, patient, ground=STAYING) is None


@pytest.mark.parametrize("is_blocked", [True, False])
def test_a_turn_that_is_over_or_given_up_within_a_coarse_step_is_not_begun_anew_before_the_step_ends(is_blocked):
    ego, _ = turning(1.0, 0.0)
    users = (ego.ahead("x", 0.6, 0.0, halted=True),) if is_blocked else ()
    before_it, asks = next(pair for pair in pairwise(ego.driven(45.0, *users)) if pair[1].completed.awaits_plan)
    traffic = ego.traffic(*users)
    coarse = Controller(graph=ego.graph, limits=CAR).step(replace(traffic, time=asks.snapshot.time), before_it.drive, 1.0)
    assert coarse.completed.request == asks.completed.request
    assert coarse.completed.move == before_it.completed.move
    assert coarse.drive.memory.move is None
    assert coarse.drive.ego.speed == pytest.approx(0.0 if is_blocked else MOVE_SPEED, abs=STANDING_SPEED)


def test_on_a_new_plan_no_move_of_the_old_one_is_under_way():
    ego, _ = turning(1.0, 0.0)
    drive = ego.driven(2.0)[-1].drive
    assert drive.memory.move is not None
    assert replanned(drive, ego.plan, ego.time).memory.move is None
