"""The world model W, built from a SUMO network for the route at hand."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain, pairwise
from pathlib import Path
from typing import Protocol
from xml.etree.ElementTree import Element

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.world.approaches import Approach, approaches_to
from sumo_reactive.driver.world.junction import Connection, Junction
from sumo_reactive.driver.world.lane import Lane, nearest_opposite
from sumo_reactive.driver.world.regions import ConflictRegion, conflict_regions, ways_near
from sumo_reactive.driver.world.road_graph import RoadGraph, arcs_of
from sumo_reactive.errors import NetworkError
from sumo_reactive.sumo.net_file import RawNet, edge_id_of, from_lane_id, lane_from, parse, to_lane_id
from sumo_reactive.sumo.net_junctions import junction_from, parts_of

APPROACH_HORIZON_M = 200.0
"""Approach lanes are searched this far upstream of a stop line: 10 s of driving at 20 m/s, above any critical gap."""

REACHES_BACK_M = 20.0
"""Who has left a junction may still reach back into it with a body as long as this."""

_ALL = 1 << 31
"""Whatever has been built is kept for the next route."""


class NetUpstream:
    """Answers `world.approaches.Upstream` from a parsed network."""

    def __init__(self, raw: RawNet, lane_of: Callable[[str], Lane]) -> None:
        self._raw, self._lane_of = raw, lane_of

    def edge_of(self, lane_id: str) -> str:
        """Return the edge that a lane belongs to."""
        return edge_id_of(lane_id)

    def ends_of(self, edge_id: str) -> tuple[str, str]:
        """Return the junctions where an edge starts and ends."""
        edge = self._raw.edge(edge_id).attrib
        return edge["from"], edge["to"]

    @kept(_ALL)
    def spine_length(self, lane_id: str) -> float:
        """Return the length of a lane's spine, m."""
        return sum(math.dist(a, b) for a, b in pairwise(self._lane_of(lane_id).spine.points.tolist()))

    @kept(_ALL)
    def arrivals(self, lane_id: str) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """Return (lane before the junction, internal lanes in driving order) of the connections into a lane."""
        return tuple((from_lane_id(link), parts_of(self._raw, link)) for link in self._raw.arriving.get(lane_id, ()))

    @kept(_ALL)
    def detours(self, lane_id: str, edge_id: str) -> tuple[str, ...]:
        """Return the lanes beside `lane_id` from which no connection leads to `edge_id`."""
        own = self._lane_of(lane_id).allowed
        beside = (lane for lane in self._raw.lane_ids(edge_id_of(lane_id)) if lane != lane_id)
        away = (lane for lane in beside if all(link["to"] != edge_id for link in self._raw.leaving.get(lane, ())))
        return tuple(lane for lane in away if own & self._lane_of(lane).allowed)


def read_net(path: Path) -> NetFile:
    """Read a `.net.xml` or `.net.xml.gz`; raise NetworkError naming the file if it cannot serve for driving."""
    return NetFile(parse(path))


class WorldSource(Protocol):
    """Where the world around a route comes from."""

    def build(self, edges: Sequence[str], /) -> RoadGraph:
        """Return a world that holds a route of normal edges; raise NetworkError for an unknown edge."""

    def end_of(self, edge_id: str) -> str:
        """Return the junction that a normal edge leads to."""


