"""Turning round in several moves, where the road is too narrow for one sweep."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from sumo_reactive.driver.nouns.completed_plan import Replanning, Request
from sumo_reactive.driver.nouns.constraint import TimeConstraint, stop_at
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Reason
from sumo_reactive.driver.nouns.forecast import FREE_GROUND, TurningGround
from sumo_reactive.driver.nouns.plan import TURNAROUND_REACHED_M, Move, NominalPlan, Turnaround
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.pilot.behaviours.cautious import approach
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.passages import reach_of
from sumo_reactive.driver.pilot.situation import BehaviourRule, Situation

ROLLING_OUT_M = 3.0
"""With this much way to the next place to stop the ego rolls on from the last move: what it stops in from there."""


class Turning(NamedTuple):
    """What a turn asks for: the move to drive, why, what of the planner; and the memory of it."""

    move: Move
    decision: Decision
    request: Request
    memory: PilotMemory


def place_to_begin(
    snapshot: Snapshot, plan: NominalPlan, memory: PilotMemory, ground: TurningGround = FREE_GROUND
) -> TimeConstraint | None:
    """Return where to stop for the next turn in several moves; None: there is none, or it is under way.

    Who comes over its `ground` is let pass, unless the ego has stood there for long; who stays where it ends is waited for.
    """
    number = None if memory.move is not None else _next(snapshot, plan)
    if number is None:
        return None
    start = plan.turnarounds[number].start
    if ground.stays:
        return stop_at(start, Reason.STAYS_THERE, cause=ground.stays)
    if ground.comes_over and memory.standing_for(snapshot.time) < snapshot.parameters.turnaround_patience_s:
        return stop_at(start, Reason.COMES_OVER, cause=ground.comes_over)
    return stop_at(start, Reason.NARROW_TURN)


def turn_round(
    snapshot: Snapshot,
    plan: NominalPlan,
    stop: TimeConstraint | None,
    memory: PilotMemory,
    *,
    ground: TurningGround = FREE_GROUND,
    is_stuck: bool = False,
) -> Turning | None:
    """Return what the turn under way asks for, or one that begins now; None: the ego does not turn round.

    It begins when the ego stands where it is to begin, and nothing keeps it from where it ends: `stop` is the nearest other
    place to stop at, and nobody is in its way on the `ground`. One that `is_stuck`, for somebody is in a move's way, goes
    on in one sweep.
    """
    if memory.move is None:
        number, place = _next(snapshot, plan), place_to_begin(snapshot, plan, memory, ground)
        if number is None or place is None or place.reason is not Reason.NARROW_TURN:
            return None
        if not _may_begin(snapshot, plan.turnarounds[number], stop):
            return None
        return _driven(plan.turnarounds[number], stop, (number, 0), memory)
    number, move = memory.move
    turn = plan.turnarounds[number]
    now = _move(turn, move, stop)
    if is_stuck:
        decision = Decision(behaviour=Behaviour.TURNING_ROUND, reason=Reason.NO_PROGRESS, passes=True)
        return Turning(now, decision, Request(what=Replanning.CURVE), memory._replace(move=None))
    return _driven(turn, stop, (number, move + now.is_over(snapshot.ego)), memory)


def _move(turn: Turnaround, number: int, stop: TimeConstraint | None) -> Move:
    """Return a move of a turn: the last one rolls out where the next `stop` leaves room."""
    move = turn.moves[number]
    if not move.is_last or (stop is not None and stop.s < turn.end + turn.into + ROLLING_OUT_M):
        return move
    return replace(move, rolls_out=True)


def _next(snapshot: Snapshot, plan: NominalPlan) -> int | None:
    """Return the number of the next turn in several moves."""
    return next((k for k, turn in enumerate(plan.turnarounds) if snapshot.front < turn.end), None)


def _may_begin(snapshot: Snapshot, turn: Turnaround, stop: TimeConstraint | None) -> bool:
    if snapshot.ego.speed >= STANDING_SPEED or turn.start - snapshot.front > TURNAROUND_REACHED_M:
        return False
    return stop is None or stop.s > turn.end + turn.into


def _driven(turn: Turnaround, stop: TimeConstraint | None, at: tuple[int, int], memory: PilotMemory) -> Turning:
    """Return the orders for a turn `at` a move (the turn's number and the move's); after the last one for a curve from the
    lane turned into, for which the last move goes on until then."""
    decision = Decision(
        behaviour=Behaviour.TURNING_ROUND, reason=Reason.NARROW_TURN, cause=f"{len(turn.moves)} moves", passes=True
    )
    if at[1] < len(turn.moves):
        return Turning(_move(turn, at[1], stop), decision, Request(), memory._replace(move=at))
    after = Request(what=Replanning.CURVE, onto=turn.to_lane, route_index=turn.route_index)
    return Turning(_move(turn, -1, stop), decision, after, memory._replace(move=None))


def is_behind_queue(situation: Situation) -> bool:
    """Whether who is in the way of a move will go on: he has not halted, nor has the ego stood for a light's cycle."""
    x, snapshot = situation.ahead_of_ego, situation.snapshot
    patience = snapshot.parameters.queue_patience_s
    return x is not None and not x.user.is_halted and situation.memory.standing_for(snapshot.time) < patience


def is_in_reach(snapshot: Snapshot, plan: NominalPlan) -> bool:
    """Whether the ego comes to where a turn in several moves begins."""
    number = _next(snapshot, plan)
    return number is not None and plan.turnarounds[number].start - snapshot.front < reach_of(snapshot)


def is_near(situation: Situation) -> bool:
    """The ego turns round, or comes to where it will."""
    return situation.memory.move is not None or is_in_reach(situation.snapshot, situation.plan)


def is_over(situation: Situation) -> bool:
    """No such turn is near any more."""
    return not is_near(situation)


RULE = BehaviourRule(Behaviour.TURNING_ROUND, (is_near,), approach, (is_over,))
