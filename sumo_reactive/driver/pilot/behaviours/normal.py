"""Normal driving: follow C at the speed of the road, behind whoever is ahead; it asks no rule (F&L 1991, §2)."""

from __future__ import annotations

from sumo_reactive.driver.nouns.decision import Behaviour, Instruction
from sumo_reactive.driver.pilot.rules.highway_code import NO_RULE
from sumo_reactive.driver.pilot.situation import BehaviourRule, Situation


def follow_curve(situation: Situation) -> Instruction:
    """Follow C; stop where another behaviour's stop still is, or where a change of lanes has no gap."""
    return Instruction.FOLLOW_CURVE if situation.stop is None else Instruction.STOP


RULE = BehaviourRule(Behaviour.NORMAL, (), follow_curve, (), NO_RULE)
