"""The trace of the pilot: one entry where what it decided changes, and its form as a line of `decisions.jsonl`."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import field_validator

from sumo_reactive.driver.nouns.assessment import Assessment, Encounter, PlanOutcome
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Instruction, Occupancy, Reason, RegionState
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.nouns.record import StepRecord
from sumo_reactive.files import text_of
from sumo_reactive.lab.schema import MOST_RECORD_BYTES, Keys, Number, checked

_OF_A_MEETING = {"arrival_s", "clearance_s", "foe_arrival_s", "foe_clearance_s"}
_OF_A_LINE = {"to_line_m", "braking_needed_m_s2"}


class EventKeys(Keys):
    """What activated the pilot."""

    event: EventKind
    cause: str


class EncounterKeys(Keys):
    """Whom going on would touch, when and where."""

    user: str
    time_s: Number | None
    s_m: Number | None
    x_m: Number | None
    y_m: Number | None


class AssessmentKeys(Keys):
    """What going on would have led to."""

    outcome: PlanOutcome
    lateness_s: Number | None
    constraint_m: Number | None
    encounter: EncounterKeys | None


class DecisionKeys(Keys):
    """A decision with the figures that it rests on."""

    behaviour: Behaviour
    reason: Reason
    region: str
    cause: str
    passes: bool
    figures: dict[str, Number | None]

    @field_validator("figures")
    @classmethod
    def _belong_together(cls, figures: dict[str, float | None]) -> dict[str, float | None]:
        for mark, others in (("foe_arrival_s", _OF_A_MEETING), ("to_line_m", _OF_A_LINE)):
            if mark in figures and (missing := sorted(others - figures.keys())):
                raise ValueError(f"'{mark}' without '{missing[0]}'")
        return figures


class RegionKeys(Keys):
    """Who holds a region."""

    region: str
    state: Occupancy
    user: str


class LineKeys(Keys):
    """A whole line."""

    time_s: Number
    events: list[EventKeys]
    assessment: AssessmentKeys
    behaviour: Behaviour
    instruction: Instruction
    decisions: list[DecisionKeys]
    regions: list[RegionKeys]
    emergency: bool = False
    hazard: str = ""


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
        if step.behaviour is None or step.instruction is None:  # SUMO's own driver decides nothing
            continue
        events = step.events or events
        now = step.behaviour, step.instruction, {decision_without_figures(decision) for decision in step.decisions}
        began = bool(step.emergency) and not in_emergency
        if now != last or began:
            behaviour, instruction = Behaviour(step.behaviour), Instruction(step.instruction)
            yield Entry(
                step.time, events, step.assessment, behaviour, instruction, step.decisions, step.regions, began,
                step.hazard or "" if began else "",
            )  # fmt: skip
        last, in_emergency = now, bool(step.emergency)


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
    """Return the entry that a line holds; raise ValueError for another line."""
    return _entry(LineKeys.model_validate_json(json.dumps(line)))


def read_entries(path: Path) -> tuple[Entry, ...]:
    """Read `decisions.jsonl`; raise ScenarioError with file and line for what is none."""
    lines = text_of(path, most=MOST_RECORD_BYTES).split("\n")
    told = "a record of this release"
    return tuple(
        _entry(checked(line, LineKeys, f"{path}:{number}", told))
        for number, line in enumerate(lines[:-1] if lines[-1] == "" else lines, start=1)
    )


def _entry(line: LineKeys) -> Entry:
    meets = line.assessment.encounter
    encounter = None
    if meets is not None:
        encounter = Encounter(meets.user, *map(_number, (meets.time_s, meets.s_m, meets.x_m, meets.y_m)))
    lateness, constraint = _number(line.assessment.lateness_s), _number(line.assessment.constraint_m)
    return Entry(
        time=line.time_s,
        events=tuple(Event(one.event, one.cause) for one in line.events),
        assessment=Assessment(line.assessment.outcome, lateness, constraint, encounter),
        behaviour=line.behaviour,
        instruction=line.instruction,
        decisions=tuple(_decision(one) for one in line.decisions),
        regions=tuple(RegionState(one.region, one.state, one.user) for one in line.regions),
        emergency=line.emergency,
        hazard=line.hazard,
    )


def _decision(keys: DecisionKeys) -> Decision:
    figures = tuple((name, _number(value)) for name, value in keys.figures.items())
    return Decision(keys.behaviour, keys.reason, keys.region, keys.cause, keys.passes, figures)


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


def _decision_line(decision: Decision) -> Line:
    return {
        "behaviour": decision.behaviour.value,
        "reason": decision.reason.value,
        "region": decision.region,
        "cause": decision.cause,
        "passes": decision.passes,
        "figures": {name: _rounded(value) for name, value in decision.figures},
    }


def _rounded(value: float) -> float | None:
    return round(value, 3) if math.isfinite(value) else None


def _number(value: float | None) -> float:
    return math.inf if value is None else value
