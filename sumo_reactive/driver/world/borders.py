"""Borders of the carriageway: the road's own static obstacles O_S (F&L 1991, §1.3)."""

from __future__ import annotations

import math

import numpy as np

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.geometry.polyline import Floats, moved_aside
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph

BORDER_STEP_M = 1.0
"""Spacing of the points of O_S on a road's border: 1.6 m beside one, the nearest is at most 2.1 m away (taxicab)."""


@kept(4096)
def borders(graph: RoadGraph, edge_id: str, vehicle_class: str) -> Floats:
    """Return points (n, 2), m, on the borders of what vehicles of the class may drive on, at most BORDER_STEP_M apart.

    These are the borders of an edge's carriageway, the oncoming side included where it may be used to overtake, and both
    borders of each lane inside that is closed to the class. None where the class may not drive at all.
    """
    across = _across(graph, edge_id)
    open_ones = [i for i, (lane, _) in enumerate(across) if lane.allows(vehicle_class)]
    if not open_ones:
        return np.empty((0, 2))
    first, last = open_ones[0], open_ones[-1]
    (near, near_side), (far, far_side) = across[first], across[last]
    lines = [border(near, near_side), border(far, -far_side)]
    for lane, side in across[first:last]:
        if not lane.allows(vehicle_class):
            lines += [border(lane, side), border(lane, -side)]
    return np.vstack(lines)


def border(lane: Lane, side: float) -> Floats:
    """Return points (n, 2), m, on a lane's left (`side` = 1) or right border (−1), as its driver sees it."""
    spine = lane.spine
    s = np.linspace(0.0, spine.length, 1 + max(1, math.ceil(spine.length / BORDER_STEP_M)))
    return moved_aside(spine.points_at(s), np.full(len(s), 0.5 * side * lane.width))


def _across(graph: RoadGraph, edge_id: str) -> list[tuple[Lane, float]]:
    """Return the carriageway's lanes from the edge's outer one on, each with the side of its border that comes first."""
    outer = 1.0 if graph.left_hand else -1.0
    own = [(lane, outer) for lane in graph.edge_lanes.get(edge_id, ())]
    oncoming = graph.oncoming(edge_id)
    return own + [(lane, -outer) for lane in reversed(oncoming)]