class NetFile:
    """A network that builds the part of W that a route touches, and keeps what it has built for the next route."""

    def __init__(self, raw: RawNet) -> None:
        self._raw = raw
        self._regions: dict[str, tuple[ConflictRegion, ...]] = {}
        self._near: dict[str, tuple[str, ...]] = {}
        self._upstream = NetUpstream(raw, self.lane)

    @property
    def path(self) -> Path:
        """The file that was read."""
        return self._raw.path

    @property
    def left_hand(self) -> bool:
        """Whether traffic keeps to the left."""
        return self._raw.left_hand

    @kept(_ALL)
    def lane(self, lane_id: str) -> Lane:
        """Return a lane; raise NetworkError if the network has none of that id."""
        return lane_from(self._raw, lane_id)

    @kept(_ALL)
    def junction(self, junction_id: str) -> Junction:
        """Return a junction with its connections; raise NetworkError if the network has none of that id."""
        return junction_from(self._raw, junction_id, self.lane)

    def build(self, *routes: Sequence[str]) -> RoadGraph:
        """Build W around one or several routes of normal edges.

        It holds the routes' edges and the edges opposite them, the junctions at the route's edges' ends with all edges
        that enter and leave them, conflict regions for the connections from route edge to route edge, and the lanes
        from which others come to these regions and to the routes' edges. Raises NetworkError for an unknown edge.
        """
        edges = tuple(dict.fromkeys(edge for route in routes for edge in route))
        junctions = {end: self.junction(end) for end in dict.fromkeys(self.end_of(edge) for edge in edges)}
        connections = {connection.id: connection for junction in junctions.values() for connection in junction.connections}
        opposite = {edge: other for edge in edges if (other := self._opposite_of(edge))}
        regions = {region.id: region for region in self._regions_on(routes, junctions)}
        others = {region.other_id for region in regions.values()} | set(self._beside(routes, junctions))
        others |= {c.id for c in connections.values() if edge_id_of(c.to_lane) in edges}
        approaches = {
            c.id: () if c.is_crossing else self._approaches_of(c.from_lane, edge_id_of(c.to_lane))
            for c in connections.values()
            if c.id in others
        }
        edge_lanes = self._edge_lanes([*edges, *opposite.values()], connections.values())
        inside = [part for connection in connections.values() for part in connection.parts]
        upstream = [approach.lane_id for found in approaches.values() for approach in found]
        exits = dict.fromkeys(c.to_lane for c in connections.values() if not c.is_crossing)
        beyond = {lane: found for lane in exits if (found := self._beyond(lane))}
        return RoadGraph(
            lanes={
                **{lane.id: lane for lanes in edge_lanes.values() for lane in lanes},
                **{lane_id: self.lane(lane_id) for lane_id in (*inside, *upstream, *chain(*beyond.values()))},
            },
            edge_lanes=edge_lanes,
            junctions=junctions,
            connections=connections,
            regions=regions,
            arcs=arcs_of(connections, regions.values()),
            opposite=opposite,
            left_hand=self.left_hand,
            approaches=approaches,
            beyond=beyond,
        )

    def _normal_edge(self, edge_id: str) -> Element:
        edge = self._raw.edge(edge_id)
        if edge_id.startswith(":") or "to" not in edge.attrib:
            raise NetworkError(f"{self.path}: edge '{edge_id}' is inside a junction; a route holds normal edges")
        return edge

    def end_of(self, edge_id: str) -> str:
        """Return the junction that a normal edge leads to."""
        return self._normal_edge(edge_id).attrib["to"]

    def _edge_lanes(self, edges: Iterable[str], connections: Iterable[Connection]) -> dict[str, tuple[Lane, ...]]:
        """Return the lanes, outermost first, of the edges and of all edges that the connections join."""
        joined = (edge_id_of(lane) for c in connections for lane in (c.from_lane, c.to_lane))
        wanted = dict.fromkeys([*edges, *joined])
        return {edge: tuple(self.lane(lane) for lane in self._raw.lane_ids(edge)) for edge in wanted}

    def _regions_on(
        self, routes: Iterable[Sequence[str]], junctions: dict[str, Junction]
    ) -> Iterator[ConflictRegion]:
        """Yield the conflict regions of the connections from each route's edge to its next, in order on each."""
        for junction, owns in self._passed(routes, junctions):
            missing = [own for own in owns if own.id not in self._regions]
            if missing:
                self._regions.update(conflict_regions(missing, junction))
            for own in owns:
                yield from self._regions[own.id]

    def _beside(self, routes: Iterable[Sequence[str]], junctions: dict[str, Junction]) -> Iterator[str]:
        """Yield the connections that come so near beside those of the routes, or the lanes behind these, that long bodies
        reach over there."""
        for junction, owns in self._passed(routes, junctions):
            for own in owns:
                if own.id not in self._near:
                    self._near[own.id] = ways_near(own, self.lane(own.to_lane).spine, junction)
                yield from self._near[own.id]

    def _passed(
        self, routes: Iterable[Sequence[str]], junctions: dict[str, Junction]
    ) -> Iterator[tuple[Junction, list[Connection]]]:
        """Yield the junctions on the routes, with the connections from each route's edge to its next."""
        for edge, onward in dict.fromkeys(pair for route in routes for pair in pairwise(route)):
            junction = junctions[self.end_of(edge)]
            ends = edge, onward
            yield junction, [c for c in junction.connections if (edge_id_of(c.from_lane), edge_id_of(c.to_lane)) == ends]

    @kept(_ALL)
    def _approaches_of(self, from_lane: str, to_edge: str) -> tuple[Approach, ...]:
        """Return the lanes that lead to the connections from a lane to an edge."""
        return tuple(approaches_to(from_lane, to_edge, self._upstream, APPROACH_HORIZON_M))

    @kept(_ALL)
    def _beyond(self, lane_id: str, reach: float = REACHES_BACK_M) -> tuple[str, ...]:
        """Return the lanes that begin less than `reach` m behind the start of a lane."""
        left = reach - self.lane(lane_id).spine.length
        found: list[str] = []
        for link in self._raw.leaving.get(lane_id, ()) if left > 0.0 else ():
            if not link["to"].startswith(":"):
                parts, onto = parts_of(self._raw, link), to_lane_id(link)
                rest = left - sum(self.lane(part).spine.length for part in parts)
                found += (*parts, onto, *self._beyond(onto, rest))
        return tuple(dict.fromkeys(found))

    @kept(_ALL)
    def _opposite_of(self, edge_id: str) -> str | None:
        """Return the edge that shares the carriageway in the other direction, if there is one."""
        edge = self._normal_edge(edge_id)
        back = self._raw.joining.get((edge.attrib["to"], edge.attrib["from"]), ())
        innermost = [self.lane(self._raw.lane_ids(one)[-1]) for one in (edge_id, *back)]
        found = nearest_opposite(innermost[0], [lane for lane in innermost[1:] if lane.edge_id != edge_id])
        return found.edge_id if found else None
