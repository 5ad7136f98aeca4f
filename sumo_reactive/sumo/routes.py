"""Routes as SUMO has them: its own quickest way, the lanes on which it does not look for the ego, places passed twice."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise

import libsumo
import numpy as np
import shapely
from scipy.spatial import KDTree

from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.sumo.net_file import edge_id_of
from sumo_reactive.sumo.orders import AT_ONCE, Tell

PLACE_STEP_M = 1.0
"""Roads that lie over each other are looked for at such steps along them…"""
ALONG_M = 10.0
"""…where there is more way than this between the two."""


def unmapped_lanes(graph: RoadGraph, edges: Sequence[str]) -> frozenset[str]:
    """Return the internal lanes of all ways between two consecutive `edges` but the first, by their ids.

    Where several internal edges join the same two edges (two lanes fork to both sides, or two turn beside each other),
    SUMO looks for a vehicle that keeps its route on one of them only.
    """
    return frozenset(lane_id for before, behind in pairwise(edges) for lane_id in _beside_the_first(graph, before, behind))


def _beside_the_first(graph: RoadGraph, before: str, behind: str) -> list[str]:
    ways = [
        connection.parts
        for lane in graph.edge_lanes.get(before, ())
        for connection in graph.ways_from(lane.id)
        if connection.parts and graph.lanes[connection.to_lane].edge_id == behind
    ]
    known = {graph.lanes[part].edge_id for part in ways[0]} if ways else set()
    return [part for way in ways[1:] for part in way if graph.lanes[part].edge_id not in known]


def quickest_way(vehicle_id: str, firsts: Iterable[str], goals: Sequence[str], tell: Tell = AT_ONCE) -> tuple[str, ...]:
    """Return the edges of the quickest way from one of the edges `firsts` by all `goals` in order; empty: there is none.

    SUMO draws a number for each answer, which changes what it draws next: others with the same simulation ask it as often.
    """
    ways = [way for first in dict.fromkeys(firsts) if (way := _through(vehicle_id, (first, *goals), tell))]
    return min(ways, key=lambda way: way[1], default=((), 0.0))[0]


def _through(vehicle_id: str, places: Sequence[str], tell: Tell) -> tuple[tuple[str, ...], float] | None:
    """Return edges and travel time (s) from place to place; None where a leg has no way.

    Asked for the type that a vehicle has for itself alone, SUMO forgets that type with its answer, and the vehicle that has
    it brings SUMO down later: it is asked for the type from which that was made.
    """
    way, time = list(places[:1]), 0.0
    now, kind = libsumo.simulation.getTime(), libsumo.vehicle.getTypeID(vehicle_id).removesuffix(f"@{vehicle_id}")
    for start, goal in pairwise(places):
        if start == goal:
            continue
        tell.elsewhere(_ask_for, start, goal, kind, now)
        try:
            leg = libsumo.simulation.findRoute(start, goal, kind, now)
        except libsumo.TraCIException:
            return None
        if not leg.edges:
            return None
        way += leg.edges[1:]
        time += float(leg.travelTime)
    return tuple(way), time


def crossed_before(graph: RoadGraph, edges: Sequence[str]) -> tuple[int, ...]:
    """Return, for each of the consecutive `edges`, the index of the last one before that it crosses or lies over, on another
    level, the ways to the next edge included; −1: none. The one directly before counts where it winds over that."""
    lines = []
    for edge, behind in zip(edges, (*edges[1:], ""), strict=True):
        lanes = graph.edge_lanes.get(edge, ())
        ways = [way for lane in lanes for way in graph.ways_from(lane.id) if edge_id_of(way.to_lane) == behind]
        driven = [*(lane.spine.points for lane in lanes), *(way.path.points for way in ways)]
        lines.append(shapely.multilinestrings([shapely.linestrings(one) for one in driven]))
    crossed = [-1] * len(lines)
    meetings = shapely.STRtree(lines).query(lines, predicate="intersects").T
    for last, first in [*meetings[meetings[:, 1] < meetings[:, 0] - 1].tolist(), *_lying_over(graph, edges)]:
        crossed[last] = max(crossed[last], first)
    return tuple(crossed)


def _lying_over(graph: RoadGraph, edges: Sequence[str]) -> list[tuple[int, int]]:
    """Return which of the `edges` pass by an earlier one, within half a lane's width, much farther along the route."""
    owners, places, arcs, arc, widest = [], [], [], 0.0, 0.0
    for number, edge in enumerate(edges):
        beside = graph.edge_lanes.get(edge, ())
        for lane in beside:
            points = lane.spine.sampled(PLACE_STEP_M)[:, :2]
            places.append(points)
            owners.append(np.full(len(points), number))
            arcs.append(arc + PLACE_STEP_M * np.arange(len(points)))
        arc += max((lane.spine.length for lane in beside), default=0.0)
        widest = max((widest, *(lane.width for lane in beside)))
    if not places:
        return []
    pairs = KDTree(np.vstack(places)).query_pairs(0.5 * widest, output_type="ndarray")
    own, way = np.concatenate(owners)[pairs], np.concatenate(arcs)[pairs]
    far = (own[:, 0] != own[:, 1]) & (np.abs(way[:, 0] - way[:, 1]) > ALONG_M)
    return [(max(pair), min(pair)) for pair in set(map(tuple, own[far].tolist()))]


