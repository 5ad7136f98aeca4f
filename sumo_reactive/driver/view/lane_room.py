"""How far the ego may lean to either side of C without leaving its lane."""

from __future__ import annotations

import numpy as np

from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.view.corridor import band_of
from sumo_reactive.driver.world.road_graph import RoadGraph

OFF_LANE_M = 0.5
"""Where C runs this far beside its lane's middle, it changes lanes or passes somebody, and nothing is added."""

GROWTH = 0.02
"""The room grows by no more than this a metre along C: a lean begins and ends smoothly."""


def lane_room(plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits) -> tuple[Floats, Floats]:
    """Return the room (n,) to the left and right of each sample of C, m, in which the ego's front axle may be; none in
    junctions.

    It is what the corridor, with its margin, leaves of the lane.
    """
    curve, band, most = plan.curve, band_of(plan.curve, limits), limits.parameters.max_lean_m
    left, right = np.zeros(len(curve.x)), np.zeros(len(curve.x))
    for segment in plan.segments:
        lane = graph.lanes[segment.lane_id]
        first, last = max(int(np.ceil(segment.start / curve.step)), 0), int(segment.end / curve.step) + 1
        at = slice(first, min(last, len(left)))
        if lane.is_internal or at.start >= at.stop:
            continue
        off = lane.spine.offsets(np.column_stack((curve.x[at], curve.y[at])))
        follows = np.abs(off) < OFF_LANE_M
        left[at] = np.where(follows, np.clip(0.5 * lane.width - off - band.left[at], 0.0, most), 0.0)
        right[at] = np.where(follows, np.clip(0.5 * lane.width + off - band.right[at], 0.0, most), 0.0)
    return _eased(left, curve.step), _eased(right, curve.step)


def _eased(room: Floats, step: float) -> Floats:
    """Return the greatest room (n,), m, no greater than `room` that grows and falls by at most GROWTH."""
    slope = GROWTH * step * np.arange(len(room))
    rising = np.minimum.accumulate(room - slope) + slope
    return np.asarray(np.minimum.accumulate((rising + slope)[::-1])[::-1] - slope)
