"""The labelled oriented graph W that joins lanes, conflict regions and post-conflict regions (F&L 1991, §2)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import shapely

from sumo_reactive.driver.world.approaches import Approach
from sumo_reactive.driver.world.junction import Connection, Junction
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.regions import ConflictRegion


class ArcLabel(Enum):
    """What leads from the source of an arc to its target."""

    FOLLOWS = "follows"  # the target lane follows the source lane
    ENTERS = "enters"  # lane before a junction → conflict region on a way through it
    CLEARS = "clears"  # conflict region → the post-conflict region behind it
    LEADS_TO = "leads to"  # post-conflict region → lane behind the junction


class Arc(NamedTuple):
    """A labelled arc between two nodes, each named by its id."""

    source: str
    target: str
    label: ArcLabel


def arcs_of(connections: Mapping[str, Connection], regions: Iterable[ConflictRegion]) -> tuple[Arc, ...]:
    """Return the arcs of W between the lanes that `connections` (by id) join, and those by `regions` on them, in order."""
    arcs = []
    for connection in connections.values():
        for source, target in pairwise((connection.from_lane, *connection.parts, connection.to_lane)):
            arcs.append(Arc(source, target, ArcLabel.FOLLOWS))
    for region in regions:
        own = connections[region.own_id]
        arcs.append(Arc(own.from_lane, region.id, ArcLabel.ENTERS))
        arcs.append(Arc(region.id, region.post.id, ArcLabel.CLEARS))
        arcs.append(Arc(region.post.id, own.to_lane, ArcLabel.LEADS_TO))
    return tuple(arcs)


@dataclass(frozen=True, eq=False, kw_only=True)
class RoadGraph:
    """The part of the world that a route touches; immutable, built once.

    Its nodes are `lanes` (normal and internal ones) and conflict `regions` with the post-conflict regions behind them, by
    id; `arcs` join them, those from one node in order. `edge_lanes` holds the lanes of an edge, outermost first; `opposite`
    the edge that shares an edge's carriageway in the other direction; `approaches` the lanes on which vehicles come to a
    connection that shares a conflict region, by the connection's id (none come to a pedestrian crossing); `beyond` the lanes
    from which long bodies still reach back over the lane before, by the id of that.
    """

    lanes: Mapping[str, Lane]
    edge_lanes: Mapping[str, tuple[Lane, ...]]
    junctions: Mapping[str, Junction]
    connections: Mapping[str, Connection]
    regions: Mapping[str, ConflictRegion]
    arcs: tuple[Arc, ...]
    opposite: Mapping[str, str]
    left_hand: bool
    approaches: Mapping[str, tuple[Approach, ...]] = field(default_factory=dict)
    beyond: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @cached_property
    def connection_of(self) -> Mapping[str, Connection]:
        """The connection that an internal lane is part of."""
        return {part: connection for connection in self.connections.values() for part in connection.parts}

    @cached_property
    def _targets(self) -> Mapping[tuple[str, ArcLabel], list[str]]:
        targets: dict[tuple[str, ArcLabel], list[str]] = {}
        for arc in self.arcs:
            targets.setdefault((arc.source, arc.label), []).append(arc.target)
        return targets

    @cached_property
    def _ways(self) -> tuple[Mapping[str, list[Connection]], Mapping[str, list[Connection]]]:
        """The connections whose lanes follow each other all the way, by the lane before and by the lane behind them."""
        onward: dict[str, list[Connection]] = {}
        back: dict[str, list[Connection]] = {}
        for connection in self.connections.values():
            lanes = connection.from_lane, *connection.parts, connection.to_lane
            if all(behind in self.successors(lane, ArcLabel.FOLLOWS) for lane, behind in pairwise(lanes)):
                onward.setdefault(connection.from_lane, []).append(connection)
                back.setdefault(connection.to_lane, []).append(connection)
        return onward, back

    def successors(self, node: str, label: ArcLabel) -> Sequence[str]:
        """Return the nodes to which arcs of a label lead from a node, in order."""
        return self._targets.get((node, label), ())

    def ways_from(self, lane_id: str) -> Sequence[Connection]:
        """Return the connections on which other lanes follow a lane."""
        return self._ways[0].get(lane_id, ())

    def ways_into(self, lane_id: str) -> Sequence[Connection]:
        """Return the connections on which a lane follows others."""
        return self._ways[1].get(lane_id, ())

    def regions_on(self, connection: Connection) -> tuple[ConflictRegion, ...]:
        """Return the conflict regions that the lane before a connection enters and that clear into its lane behind, in order
        of their start."""
        entered = self.successors(connection.from_lane, ArcLabel.ENTERS)
        return tuple(self.regions[one] for one in entered if connection.to_lane in self._behind(one))

    def _behind(self, region_id: str) -> Iterator[str]:
        for post in self.successors(region_id, ArcLabel.CLEARS):
            yield from self.successors(post, ArcLabel.LEADS_TO)

    @cached_property
    def _spines(self) -> tuple[tuple[Lane, ...], shapely.STRtree]:
        """The normal lanes, and the tree of their spines."""
        lanes = tuple(lane for lane in self.lanes.values() if not lane.is_internal)
        return lanes, shapely.STRtree([shapely.linestrings(lane.spine.points) for lane in lanes])

    def lanes_crossing(self, line: shapely.LineString) -> list[Lane]:
        """Return the normal lanes whose spines have a place in common with a line, in the order of `lanes`."""
        lanes, tree = self._spines
        return [lanes[k] for k in sorted(tree.query(line, predicate="intersects").tolist())]

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


def walk(graph: RoadGraph, lane_ids: Sequence[str]) -> Iterator[tuple[Connection, tuple[ConflictRegion, ...]]]:
    """Walk W along the lanes of a way, each following the last or beside it, and yield what it passes, in order: each
    connection with the conflict regions on it.

    A way that begins inside a junction passes it, too.
    """
    begun = graph.connection_of.get(lane_ids[0]) if lane_ids else None
    for lane_id, onward in pairwise(lane_ids if begun is None else (begun.from_lane, *lane_ids)):
        for connection in graph.ways_from(lane_id):
            if onward == connection.to_lane or onward in connection.parts:
                yield connection, graph.regions_on(connection)
