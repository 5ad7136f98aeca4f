"""The mechanisms of the paper that can be left out, one at a time, to measure what driving loses without it.

`Parameters.without` names the one that is; the others that an ablation needs are parameters, too.
"""

from __future__ import annotations

from enum import IntEnum


class Mechanism(IntEnum):
    """What can be left out, and what is then in its place."""

    NONE = 0
    """Nothing is left out."""
    TIMES = 1
    """v_d knows no (l, t_l)."""
    DELAYS = 2
    """A delay neither shifts the time constraints nor has them planned anew."""
    FAILURE = 3
    """The assessment meets nobody."""
    BEHAVIOURS = 4
    """Normal driving, whatever comes."""
    TUNING = 5
    """One tuning, whatever the instruction."""
    ROOM_BEHIND = 6
    """Nobody asks for the post-conflict region."""
    GRAPH = 7
    """W is not walked: no line, no light, no region, no foe ahead."""
    EVENTS = 8
    """The pilot decides at every step."""
    FEEDBACK = 9
    """The executor does not say that no command is admissible."""
    ESCAPE = 10
    """Nothing leads out of a local minimum."""
    ROOM_TO_STOP = 11
    """A command need not leave a way to stop, and nothing makes the ego brake harder than planned."""
