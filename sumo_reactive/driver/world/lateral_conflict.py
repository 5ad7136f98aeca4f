"""Ways from neighbour lanes of one road through a junction that come nearer to each other than bodies on them are wide.

A long body is straight: in a bend its middle is as far inside of its way as the chord from its front to its rear.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import shapely

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.geometry.polyline import Floats, Points, Polyline, cut, joined
from sumo_reactive.driver.world.junction import HOLD_BACK_REACH_M, Connection
from sumo_reactive.driver.world.road_graph import RoadGraph

LATERAL_CONFLICT_M = 4.5
"""Two bodies of up to 2.5 m need 2.8 m between the middles of their ways to pass each other 0.3 m apart, and a long one in a
tight turn 1.7 m more."""

SIDE_BY_SIDE_ANGLE = 0.6
"""rad; paths from one road that meet at a smaller angle run beside each other."""

_CHORD_STEP_M = 1.0
"""A long body's chord is drawn this often along its way."""


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


@kept(64)
def off_tracking_on(way: Polyline, length: float) -> tuple[float, float]:
    """Return how far (m) to the left and to the right of a way the middle of a body of `length` m comes that is straight
    from its front to its rear on it: into left and into right bends."""
    fronts = np.arange(0.0, way.length + _CHORD_STEP_M, _CHORD_STEP_M)
    front, middle, rear = (_prolonged(way, fronts - behind) for behind in (0.0, 0.5 * length, length))
    inside = way.offsets(0.5 * (front + rear)) - way.offsets(middle)
    return max(float(inside.max()), 0.0), max(float(-inside.min()), 0.0)


def _prolonged(way: Polyline, s: Floats) -> Points:
    """Return the points (n, 2) at arc lengths `s` (n,), m, of a way that comes straight to its start."""
    heading = way.heading_at(0.0)
    ahead = np.array([math.cos(heading), math.sin(heading)])
    found: Points = way.points_at(s) + np.minimum(s, 0.0)[:, None] * ahead
    return found


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
