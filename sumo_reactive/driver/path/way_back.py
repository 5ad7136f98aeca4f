"""Where a route leads back beside the way it comes from, and what road there is to turn round on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.geometry.curve import CURVE_STEP_M
from sumo_reactive.driver.geometry.polyline import Polyline, joined, wrapped
from sumo_reactive.driver.path.turning import U_TURN_RAD
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.junction import Connection
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph

TURNAROUNDS_KEPT = 1024
"""What is worked out once is kept for so many ways back."""

BETWEEN_M = 1.0
"""Junctions this near to each other are one to who turns round."""

STUB_LENGTHS = 2.0
"""A road shorter than so many lengths of the car is too short to turn round on it alone."""


class Around(NamedTuple):
    """The lanes that the route takes before and behind a way back, in driving order, and the `apron`: a connection behind
    them, by its id, with how far the front may reach into it, m."""

    before: tuple[str, ...] = ()
    behind: tuple[str, ...] = ()
    apron: tuple[str, float] | None = None


class WayBack(NamedTuple):
    """Where a turn leads from lane `own` to lane `behind` over `parts`, the lanes in between, along `path`; `hold_back` m
    before the end of its own lane it waits."""

    own: Lane
    behind: Lane
    parts: tuple[str, ...]
    path: Polyline
    hold_back: float

    @property
    def turned(self) -> float:
        """By how much it turns, rad."""
        ways = np.diff(self.path.points, axis=0)
        ends = self.own.spine.heading_at(self.own.spine.length), self.behind.spine.heading_at(0.0)
        headings = np.unwrap([ends[0], *np.arctan2(ways[:, 1], ways[:, 0]), ends[1]])
        return float(headings[-1] - headings[0])


def way_over(graph: RoadGraph, connection_ids: Sequence[str]) -> WayBack:
    """Return the way over connections that follow each other."""
    ways = [graph.connections[one] for one in connection_ids]
    between = [way.to_lane for way in ways[:-1]]
    parts = [name for way, lane in zip(ways, (*between, ""), strict=True) for name in (*way.parts, lane) if name]
    chains = [part for way in ways for part in (way.path.points, graph.lanes[way.to_lane].spine.points)][:-1]
    own, behind = graph.lanes[ways[0].from_lane], graph.lanes[ways[-1].to_lane]
    return WayBack(own, behind, tuple(parts), Polyline(joined(chains)), ways[0].hold_back)


@kept(TURNAROUNDS_KEPT)
def leads_back(graph: RoadGraph, connection_ids: tuple[str, ...]) -> bool:
    """Whether connections that follow each other lead back beside the way they come from."""
    return abs(wrapped(way_over(graph, connection_ids).turned)) >= U_TURN_RAD


def ways_back(
    graph: RoadGraph, passages: Sequence[tuple[Connection, float, float]]
) -> Iterator[tuple[tuple[str, ...], float, float]]:
    """Yield the connections of each way back among `passages` (connection, where it begins and ends, m), and where it begins
    and ends: one, or several with hardly any road in between."""
    first = 0
    while first < len(passages):
        last, found = first + 1, False
        while not (found := leads_back(graph, tuple(way.id for way, *_ in passages[first:last]))):
            if last == len(passages) or passages[last][1] - passages[last - 1][2] > BETWEEN_M:
                break
            last += 1
        if found:
            yield tuple(way.id for way, *_ in passages[first:last]), passages[first][1], passages[last - 1][2]
        first = last if found else first + 1


def road_around(
    graph: RoadGraph, connection_ids: tuple[str, ...], edges: Sequence[str], index: int, limits: VehicleLimits
) -> Around:
    """Return what a route over `edges` takes before and behind a way back from `edges[index]`, where the roads that it joins
    are too short to turn round on: as far as nobody is yielded to and no light waited for in between."""
    way, onward = way_over(graph, connection_ids), edges[index + 1 + len(connection_ids) :]
    before, _ = _lanes_on(graph, way.own.id, edges[:index][::-1], -1, limits)
    behind, is_short = _lanes_on(graph, way.behind.id, onward, 1, limits)
    reached = sum(graph.lanes[name].edge_id in onward for name in behind)
    apron = _apron(graph, (way.behind.id, *behind)[-1], onward[reached : reached + 1]) if is_short else None
    return Around(before[::-1], behind, apron)


def _lanes_on(
    graph: RoadGraph, lane_id: str, edges: Sequence[str], step: int, limits: VehicleLimits
) -> tuple[tuple[str, ...], bool]:
    """Return the lanes over `edges` that follow on a lane (`step` 1) or come before it (−1), as far as needed to turn, and
    whether more would be needed."""
    found, reach = list[str](), graph.lanes[lane_id].spine.length
    needed = STUB_LENGTHS * limits.length
    for edge_id in edges:
        ways = (graph.ways_from if step > 0 else graph.ways_into)(lane_id)
        onward = _joining(graph, ways, edge_id, step) if reach < needed else None
        if onward is None:
            break
        lane_id = onward.to_lane if step > 0 else onward.from_lane
        found += (*onward.parts[::step], lane_id)
        reach += graph.lanes[lane_id].spine.length
    return tuple(found), reach < needed


def _apron(graph: RoadGraph, lane_id: str, edges: Sequence[str]) -> tuple[str, float] | None:
    """Return the connection from a lane to the next of `edges`, straight on where there is none, and how far it leads before
    somebody has to be yielded to, m; None: there is none, or a light."""
    ways = [way for way in graph.ways_from(lane_id) if way.to_lane in graph.lanes]
    ways = [way for way in ways if not edges or graph.lanes[way.to_lane].edge_id in edges]
    way = min(ways, key=lambda one: abs(one.path.heading_at(one.path.length) - one.path.heading_at(0.0)), default=None)
    if way is None or way.light is not None:
        return None
    rule = graph.junctions[way.junction_id].right_of_way
    regions = [(one.own.start, graph.connections[one.other_id].index) for one in graph.regions_on(way)]
    length = min([start for start, other in regions if rule.must_yield(way.index, other)], default=way.path.length)
    return (way.id, length) if length > CURVE_STEP_M else None


def _joining(graph: RoadGraph, ways: Sequence[Connection], edge_id: str, step: int) -> Connection | None:
    """Return the one of `ways` that leads to (`step` 1) or comes from (−1) an edge, if who takes it goes first there."""
    for way in ways:
        lane = graph.lanes.get(way.to_lane if step > 0 else way.from_lane)
        if lane is not None and lane.edge_id == edge_id and way.light is None:
            rule, regions = graph.junctions[way.junction_id].right_of_way, graph.regions_on(way)
            if not any(rule.must_yield(way.index, graph.connections[region.other_id].index) for region in regions):
                return way
    return None
