"""Conflict regions with others' long bodies: the ground that they cover beside the ways of the map as they turn.

The map's regions lie between bands that cars sweep. SUMO lays a body straight from its front towards where its rear is on
its way: in a bend a long one cuts the corner, and since the chord is shorter than the way, its tail reaches out behind.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import shapely

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.geometry.polyline import Floats, Polyline, cut, joined
from sumo_reactive.driver.nouns.snapshot import Conflict
from sumo_reactive.driver.nouns.traffic import Body
from sumo_reactive.driver.view.ahead import conflicts_of
from sumo_reactive.driver.world.junction import HOLD_BACK_REACH_M, Connection
from sumo_reactive.driver.world.lane import road_of
from sumo_reactive.driver.world.regions import (
    SWEPT_WIDTH_M,
    ConflictKind,
    ConflictRegion,
    Interval,
    PostConflictRegion,
)
from sumo_reactive.driver.world.road_graph import RoadGraph


class Size(NamedTuple):
    """Length and width of a body, and the length both ends of which keep to its way, m."""

    length: float
    width: float
    turning: float


_BODIES_STEP_M = 0.5
"""The body is laid along its way this often."""


def size_of(body: Body) -> Size:
    """Return the size of a body."""
    return Size(body.length, body.width, body.turning_length)


@kept(4096)
def conflicts_with_long(graph: RoadGraph, own_id: str, size: Size) -> tuple[Conflict, ...]:
    """Return the conflicts of a connection with bodies of a `size`: the map's, and those with who comes from another road
    and reaches over, though the map calls that free and no rule makes anybody wait.

    On their ways (`other`) the regions are where their fronts are while they are in them.
    """
    own = graph.connections[own_id]
    return tuple(_widened(graph, own, conflicts_of(graph, own, graph.regions_on(own)), size))


def _widened(graph: RoadGraph, own: Connection, known: tuple[Conflict, ...], size: Size) -> Iterator[Conflict]:
    line = _own_line(graph, own)
    band = shapely.buffer(line, 0.5 * SWEPT_WIDTH_M, cap_style="flat")
    shapely.prepare(band)
    for other in graph.junctions[own.junction_id].connections:
        is_met = road_of(other.from_lane) == road_of(own.from_lane) or other.to_lane == own.to_lane or other.is_crossing
        found = None if is_met else _region(own, (line, band), other, _bodies(graph, other.id, size))
        over = 0.0 if found is None else max(-found.own.start, 0.0)
        on_map = [conflict for conflict in known if conflict.other.id == other.id]
        for conflict in on_map:
            yield conflict._replace(region=_longer(conflict.region, size.length, found), reaches_over=over)
        if found is not None and not on_map:
            yield Conflict(_behind_line(found), other, must_yield=False, is_yielded_to=False, reaches_over=over)


def _own_line(graph: RoadGraph, own: Connection) -> Any:
    """Return the line that the ego drives from HOLD_BACK_REACH_M before the stop line to as far behind the junction."""
    before, behind = graph.lanes[own.from_lane].spine, graph.lanes[own.to_lane].spine
    head = cut(before, before.length - HOLD_BACK_REACH_M, before.length)
    return shapely.linestrings(joined([head, own.path.points, cut(behind, 0.0, min(behind.length, HOLD_BACK_REACH_M))]))


@kept(256)
def _bodies(graph: RoadGraph, other_id: str, size: Size) -> tuple[Floats, Any]:
    """Return where the front of a body is from its stop line on until its rear is behind the junction, (n,), m, and the
    boxes (n,) there."""
    other = graph.connections[other_id]
    before, behind, length = graph.lanes[other.from_lane].spine, graph.lanes[other.to_lane].spine, size.length
    head, tail = cut(before, before.length - length, before.length), cut(behind, 0.0, min(behind.length, length))
    way = Polyline(joined([head, other.path.points, tail]))
    fronts = np.arange(0.0, max(way.length - length, _BODIES_STEP_M), _BODIES_STEP_M)
    front, rear = way.points_at(fronts + length), way.points_at(fronts + length - size.turning)
    along = (front - rear) / np.maximum(np.hypot(*(front - rear).T), 1e-6)[:, None]
    aside = 0.5 * size.width * np.column_stack((-along[:, 1], along[:, 0]))
    end = front - length * along
    return fronts, shapely.polygons(np.stack((front + aside, end + aside, end - aside, front - aside), axis=1))


def _region(
    own: Connection, swept: tuple[Any, Any], other: Connection, bodies: tuple[Floats, Any]
) -> ConflictRegion | None:
    """Return where the `bodies` on another way reach over the own line and band; None: nowhere."""
    (line, band), (fronts, boxes) = swept, bodies
    at = np.flatnonzero(shapely.intersects(boxes, band))
    if not len(at):
        return None
    met = shapely.intersection(boxes[at], band)
    along = shapely.line_locate_point(line, shapely.points(shapely.get_coordinates(met))) - HOLD_BACK_REACH_M
    start, end, region_id = float(along.min()), float(along.max()), f"{own.id}~{other.id}"
    first, last = float(fronts[at[0]]), float(fronts[at[-1]]) + _BODIES_STEP_M
    return ConflictRegion(
        id=region_id, kind=ConflictKind.CROSSING, own_id=own.id, other_id=other.id, own=Interval(start, end),
        other=Interval(first, last),
        polygon=shapely.get_coordinates(shapely.convex_hull(shapely.geometrycollections(met)))[:-1],
        post=PostConflictRegion(own.id, end, region_id),
    )  # fmt: skip


def _behind_line(region: ConflictRegion) -> ConflictRegion:
    """Return what of a region lies behind the own stop line."""
    own = Interval(max(region.own.start, 0.0), max(region.own.end, 0.0))
    return replace(region, own=own, post=replace(region.post, start=own.end))


def _longer(region: ConflictRegion, length: float, found: ConflictRegion | None) -> ConflictRegion:
    """Return a region of the map as far as a body of `length` m reaches, `found` along its way."""
    own, other = region.own, Interval(region.other.start, region.other.end + length)
    if found is not None:
        own = Interval(min(own.start, max(found.own.start, 0.0)), max(own.end, found.own.end))
        other = Interval(min(other.start, found.other.start), max(other.end, found.other.end))
    return replace(region, own=own, other=other, post=replace(region.post, start=own.end))
