"""The mechanisms of the paper that can be left out, one in a process, to measure what driving loses without it.

`WITHOUT` of `parameters.py` names the one that is; the others that an ablation needs are values of `parameters.py`.
"""

from __future__ import annotations

from enum import IntEnum

from sumo_reactive.driver.parameters import WITHOUT


class Mechanism(IntEnum):
    """What can be left out, and what is then in its place."""

    MINIMUM = 1
    """U is 0 everywhere: the first command that passes the exact tests."""
    VALLEY = 2
    """w₁ = 0."""
    SHADOW = 3
    """w₂ = 0."""
    VELOCITY = 4
    """w₃ = 0."""
    TIMES = 5
    """v_d knows no (l, t_l)."""
    DELAYS = 6
    """A delay neither shifts the time constraints nor has them planned anew."""
    FAILURE = 7
    """The assessment meets nobody."""
    BEHAVIOURS = 8
    """Normal driving, whatever comes."""
    TUNING = 9
    """One tuning, whatever the instruction."""
    ROOM_BEHIND = 10
    """Nobody asks for the post-conflict region."""
    GRAPH = 11
    """W is not walked: no line, no light, no region, no foe ahead."""
    EVENTS = 12
    """The pilot decides at every step."""
    FEEDBACK = 13
    """The executor does not say that no command is admissible."""
    ESCAPE = 14
    """Nothing leads out of a local minimum."""
    ROOM_TO_STOP = 15
    """A command need not leave a way to stop, and nothing makes the ego brake harder than planned."""


def has(mechanism: Mechanism) -> bool:
    """Whether the driver has a mechanism in this process."""
    return mechanism != WITHOUT
