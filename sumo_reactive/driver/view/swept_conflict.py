"""Conflict regions that the map does not know: ground beside its ways that a body covers as it swings through a turn.

The map's regions lie between bands that cars sweep along the ways. A long body's front swings out of its way and its middle
cuts the corner, and so does a car where the turn is drawn tighter than it can drive: over the lane of those who come towards
it there, or over who waits at the line of another road. They do not look at it, no rule makes them, so it waits before its
line until nobody is about to be there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
import shapely

from sumo_reactive.driver.caching import PLANS_KEPT, kept
from sumo_reactive.driver.geometry.polyline import Floats, Points, cut, joined
from sumo_reactive.driver.geometry.swept import steering_along
from sumo_reactive.driver.nouns.plan import NominalPlan, Passage
from sumo_reactive.driver.nouns.snapshot import Conflict
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.view.leaders import ORDINARY_M
from sumo_reactive.driver.world.junction import HOLD_BACK_REACH_M, Connection, Junction
from sumo_reactive.driver.world.lane import road_of
from sumo_reactive.driver.world.regions import (
    SWEPT_WIDTH_M,
    ConflictKind,
    ConflictRegion,
    Interval,
    PostConflictRegion,
)
from sumo_reactive.driver.world.road_graph import RoadGraph

_BODIES_STEP_M = 0.5
"""The body is laid along C this often."""


BESIDE_OWN_WAY_M = 0.5
"""A body that reaches this much farther beside its own way than one that is straight on it covers what is there."""


class _Bodies(NamedTuple):
    """The body where its front is at `fronts` (n,), m of C: boxes (n,), and the `way` of its front axle there."""

    fronts: Floats
    boxes: Any
    way: Any


class _OtherWay(NamedTuple):
    """The line that others by `connection` drive, from `before` m before their stop line on (negative: behind it)."""

    connection: Connection
    line: Any
    before: float
    mark: str = "~"


@kept(PLANS_KEPT)
def swept_conflicts(plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits) -> Mapping[int, tuple[Conflict, ...]]:
    """Return the conflicts with those over whose ways the body swings where the map calls them free, by passage."""
    found = {}
    for i, passage in enumerate(plan.passages):
        junction = graph.junctions.get(passage.junction_id)
        if junction is None or any(turn.holds(passage) for turn in plan.turnarounds):
            continue
        if limits.length > ORDINARY_M or _swings_out(plan, passage, graph):
            found[i] = tuple(_conflicts(plan, passage, junction, graph, limits))
    return {i: conflicts for i, conflicts in found.items() if conflicts}


def _swings_out(plan: NominalPlan, passage: Passage, graph: RoadGraph) -> bool:
    """Whether C leaves the map's way through a junction by more than BESIDE_OWN_WAY_M, other than to change lanes: a turn
    drawn tighter than a car can drive."""
    curve, changes = plan.curve, (change.start for change in plan.lane_changes if change.end > passage.start)
    until = min([passage.end + HOLD_BACK_REACH_M, *changes])
    at = slice(max(int(passage.start / curve.step), 0), int(until / curve.step))
    places = shapely.points(curve.x[at], curve.y[at])
    way = _own_way(graph, graph.connections[passage.connection_id])
    return bool((shapely.distance(places, way) > BESIDE_OWN_WAY_M).any())


def _own_way(graph: RoadGraph, own: Connection) -> Any:
    """Return the line that the map draws for a passage, with the road before and behind it."""
    before, behind = graph.lanes[own.from_lane].spine, graph.lanes[own.to_lane].spine
    reach = HOLD_BACK_REACH_M
    parts = [cut(before, max(before.length - reach, 0.0), before.length), own.path.points]
    return shapely.linestrings(joined([*parts, cut(behind, 0.0, min(behind.length, reach))]))


def _conflicts(
    plan: NominalPlan, passage: Passage, junction: Junction, graph: RoadGraph, limits: VehicleLimits
) -> Iterator[Conflict]:
    own, bodies = graph.connections[passage.connection_id], _bodies(plan, passage, limits)
    if bodies is None:
        return
    line = _own_way(graph, own)
    ground = shapely.buffer(shapely.box(*shapely.total_bounds(bodies.boxes)), 0.5 * SWEPT_WIDTH_M)
    known = {region.other_id for region in graph.regions_on(own)}
    reach = max(HOLD_BACK_REACH_M, limits.length)  # behind a sharp turn it is crooked for its length
    oncoming = {lane.id for lane in graph.oncoming(road_of(own.from_lane))}
    for other in junction.connections:
        if other.is_crossing or road_of(other.from_lane) == road_of(own.from_lane):
            continue
        way, own_way = _other_way(graph, other, reach, at_line=other.id in known), None
        if line.distance(way.line) < SWEPT_WIDTH_M:  # over each other: the map's affair, but for what is beside
            way, own_way = _other_way(graph, other, reach, at_line=True), bodies.way
        ways = [(way, own_way), *([(_way_out(graph, other), None)] if other.to_lane in oncoming else [])]
        near = (one for one in ways if ground.intersects(one[0].line))
        regions = (_region(own, way, passage, bodies, limits, own_way) for way, own_way in near)
        first = junction.yielded_to_by(other)
        yield from (Conflict(one, other, must_yield=False, is_yielded_to=False, lets_pass=first) for one in regions if one)


def _bodies(plan: NominalPlan, passage: Passage, limits: VehicleLimits) -> _Bodies | None:
    """Return the body all along a passage."""
    curve, stride = plan.curve, max(int(_BODIES_STEP_M / plan.curve.step), 1)
    first = max(int((passage.start - 2.0 * limits.length) / curve.step), 0)
    last = min(int((passage.end + limits.length + HOLD_BACK_REACH_M) / curve.step), len(curve.x) - 1)
    if last - first < 2:
        return None
    at = slice(first, last, stride)
    headings = curve.heading[at]
    angles = steering_along(headings, np.full(len(headings), stride * curve.step), limits.wheelbase, 0.0)
    headings = headings - angles
    c, s, half = np.cos(headings), np.sin(headings), 0.5 * limits.width
    front = np.column_stack((curve.x[at], curve.y[at])) + limits.front_overhang * np.column_stack((c, s))
    back, aside = limits.length * np.column_stack((c, s)), half * np.column_stack((-s, c))
    corners = np.stack((front + aside, front - back + aside, front - back - aside, front - aside), axis=1)
    places = first + stride * np.arange(len(headings), dtype=np.float64)
    fronts: Floats = places * curve.step + limits.front_overhang
    way = shapely.linestrings(np.column_stack((curve.x[at], curve.y[at])))
    return _Bodies(fronts, shapely.polygons(corners), way)


def _other_way(graph: RoadGraph, other: Connection, reach: float, *, at_line: bool) -> _OtherWay:
    """Return the way of others from `reach` m before their stop line on; only up to the line if it ends `at_line`."""
    lane = graph.lanes[other.from_lane].spine
    before = min(lane.length, reach)
    parts: list[Points] = [cut(lane, lane.length - before, lane.length)]
    if not at_line:
        parts.append(other.path.points)
    return _OtherWay(other, shapely.linestrings(joined(parts)), before)


def _way_out(graph: RoadGraph, other: Connection) -> _OtherWay:
    """Return the lane that others by `other` come out of the junction on: who swings out before his line is in their way."""
    return _OtherWay(other, shapely.linestrings(graph.lanes[other.to_lane].spine.points), -other.path.length, "~~")


def _region(
    own: Connection, way: _OtherWay, passage: Passage, bodies: _Bodies, limits: VehicleLimits, own_way: Any
) -> ConflictRegion | None:
    """Return where the body meets a car on another way, beside its `own_way` if that is given; None: nowhere."""
    band = shapely.buffer(way.line, 0.5 * SWEPT_WIDTH_M, cap_style="flat")
    at = np.flatnonzero(shapely.intersects(bodies.boxes, band))
    met = shapely.intersection(bodies.boxes[at], band)
    if own_way is not None and len(at):
        met = shapely.difference(met, shapely.buffer(own_way, 0.5 * limits.width + BESIDE_OWN_WAY_M))
        at, met = at[~shapely.is_empty(met)], met[~shapely.is_empty(met)]
    if not len(at):
        return None
    corners = shapely.points(shapely.get_coordinates(met))
    along = shapely.line_locate_point(way.line, corners) - way.before
    fronts = bodies.fronts[at[0]], bodies.fronts[at[-1]] - limits.length
    start, end = (_inside(float(front), passage, own) for front in fronts)
    other, region_id = way.connection, f"{own.id}{way.mark}{way.connection.id}"
    return ConflictRegion(
        id=region_id, kind=ConflictKind.CROSSING, own_id=own.id, other_id=other.id, own=Interval(start, max(start, end)),
        other=Interval(float(along.min()), float(along.max())),
        polygon=shapely.get_coordinates(shapely.convex_hull(shapely.geometrycollections(met)))[:-1],
        # who swings out with its front is out of it before its rear comes there
        post=PostConflictRegion(own.id, end, region_id),
    )  # fmt: skip


def _inside(s: float, passage: Passage, own: Connection) -> float:
    """Return arc length `s` of C (m) as one from the stop line on the connection's path."""
    if s >= passage.end:
        return own.path.length + s - passage.end
    scale = (passage.end - passage.start) / max(own.path.length, 0.1)
    return (s - passage.start) / scale if s > passage.start else s - passage.start
