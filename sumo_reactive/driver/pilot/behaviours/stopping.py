"""Stopping at a location: the route's stops (F&L 1991, §2)."""

from __future__ import annotations

from sumo_reactive.driver.nouns.decision import Behaviour, Instruction, Reason
from sumo_reactive.driver.pilot.situation import BehaviourRule, Situation


def stop_is_next(situation: Situation) -> bool:
    """The nearest place to stop at is a stop of the route."""
    return situation.stop is not None and situation.stop.reason is Reason.SCHEDULED_STOP


def stop_is_served(situation: Situation) -> bool:
    """No stop of the route is next any more."""
    return not stop_is_next(situation)


def stop_there(situation: Situation) -> Instruction:
    """Stop at the location."""
    return Instruction.STOP


RULE = BehaviourRule(Behaviour.STOPPING, (stop_is_next,), stop_there, (stop_is_served,))
