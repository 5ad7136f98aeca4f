"""Room for those who wait inside a junction, and for those who drive abreast through it: where their bodies would reach into
the way of the ego's, C gives way, since who waits there cannot move, and who drives there does not look."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from sumo_reactive.driver.geometry.polyline import Points, moved_aside
from sumo_reactive.driver.parameters import CORRIDOR_MARGIN_M, CURVE_STEP_M, WAITING_LENGTH_M, WAITING_WIDTH_M
from sumo_reactive.driver.path.abreast import ABREAST_REACH_M, keep_abreast
from sumo_reactive.driver.path.centring import BEYOND_M, LEAST_M, eased_in
from sumo_reactive.driver.path.reference import Reference
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.abreast import abreast_of
from sumo_reactive.driver.world.junction import Connection

Floats = NDArray[np.float64]

SPARE_M = 0.05
"""Room left beyond what the corridor of the ego takes."""

KEPT_M = 4.0
"""C keeps away for this much longer before and behind, so that smoothing does not fill up the way round."""

SIDE_POINTS = 6
"""The side of a waiting body is looked at in so many points…"""
END_POINTS = 3
"""…and its front in so many."""


def clear_of_waiting(line: Points, half_widths: Floats, reference: Reference, limits: VehicleLimits) -> Points:
    """Return `line` (n, 2), sampled every CURVE_STEP_M, moved away from the bodies that may wait inside junctions or be
    abreast of the ego's there.

    `half_widths` (n,) are the lanes', m. It is moved only as far as the body stays within its lane but for BEYOND_M.
    """
    shift = np.zeros(len(line))
    room = np.maximum(half_widths + BEYOND_M - 0.5 * limits.width, 0.0)
    for connection, start, end in reference.passages:
        first, last = max(int(start / CURVE_STEP_M), 0), min(int(end / CURVE_STEP_M) + 1, len(line) - 1)
        junction = reference.graph.junctions.get(connection.junction_id)
        if junction is None or last - first < 2:
            continue
        for other in junction.connections:
            if _may_be_met(connection, other):
                _give_way(shift[first:last], line[first : last + 1], _waiting(other), limits)
        reach = min(last + int(ABREAST_REACH_M / CURVE_STEP_M), len(line))
        keep_abreast(shift[first:reach], line[first:reach], abreast_of(reference.graph, connection.id), limits)
    if not shift.any():
        return line
    reach = 2 * int(0.5 * limits.wheelbase / CURVE_STEP_M) + 1
    kept = reach + 2 * int(KEPT_M / CURVE_STEP_M)
    left, right = (maximum_filter1d(np.clip(side, 0.0, room), kept) for side in (shift, -shift))
    eased = eased_in(left - right, reach)
    return line if np.abs(eased).max() < LEAST_M else moved_aside(line, eased)


def _may_be_met(connection: Connection, other: Connection) -> bool:
    """Whether somebody on `other` may wait inside the junction while the ego, on another approach, passes."""
    approach = connection.from_lane.rpartition("_")[0]
    return other.wait_at is not None and other.from_lane.rpartition("_")[0] != approach and not other.is_crossing


def _waiting(other: Connection) -> Points:
    """Return points (k, 2) on the outline of a car whose front is at the waiting place of `other`."""
    place = other.wait_at or 0.0
    x, y = other.path.at(place)
    bx, by = other.path.at(max(place - WAITING_LENGTH_M, 0.0))
    heading = math.atan2(y - by, x - bx)
    way, left = np.array([math.cos(heading), math.sin(heading)]), np.array([-math.sin(heading), math.cos(heading)])
    back, half = np.linspace(0.0, WAITING_LENGTH_M, SIDE_POINTS), 0.5 * WAITING_WIDTH_M
    sides = [np.array([x, y]) - back[:, None] * way + side * half * left for side in (1.0, -1.0)]
    front = np.array([x, y]) + np.linspace(-half, half, END_POINTS)[:, None] * left
    return np.vstack((*sides, front))


def _give_way(shift: Floats, line: Points, body: Points, limits: VehicleLimits) -> None:
    """Set in `shift` (n − 1,), m to the left, how far `line` (n, 2) has to be moved to pass the points of `body` (k, 2).

    Who stands across the line is not passed.
    """
    way = np.diff(line, axis=0)
    off = body[:, None, :] - line[:-1]
    nearest = np.argmin((off**2).sum(axis=2), axis=1)
    k = np.arange(len(body))
    along, to = way[nearest], off[k, nearest]
    aside = (along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0]) / np.maximum(np.hypot(*along.T), 1e-9)
    beside = (nearest > 0) & (nearest < len(way) - 1)
    if not beside.any() or (aside[beside].min() < 0.0 < aside[beside].max()):
        return
    needed = 0.5 * limits.width + CORRIDOR_MARGIN_M + SPARE_M - np.abs(aside)
    for j, side, by in zip(nearest[beside], np.sign(aside[beside]), needed[beside], strict=True):
        if by > abs(shift[j]):
            shift[j] = -side * by
