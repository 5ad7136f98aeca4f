"""The labelled oriented graph W that joins lanes, conflict regions and post-conflict regions (F&L 1991, §2)."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from itertools import pairwise
from typing import NamedTuple, Protocol

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


@dataclass(frozen=True, slots=True)
class Approach:
    """A lane (normal or internal) from which a vehicle can reach a connection's stop line.

    `distance` is the spine length from the lane's START to the stop line, m. `edges` are the normal edges still to drive,
    from the lane's own edge (from the next one, if the lane is internal) up to and including the edge behind the
    connection; a vehicle comes this way if its remaining route begins with them.
    """

    lane_id: str
    distance: float
    edges: tuple[str, ...]


class Upstream(Protocol):
    """What the search backwards along the lanes asks of a network."""

    def edge_of(self, lane_id: str) -> str:
        """Return the edge that a lane belongs to."""

    def ends_of(self, edge_id: str) -> tuple[str, str]:
        """Return the junctions where an edge starts and ends."""

    def spine_length(self, lane_id: str) -> float:
        """Return the length of a lane's spine, m."""

    def arrivals(self, lane_id: str) -> Iterable[tuple[str, Sequence[str]]]:
        """Yield (lane before the junction, internal lanes in driving order) of the connections into a lane."""

    def detours(self, lane_id: str, edge_id: str) -> Iterable[str]:
        """Yield the lanes beside `lane_id` that do not themselves lead to `edge_id`: who drives there must change lanes."""


def approaches_to(from_lane: str, to_edge: str, net: Upstream, horizon: float) -> tuple[Approach, ...]:
    """Return the approaches of the connection from `from_lane` to `to_edge`, nearest first.

    A lane belongs to them if its end is less than `horizon` m from the stop line. Ways that pass a junction twice before
    the stop line (turn around, drive round the block) are left out: no route does so, and they are many.
    """
    found: dict[tuple[str, tuple[str, ...]], float] = {}
    passed_first = frozenset(net.ends_of(net.edge_of(from_lane))[1:])
    queue: list[tuple[float, str, tuple[str, ...], frozenset[str]]]  # a lane's end, edges and junctions behind it
    queue = [(0.0, from_lane, (to_edge,), passed_first)]
    while queue:
        ahead, lane, onward, passed = heapq.heappop(queue)
        edge = net.edge_of(lane)
        start = net.ends_of(edge)[0]
        if start in passed:
            continue
        for beside in (lane, *net.detours(lane, onward[0])):
            key = (beside, (edge, *onward))
            distance = ahead + net.spine_length(beside)
            if found.get(key, math.inf) <= distance:
                continue
            found[key] = distance
            for reached, before in _upstream(beside, distance, key[1], net, horizon, found):
                heapq.heappush(queue, (reached, before, key[1], passed | {start}))
    ordered = sorted(found.items(), key=lambda item: item[1])
    return tuple(Approach(lane, distance, edges) for (lane, edges), distance in ordered)


def _upstream(
    lane: str, distance: float, edges: tuple[str, ...], net: Upstream, horizon: float,
    found: dict[tuple[str, tuple[str, ...]], float],
) -> Iterator[tuple[float, str]]:  # fmt: skip
    """Note the internal lanes that lead into `lane` and yield the lanes before them with their end's distance (m)."""
    if distance >= horizon:
        return
    for before, parts in net.arrivals(lane):
        reached = distance
        for part in reversed(parts):
            if reached >= horizon:
                break
            reached += net.spine_length(part)
            key = (part, edges)
            found[key] = min(reached, found.get(key, math.inf))
        if reached < horizon:
            yield reached, before
