"""Routes: the edges to drive, from where to where."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ScheduledStop:
    """A halt that the route prescribes: the front at `position` (m on the lane) for `duration` s, not before `until` s."""

    lane_id: str
    position: float
    duration: float
    until: float | None = None


@dataclass(frozen=True)
class Route:
    """A sequence of edges; the front bumper arrives at `arrival_position` (m on the last edge; None: its end)."""

    edges: tuple[str, ...]
    arrival_position: float | None = None
    arrival_lane: int | None = None
    stops: tuple[ScheduledStop, ...] = ()

    def __post_init__(self) -> None:
        if not self.edges:
            raise ValueError("a route needs at least one edge")
