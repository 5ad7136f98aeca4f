"""What a traffic light's letter asks of a car before its line."""

from __future__ import annotations

import math
from enum import Enum

from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.world.junction import Connection

ON_LINE_M = 0.05
"""A front bumper no farther over a line than this is at it: a car inserted at the very end of its lane, or one that has
stopped there, has not passed its light. SUMO's lanes and C agree to less."""

SHUT = frozenset("rRuyY")
"""Letters at which nobody begins to cross the line who can still stop."""


class Signal(Enum):
    """What the letter means now."""

    GO = "go"
    GO_ON_YELLOW = "go on, too close to stop"
    STOP_ON_YELLOW = "stop, the light is yellow"
    STOP = "stop"
    STOP_THEN_GO = "stop fully, then yield and go"


def letter_of(connection: Connection, snapshot: Snapshot) -> str:
    """Return the light's letter for a connection, empty when no light speaks."""
    link = connection.light
    if link is None:
        return ""
    letters = snapshot.lights.get(link.light_id, "")
    return letters[link.index] if link.index < len(letters) else ""


def green_at(connection: Connection, snapshot: Snapshot) -> float:
    """Return when the light turns green for a connection, s of simulation time, if the driver knows; else infinite."""
    link = connection.light
    if link is None:
        return math.inf
    switches = snapshot.switches.get(link.light_id, ())
    return next((time for time, letters in switches if letters[link.index : link.index + 1] in ("G", "g")), math.inf)


def has_passed(line: float, front: float) -> bool:
    """Whether the front bumper, `front` m along C, is over the line at `line` m, so that its light speaks no more."""
    return front > line + ON_LINE_M


def signal(letter: str, to_line: float, speed: float, hardest: float, bearable: float) -> Signal:
    """Read `letter` with the front bumper `to_line` m before the line at `speed` m/s.

    G, g go (the right of way decides the rest); r and u (red with yellow) stop; y stops where a `bearable` braking (m/s²)
    suffices; s stops fully, then yields (right on red); o and O leave it to the right of way. A red that turns on with no
    yellow before it, so late that `hardest` braking (m/s²) cannot stop, is passed like a yellow that came too late.
    """
    if letter in "rRu":
        return Signal.STOP if speed * speed <= 2.0 * hardest * max(to_line, 0.0) or speed < 1.0 else Signal.GO_ON_YELLOW
    if letter in "yY":
        comfortable = speed * speed <= 2.0 * bearable * max(to_line, 0.0)
        return Signal.STOP_ON_YELLOW if comfortable else Signal.GO_ON_YELLOW
    return Signal.STOP_THEN_GO if letter == "s" else Signal.GO


def outranks(letter: str, other: str) -> bool:
    """Whether traffic at `letter` goes before traffic at `other`: green before "stop, then go", full before permissive."""
    return bool(letter and other) and ((letter in "Gg" and other == "s") or (letter == "G" and other in "go"))


def holds_back(letter: str, to_line: float, speed: float, shut_for: float, hardest: float, bearable: float) -> bool:
    """Whether a light that has not been green for `shut_for` s keeps another car, `to_line` m before its line at `speed`
    m/s, out of the junction: where a `bearable` braking (m/s²) sufficed when it came on, and its `hardest` does now."""
    if to_line < 0.0 or letter not in SHUT:
        return False
    seen_from = to_line + speed * shut_for
    return speed * speed <= 2.0 * min(bearable * max(seen_from, 0.5), hardest * max(to_line, 0.5))
