"""Where C keeps off the middle of its lane: bends for long bodies, narrow roads, who waits in or at junctions or is beside.

A long body's front keeps to the outside, so that the rear, which cuts the inside, stays in the lane too. Who waits inside a
junction, or at a line that the map draws into others' way, does not move aside, and who comes too near beside the ego there
does not look.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np
import shapely
from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.curve import CURVE_STEP_M
from sumo_reactive.driver.geometry.polyline import Floats, Points, Polyline, moved_aside, nearest_point
from sumo_reactive.driver.geometry.swept import swept_sides
from sumo_reactive.driver.path.reference import Reference
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.junction import (
    HOLD_BACK_REACH_M,
    WAITING_LENGTH_M,
    WAITING_WIDTH_M,
    Connection,
    Junction,
    Turn,
)
from sumo_reactive.driver.world.lane import road_of, separation
from sumo_reactive.driver.world.lateral_conflict import LateralConflict, beside, lateral_conflicts
from sumo_reactive.driver.world.regions import SWEPT_WIDTH_M
from sumo_reactive.driver.world.road_graph import RoadGraph

MAX_CENTRING_M = 0.6
"""In a bend a long vehicle keeps to the outside by at most this, as its rear keeps to the inside: farther, its front bumper
would reach into the next lane."""

COMFORT_DEVIATION_M = 0.25
"""In turns C may leave the centre line this far to be driven at the road's speed: half of a car's room in a 2.8 m lane."""

BEYOND_M = 0.2
"""Rear and, on the side of oncoming traffic, front may leave the lane by this: who drives in the middle of a lane of 3.2 m
leaves 0.7 m."""
CORNER_REACH = 1.5
"""Round the corners of a line that is not smooth yet, the way is longer than straight by up to this factor."""
LEAST_M = 1e-4
"""Less is rounding."""
BUMPER_SPARE_M = 0.3
"""The front bumper covers at least this much of its lane, which is what maps it to the lane."""
ONCOMING_WIDTH_M = 1.8
"""What an oncoming car takes of a narrow road."""
MOST_OUTWARD_M = 0.8
"""The ego keeps no farther than this off the middle of its lane there: SUMO has to find it on the lane."""
BACK_WITHIN_M = 12.0
"""It comes to the outside, and back to the middle, within this way."""
BEND_RAD = 0.3
"""A line that turns by more within that way is a bend, or a turn."""
KEPT_M = 4.0
"""C keeps away for this much longer before and behind, so that smoothing does not fill up the way round."""
SIDE_POINTS, END_POINTS = 6, 3
"""The side of a waiting body, and its front, are looked at in so many points."""


def centred(line: Points, half_widths: Floats, limits: VehicleLimits, left_hand: bool) -> Points:
    """Return `line` (n, 2), sampled every CURVE_STEP_M, moved to the outside of bends where the rear would leave the lane.

    `half_widths` (n,) are the lanes', m. It is moved by what the rear axle leaves the lane by, at most by half of what the
    axle is inside (then front and rear leave it alike), at most by MAX_CENTRING_M, and only as far as the front bumper
    stays near the lane: on the side of oncoming traffic (the right if `left_hand`) within it, but for BEYOND_M.
    """
    ahead = np.gradient(line, axis=0)
    headings, (xs, ys) = np.arctan2(ahead[:, 1], ahead[:, 0]), Polyline(line).columns
    sizes = limits.wheelbase, limits.front_overhang
    most = swept_sides(xs, ys, headings, CURVE_STEP_M, headings[0], *sizes, 0.0, CORNER_REACH)
    rear, bumper = (np.where(side[:, 0] >= -side[:, 1], side[:, 0], side[:, 1]) for side in most)
    rear[[0, -1]] = bumper[[0, -1]] = 0.0  # what is before or behind the line is noted there
    half = 0.5 * limits.width
    excess = np.abs(rear) + half - BEYOND_M - half_widths
    if not (excess > 0.0).any():
        return line
    oncoming = rear < 0.0 if not left_hand else rear > 0.0  # the outside of the bend
    room = half_widths + np.where(oncoming, BEYOND_M - half, half - BUMPER_SPARE_M) - np.abs(bumper)
    allowed = np.minimum(0.5 * np.abs(rear), np.minimum(room, MAX_CENTRING_M))
    reach = _eased_over(limits)
    shift = -np.sign(rear) * np.clip(excess, 0.0, np.maximum(minimum_filter1d(allowed, 2 * reach + 1), 0.0))
    return moved_aside(line, _eased_in(shift, reach))


def clear_of_others(line: Points, half_widths: Floats, reference: Reference, limits: VehicleLimits) -> Points:
    """Return `line` (n, 2), sampled every CURVE_STEP_M, moved away from the bodies that may wait inside junctions or at
    their lines, or be too near beside the ego's there, from a neighbour lane of its road.

    `half_widths` (n,) are the lanes', m. It is moved only as far as the body stays within its lane but for BEYOND_M, and out
    of the ways of those who drive through the junction at the same time.
    """
    shift, (xs, ys) = np.zeros(len(line)), Polyline(line).columns
    room = np.maximum(half_widths + BEYOND_M - 0.5 * limits.width, 0.0)
    to_left, to_right = room.copy(), room.copy()
    margin = limits.parameters.corridor_margin_m + COMFORT_DEVIATION_M  # smoothing takes the latter back
    needed = 0.5 * limits.width + margin
    for connection, start, end in reference.passages:
        first, last = max(int(start / CURVE_STEP_M), 0), min(int(end / CURVE_STEP_M) + 1, len(line) - 1)
        junction = reference.graph.junctions.get(connection.junction_id)
        if junction is None or last - first < 2:
            continue
        for body in _waiting(connection, junction, reference.graph):
            _clear_of_body(shift[first:last], xs[first : last + 1], ys[first : last + 1], body, needed)
        reach = min(last + int(HOLD_BACK_REACH_M / CURVE_STEP_M), len(line))  # one may still be inside, the other out of it
        ways = lateral_conflicts(reference.graph, connection.id)
        _clear_of_ways(shift[first:reach], line[first:reach], ways, needed + 0.5 * WAITING_WIDTH_M)
        for way in _driven_at_once(connection, junction) if shift[first:reach].any() else ():
            _held_off(to_left[first:last], to_right[first:last], line[first:last], way, needed + 0.5 * SWEPT_WIDTH_M)
    if not shift.any():
        return line
    reach = _eased_over(limits)
    kept = reach + 2 * int(KEPT_M / CURVE_STEP_M)
    left, right = (
        np.minimum(maximum_filter1d(np.clip(side, 0.0, most), kept), minimum_filter1d(most, 2 * reach + 1))
        for side, most in ((shift, to_left), (-shift, to_right))
    )
    eased = _eased_in(left - right, reach)
    return line if np.abs(eased).max() < LEAST_M else moved_aside(line, eased)


def clear_of_oncoming(line: Points, reference: Reference, limits: VehicleLimits) -> Points:
    """Return `line` (n, 2), sampled every CURVE_STEP_M, moved to the outside of roads on which the oncoming lane is nearer
    than two cars are wide; in turns and bends, where the body needs the road, it is back in the middle."""
    graph, pieces = reference.graph, reference.pieces
    width = limits.width + 2.0 * (limits.parameters.corridor_margin_m + COMFORT_DEVIATION_M)
    outward = [_outward(graph, piece.lane.id, width) for piece in pieces]
    if not any(outward):
        return line
    for k, piece in enumerate(pieces):
        if piece.lane.is_internal and k:
            behind = (out for one, out in zip(pieces[k:], outward[k:], strict=True) if not one.lane.is_internal)
            outward[k] = max(outward[k - 1], next(behind, 0.0), key=abs)
    at = np.searchsorted([piece.u for piece in pieces], CURVE_STEP_M * np.arange(len(line)), side="right") - 1
    shift = np.array(outward)[np.clip(at, 0, None)]
    reach, headings = int(BACK_WITHIN_M / CURVE_STEP_M), np.unwrap(np.arctan2(*np.gradient(line, axis=0).T[::-1]))
    ends = np.pad(headings, reach // 2, mode="edge")
    bends = np.abs(ends[2 * (reach // 2) :] - ends[: len(headings)]) > BEND_RAD
    shift[maximum_filter1d(bends, 2 * reach + 1)] = 0.0
    return moved_aside(line, _eased_in(shift, reach))


@kept(4096)
def _outward(graph: RoadGraph, lane_id: str, width: float) -> float:
    """Return how far to the left (negative: right) of the middle of a lane a car keeps that takes `width` m of the road.

    It stays in the middle where oncoming cars have room, or another lane lies on the outside.
    """
    lane = graph.lanes[lane_id]
    oncoming = graph.oncoming(lane.edge_id)
    if lane.is_internal or not oncoming or len(graph.edge_lanes[lane.edge_id]) > 1:
        return 0.0
    apart = separation(lane, oncoming[-1]) + 0.5 * (lane.width + oncoming[-1].width)
    outward = min(max(0.5 * (width + ONCOMING_WIDTH_M) - apart, 0.0), MOST_OUTWARD_M)
    return outward if graph.left_hand else -outward


def _eased_over(limits: VehicleLimits) -> int:
    return 2 * int(0.5 * limits.wheelbase / CURVE_STEP_M) + 1


def _eased_in(shift: Floats, reach: int) -> Floats:
    """Return `shift` (n,), m, kept up for half of `reach` samples before and behind a bend, and led there within as many."""
    left, right = (maximum_filter1d(np.maximum(side, 0.0), reach) for side in (shift, -shift))
    found = np.asarray(left - right)
    for _ in range(2):
        found = uniform_filter1d(found, reach, mode="nearest")
    return np.where(np.abs(found) < LEAST_M, 0.0, found)


def _waiting(connection: Connection, junction: Junction, graph: RoadGraph) -> Iterator[Points]:
    """Yield the outlines (k, 2) of those who may wait while the ego, on another approach, passes: inside the junction,
    and at their lines."""
    others = [c for c in junction.connections if not c.is_crossing and road_of(c.from_lane) != road_of(connection.from_lane)]
    yield from (_outline(c.path, c.wait_at) for c in others if c.wait_at is not None)
    for lane_id in dict.fromkeys(c.from_lane for c in others):
        approach = graph.lanes[lane_id].spine
        yield _outline(approach, approach.length)


def _driven_at_once(connection: Connection, junction: Junction) -> Iterator[Polyline]:
    """Yield the ways of those from other roads whom the map calls free beside the ego: nobody there waits for the other.

    Turning around is not one of them: the map draws it so narrow that it would keep C from moving aside at most junctions.
    """
    for other in junction.connections:
        if other.is_crossing or other.turn is Turn.AROUND or road_of(other.from_lane) == road_of(connection.from_lane):
            continue
        if not junction.right_of_way.in_conflict(connection.index, other.index):
            yield other.path


def _held_off(to_left: Floats, to_right: Floats, line: Points, way: Polyline, needed: float) -> None:
    """Set how far (n,), m, `line` (n, 2) may be moved to either side so that `needed` m are left to a way beside it, or as
    many as there are."""
    places = shapely.points(line)
    other = shapely.linestrings(way.points)
    nearest = shapely.line_interpolate_point(other, shapely.line_locate_point(other, places))
    to_way, ahead = shapely.get_coordinates(nearest) - line, np.gradient(line, axis=0)
    is_left = ahead[:, 0] * to_way[:, 1] > ahead[:, 1] * to_way[:, 0]
    left_over = np.maximum(np.hypot(*to_way.T) - needed, 0.0)
    for side, is_there in ((to_left, is_left), (to_right, ~is_left)):
        np.minimum(side, left_over, out=side, where=is_there)


@kept(4)
def _outline(way: Polyline, place: float) -> Points:
    """Return points (k, 2) on the outline of a car whose front is at a place (m) of its way."""
    x, y = way.at(place)
    bx, by = way.at(max(place - WAITING_LENGTH_M, 0.0))
    heading = math.atan2(y - by, x - bx)
    ahead, left = np.array([math.cos(heading), math.sin(heading)]), np.array([-math.sin(heading), math.cos(heading)])
    back, half = np.linspace(0.0, WAITING_LENGTH_M, SIDE_POINTS), 0.5 * WAITING_WIDTH_M
    sides = [np.array([x, y]) - back[:, None] * ahead + side * half * left for side in (1.0, -1.0)]
    front = np.array([x, y]) + np.linspace(-half, half, END_POINTS)[:, None] * left
    return np.vstack((*sides, front))


@kernel
def _clear_of_body(shift: Floats, xs: Floats, ys: Floats, body: Points, room: float) -> None:
    """Set in `shift` (n − 1,), m to the left, how far the line through `xs`, `ys` (n,) has to be moved to pass the points of
    `body` (k, 2) with `room` m between.

    Who stands across the line is not passed.
    """
    last = len(xs) - 2
    nearest, aside = np.empty(len(body), dtype=np.int64), np.empty(len(body))
    least, most = 0.0, 0.0
    for k in range(len(body)):
        x, y = body[k]
        i = nearest_point(xs, ys, x, y, 0, last)
        ex, ey = xs[i + 1] - xs[i], ys[i + 1] - ys[i]
        by = (ex * (y - ys[i]) - ey * (x - xs[i])) / max(math.hypot(ex, ey), 1e-9)
        nearest[k], aside[k] = i, by
        if 0 < i < last:
            least, most = min(least, by), max(most, by)
    for k in range(len(body) if least == 0.0 or most == 0.0 else 0):
        i, left = nearest[k], room - abs(aside[k])
        if 0 < i < last and left > abs(shift[i]):
            shift[i] = -np.sign(aside[k]) * left


def _clear_of_ways(shift: Floats, line: Points, ways: Iterable[LateralConflict], room: float) -> None:
    """Set in `shift` (n,), m to the left, how far `line` (n, 2) has to be moved to leave `room` m to each of `ways`.

    Between two of them it runs in the middle. A way that leads to the other side is crossed, not kept clear of.
    """
    left, right = np.zeros(len(line)), np.zeros(len(line))
    for other in ways:
        aside = beside(other.way, line)
        needed = np.sign(aside) * np.maximum(room - np.abs(aside), 0.0)
        if needed.min() >= 0.0 or needed.max() <= 0.0:
            left, right = np.maximum(left, needed), np.minimum(right, needed)
    needed = np.where((left > 0.0) & (right < 0.0), 0.5 * (left + right), left + right)
    more = np.abs(needed) > np.abs(shift)
    shift[more] = needed[more]
