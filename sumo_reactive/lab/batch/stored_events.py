"""The rows of a trial in the store's table `events`: faults, emergencies, and every decision with its entry."""

from __future__ import annotations

import json
from collections.abc import Iterator

from sumo_reactive.lab.process.task import Outcome
from sumo_reactive.lab.trace import line_of

COLLISION, HARD_BRAKING, EMERGENCY, DECISION = "collision", "hard braking", "emergency", "decision"

EventRow = tuple[float, str, str, str, str | None]
"""Time (s), kind (a violation's is its own), user concerned, lane of the ego, a decision's entry as in `decisions.jsonl`."""


def events_of(outcome: Outcome) -> list[EventRow]:
    """Return the events of a trial in order of time."""
    return sorted((*_faults(outcome), *_decisions(outcome)), key=lambda row: row[0])


def _faults(outcome: Outcome) -> Iterator[EventRow]:
    if outcome.result is None:
        return
    for collision in outcome.result.collisions:
        yield collision.time, COLLISION, collision.user_id, collision.lane_id, None
    for violation in outcome.result.violations:
        yield violation.time, violation.kind, violation.user_id, violation.lane_id, None
    for brake in outcome.result.hard_brakes:
        yield brake.time, HARD_BRAKING, brake.user_id, brake.lane_id, None


def _decisions(outcome: Outcome) -> Iterator[EventRow]:
    for entry in outcome.entries:
        cause = next((one.cause for one in entry.decisions if one.cause), "")
        kind = EMERGENCY if entry.emergency else DECISION
        yield round(entry.time, 3), kind, cause, "", json.dumps(line_of(entry), allow_nan=False)
