"""Cautious driving: the approach to an intersection (F&L 1991, §2)."""

from __future__ import annotations

from sumo_reactive.driver.nouns.decision import Behaviour, Instruction
from sumo_reactive.driver.pilot.passages import reach_of
from sumo_reactive.driver.pilot.rules.lights import has_passed
from sumo_reactive.driver.pilot.situation import BehaviourRule, Situation


def intersection_is_near(situation: Situation) -> bool:
    """M approaches an intersection where somebody may cross its path or a light speaks, and has not passed the line."""
    reach = reach_of(situation.snapshot.ego.speed)
    for way, (_, connection, conflicts) in zip(situation.ways, situation.ahead, strict=True):
        line, front = way.passage.start, situation.snapshot.front
        if not has_passed(line, front) and line - front < reach and (conflicts or connection.light):
            return True
    return False


def no_intersection_is_near(situation: Situation) -> bool:
    """The line is passed, or the intersection out of reach."""
    return not intersection_is_near(situation)


def approach(situation: Situation) -> Instruction:
    """Approach, ready to stop; stop where light, sign, region or the room behind it ask for it."""
    return Instruction.APPROACH if situation.stop is None else Instruction.STOP


RULE = BehaviourRule(Behaviour.CAUTIOUS, (intersection_is_near,), approach, (no_intersection_is_near,))
