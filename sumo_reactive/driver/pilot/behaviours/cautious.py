"""Cautious driving: the approach to an intersection (F&L 1991, §2)."""

from __future__ import annotations

import math

from sumo_reactive.driver.nouns.decision import Behaviour, Instruction
from sumo_reactive.driver.pilot.passages import reach_of
from sumo_reactive.driver.pilot.rules.lights import has_passed
from sumo_reactive.driver.pilot.situation import BehaviourRule, Situation


def intersection_is_near(situation: Situation) -> bool:
    """M approaches an intersection where somebody may cross its path or a light speaks, and has not passed the line."""
    return _is_ahead(situation, reach_of(situation.snapshot))


def no_intersection_is_ahead(situation: Situation) -> bool:
    """The line is passed, and no other one is in sight: an ego that has slowed down is still on the approach."""
    return not _is_ahead(situation, math.inf)


def _is_ahead(situation: Situation, reach: float) -> bool:
    front = situation.snapshot.front
    for way, (_, connection, conflicts) in zip(situation.ways, situation.ahead, strict=True):
        line = way.passage.start
        if not has_passed(line, front) and line - front < reach and (conflicts or connection.light):
            return True
    return False


def approach(situation: Situation) -> Instruction:
    """Approach, ready to stop; stop where light, sign, region, the room behind it or a turn in several moves ask for it."""
    return Instruction.APPROACH if situation.stop is None else Instruction.STOP


RULE = BehaviourRule(Behaviour.CAUTIOUS, (intersection_is_near,), approach, (no_intersection_is_ahead,))
