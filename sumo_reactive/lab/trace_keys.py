"""The keys of a line of `decisions.jsonl`."""

from __future__ import annotations

from pydantic import field_validator

from sumo_reactive.driver.nouns.assessment import Outcome
from sumo_reactive.driver.nouns.decision import Behaviour, Instruction, Occupancy, Reason
from sumo_reactive.driver.nouns.event import EventKind
from sumo_reactive.lab.json_file import Keys, Number

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

    outcome: Outcome
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
