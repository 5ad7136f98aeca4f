"""Lanes that end beyond the start of the next one: the connection turns back on the lane that leads to it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.geometry.angle import wrapped
from sumo_reactive.driver.geometry.polyline import Polyline, joined
from sumo_reactive.driver.parameters import CURVE_STEP_M
from sumo_reactive.driver.world.road_graph import RoadGraph

TURNED_BACK_RAD = math.radians(110.0)
"""A connection turns back on its lane if it begins in a direction this far from the lane's, and does not lead back."""
REACH_M = 30.0
"""The way behind the end of the lane is looked at so far."""
BEGUN_M = 0.5
"""A way that has just begun is on its lane for so long."""
LEAST_M = 2.0
"""What a lane overruns the next one by less is smoothed away."""


class Overrun(NamedTuple):
    """C leaves the lane at its spine arc length `leaves` and goes on at `joins` of the connection's path and the lane behind
    it, m: in between it would drive on and come back along the lane."""

    leaves: float
    joins: float


@kept(4096)
def overrun_of(graph: RoadGraph, connection_id: str) -> Overrun | None:
    """Return what C leaves out where a connection turns back on its lane; None where it does not.

    That is up to where the way behind the lane's end crosses the lane for the last time, else leaves it to the side.
    """
    way = graph.connections[connection_id]
    own, behind = graph.lanes[way.from_lane], graph.lanes[way.to_lane]
    before, onto = own.spine.heading_at(own.spine.length), behind.spine.heading_at(0.0)
    turned = abs(wrapped(way.path.heading_at(0.0) - before))
    if turned < TURNED_BACK_RAD or abs(wrapped(onto - before)) > TURNED_BACK_RAD:
        return None
    back = Polyline(joined([way.path.points, behind.spine.points]))
    at = np.arange(BEGUN_M, min(back.length, way.path.length + REACH_M), CURVE_STEP_M)
    places = back.points_at(at)
    aside, along = own.spine.offsets(places), own.spine.arc_lengths_at(places)
    beside = (along > 0.0) & (along < own.spine.length)
    crosses = np.flatnonzero((aside[1:] * aside[:-1] < 0.0) & beside[1:]) + 1
    leaves = np.flatnonzero(beside & (np.abs(aside) > 0.5 * own.width))
    if not len(crosses) and not len(leaves):
        return None
    k = crosses[-1] if len(crosses) else leaves[0]
    left_out = own.spine.length - float(along[k])
    return Overrun(float(along[k]), float(at[k])) if left_out > LEAST_M else None
