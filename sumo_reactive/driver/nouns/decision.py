"""What the pilot decides, each with its reason and its cause."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum


class Behaviour(Enum):
    """What the ego is doing: the paper's five (F&L 1991, §2), and those that the road adds; a file each."""

    NORMAL = "normal driving"
    CAUTIOUS = "cautious driving"
    OVERTAKING = "overtaking"
    STOPPING = "stopping at a location"
    CROSSING = "crossing an intersection"
    CHANGING_LANES = "changing lanes"
    CHANGING_QUEUES = "changing queues"
    TURNING_ROUND = "turning round"
    BACKING_UP = "backing up"
    GIVING_WAY = "giving way"
    TAKING_ANOTHER_WAY = "taking another way"


class Instruction(Enum):
    """The symbolic instructions to the executor, part of P⁺ (F&L 1991, §1.3)."""

    FOLLOW_CURVE = "follow C"
    APPROACH = "approach, ready to stop"
    STOP = "stop at the place named"
    CROSS = "cross without stopping"
    OVERTAKE = "pull out and pass"
    RETURN = "return to C"
    FALL_BACK = "fall back and return to C"
    BACK_UP = "back up at walking speed"
    TURN_ROUND = "turn round, forwards and backwards by turns"
    WIDEN = "search more commands"


INSTRUCTION_NUMBERS = {instruction: float(number) for number, instruction in enumerate(Instruction, 1)}
"""Instructions by their number, as `Parameters.shares_of` has them."""


class Reason(Enum):
    """Why the ego may not go on, or goes on although something speaks against it."""

    ON_SCHEDULE = "the schedule of the plan"
    RED_LIGHT = "the light is red"
    YELLOW_LIGHT = "the light is yellow and stopping is comfortable"
    YELLOW_TOO_CLOSE = "the light is yellow and too close to stop"
    STOP_SIGN = "a full stop is due at the line"
    WAIT_FOR_TURN = "it is the turn of others"
    YIELD_TO = "traffic with priority would meet the ego in the region"
    REGION_OCCUPIED = "the region is occupied"
    FOE_CANNOT_STOP = "traffic that should yield can no longer stop"
    NO_RULE = "no rule makes the others wait, and they do not look"
    PEDESTRIAN = "a pedestrian is on or near the crossing"
    EXIT_BLOCKED = "there is no room behind the region"
    SCHEDULED_STOP = "the route has a stop here"
    NO_GAP = "no gap on the lane that the route needs"
    GAP_CLOSED = "the gap on the other lane has closed"
    MERGE_AHEAD = "the lane ends in a merge, and there is a gap on the lane beside"
    ASKS = "somebody on the lane beside is asked to let the ego in"
    LETS_IN = "somebody on the lane beside asks to be let in"
    QUEUE_CHANGE = "the queue ahead is held up, and a lane beside leads on as well"
    FASTER_LANE = "a lane beside that leads on as well gets on faster"
    BLOCKED = "the way is blocked"
    SLOW_AHEAD = "somebody ahead is slow or has halted, and the gap to pass is proven"
    GAP_LOST = "the gap to pass is lost"
    NARROW_TURN = "the road is too narrow to turn round in one sweep"
    COMES_OVER = "somebody comes over the ground that the turn needs"
    STAYS_THERE = "somebody leaves no room where the turn ends"
    FOLLOWS = "somebody slower is ahead"
    NO_ROOM_TO_PASS = "somebody ahead is slow or has halted, and there is no gap to pass"
    NO_PROGRESS = "nobody has the right to block the ego, yet it does not get on"
    MUTUAL_WAIT = "the ego and others wait for each other"


@dataclass(frozen=True, slots=True, kw_only=True)
class Decision:
    """A symbolic statement of the pilot: what `behaviour` does because of `reason`, caused by `cause` at `region`.

    `figures` are the numbers that it rests on, by name with unit (`arrival_s`, `clearance_s`, `gap_m`).
    """

    behaviour: Behaviour
    reason: Reason
    region: str = ""
    cause: str = ""
    passes: bool = False
    figures: tuple[tuple[str, float], ...] = ()


class Occupancy(Enum):
    """The state of a conflict region for the ego: one vehicle at a time (F&L 1991, §2)."""

    FREE = "free"
    CLAIMED = "claimed by another"
    OCCUPIED = "occupied"
    OWN = "held by the ego"


@dataclass(frozen=True, slots=True)
class RegionState:
    """Conflict region `region` on the ego's way, and by whom it is claimed or occupied."""

    region: str
    occupancy: Occupancy
    user_id: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class PostConflictState:
    """The post-conflict region behind connection `connection_id`, from `start` to `end` on C (m), as the pilot finds it.

    It is free where the ego need wait for nobody there, occupied by `cause` who leaves no room in it, or the ego's once that
    is past the stop line. `waits`: the ego waits before the junction, for the room to be left, or since it
    would have to stop there for `cause`.
    """

    connection_id: str
    start: float
    end: float
    occupancy: Occupancy
    cause: str = ""
    waits: bool = False

    def __post_init__(self) -> None:
        if not self.start <= self.end < math.inf:
            raise ValueError(f"a region from {self.start} to {self.end}")
