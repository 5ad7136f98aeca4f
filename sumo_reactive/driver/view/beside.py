"""The lanes beside C to which the ego might move aside: its road's own, and the oncoming one."""

from __future__ import annotations

from collections.abc import Iterator

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.nouns.forecast import LaneBeside
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.opposite import separation
from sumo_reactive.driver.world.road_graph import RoadGraph

CAR = "passenger"
"""SUMO's class of ordinary cars."""


def lanes_beside(graph: RoadGraph, plan: NominalPlan, front: float, reach: float) -> Iterator[LaneBeside]:
    """Yield the lanes on the side to overtake on, along C from `front` m on for `reach` m."""
    for segment in plan.segments:
        if segment.end > front and segment.start < front + reach and not segment.lane_id.startswith(":"):
            beside = _beside(graph, segment.lane_id)
            if beside is not None:
                lane, away, is_oncoming = beside
                yield LaneBeside(lane.id, segment.start, segment.end, away, lane.width, lane.speed_limit, is_oncoming)


@kept(4096)
def _beside(graph: RoadGraph, lane_id: str) -> tuple[Lane, float, bool] | None:
    """Return the lane beside, how far to the left its centre is (m), and whether its traffic comes towards the ego."""
    side = -1.0 if graph.left_hand else 1.0
    lane = graph.lanes[lane_id]
    left, right = graph.neighbours(lane_id)
    inner = right if graph.left_hand else left
    if inner is not None and _usable(lane, inner):
        return inner, side * 0.5 * (lane.width + inner.width), False
    oncoming = graph.edge_lanes.get(graph.opposite.get(lane.edge_id, ""), ())
    if inner is not None or not oncoming or not _usable(lane, oncoming[-1]):
        return None
    other = oncoming[-1]
    return other, side * (0.5 * (lane.width + other.width) + max(separation(lane, other), 0.0)), True


def _usable(lane: Lane, other: Lane) -> bool:
    """Whether the cars of a lane may use the other."""
    return CAR in other.allowed if CAR in lane.allowed else bool(lane.allowed & other.allowed)
