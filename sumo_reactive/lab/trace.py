"""The trace of the pilot: one entry where what it decided changes, and its form as a line of `decisions.jsonl`."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NamedTuple

from pydantic import AfterValidator, Field, field_validator

from sumo_reactive.driver.nouns.assessment import Assessment, Encounter, PlanOutcome
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Instruction, Occupancy, Reason, RegionState
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.files import text_of
from sumo_reactive.lab.schema import MOST_RECORD_BYTES, Keys, Number, checked

if TYPE_CHECKING:
    from sumo_reactive.driver.nouns.record import StepRecord

_OF_A_MEETING = {"arrival_s", "clearance_s", "foe_arrival_s", "foe_clearance_s"}
_OF_A_LINE = {"to_line_m", "braking_needed_m_s2"}


Measure = Annotated[Number | None, AfterValidator(lambda value: math.inf if value is None else value)]
"""A number, or null where there is none."""


class NounKeys(Keys):
    """A noun as a JSON object: a key for each of its fields, or the field's alias where units or the trace name it anew."""

    noun: ClassVar[type[Any]]

    def made(self) -> Any:
        """Return the noun."""
        return self.noun(**{name: _made(getattr(self, name)) for name in type(self).model_fields})


def _made(value: object) -> object:
    if isinstance(value, NounKeys):
        return value.made()
    if isinstance(value, dict):
        return tuple(value.items())
    return tuple(map(_made, value)) if isinstance(value, tuple) else value


class EventKeys(NounKeys):
    """What activated the pilot."""

    noun = Event
    kind: EventKind = Field(alias="event")
    """What happened."""
    cause: str
    """The road user, light or place behind it; empty: the ego."""


class EncounterKeys(NounKeys):
    """Whom going on would touch, when and where."""

    noun = Encounter
    user_id: str = Field(alias="user")
    """Whom."""
    time: Measure = Field(alias="time_s")
    """When: simulation time."""
    s: Measure = Field(alias="s_m")
    """Where: the front bumper along C."""
    x: Measure = Field(alias="x_m")
    """Where."""
    y: Measure = Field(alias="y_m")
    """Where."""


class AssessmentKeys(NounKeys):
    """What going on would have led to."""

    noun = Assessment
    outcome: PlanOutcome
    """How it would have ended."""
    lateness: Measure = Field(alias="lateness_s")
    """How late the ego would have been for a time constraint."""
    constraint: Measure = Field(alias="constraint_m")
    """The place of that along C."""
    encounter: EncounterKeys | None
    """Whom it would have touched; null: nobody."""


class DecisionKeys(NounKeys):
    """A decision with the figures that it rests on."""

    noun = Decision
    behaviour: Behaviour
    """What the ego does."""
    reason: Reason
    """Why."""
    region: str
    """Where: a conflict region, connection or lane."""
    cause: str
    """The road user, light or place behind it."""
    passes: bool
    """Whether the ego goes on, or waits."""
    figures: dict[str, Measure]
    """The numbers that it rests on, by name; null: there is none."""

    @field_validator("figures")
    @classmethod
    def _belong_together(cls, figures: dict[str, float]) -> dict[str, float]:
        for mark, others in (("foe_arrival_s", _OF_A_MEETING), ("to_line_m", _OF_A_LINE)):
            if mark in figures and (missing := sorted(others - figures.keys())):
                raise ValueError(f"'{mark}' without '{missing[0]}'")
        return figures


class RegionKeys(NounKeys):
    """Who holds a region."""

    noun = RegionState
    region: str
    """A conflict region on the ego's way."""
    occupancy: Occupancy = Field(alias="state")
    """Whether it is free."""
    user_id: str = Field(alias="user")
    """Who claims or occupies it."""


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


class EntryKeys(NounKeys):
    """A whole line."""

    noun = Entry
    time: Number = Field(alias="time_s")
    """Simulation time from when on it is in force."""
    events: tuple[EventKeys, ...]
    """What activated the pilot last."""
    assessment: AssessmentKeys
    """What going on would have led to."""
    behaviour: Behaviour
    """What the ego is doing."""
    instruction: Instruction
    """What the executor is told."""
    decisions: tuple[DecisionKeys, ...]
    """What it was decided on."""
    regions: tuple[RegionKeys, ...]
    """Who holds the conflict regions ahead."""
    emergency: bool = False
    """An emergency began here; absent: none did."""
    hazard: str = ""
    """What that is for; absent: none began."""


_KEYS: dict[type, type[NounKeys]] = {
    keys.noun: keys for keys in (EventKeys, EncounterKeys, AssessmentKeys, DecisionKeys, RegionKeys, EntryKeys)
}


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


def line_of(entry: Entry) -> dict[str, Any]:
    """Return an entry as plain data: units in the keys, null for "none"."""
    line: dict[str, Any] = _plain(entry)
    return line if entry.emergency else {name: value for name, value in line.items() if name not in ("emergency", "hazard")}


def _plain(value: Any) -> Any:
    if keys := _KEYS.get(type(value)):
        line = {field.alias or name: _plain(getattr(value, name)) for name, field in keys.model_fields.items()}
        return line | ({"figures": dict(line["figures"])} if "figures" in line else {})
    if isinstance(value, tuple):
        return [_plain(one) for one in value]
    if isinstance(value, float):
        return round(value, 3) if math.isfinite(value) else None
    return value.value if isinstance(value, Enum) else value


def entry_of(line: Mapping[str, Any]) -> Entry:
    """Return the entry that a line holds; raise ValueError for another line."""
    entry: Entry = EntryKeys.model_validate_json(json.dumps(line)).made()
    return entry


def read_entries(path: Path) -> tuple[Entry, ...]:
    """Read `decisions.jsonl`; raise ScenarioError with file and line for what is none."""
    lines = text_of(path, most=MOST_RECORD_BYTES).split("\n")
    told = "a record of this release"
    return tuple(
        checked(line, EntryKeys, f"{path}:{number}", told).made()
        for number, line in enumerate(lines[:-1] if lines[-1] == "" else lines, start=1)
    )
