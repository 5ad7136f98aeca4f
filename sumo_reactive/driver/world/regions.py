"""Conflict regions and the post-conflict regions behind them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from sumo_reactive.driver.geometry.polyline import Points


class ConflictKind(Enum):
    """How two paths meet."""

    CROSSING = "crossing"
    MERGING = "merging"
    DIVERGING = "diverging"


@dataclass(frozen=True)
class Interval:
    """A stretch [start, end] of arc length on a path, m."""

    start: float
    end: float

    def __post_init__(self) -> None:
        if self.end < self.start:
            raise ValueError(f"interval ends at {self.end} before it starts at {self.start}")


@dataclass(frozen=True, eq=False)
class PostConflictRegion:
    """The room behind a conflict region that a vehicle needs so as not to stop inside it (F&L 1991, §2).

    It starts on the own path at `start` (arc length from the stop line, m; it may lie on the lane behind the junction).
    `region_id` names the conflict region before it.
    """

    connection_id: str
    start: float
    region_id: str = ""

    @property
    def id(self) -> str:
        """Name of this node of the graph."""
        return f"{self.region_id or self.connection_id}+post"


@dataclass(frozen=True, eq=False)
class ConflictRegion:
    """Where bodies on connection `own_id` and on `other_id` may touch: one vehicle at a time (F&L 1991, §2).

    `own` and `other` are the stretches on each connection's path, arc length from its stop line; `polygon` is the common
    area, shape (n, 2), m.
    """

    id: str
    kind: ConflictKind
    own_id: str
    other_id: str
    own: Interval
    other: Interval
    polygon: Points
    post: PostConflictRegion
