"""Giving way where the ego and others wait for each other: it lets those go whom it keeps from it, backing up if it must."""

from __future__ import annotations

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.nouns.constraint import stop_at
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Instruction, Reason
from sumo_reactive.driver.nouns.event import EventKind
from sumo_reactive.driver.nouns.forecast import Hindered
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.pilot.behaviours.backing_up import Escape, is_queued
from sumo_reactive.driver.pilot.situation import BehaviourRule, Situation
from sumo_reactive.driver.vehicle.body import clear_behind

_BACK_M = 2.0
"""The ego backs up so far behind where it last came on, or as far as it can, …"""

_LEAST_BACK_M = 1.0
"""…but not for less than this."""

_BEHIND_M = 0.5
"""Room left behind it then."""

_ARRIVED_M = 0.05
"""It has backed up when no more than this is left."""


def give_way(situation: Situation) -> Escape | None:
    """Return where the ego waits and whom it lets go, if they and it keep each other from going; None: they do not.

    Who would touch it if he went on cannot be let go: it backs up first. It tries for as long as it takes to find that it
    does not get on, then ahead again, and so on by turns.
    """
    snapshot, memory = situation.snapshot, situation.memory
    let_go = _let_go(situation)
    blocked = tuple(one.user_id for one in situation.outlook.hindered if one.is_waiting and not one.is_free)
    goes_on = memory.behaviour is Behaviour.GIVING_WAY and not _has_happened(EventKind.NO_PROGRESS, situation)
    if not (goes_on or _begins(situation)) or not (let_go or blocked):
        return None
    place = min(_place_behind(situation), snapshot.front) if blocked else snapshot.front
    way = snapshot.front - place
    if way < (_ARRIVED_M if goes_on else _LEAST_BACK_M):
        place = snapshot.front
        if not let_go:
            return None
    passes = place == snapshot.front
    cause = let_go[0] if passes else blocked[0]
    decision = Decision(behaviour=Behaviour.GIVING_WAY, reason=Reason.MUTUAL_WAIT, cause=cause, passes=passes)
    stop = stop_at(place, Reason.MUTUAL_WAIT, cause=cause)
    return Escape(decision, Instruction.BACK_UP, stop, let_go=let_go if passes else ())


def _place_behind(situation: Situation) -> float:
    """Return where the front bumper is to be, m of C, when the ego has backed up as far as it should and can."""
    snapshot = situation.snapshot
    clear = clear_behind(snapshot.boxes, snapshot.ego.pose, situation.limits)
    wanted = situation.memory.progress_s + snapshot.front - snapshot.s - _BACK_M
    return max(wanted, snapshot.front - clear + _BEHIND_M)


def _begins(situation: Situation) -> bool:
    """Whether the ego is found, every other time, to stand for no rule and for nobody who is about to go."""
    snapshot, memory = situation.snapshot, situation.memory
    manoeuvres = memory.overtaking is not None or memory.move is not None
    if not _has_happened(EventKind.LOCKED, situation) or memory.escapes % 2 or manoeuvres:
        return False
    return abs(snapshot.ego.speed) < STANDING_SPEED and not is_queued(situation, situation.ahead_of_ego)


def _has_happened(kind: EventKind, situation: Situation) -> bool:
    return any(event.kind is kind for event in situation.events)


def _let_go(situation: Situation) -> tuple[str, ...]:
    """Return who waits and would not touch the ego if he went on, and whoever of these has begun to."""
    known = situation.memory.let_go

    def may_go(one: Hindered) -> bool:
        return one.is_free and (one.is_waiting or one.user_id in known)

    return tuple(one.user_id for one in situation.outlook.hindered if may_go(one))


def is_locked(situation: Situation) -> bool:
    """The ego and others keep each other from going."""
    return situation.limits.parameters.has(Mechanism.ESCAPE) and give_way(situation) is not None


def is_free(situation: Situation) -> bool:
    """Nobody waits for the ego any more, or that has not helped."""
    return not is_locked(situation)


def back_off(situation: Situation) -> Instruction:
    """Back up at walking speed, or stay."""
    return Instruction.BACK_UP


RULE = BehaviourRule(Behaviour.GIVING_WAY, (is_locked,), back_off, (is_free,))
