"""Which behaviour may follow which: the pilot's transition table (F&L 1991, §2)."""

from __future__ import annotations

from sumo_reactive.driver.ablation import Mechanism, has
from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.driver.pilot.behaviours import cautious, crossing, normal, overtaking, stopping
from sumo_reactive.driver.pilot.situation import BehaviourRule, Situation

RULES: dict[Behaviour, BehaviourRule] = {
    rule.behaviour: rule for rule in (normal.RULE, cautious.RULE, overtaking.RULE, stopping.RULE, crossing.RULE)
}

TRANSITIONS: dict[Behaviour, tuple[Behaviour, ...]] = {
    Behaviour.NORMAL: (Behaviour.STOPPING, Behaviour.CROSSING, Behaviour.OVERTAKING, Behaviour.CAUTIOUS),
    Behaviour.CAUTIOUS: (Behaviour.STOPPING, Behaviour.CROSSING, Behaviour.OVERTAKING),
    Behaviour.STOPPING: (Behaviour.CROSSING, Behaviour.CAUTIOUS),
    Behaviour.CROSSING: (Behaviour.STOPPING,),
    Behaviour.OVERTAKING: (),
}
"""From each behaviour to those that may follow at once, the most pressing first; whichever has ended gives way to normal."""


def next_behaviour(situation: Situation) -> Behaviour:
    """Return the behaviour for a situation: the present one until it has ended or another one's preconditions hold."""
    if not has(Mechanism.BEHAVIOURS):
        return Behaviour.NORMAL
    now = situation.memory.behaviour
    if RULES[now].has_ended(situation):
        now = Behaviour.NORMAL
    return next((one for one in TRANSITIONS[now] if RULES[one].may_begin(situation)), now)
