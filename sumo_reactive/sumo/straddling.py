"""Which lane the ego's body covers besides the one that SUMO maps it to."""

from __future__ import annotations

from sumo_reactive.messages.plan import NominalPlan
from sumo_reactive.parameters import STRADDLE_M
from sumo_reactive.vehicle.limits import VehicleLimits
from sumo_reactive.world.lane import Lane
from sumo_reactive.world.road_graph import RoadGraph


def lane_to_haunt(
    graph: RoadGraph, plan: NominalPlan, lane_id: str, x: float, y: float, s: float, limits: VehicleLimits
) -> Lane | None:
    """Return the lane beside `lane_id` that a change under way covers or is about to; None when there is none.

    `x`, `y`: front bumper (m); `s`: arc length of the front axle on C. During the change both lanes must see the ego, and
    the old one until the rear has left it.
    """
    change = next((c for c in plan.lane_changes if c.start <= s <= c.end + limits.length), None)
    lane = graph.lanes.get(lane_id)
    if change is None or lane is None or lane.is_internal:
        return None
    _, d = lane.spine.project(x, y)
    left, right = graph.neighbours(lane_id)
    on_new_lane = d * change.side < 0.0
    beside = (right if change.side > 0 else left) if on_new_lane else (left if change.side > 0 else right)
    finished = on_new_lane and abs(d) + 0.5 * limits.width < 0.5 * lane.width - STRADDLE_M and s > change.end
    return None if finished else beside
