"""Bridges: lanes that cross C and that no junction joins to it are on another level, and nobody there is an obstacle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import shapely

from sumo_reactive.driver.caching import PLANS_KEPT, kept
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.traffic import RoadUser, Traffic
from sumo_reactive.driver.world.lane import CROSSING_SINE, Lane
from sumo_reactive.driver.world.road_graph import RoadGraph

COMING_M, GONE_M = 60.0, 10.0
"""Who is this near before the crossing, or with his rear this near behind it, might be taken for one who meets the ego."""


def on_its_level(traffic: Traffic, plan: NominalPlan, graph: RoadGraph) -> tuple[Sequence[RoadUser], Floats]:
    """Return the users of `traffic` whom the ego may meet, with their boxes (n, 6): all but those who pass it on a bridge or
    below one, wholly on their lane."""
    users, boxes = traffic.users, traffic.boxes
    crossed = _crossed(plan, graph) if users else {}
    if not crossed:
        return users, boxes
    met = [k for k, user in enumerate(users) if not _passes_on_another(user, crossed.get(user.lane_id, ()))]
    return (users, boxes) if len(met) == len(users) else ([users[k] for k in met], boxes[met])


def _passes_on_another(user: RoadUser, places: Sequence[float]) -> bool:
    front, rear = user.lane_position, user.lane_position - user.body.length
    return rear >= 0.0 and any(front > at - COMING_M and rear < at + GONE_M for at in places)


@kept(PLANS_KEPT)
def _crossed(plan: NominalPlan, graph: RoadGraph) -> Mapping[str, tuple[float, ...]]:
    """Return where lanes cross C on another level, by lane id, m of their spines."""
    way = shapely.linestrings(np.column_stack((plan.curve.x, plan.curve.y)))
    found: dict[str, tuple[float, ...]] = {}
    for lane in graph.lanes_crossing(way):
        met = shapely.get_coordinates(shapely.intersection(way, shapely.linestrings(lane.spine.points)))
        places = tuple(at for x, y in met.tolist() if (at := _crossed_on_another(plan, graph, lane, x, y)) is not None)
        if places:
            found[lane.id] = places
    return found


def _crossed_on_another(plan: NominalPlan, graph: RoadGraph, lane: Lane, x: float, y: float) -> float | None:
    """Return where a lane crosses C at (x, y), m of its spine; None: on the level of C, or hardly across it."""
    curve, at = plan.curve, lane.spine.project(x, y)[0]
    k = int(np.argmin((curve.x - x) ** 2 + (curve.y - y) ** 2))
    here = next((one for one in plan.segments if one.start <= k * curve.step < one.end), plan.segments[-1])
    own = graph.lanes[here.lane_id]
    is_joined = own.edge_id == lane.edge_id or _junctions(graph, own) & _junctions(graph, lane)
    is_across = abs(np.sin(lane.spine.heading_at(at) - curve.heading[k])) > CROSSING_SINE
    return at if is_across and not is_joined else None


@kept(4096)
def _junctions_of(graph: RoadGraph, lane_id: str) -> frozenset[str]:
    return frozenset(way.junction_id for way in (*graph.ways_from(lane_id), *graph.ways_into(lane_id)))


def _junctions(graph: RoadGraph, lane: Lane) -> frozenset[str]:
    """Return the junctions of the route that a lane joins."""
    return frozenset((graph.connection_of[lane.id].junction_id,)) if lane.is_internal else _junctions_of(graph, lane.id)
