"""Which behaviour may follow which: the pilot's transition table (F&L 1991, §2)."""

from __future__ import annotations

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.driver.pilot.behaviours import (
    backing_up,
    cautious,
    changing_lanes,
    changing_queues,
    crossing,
    giving_way,
    normal,
    overtaking,
    stopping,
    taking_another_way,
    turning_round,
)
from sumo_reactive.driver.pilot.situation import BehaviourRule, Situation

RULES: dict[Behaviour, BehaviourRule] = {
    module.RULE.behaviour: module.RULE
    for module in (
        normal, cautious, overtaking, stopping, crossing, changing_lanes, changing_queues, turning_round, backing_up,
        giving_way, taking_another_way,
    )
}  # fmt: skip

_URGENT = (Behaviour.TURNING_ROUND, Behaviour.BACKING_UP, Behaviour.GIVING_WAY)
_MANOEUVRES = (Behaviour.OVERTAKING, Behaviour.CHANGING_LANES, Behaviour.CHANGING_QUEUES)

TRANSITIONS: dict[Behaviour, tuple[Behaviour, ...]] = {
    Behaviour.NORMAL: (*_URGENT, Behaviour.STOPPING, Behaviour.CROSSING, *_MANOEUVRES, Behaviour.CAUTIOUS),
    Behaviour.CAUTIOUS: (*_URGENT, Behaviour.STOPPING, Behaviour.CROSSING, *_MANOEUVRES),
    Behaviour.STOPPING: (*_URGENT, Behaviour.CROSSING, Behaviour.CAUTIOUS),
    Behaviour.CROSSING: (*_URGENT, Behaviour.STOPPING, Behaviour.TAKING_ANOTHER_WAY),
    Behaviour.OVERTAKING: (),
    Behaviour.CHANGING_LANES: (
        *_URGENT, Behaviour.TAKING_ANOTHER_WAY, Behaviour.STOPPING, Behaviour.CROSSING, Behaviour.OVERTAKING,
    ),
    Behaviour.CHANGING_QUEUES: (*_URGENT, Behaviour.CROSSING, Behaviour.OVERTAKING, Behaviour.CHANGING_LANES),
    Behaviour.TURNING_ROUND: (Behaviour.TAKING_ANOTHER_WAY,),
    Behaviour.BACKING_UP: (Behaviour.OVERTAKING,),
    Behaviour.GIVING_WAY: (),
    Behaviour.TAKING_ANOTHER_WAY: (Behaviour.CROSSING,),
}  # fmt: skip
"""From each behaviour to those that may follow at once, the most pressing first; whichever has ended gives way to normal."""


def next_behaviour(situation: Situation) -> Behaviour:
    """Return the behaviour for a situation: the present one until it has ended or another one's preconditions hold."""
    if not situation.limits.parameters.has(Mechanism.BEHAVIOURS):
        return Behaviour.NORMAL
    now = situation.memory.behaviour
    if RULES[now].has_ended(situation):
        now = Behaviour.NORMAL
    return next((one for one in TRANSITIONS[now] if RULES[one].may_begin(situation)), now)