def told_lanes(graph: RoadGraph, edges: Sequence[str], crossed: Sequence[int]) -> frozenset[str]:
    """Return the lanes along a route that SUMO is told when the ego is on them, by their ids: it would not find it there, or
    one loop ahead on a ramp that winds over itself. `crossed`: see `crossed_before`."""
    below = (graph.edge_lanes[edges[i]] for i in range(len(edges) - 1) if crossed[i + 1] == i)
    return unmapped_lanes(graph, edges) | {lane.id for lanes in below for lane in lanes}


class RouteWindow:
    """Keeps SUMO's route of the ego free of places that it passes twice: SUMO maps a moved vehicle to any pass of a place,
    so it gets to know only the present one.

    A place is an edge, a junction, or where an edge crosses or lies over an earlier one (`crossed`: see `crossed_before`).
    `number`: which route of the ego's this is, for SUMO keeps the names of all. SUMO is told by `tell`.
    """

    def __init__(
        self, ego_id: str, edges: tuple[str, ...], end_of: Callable[[str], str], crossed: Sequence[int], number: int = 1,
        tell: Tell = AT_ONCE,
    ) -> None:  # fmt: skip
        self._ego_id, self._edges, self._number, self._crossed, self._tell = ego_id, edges, number, crossed, tell
        self._ends = tuple(end_of(edge) for edge in edges)
        occurs_twice = len(set(edges)) < len(edges) or len(set(self._ends)) < len(self._ends)
        self._needed = occurs_twice or any(index >= 0 for index in crossed)
        self._index = -1
        self._added: set[str] = set()

    def follow(self, index: int) -> None:
        """Show SUMO the route from edge `index` on, up to where it would come to the same place again.

        SUMO takes a route only on one of its edges; where roads are shorter than a step or the car, it may still count the
        ego on the one before. Then the next step shows it.
        """
        if not self._needed or index == self._index or libsumo.vehicle.getRoadID(self._ego_id) != self._edges[index]:
            return
        last = index + 1
        while last < len(self._edges) and not self._returns(index, last):
            last += 1
        name = f"reactive.route.{self._ego_id}.{self._number}.{index}"
        if name not in self._added:
            self._tell(_add_route, name, self._edges[index:last])
            self._added.add(name)
        self._index = index
        self._tell(_set_route, self._ego_id, name, failed=self._is_refused)

    def _is_refused(self) -> None:
        self._index = -1

    def _returns(self, first: int, last: int) -> bool:
        """Whether edge `last`, its end or a place on it has been passed since edge `first`, which it may wind over."""
        earlier = slice(first, last)
        is_twice = self._edges[last] in self._edges[earlier] or self._ends[last] in self._ends[earlier]
        return is_twice or (last > first + 1 and self._crossed[last] >= first)


def _ask_for(start: str, goal: str, kind: str, now: float) -> None:
    with contextlib.suppress(libsumo.TraCIException):
        libsumo.simulation.findRoute(start, goal, kind, now)


def _add_route(name: str, edges: tuple[str, ...]) -> None:
    libsumo.route.add(name, edges)


def _set_route(vehicle_id: str, name: str) -> None:
    libsumo.vehicle.setRouteID(vehicle_id, name)
