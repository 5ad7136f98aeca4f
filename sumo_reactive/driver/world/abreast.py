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
from sumo_reactive.driver.parameters import ABREAST_M, HOLD_BACK_REACH_M, SIDE_BY_SIDE_ANGLE
from sumo_reactive.driver.world.junction import Connection
from sumo_reactive.driver.world.road_graph import RoadGraph

_CUT_STEP_M = 1.0
"""A long body's chord is drawn this often along its way."""


class Abreast(NamedTuple):
    """Traffic on `connection` drives abreast of the ego's; `way` is its path and the start of the lane behind it."""

    connection: Connection
    way: Polyline


@kept(4096)
def abreast_of(graph: RoadGraph, connection_id: str) -> tuple[Abreast, ...]:
    """Return whose ways come nearer than ABREAST_M to the way of a connection, from other lanes of its road to other lanes.

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
        if _nearest(line, way) < ABREAST_M:
            found.append(Abreast(other, Polyline(way)))
    return tuple(found)


def beside(way: Polyline, places: Points) -> Floats:
    """Return how far left of a way each of `places` (n, 2) is, (n,), m; infinite where the way is not beside it."""
    s = way.arc_lengths_at(places)
    return np.where((s > 0.0) & (s < way.length), way.offsets(places), np.inf)


@kept(64)
def cut_by(way: Polyline, length: float) -> tuple[float, float]:
    """Return how far (m) to the left and to the right of a way the middle of a body of `length` m comes that is drawn
    straight from its front to its rear on it: into left and into right bends."""
    fronts = np.arange(0.0, way.length + _CUT_STEP_M, _CUT_STEP_M)
    front, middle, rear = (_prolonged(way, fronts - behind) for behind in (0.0, 0.5 * length, length))
    inside = way.offsets(0.5 * (front + rear)) - way.offsets(middle)
    return max(float(inside.max()), 0.0), max(float(-inside.min()), 0.0)


def _prolonged(way: Polyline, s: Floats) -> Points:
    """Return the points (n, 2) at arc lengths `s` (n,), m, of a way that comes straight to its start."""
    heading = way.heading_at(0.0)
    ahead = np.array([math.cos(heading), math.sin(heading)])
    return way.points_at(s) + np.minimum(s, 0.0)[:, None] * ahead


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
