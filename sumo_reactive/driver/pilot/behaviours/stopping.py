"""Stopping at a location: the route's stops (F&L 1991, §2)."""

from __future__ import annotations

from sumo_reactive.driver.nouns.decision import Behaviour, Instruction
from sumo_reactive.driver.pilot.rules.scheduled_stop import is_next
from sumo_reactive.driver.pilot.situation import BehaviourRule, Situation


def stop_is_next(situation: Situation) -> bool:
    """A stop of the route is in reach, and no line lies before it where the ego drives cautiously."""
    return is_next(situation.snapshot, situation.plan, situation.ahead, situation.memory)


def stop_is_served(situation: Situation) -> bool:
    """No stop of the route is next any more."""
    return not stop_is_next(situation)


def stop_there(situation: Situation) -> Instruction:
    """Stop at the location."""
    return Instruction.STOP


RULE = BehaviourRule(Behaviour.STOPPING, (stop_is_next,), stop_there, (stop_is_served,))
