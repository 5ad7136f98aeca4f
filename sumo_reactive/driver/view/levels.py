"""Bridges: lanes that cross C and that no junction joins to it are on another level, and nobody there is an obstacle."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import shapely

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.traffic import RoadUser, Traffic
from sumo_reactive.driver.world.lane import CROSSING_SINE, Lane
from sumo_reactive.driver.world.road_graph import RoadGraph

COMING_M, GONE_M = 60.0, 10.0
"""Who is this near before the crossing, or with his rear this near behind it, might be taken for one who meets the ego."""


def on_its_level(traffic: Traffic, crossed: Mapping[str, tuple[float, ...]]) -> tuple[Sequence[RoadUser], Floats]:
    """Return the users of `traffic` whom the ego may meet, with their boxes (n, 6): all but those who pass it on a bridge or
    below one, wholly on their lane, one of those `crossed`."""
    users, boxes = traffic.users, traffic.boxes
    others = {k for k, user in enumerate(users) if user.lane_id in crossed and _passes_on_another(user, crossed)}
    if not others:
        return users, boxes
    met = [k for k in range(len(users)) if k not in others]
    return [users[k] for k in met], boxes[met]


def _passes_on_another(user: RoadUser, crossed: Mapping[str, tuple[float, ...]]) -> bool:
    front, rear = user.lane_position, user.lane_position - user.body.length
    return rear >= 0.0 and any(front > at - COMING_M and rear < at + GONE_M for at in crossed[user.lane_id])


def lanes_crossed(plan: NominalPlan, graph: RoadGraph) -> Mapping[str, tuple[float, ...]]:
    """Return where lanes cross C on another level, by lane id, m of their spines."""
    curve, found = plan.curve, dict[str, tuple[float, ...]]()
    points, last = np.column_stack((curve.x, curve.y)), len(curve.x) - 1
    ends = [min(int(segment.start / curve.step) + 1, last) for segment in plan.segments[1:]]
    for segment, end in zip(plan.segments, (*ends, last), strict=True):
        first, own = max(int(segment.start / curve.step), 0), graph.lanes[segment.lane_id]
        if first >= end:
            continue
        way = shapely.linestrings(points[first : end + 1])
        for lane in graph.lanes_crossing(way):
            if own.edge_id != lane.edge_id and not _junctions(graph, own) & _junctions(graph, lane):
                places = tuple(_places_across(way, curve.heading[first:], curve.step, lane))
                if places:
                    found[lane.id] = (*found.get(lane.id, ()), *places)
    return found


def _places_across(way: shapely.LineString, headings: Floats, step: float, lane: Lane) -> Iterator[float]:
    """Yield where a lane leads across a part of C, which has its `headings` (rad) every `step` m, m of the lane's spine."""
    met = shapely.intersection(way, shapely.linestrings(lane.spine.points))
    for x, y in shapely.get_coordinates(met).tolist():
        at = lane.spine.project(x, y)[0]
        heading = headings[round(way.project(shapely.Point(x, y)) / step)]
        if abs(math.sin(lane.spine.heading_at(at) - heading)) > CROSSING_SINE:
            yield at


@kept(4096)
def _junctions_of(graph: RoadGraph, lane_id: str) -> frozenset[str]:
    return frozenset(way.junction_id for way in (*graph.ways_from(lane_id), *graph.ways_into(lane_id)))


def _junctions(graph: RoadGraph, lane: Lane) -> frozenset[str]:
    """Return the junctions of the route that a lane joins."""
    return frozenset((graph.connection_of[lane.id].junction_id,)) if lane.is_internal else _junctions_of(graph, lane.id)
