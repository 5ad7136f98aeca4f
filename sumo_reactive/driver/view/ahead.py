"""What lies ahead: found by walking the labelled oriented graph W along the lanes that C uses (F&L 1991, §2)."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.caching import PLANS_KEPT, kept
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import Conflict
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.view.corridor import band_of, blocking_ones
from sumo_reactive.driver.view.swept_conflict import swept_conflicts
from sumo_reactive.driver.world.junction import WAITING_LENGTH_M, WAITING_WIDTH_M, Connection
from sumo_reactive.driver.world.lateral_conflict import SIDE_BY_SIDE_ANGLE
from sumo_reactive.driver.world.regions import REGION_STEP_M, ConflictKind, ConflictRegion
from sumo_reactive.driver.world.road_graph import RoadGraph, walk

CHANGED_SIDES_M = 0.5
"""Ways that cross less far are drawn over each other by rounding or by a lane that widens."""


@kept(PLANS_KEPT)
def passages_ahead(
    graph: RoadGraph, plan: NominalPlan, limits: VehicleLimits, sight: tuple[int, ...]
) -> tuple[tuple[int, Connection, tuple[Conflict, ...]], ...]:
    """Return the passages in `sight` that the walk along C finds: index in the plan, connection, conflicts."""
    found = _walked(graph, plan, limits)
    return tuple((i, *found[i]) for i in sight if i in found)


@kept(PLANS_KEPT)
def _walked(
    graph: RoadGraph, plan: NominalPlan, limits: VehicleLimits
) -> Mapping[int, tuple[Connection, tuple[Conflict, ...]]]:
    """Walk along all of C and return the connections that it passes with the conflicts on them, by index in the plan."""
    found: dict[int, tuple[Connection, tuple[Conflict, ...]]] = {}
    numbers = iter(range(len(plan.passages)))
    lanes = [segment.lane_id for segment in plan.segments] if limits.parameters.has(Mechanism.GRAPH) else []
    swept = swept_conflicts(plan, graph, limits)
    for connection, regions in walk(graph, lanes):
        number = next((i for i in numbers if plan.passages[i].connection_id == connection.id), None)
        if number is not None:
            conflicts = conflicts_of(graph, connection, regions) + swept.get(number, ())
            found[number] = connection, tuple(_against(conflict, plan, number, limits) for conflict in conflicts)
    return found


def _against(conflict: Conflict, plan: NominalPlan, number: int, limits: VehicleLimits) -> Conflict:
    """Return a conflict with whether a usual car that waits for the ego where the map says stands in its corridor."""
    wait, path, curve, passage = conflict.other.wait_at, conflict.other.path, plan.curve, plan.passages[number]
    if wait is None or not conflict.is_yielded_to:
        return conflict
    length, width = min(limits.length, WAITING_LENGTH_M), min(limits.width, WAITING_WIDTH_M)
    (x, y), (first_x, first_y), first = path.at(wait), path.at(wait - length), path.heading_at(0.0)
    before = max(length - wait, 0.0)  # his rear is on the lane that he comes from
    heading = math.atan2(y - first_y + before * math.sin(first), x - first_x + before * math.cos(first))
    box = np.array([(x, y, heading, 0.0, length, width)])
    start, band = max(passage.start, 0.0), band_of(curve, limits)
    which, _ = blocking_ones(box, curve.x, curve.y, curve.heading, curve.step, start, passage.end, *band)
    return conflict._replace(waits_in_the_way=len(which) > 0)


@kept(4096)
def conflicts_of(graph: RoadGraph, own: Connection, regions: tuple[ConflictRegion, ...]) -> tuple[Conflict, ...]:
    """Return the crossing and merging conflicts in the `regions` on a connection, in their order.

    Bodies that brush past each other from neighbour lanes of one road, with no rule between them, are no conflict: they
    drive side by side, and whoever reaches into the ego's corridor is a leader. Those whose ways change sides are one:
    some maps draw a turn across the lane beside it and declare it free, and SUMO's cars then do not look.
    """
    junction = graph.junctions[own.junction_id]
    rules = junction.right_of_way
    found = []
    for region in regions:
        other = graph.connections[region.other_id]
        if region.kind is ConflictKind.DIVERGING:
            continue
        yields, yielded = rules.must_yield(own.index, other.index), rules.must_yield(other.index, own.index)
        if yields or yielded or region.kind is ConflictKind.MERGING or not _side_by_side(graph, region, own, other):
            found.append(Conflict(region, other, yields, yielded, junction.yielded_to_by(other)))
    return tuple(found)


def _side_by_side(graph: RoadGraph, region: ConflictRegion, own: Connection, other: Connection) -> bool:
    """Whether two paths come from one road, run in about one direction where they meet and stay on their sides."""
    before, beside = graph.lanes.get(own.from_lane), graph.lanes.get(other.from_lane)
    if before is None or beside is None or before.edge_id != beside.edge_id:
        return False
    along = own.path.heading_at(0.5 * (region.own.start + region.own.end))
    across = other.path.heading_at(0.5 * (region.other.start + region.other.end))
    return math.cos(along - across) > math.cos(SIDE_BY_SIDE_ANGLE) and not _change_sides(region, own, other)


def _change_sides(region: ConflictRegion, own: Connection, other: Connection) -> bool:
    """Whether the other path is on either side of the own one while it passes their region."""
    start, end = region.other.start, region.other.end
    s = np.linspace(start, end, 2 + int((end - start) / REGION_STEP_M))
    sides = own.path.offsets(other.path.points_at(s))
    return bool(sides.min() < -CHANGED_SIDES_M and sides.max() > CHANGED_SIDES_M)
