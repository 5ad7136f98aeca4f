"""Another way to the goal, for an ego that cannot get onto the lane that its route turns off from."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from sumo_reactive.driver.nouns.plan import LaneSegment
from sumo_reactive.driver.parameters import CREEPING_SPEED
from sumo_reactive.driver.path.lane_choice import LaneChoice, choose_lanes
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route, ScheduledStop
from sumo_reactive.sumo.net_file import edge_id_of
from sumo_reactive.sumo.net_reader import WorldSource
from sumo_reactive.sumo.routes import quickest_way


class WayRound(NamedTuple):
    """A new route from the ego's edge on, the world around it, its lane outlooks, and how much longer it takes, s.

    `missed`: the edge that the old route turned to.
    """

    route: Route
    graph: RoadGraph
    choice: LaneChoice
    longer: float
    missed: str


def way_round(
    ego_id: str, net: WorldSource, choice: LaneChoice, route: Route, here: LaneSegment, served: Sequence[ScheduledStop]
) -> WayRound | None:
    """Return the quickest other way to the end of `route` that lane `here` leads to without a change; None: no such way.

    It passes the stops of the route that are not `served` yet.
    """
    graph, index = choice.graph, here.route_index
    lane = graph.lanes[here.lane_id]
    stops = tuple(stop for stop in route.stops if stop not in served)
    goals = [*(edge_id_of(stop.lane_id) for stop in stops), route.edges[-1]]
    if lane.is_internal or index + 1 >= len(route.edges) or lane.edge_id in goals[:-1]:
        return None
    missed = route.edges[index + 1]
    onward = [c.to_lane for c in graph.outgoing.get(lane.id, ()) if graph.lanes[c.to_lane].allows(choice.vehicle_class)]
    way = quickest_way(ego_id, (edge for edge in map(edge_id_of, onward) if edge != missed), goals)
    if not way:
        return None
    new = Route((lane.edge_id, *way), route.arrival_position, route.arrival_lane, stops)
    world = net.build(new.edges)
    lanes = choose_lanes(world, new, choice.vehicle_class)
    if lanes.onward[0][lane.index].cost == math.inf:
        return None
    longer = _duration(world, new.edges) - _duration(graph, route.edges[index:])
    return WayRound(new, world, lanes, longer, missed)


def _duration(graph: RoadGraph, edges: Sequence[str]) -> float:
    """Return the time that a free drive along `edges` takes, s."""
    return sum(lane.length / max(lane.speed_limit, CREEPING_SPEED) for lane, *_ in map(graph.edge_lanes.__getitem__, edges))
