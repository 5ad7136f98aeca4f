"""Junctions and the connections that lead through them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from sumo_reactive.driver.geometry.polyline import Floats, Points, Polyline
from sumo_reactive.driver.world.right_of_way import RightOfWay

WAITING_LENGTH_M = 5.0
"""A car of this length…"""

WAITING_WIDTH_M = 1.8
"""…and width, SUMO's usual ones, is taken to wait inside a junction wherever a turn may."""

HOLD_BACK_REACH_M = 12.0
"""Approach and exit lanes are looked at this far from the stop line for a place where they lie over each other."""


class Turn(Enum):
    """Direction of a connection."""

    STRAIGHT = "straight"
    LEFT = "left"
    RIGHT = "right"
    AROUND = "around"


class Control(Enum):
    """How a connection is regulated when no light speaks."""

    MAJOR = "major"
    MINOR = "minor"
    EQUAL = "equal"  # right before left
    STOP = "stop"
    ALL_WAY_STOP = "all-way stop"
    ZIPPER = "zipper"
    LIGHT = "light"
    OFF = "light off"
    DEAD_END = "dead end"


@dataclass(frozen=True)
class LightLink:
    """The signal that a connection obeys: a traffic light's id and the index of its letter."""

    light_id: str
    index: int


@dataclass(frozen=True, eq=False, kw_only=True)
class Connection:
    """A way from one lane to another through a junction.

    `index` is its row in the junction's `RightOfWay` (-1: none). `parts` are the internal lanes in driving order (two or
    more for a turn that may wait inside), `path` their joined centre line; arc length on it starts at the stop line.
    `wait_at` is the arc length of the place inside the junction where a turn may wait, or None. `width` is the narrowest
    internal lane's, m. `heights` (n,) are the elevations of the path's points, m; None in a flat network. `tail` (k, 2)
    is where the lane behind goes on inside the junction's outline or over the approach of another road, None if it does
    not. `hold_back` (m) is how far before the stop line a body must stop so as not to stand in others' way, `head` (k, 2)
    that part of the approach lane, None if there is none. `speed_limit` is the least on the way, `approach_limit` that of
    the lane before it, m/s. A pedestrian crossing (`is_crossing`) joins two walking areas and is used both ways.
    """

    id: str
    junction_id: str
    index: int
    from_lane: str
    to_lane: str
    parts: tuple[str, ...]
    path: Polyline
    turn: Turn
    control: Control
    light: LightLink | None = None
    wait_at: float | None = None
    keep_clear: bool = True
    is_crossing: bool = False
    width: float = 3.2
    speed_limit: float = 13.89
    approach_limit: float = 13.89
    heights: Floats | None = None
    tail: Points | None = None
    hold_back: float = 0.0
    head: Points | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Junction:
    """A junction: its kind as SUMO's network names it, outline (n, 2), connections in order of their index."""

    id: str
    kind: str
    outline: Points
    connections: tuple[Connection, ...]
    right_of_way: RightOfWay

    def yielded_to_by(self, connection: Connection) -> frozenset[str]:
        """Return the ids of the connections that one of this junction lets go first."""
        own = connection.index
        return frozenset(one.id for one in self.connections if self.right_of_way.must_yield(own, one.index))
