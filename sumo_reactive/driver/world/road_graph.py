"""The labelled oriented graph W that joins lanes, conflict regions and post-conflict regions (F&L 1991, §2)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from sumo_reactive.driver.world.approach import Approach
from sumo_reactive.driver.world.arcs import Arc, ArcLabel, arcs_of_connection, arcs_of_region
from sumo_reactive.driver.world.junction import Connection, Junction
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.regions import ConflictRegion


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

    def arcs(self) -> Iterator[Arc]:
        """Yield W as labelled arcs between lanes, conflict regions, post-conflict regions and connections."""
        for connection in self.connections.values():
            yield from arcs_of_connection(connection)
        for lane_id in self.lanes:
            yield from self._side_arcs(lane_id)
        for own_id, regions in self.regions.items():
            for region in regions:
                yield from arcs_of_region(region, self.connections[own_id])

    def _side_arcs(self, lane_id: str) -> Iterator[Arc]:
        left, right = self.neighbours(lane_id)
        if left:
            yield Arc(left.id, lane_id, ArcLabel.LEFT_OF)
        if right:
            yield Arc(right.id, lane_id, ArcLabel.RIGHT_OF)
