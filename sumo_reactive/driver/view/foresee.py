"""Where the others will be if each keeps its behaviour constant: speed kept, along its lane, as its route says."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import accumulate

import numpy as np

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.polyline import Floats, Polyline, wrapped
from sumo_reactive.driver.nouns.forecast import PATH_STEP_M, Forecast
from sumo_reactive.driver.nouns.state import Pose
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.world.road_graph import RoadGraph

FORECAST_REACH_M = 300.0
"""Others are foreseen this far: 13 s at 22 m/s."""

AGAINST_LANE = -0.5
"""Cosine between a heading and the lane; who has less drives against it."""


def foresee(graph: RoadGraph, users: tuple[RoadUser, ...], duration: float) -> Forecast:
    """Return the paths of `users` for `duration` s; both branches, or all, where a route is unknown (F&L 1991, §2)."""
    ids: list[str] = []
    chunks: list[Floats] = []
    bodies: list[float] = []
    for user in users:
        for path, position in _paths_of(graph, user):
            at = min(max(int(position / PATH_STEP_M), 0), len(path) - 2)
            near = path[at : at + 3 + int(user.speed * duration / PATH_STEP_M)]
            ids.append(user.id)
            chunks.append(near)
            limit = graph.lanes[user.lane_id].speed_limit if user.lane_id else 0.0
            start = position - at * PATH_STEP_M
            bodies += (start, _beside(near[0].tolist(), user), user.speed, user.body.length, user.body.width, limit)
    if not ids:
        return NOBODY
    counts = [len(chunk) for chunk in chunks]
    first = np.array([0, *accumulate(counts[:-1])])
    return Forecast(tuple(ids), np.concatenate(chunks), first, np.array(counts), np.array(bodies).reshape(-1, 6))


NOBODY = Forecast((), np.empty((0, 3)), np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 6)))


def _paths_of(graph: RoadGraph, user: RoadUser) -> tuple[tuple[Floats, float], ...]:
    """Return the ways of a user, each with how far along it its front is, m.

    A body that stands on no lane has one, which starts at its front; who overtakes on the oncoming lane goes on along it.
    """
    lane = graph.lanes.get(user.lane_id)
    if lane is not None and math.cos(user.heading - lane.spine.heading_at(user.lane_position)) < AGAINST_LANE:
        way = _backwards(graph, user.lane_id)
        return ((way, lane.spine.length - lane.spine.project(user.x, user.y)[0]),)
    if user.lane_id or not user.is_halted:
        return tuple((path, user.lane_position) for path in paths_ahead(graph, user.lane_id, user.route[:3]))
    front = Pose(user.x, user.y, user.heading)
    return ((np.array([(*front.ahead(way), user.heading) for way in (0.0, PATH_STEP_M)]), 0.0),)


@kept(4096)
def _backwards(graph: RoadGraph, lane_id: str) -> Floats:
    """Return the way against a lane, (n, 3), from its end on: x, y, heading every PATH_STEP_M."""
    return Polyline(graph.lanes[lane_id].spine.points[::-1]).sampled(PATH_STEP_M)


@kept(4096)
def paths_ahead(graph: RoadGraph, lane_id: str, edges: tuple[str, ...]) -> tuple[Floats, ...]:
    """Return each way on from the start of a lane, (n, 3): x, y, heading every PATH_STEP_M.

    `edges` are the next ones of the route (empty: unknown, every way out counts). None for lanes outside `graph`.
    """
    lane = graph.lanes.get(lane_id)
    if lane is None:
        return ()
    return tuple(Polyline(np.vstack(chunks)).sampled(PATH_STEP_M) for chunks in _lines(graph, lane_id, edges))


def turn_rate(graph: RoadGraph, user: RoadUser, duration: float) -> float:
    """Return how fast a vehicle turns on average over the next `duration` s along its lane, rad/s: as much as on each of the
    ways that it may take, not at all where they part to both sides.

    Both ends of its body keep to the lane, as those of SUMO's do.
    """
    ways, at, length = paths_ahead(graph, user.lane_id, user.route[:3]), user.lane_position, user.body.turning_length
    turns = [turned(way, at, user.speed * duration, user.heading, length) for way in ways]
    if len(turns) == 1:
        return turns[0] / duration
    least = min(turns, key=abs, default=0.0)
    return least / duration if all(turn * least > 0.0 for turn in turns) else 0.0


def places_after(graph: RoadGraph, user: RoadUser, time: float) -> list[tuple[float, ...]]:
    """Return the boxes (front x, y, heading, speed, length, width) of a user who keeps its speed for `time` s: on each way
    that it may take, as far left of it as now, and straight on."""
    way, at, length = user.speed * time, user.lane_position, user.body.turning_length
    rest = (user.speed, user.body.length, user.body.width)
    c, s = math.cos(user.heading), math.sin(user.heading)
    places: list[tuple[float, ...]] = [(user.x + way * c, user.y + way * s, user.heading, *rest)]
    for path in paths_ahead(graph, user.lane_id, user.route[:3]):
        heading = user.heading + turned(path, at, way, user.heading, length)
        (px, py), (x, y) = point_at(path, at), point_at(path, at + way)
        aside = (user.y - py) * c - (user.x - px) * s
        places.append((x - aside * math.sin(heading), y + aside * math.cos(heading), heading, *rest))
    return places


def way_left(graph: RoadGraph, user: RoadUser) -> float:
    """Return the way (m) to where a vehicle leaves the road: the end of the last lane of its route, else infinite."""
    lane = graph.lanes.get(user.lane_id) if len(user.route) == 1 else None
    if lane is None or lane.edge_id != user.route[0]:
        return math.inf
    return max(lane.spine.length - user.lane_position, 0.0)


@kernel
def turned(path: Floats, front: float, way: float, heading: float, length: float) -> float:
    """Return by how much (rad) a body of that `heading` and `length` (m) turns while its front drives `way` m along a path.

    Its front is `front` m from the start of the path. A rear that is not on the path yet comes to its start straight from
    where it is.
    """
    way = min(way, (len(path) - 1) * PATH_STEP_M - front)
    if way <= 0.0:
        return 0.0
    fx, fy = point_at(path, front + way)
    behind = front + way - length
    if behind >= 0.0:
        rx, ry = point_at(path, behind)
    else:
        x, y = point_at(path, front)
        rx, ry = x - length * math.cos(heading), y - length * math.sin(heading)
        share = way / (length - front)
        rx, ry = rx + share * (path[0, 0] - rx), ry + share * (path[0, 1] - ry)
    return wrapped(math.atan2(fy - ry, fx - rx) - heading)


@kernel
def point_at(path: Floats, s: float) -> tuple[float, float]:
    """Return the point (m) at arc length `s` of a path, between the samples next to it."""
    u = s / PATH_STEP_M
    i = min(max(int(u), 0), len(path) - 2)
    share = min(max(u - i, 0.0), 1.0)
    return path[i, 0] + share * (path[i + 1, 0] - path[i, 0]), path[i, 1] + share * (path[i + 1, 1] - path[i, 1])


def _lines(graph: RoadGraph, lane_id: str, edges: tuple[str, ...]) -> Iterator[list[Floats]]:
    spine, own = graph.lanes[lane_id].spine, graph.connection_of.get(lane_id)
    if own is not None and not own.is_crossing:
        lanes = [lane for lane, _ in graph.lanes_behind(own) if lane in graph.lanes]
        yield [graph.lanes[lane].spine.points for lane in lanes[lanes.index(lane_id) :]]
        return
    ways = () if spine.length > FORECAST_REACH_M or own is not None else graph.ways_from(lane_id)
    targets = {way.id: graph.lanes.get(way.to_lane) for way in ways if not way.is_crossing}
    behind = [
        [graph.lanes[lane].spine.points for lane, _ in graph.lanes_behind(way)]
        for way in ways
        if (target := targets.get(way.id)) is not None and (not edges or target.edge_id in edges[1:2])
    ]
    yield from ([spine.points, *way] for way in behind or [[]])


def _beside(point: Sequence[float], user: RoadUser) -> float:
    """How far left of a point (x, y, heading) of its path the user's front is, m."""
    x, y, heading = point
    return (user.y - y) * math.cos(heading) - (user.x - x) * math.sin(heading)
