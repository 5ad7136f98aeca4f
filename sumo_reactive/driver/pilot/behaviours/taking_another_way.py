"""A missed turn: the ego waits for a gap to change lanes, and nobody lets it onto the lane that the turn is made from."""

from __future__ import annotations

from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Behaviour, Instruction, Reason
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import CREEPING_SPEED
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.passages import Ahead
from sumo_reactive.driver.pilot.rules.lights import letter_of
from sumo_reactive.driver.pilot.situation import BehaviourRule, Situation

AT_LANE_END_M = 5.0
"""At the end of its lane is who is not farther than a car's length from the last place to change."""


def waiting_since(
    snapshot: Snapshot, plan: NominalPlan, ahead: Ahead, stop: TimeConstraint | None, memory: PilotMemory
) -> float | None:
    """Return since when (s) the ego waits for a gap to change lanes; None: it does not. Who creeps still waits.

    `stop` is the nearest place to stop at. While the light `ahead` holds back those on the other lane as well, the ego loses
    nothing by waiting: it waits from the end of that on.
    """
    if stop is None or stop.reason is not Reason.NO_GAP or snapshot.ego.speed > CREEPING_SPEED:
        return None
    is_new = memory.waiting_since is None or _is_red(snapshot, plan, ahead)
    return snapshot.time if is_new else memory.waiting_since


def _is_red(snapshot: Snapshot, plan: NominalPlan, ahead: Ahead) -> bool:
    """Whether the light before the next junction shows red, or yellow, to who takes the plan's way there."""
    way = next((connection for i, connection, _ in ahead if plan.passages[i].start > snapshot.front), None)
    return way is not None and letter_of(way, snapshot) in tuple("rRuyY")


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
    """Nobody lets the ego onto the lane that its turn is made from."""
    return is_missed(situation.snapshot, situation.changing.stop, situation.memory)


def turn_is_open(situation: Situation) -> bool:
    """The ego has another way, or a gap."""
    return not turn_is_missed(situation)


def wait(situation: Situation) -> Instruction:
    """Wait until the other way is found."""
    return Instruction.FOLLOW_CURVE if situation.stop is None else Instruction.STOP


RULE = BehaviourRule(Behaviour.TAKING_ANOTHER_WAY, (turn_is_missed,), wait, (turn_is_open,))
