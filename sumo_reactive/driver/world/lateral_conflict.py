"""Ways from neighbour lanes of one road through a junction that come nearer to each other than the lanes are apart."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import shapely

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.geometry.polyline import Floats, Points, Polyline, cut, joined
from sumo_reactive.driver.world.junction import HOLD_BACK_REACH_M, Connection
from sumo_reactive.driver.world.road_graph import RoadGraph

LATERAL_CONFLICT_M = 2.8
"""Two bodies of up to 2.5 m need this between the middles of their ways to pass each other 0.3 m apart."""

SIDE_BY_SIDE_ANGLE = 0.6
"""rad; paths from one road that meet at a smaller angle run beside each other."""


class LateralConflict(NamedTuple):
    """Traffic on `connection` drives beside the ego's, too near; `way` is its path and the start of the lane behind it."""

    connection: Connection
    way: Polyline


@kept(4096)
def lateral_conflicts(graph: RoadGraph, connection_id: str) -> tuple[LateralConflict, ...]:
    """Return whose ways come nearer than LATERAL_CONFLICT_M to that of a connection, from and to other lanes of its road.

    Pairs that the network calls conflicting have rules; where it calls them free, SUMO's cars do not look at each other.
    """
    own = graph.connections[connection_id]
    junction, line = graph.junctions[own.junction_id], _way(graph, own)
    found = []
    for other in junction.connections:
        declared = junction.right_of_way.in_conflict(own.index, other.index)
        if declared or not _drives_beside(graph, own, other):
            continue
        way = _way(graph, other)
        if _nearest(line, way) < LATERAL_CONFLICT_M:
            found.append(LateralConflict(other, Polyline(way)))
    return tuple(found)


def beside(way: Polyline, places: Points) -> Floats:
    """Return how far left of a way each of `places` (n, 2) is, (n,), m; infinite where the way is not beside it."""
    s = way.arc_lengths_at(places)
    return np.where((s > 0.0) & (s < way.length), way.offsets(places), np.inf)


def _drives_beside(graph: RoadGraph, own: Connection, other: Connection) -> bool:
    """Whether a connection leads from another lane of the same road to another lane, in about the same direction."""
    if other.is_crossing or own.from_lane == other.from_lane or own.to_lane == other.to_lane:
        return False
    before, beside = graph.lanes.get(own.from_lane), graph.lanes.get(other.from_lane)
    if before is None or beside is None or before.edge_id != beside.edge_id or not before.allowed & beside.allowed:
        return False
    along, across = (c.path.heading_at(c.path.length) for c in (own, other))
    return math.cos(along - across) > math.cos(SIDE_BY_SIDE_ANGLE)


def _way(graph: RoadGraph, connection: Connection) -> Points:
    behind = graph.lanes[connection.to_lane].spine
    return joined([connection.path.points, cut(behind, 0.0, min(behind.length, HOLD_BACK_REACH_M))])


def _nearest(line: Points, way: Points) -> float:
    return float(shapely.linestrings(line).distance(shapely.linestrings(np.ascontiguousarray(way))))
