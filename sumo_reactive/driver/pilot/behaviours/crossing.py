"""Crossing an intersection without stopping in it (F&L 1991, §2)."""

from __future__ import annotations

from sumo_reactive.driver.nouns.decision import Behaviour, Instruction
from sumo_reactive.driver.pilot.situation import BehaviourRule, Situation


def line_is_passed(situation: Situation) -> bool:
    """M has passed the line of an intersection where somebody may cross its path, and not yet left it.

    It passes the line only when each region was free and the room behind it too: else `cautious` stops it there.
    """
    snapshot = situation.snapshot
    for way, (_, _, conflicts) in zip(situation.ways, situation.ahead, strict=True):
        if conflicts and way.passage.start < snapshot.front and snapshot.s < way.passage.end:
            return True
    return False


def intersection_is_left(situation: Situation) -> bool:
    """M has left every conflict region."""
    return not line_is_passed(situation)


def cross(situation: Situation) -> Instruction:
    """Cross without stopping; wait before the next region if it must."""
    return Instruction.CROSS if situation.stop is None else Instruction.STOP


RULE = BehaviourRule(Behaviour.CROSSING, (line_is_passed,), cross, (intersection_is_left,))
