"""Events: what makes the pilot run (F&L 1991, §2: it is activated asynchronously)."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class EventKind(Enum):
    """Every kind of event; between events the pilot does not run."""

    NEW_PLAN = "a new nominal plan"
    NEW_ROUTE = "a new route, since a turn was missed"
    NEW_OBSTACLE = "a new obstacle ahead"
    INTERSECTION = "an intersection comes into reach, or its line, or its end"
    STOP_AHEAD = "a stop of the route, or a turn in several moves, comes into reach"
    LANE_CHANGE = "a lane change that the route needs comes into reach"
    LIGHT_CHANGE = "a light changes"
    OTHER_BEHAVIOUR = "a road user does something else than foreseen"
    CAUSE_VANISHED = "the cause of the instruction is gone"
    OFF_NOMINAL = "the speed is far from nominal"
    CONSTRAINT_MISSED = "a time constraint is missed"
    DELAY = "the delay is excessive"
    NO_COMMAND = "no command was admissible"
    STANDSTILL = "the ego comes to a stand or moves off"
    TIME_REACHED = "a time that the instruction named is reached"
    GAP_OPENED = "a gap that the ego waits for at a region has opened"
    GAP_CLOSED = "a gap that it counted on at a region has closed"
    ROOM_BEHIND = "the room behind an intersection is taken, or free again"
    GAP_SOUGHT = "a gap on the lane beside is looked for anew"
    ASKED = "another ego asks to be let in, or no longer does"
    PASS_TRIED = "whether somebody ahead can be passed is tried out anew"
    NO_PROGRESS = "no progress, though nobody has the right to block the ego"
    LOCKED = "no rule holds the ego that does not get on"
    MOVE_ENDED = "a move of a turn is over"
    PROGRESS = "the ego gets on again after an escape"


class Event(NamedTuple):
    """Something happened that may spoil the plan; `cause` is the road user, light or place behind it (empty: the ego)."""

    kind: EventKind
    cause: str = ""
