"""The trace of the pilot: one entry where what it decided changes, and its form as a line of `decisions.jsonl`."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from sumo_reactive.errors import ScenarioError
from sumo_reactive.messages.assessment import Assessment, Encounter, Outcome
from sumo_reactive.messages.decision import Behaviour, Decision, Instruction, Occupancy, Reason, RegionState
from sumo_reactive.messages.event import Event, EventKind
from sumo_reactive.messages.record import StepRecord

Line = dict[str, Any]


class Entry(NamedTuple):
    """What is in force from `time` (s) on, and why: fields as in `StepRecord`.

    `events` are those that activated the pilot last. `emergency`: one began here, for `hazard`.
    """

    time: float
    events: tuple[Event, ...]
    assessment: Assessment
    behaviour: Behaviour
    instruction: Instruction
    decisions: tuple[Decision, ...]
    regions: tuple[RegionState, ...] = ()
    emergency: bool = False
    hazard: str = ""


def entries(steps: Sequence[StepRecord]) -> Iterator[Entry]:
    """Yield an entry where behaviour, instruction or the set of decisions changes, and where an emergency begins."""
    last: object = None
    events: tuple[Event, ...] = ()
    in_emergency = False
    for step in steps:
        events = step.events or events
        now = step.behaviour, step.instruction, {decision_without_figures(decision) for decision in step.decisions}
        began = step.emergency and not in_emergency
        if now != last or began:
            behaviour, instruction = Behaviour(step.behaviour), Instruction(step.instruction)
            yield Entry(
                step.time, events, step.assessment, behaviour, instruction, step.decisions, step.regions, began,
                step.hazard if began else "",
            )  # fmt: skip
        last, in_emergency = now, step.emergency


def decision_without_figures(decision: Decision) -> tuple[object, ...]:
    """Return what makes a decision another one; its figures change at every activation."""
    return decision.behaviour, decision.reason, decision.region, decision.cause, decision.passes


def line_of(entry: Entry) -> Line:
    """Return an entry as plain data: units in the keys, null for "none"."""
    line: Line = {
        "time_s": round(entry.time, 3),
        "events": [{"event": event.kind.value, "cause": event.cause} for event in entry.events],
        "assessment": _assessment_line(entry.assessment),
        "behaviour": entry.behaviour.value,
        "instruction": entry.instruction.value,
        "decisions": [_decision_line(decision) for decision in entry.decisions],
        "regions": [{"region": r.region, "state": r.occupancy.value, "user": r.user_id} for r in entry.regions],
    }
    return line | ({"emergency": True, "hazard": entry.hazard} if entry.emergency else {})


def entry_of(line: Mapping[str, Any]) -> Entry:
    """Return the entry that a line holds; raise KeyError, TypeError or ValueError for another line."""
    return Entry(
        time=float(line["time_s"]),
        events=tuple(Event(EventKind(one["event"]), one["cause"]) for one in line["events"]),
        assessment=_assessment_of(line["assessment"]),
        behaviour=Behaviour(line["behaviour"]),
        instruction=Instruction(line["instruction"]),
        decisions=tuple(_decision_of(one) for one in line["decisions"]),
        regions=tuple(RegionState(one["region"], Occupancy(one["state"]), one["user"]) for one in line["regions"]),
        emergency=bool(line.get("emergency", False)),
        hazard=str(line.get("hazard", "")),
    )


def read_entries(path: Path) -> tuple[Entry, ...]:
    """Read `decisions.jsonl`; raise ScenarioError with file and line for what is none."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise ScenarioError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from error
    return tuple(_read_line(path, number, line) for number, line in enumerate(lines, start=1))


def _read_line(path: Path, number: int, line: str) -> Entry:
    try:
        return entry_of(json.loads(line))
    except KeyError as error:
        raise ScenarioError(f"{path}:{number}: key {error} is missing: not a record of this release") from error
    except (TypeError, ValueError) as error:
        raise ScenarioError(f"{path}:{number}: not a record of this release: {error}") from error


def _assessment_line(assessment: Assessment) -> Line:
    meets = assessment.encounter
    return {
        "outcome": assessment.outcome.value,
        "lateness_s": _rounded(assessment.lateness),
        "constraint_m": _rounded(assessment.constraint),
        "encounter": None if meets is None else {
            "user": meets.user_id,
            "time_s": _rounded(meets.time),
            "s_m": _rounded(meets.s),
            "x_m": _rounded(meets.x),
            "y_m": _rounded(meets.y),
        },
    }  # fmt: skip


def _assessment_of(line: Mapping[str, Any]) -> Assessment:
    meets = line["encounter"]
    encounter = None
    if meets is not None:
        encounter = Encounter(meets["user"], *(_number(meets[key]) for key in ("time_s", "s_m", "x_m", "y_m")))
    return Assessment(Outcome(line["outcome"]), _number(line["lateness_s"]), _number(line["constraint_m"]), encounter)


def _decision_line(decision: Decision) -> Line:
    return {
        "behaviour": decision.behaviour.value,
        "reason": decision.reason.value,
        "region": decision.region,
        "cause": decision.cause,
        "passes": decision.passes,
        "figures": {name: _rounded(value) for name, value in decision.figures},
    }


def _decision_of(line: Mapping[str, Any]) -> Decision:
    figures = tuple((name, _number(value)) for name, value in line["figures"].items())
    behaviour, reason = Behaviour(line["behaviour"]), Reason(line["reason"])
    return Decision(behaviour, reason, line["region"], line["cause"], bool(line["passes"]), figures)


def _rounded(value: float) -> float | None:
    return round(value, 3) if math.isfinite(value) else None


def _number(value: float | None) -> float:
    return math.inf if value is None else float(value)
