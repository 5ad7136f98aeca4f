"""The labelled oriented graph W that joins lanes, conflict regions and post-conflict regions (F&L 1991, §2)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import Enum
from itertools import pairwise
from typing import NamedTuple

from sumo_reactive.driver.world.approach import Approach
from sumo_reactive.driver.world.junction import Connection, Junction
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.regions import ConflictRegion


class ArcLabel(Enum):
    """What the source of an arc is to its target."""

    FOLLOWS = "follows"  # the target lane follows the source lane
    LEFT_OF = "left of"  # the source lane lies left of the target lane
    RIGHT_OF = "right of"
    ENTERS = "enters"  # lane → conflict region
    CLEARS = "clears"  # conflict region → the post-conflict region behind it
    LEADS_TO = "leads to"  # post-conflict region → lane
    CONFLICTS = "conflicts"  # conflict region ↔ the connection that shares it


class Arc(NamedTuple):
    """A labelled arc between two nodes, each named by its id."""

    source: str
    target: str
    label: ArcLabel


@dataclass(frozen=True, eq=False)
class RoadGraph:
    """The part of the world that a route touches; immutable, built once.

    `lanes` holds normal and internal lanes by id; `edge_lanes` the lanes of an edge, outermost first; `outgoing` and
    `incoming` the connections by lane id; `connection_of` the connection that an internal lane is part of; `regions`
    the conflict regions by the id of the own connection, in order of their start; `opposite` the edge that shares an
    edge's carriageway in the other direction; `approaches` the lanes on which vehicles come to a connection that shares
    a conflict region, by the connection's id (none come to a pedestrian crossing).
    """

    lanes: Mapping[str, Lane]
    edge_lanes: Mapping[str, tuple[Lane, ...]]
    junctions: Mapping[str, Junction]
    connections: Mapping[str, Connection]
    outgoing: Mapping[str, tuple[Connection, ...]]
    incoming: Mapping[str, tuple[Connection, ...]]
    connection_of: Mapping[str, Connection]
    regions: Mapping[str, tuple[ConflictRegion, ...]]
    opposite: Mapping[str, str]
    left_hand: bool
    approaches: Mapping[str, tuple[Approach, ...]] = field(default_factory=dict)

    def neighbours(self, lane_id: str) -> tuple[Lane | None, Lane | None]:
        """Return the lanes directly left and right of a lane on its edge, as the driver sees them."""
        lane = self.lanes[lane_id]
        lanes = self.edge_lanes.get(lane.edge_id, ())
        outer = lanes[lane.index - 1] if 0 < lane.index <= len(lanes) else None
        inner = lanes[lane.index + 1] if lane.index + 1 < len(lanes) else None
        return (outer, inner) if self.left_hand else (inner, outer)

    def oncoming(self, edge_id: str) -> tuple[Lane, ...]:
        """Return the lanes of the other direction on an edge's carriageway, outermost first."""
        return self.edge_lanes.get(self.opposite.get(edge_id, ""), ())

    def lanes_behind(self, connection: Connection) -> Iterator[tuple[str, float]]:
        """Yield the lanes on the way from a connection's stop line on, up to the one that it leads to, with the arc length
        at which each starts, m."""
        at = 0.0
        for part in connection.parts:
            yield part, at
            at += self.lanes[part].spine.length
        yield connection.to_lane, at

    def arcs(self) -> Iterator[Arc]:
        """Yield W as labelled arcs between lanes, conflict regions, post-conflict regions and connections."""
        for connection in self.connections.values():
            for source, target in pairwise((connection.from_lane, *connection.parts, connection.to_lane)):
                yield Arc(source, target, ArcLabel.FOLLOWS)
        for lane_id in self.lanes:
            for beside, label in zip(self.neighbours(lane_id), (ArcLabel.LEFT_OF, ArcLabel.RIGHT_OF), strict=True):
                if beside is not None:
                    yield Arc(beside.id, lane_id, label)
        for own_id, regions in self.regions.items():
            own = self.connections[own_id]
            for region in regions:
                yield Arc(own.from_lane, region.id, ArcLabel.ENTERS)
                yield Arc(region.id, region.post.id, ArcLabel.CLEARS)
                yield Arc(region.post.id, own.to_lane, ArcLabel.LEADS_TO)
                yield Arc(region.id, region.other_id, ArcLabel.CONFLICTS)
                yield Arc(region.other_id, region.id, ArcLabel.CONFLICTS)
