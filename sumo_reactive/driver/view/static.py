"""Static obstacles O_S as U₁ takes them: the borders of the roads that C follows, and points that were observed."""

from __future__ import annotations

from array import array
from bisect import bisect_left
from collections.abc import Sequence

import numpy as np

from sumo_reactive.driver.caching import PLANS_KEPT, kept
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.plan import LaneSegment, NominalPlan
from sumo_reactive.driver.nouns.state import Pose
from sumo_reactive.driver.nouns.traffic import NO_POINTS
from sumo_reactive.driver.world.borders import BORDER_STEP_M, borders
from sumo_reactive.driver.world.road_graph import RoadGraph

STATIC_REACH_M = 12.0
"""Taxicab distance up to which exact U₁ sees points of O_S: β·d/12 m is 4 % of α·d, and F moves 7 m in 0.1 s at 70 m/s."""


def static_near(
    borders: tuple[Sequence[float], Floats], s: float, pose: Pose, wheelbase: float, extra: Floats = NO_POINTS
) -> Floats:
    """Return the points of O_S (k, 2), m, near the front axle, `wheelbase` m ahead of `pose` and at `s` of C.

    Of the `borders` along C these are those beside it and up to STATIC_REACH_M ahead, of the `extra` points (m) those within
    that taxicab distance.
    """
    arcs, points = borders
    near = points[bisect_left(arcs, s - BORDER_STEP_M) : bisect_left(arcs, s + STATIC_REACH_M)]
    if not len(extra):
        return near
    away = np.abs(extra - pose.ahead(wheelbase)).sum(axis=1)
    return np.concatenate((near, extra[away < STATIC_REACH_M]))


def static_within(
    graph: RoadGraph, plan: NominalPlan, vehicle_class: str, at: tuple[float, float], side: float, extra: Floats = NO_POINTS
) -> Floats:
    """Return the points of O_S (k, 2), m, in the square window of `side` m around a place."""
    points = np.concatenate((borders_along(plan, graph, vehicle_class)[1], extra))
    inside = np.abs(points - at).max(axis=1, initial=0.0) <= 0.5 * side
    return np.asarray(points[inside])


@kept(PLANS_KEPT)
def borders_along(plan: NominalPlan, graph: RoadGraph, vehicle_class: str) -> tuple[Sequence[float], Floats]:
    """Return the border points along C: arc lengths (n), ascending, and place (n, 2), m. Junctions have none."""
    parts = [_of_segment(graph, g, vehicle_class) for g in plan.segments if not graph.lanes[g.lane_id].is_internal]
    if not parts:
        return [], NO_POINTS
    arcs, points = (np.concatenate(column) for column in zip(*parts, strict=True))
    order = np.argsort(arcs, kind="stable")
    return array("d", arcs[order]), points[order]


def _of_segment(graph: RoadGraph, segment: LaneSegment, vehicle_class: str) -> tuple[Floats, Floats]:
    """Return the border points beside one segment: arc length on C (n,), place (n, 2), m."""
    along, points = _of_lane(graph, segment.lane_id, vehicle_class)
    arcs = segment.start + (along - segment.lane_offset) * segment.stretch
    inside = (arcs >= segment.start - BORDER_STEP_M) & (arcs <= segment.end)
    return arcs[inside], points[inside]


@kept(4096)
def _of_lane(graph: RoadGraph, lane_id: str, vehicle_class: str) -> tuple[Floats, Floats]:
    """Return the border points of a lane's road: arc length on the lane's spine (n,), place (n, 2), m."""
    lane = graph.lanes[lane_id]
    points = borders(graph, lane.edge_id, vehicle_class)
    return lane.spine.arc_lengths_at(points), points
