"""What the pilot expects of a plan that it has simulated ahead (F&L 1991, §2, step 1)."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class PlanOutcome(Enum):
    """How a manoeuvre ends if everybody goes on as now."""

    FINE = "fine"
    DEGRADED = "degraded"
    FAILURE = "failure"


class Encounter(NamedTuple):
    """The ego's body would touch that of `user_id`: at `time` (s of simulation time), front bumpers at `s` (m of C)."""

    user_id: str
    time: float
    s: float
    x: float
    y: float


class Assessment(NamedTuple):
    """The outcome, with the `lateness` (s) for the constraint at arc length `constraint` (m of C), and the encounter of a
    failure."""

    outcome: PlanOutcome
    lateness: float
    constraint: float
    encounter: Encounter | None = None


NOT_ASSESSED = Assessment(PlanOutcome.FINE, 0.0, 0.0)
