"""A missed turn: nobody lets the ego onto the lane that the turn is made from, or lets it turn round."""

from __future__ import annotations

from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Behaviour, Instruction, Reason
from sumo_reactive.driver.nouns.plan import TURNAROUND_REACHED_M, NominalPlan
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import CREEPING_SPEED
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.passages import Ahead
from sumo_reactive.driver.pilot.rules.lights import SHUT, letter_of
from sumo_reactive.driver.pilot.situation import BehaviourRule, Situation

AT_LANE_END_M = 5.0
"""At the end of its lane is who is not farther than a car's length from the last place to change."""

LIGHTS_WAITED = 2
"""Cycles of a light for which the ego waits to turn round: the first one may have begun with red."""


def waiting_since(
    snapshot: Snapshot, plan: NominalPlan, ahead: Ahead, stop: TimeConstraint | None, memory: PilotMemory
) -> float | None:
    """Return since when (s) the ego waits for a gap to change lanes, or to turn round in several moves; None: it does not.
    Who creeps still waits.

    `stop` is the nearest place to stop at. While the light `ahead` holds back those on the other lane as well, the ego loses
    nothing by waiting: it waits from the end of that on. To turn round it waits from light to light.
    """
    if stop is None or snapshot.ego.speed > CREEPING_SPEED:
        return None
    if _waits_to_turn_round(snapshot, plan, memory):
        return snapshot.time if memory.waiting_since is None else memory.waiting_since
    if stop.reason is not Reason.NO_GAP:
        return None
    is_new = memory.waiting_since is None or _is_red(snapshot, plan, ahead)
    return snapshot.time if is_new else memory.waiting_since


def _waits_to_turn_round(snapshot: Snapshot, plan: NominalPlan, memory: PilotMemory) -> bool:
    """Whether the ego is where the next turn in several moves begins, and has not begun it."""
    turn = next((one for one in plan.turnarounds if snapshot.front < one.end), None)
    return memory.move is None and turn is not None and turn.start - snapshot.front < TURNAROUND_REACHED_M


def _is_red(snapshot: Snapshot, plan: NominalPlan, ahead: Ahead) -> bool:
    """Whether the light before the next junction shows red, or yellow, to who takes the plan's way there."""
    way = next((connection for i, connection, _ in ahead if plan.passages[i].start > snapshot.front), None)
    return way is not None and letter_of(way, snapshot) in SHUT


def is_missed(snapshot: Snapshot, stop: TimeConstraint | None, memory: PilotMemory) -> bool:
    """Whether the ego has waited so long that another way to its goal deserves a look.

    That comes sooner where traffic keeps passing an ego that can go no farther on its lane; a queue may yet move.
    """
    if stop is None or memory.waiting_since is None:
        return False
    is_at_end = stop.s - snapshot.front < AT_LANE_END_M
    are_passing = any(neighbour.user.speed > CREEPING_SPEED for neighbour in snapshot.neighbours)
    patience = snapshot.parameters.missed_turn_s if is_at_end and are_passing else snapshot.parameters.queue_patience_s
    return snapshot.time - memory.waiting_since > patience


def turn_is_missed(situation: Situation) -> bool:
    """Nobody lets the ego onto the lane that its turn is made from, or no gap is long enough for it to turn round."""
    snapshot, memory = situation.snapshot, situation.memory
    if _waits_to_turn_round(snapshot, situation.plan, memory):
        since = snapshot.time if memory.waiting_since is None else memory.waiting_since
        return snapshot.time - since > LIGHTS_WAITED * snapshot.parameters.queue_patience_s
    return is_missed(snapshot, situation.changing.stop, memory)


def turn_is_open(situation: Situation) -> bool:
    """The ego has another way, or a gap."""
    return not turn_is_missed(situation)


def wait(situation: Situation) -> Instruction:
    """Wait until the other way is found."""
    return Instruction.FOLLOW_CURVE if situation.stop is None else Instruction.STOP


RULE = BehaviourRule(Behaviour.TAKING_ANOTHER_WAY, (turn_is_missed,), wait, (turn_is_open,))
