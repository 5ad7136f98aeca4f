"""Where the body cuts into the lane beside: its rear on the inside of a bend, its front when it swings out for one."""

from __future__ import annotations

import numpy as np

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import Cut
from sumo_reactive.driver.parameters import CUT_M, CUT_SIGHT_M, PLANS_KEPT
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.view.corridor import band_along
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph


def cuts_of(plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits) -> tuple[Cut, ...]:
    """Return where the body covers lanes beside its own while the front axle follows C, in order along C.

    Where C itself leads from lane to lane it cuts into none.
    """
    return _cuts(plan, graph, limits.width, limits.wheelbase, limits.front_overhang)


@kept(PLANS_KEPT)
def _cuts(plan: NominalPlan, graph: RoadGraph, width: float, wheelbase: float, overhang: float) -> tuple[Cut, ...]:
    curve, band, found = plan.curve, band_along(plan.curve, width, wheelbase, overhang), []
    places = np.column_stack((curve.x, curve.y))
    for g in plan.segments:
        first, end = max(int(g.start / curve.step) + 1, 0), min(int(g.end / curve.step), len(curve.x))
        if first >= end or any(change.start < g.end and change.end > g.start for change in plan.lane_changes):
            continue
        own = graph.lanes[g.lane_id]
        aside = own.spine.offsets(places[first:end])
        for left, reach in ((True, aside + band.left[first:end]), (False, band.right[first:end] - aside)):
            lane = lane_at_side(graph, g.lane_id, left)
            at = first + np.flatnonzero(reach > 0.5 * own.width + CUT_M)
            if lane is not None and len(at):
                runs = np.split(at, np.flatnonzero(np.diff(at) > 1) + 1)
                found += [Cut(float(run[0]) * curve.step, float(run[-1]) * curve.step, left, lane.id) for run in runs]
    return tuple(sorted(found))


def next_cut(plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits, s: float, front: float) -> Cut | None:
    """Return the next cut into the lane of a road, if it is in sight and its end not yet passed; none during a lane change.

    `s`, `front`: arc length of front axle and front bumper on C, m.
    """
    for cut in cuts_of(plan, graph, limits):
        if cut.start > front + CUT_SIGHT_M:
            break
        if cut.end > s and not cut.lane_id.startswith(":"):
            return cut
    return None


def lane_at_side(graph: RoadGraph, lane_id: str, left: bool) -> Lane | None:
    """Return the lane directly left or right of a lane, inside a junction too."""
    lane = graph.lanes[lane_id]
    if not lane.is_internal:
        return graph.neighbours(lane_id)[0 if left else 1]
    index = lane.index + (1 if left != graph.left_hand else -1)
    return graph.lanes.get(f"{lane.edge_id}_{index}")
