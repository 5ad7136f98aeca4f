"""Conflict regions and the post-conflict regions behind them, from the bands that bodies sweep (F&L 1991, §2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
import shapely

from sumo_reactive.driver.geometry.polyline import Points, Polyline, cut, joined
from sumo_reactive.driver.world.junction import HOLD_BACK_REACH_M, Connection, Junction
from sumo_reactive.driver.world.lane import road_of

SWEPT_WIDTH_M = 2.2
"""Width of the band that a body sweeps along its path: a car of 1.8 m with 0.2 m to spare on either side."""

MIN_REGION_AREA_M2 = 0.01
"""Smaller overlaps of paths that the network itself calls conflicting come from rounding (coordinates hold 1 cm)."""

UNDECLARED_REGION_AREA_M2 = 0.5
"""Overlap that makes a conflict region of paths that the network calls free of conflict: two corners 0.7 m deep."""

STRAIGHT_COSINE = 0.95
"""Paths that nowhere turn by more than the angle with this cosine, 0.32 rad, are straight."""

PASSED_BESIDE_M = 1.2
"""Oncoming ways at least so far apart are those of lanes: a car of 1.8 m has the rest of the room that it needs outside."""

SEPARATE_LEVELS_M = 3.0
"""Difference in height of paths that pass over each other; a car and its clearance need about this."""

LONG_REACH_M = 5.0
"""The body of a trailer of 18 m reaches over ways this far beside its own, but for half of another's width."""

REGION_STEP_M = 0.25
"""Spacing of the points of a region's outline that are projected on the paths."""

CROSSED_TWICE_M = 9.0
"""Where ways meet twice, and on each of them so much lies between, a car of 5 m can stand clear of both places, 2 m each."""

TAIL_REACH_M = 20.0
"""How far a lane behind a junction is looked at for a part that lies inside the junction's outline."""

MIN_TAIL_M = 2.0
"""Shorter parts are rounding of the map."""


class ConflictKind(Enum):
    """How two paths meet."""

    CROSSING = "crossing"
    MERGING = "merging"
    DIVERGING = "diverging"


@dataclass(frozen=True)
class Interval:
    """A stretch [start, end] of arc length on a path, m."""

    start: float
    end: float

    def __post_init__(self) -> None:
        if self.end < self.start:
            raise ValueError(f"interval ends at {self.end} before it starts at {self.start}")


@dataclass(frozen=True, eq=False)
class PostConflictRegion:
    """The room behind a conflict region that a vehicle needs so as not to stop inside it (F&L 1991, §2).

    It starts on the own path at `start` (arc length from the stop line, m; it may lie on the lane behind the junction).
    `region_id` names the conflict region before it.
    """

    connection_id: str
    start: float
    region_id: str = ""

    @property
    def id(self) -> str:
        """Name of this node of the graph."""
        return f"{self.region_id or self.connection_id}+post"


@dataclass(frozen=True, eq=False, kw_only=True)
class ConflictRegion:
    """Where bodies on connection `own_id` and on `other_id` may touch: one vehicle at a time (F&L 1991, §2).

    Ways that cross twice have two, the second one with a number at the end of its `id`. `own` and `other` are the
    stretches on each connection's path, arc length from its stop line; `polygon` is the common area, shape (n, 2), m.
    """

    id: str
    kind: ConflictKind
    own_id: str
    other_id: str
    own: Interval
    other: Interval
    polygon: Points
    post: PostConflictRegion


_ARC_SEGMENTS = 3  # per quarter circle: within 4 cm of a round joint of 1.1 m radius


def conflict_regions(owns: Sequence[Connection], junction: Junction) -> dict[str, tuple[ConflictRegion, ...]]:
    """Return the conflict regions of each of `owns` (connections of `junction`) by its id, in order of their start."""
    if not owns:
        return {}
    points, path_numbers = _indexed_points(junction.connections)
    lines = shapely.linestrings(points, indices=path_numbers)
    widths = [connection.width if connection.is_crossing else SWEPT_WIDTH_M for connection in junction.connections]
    sweeps = _bands(lines, 0.5 * np.array(widths), _ARC_SEGMENTS)
    position = {connection.id: i for i, connection in enumerate(junction.connections)}
    return {own.id: _regions_of(position[own.id], junction, lines, sweeps) for own in owns}


def _bands(lines: Any, half_widths: Any, arc_segments: int = 8) -> Any:
    """Return the areas swept along `lines` up to `half_widths` m on each side, valid ones.

    With flat ends, the outline that GEOS draws of a hairpin crosses itself where the legs are nearer to each other than the
    band is wide. The structure of its rings, not its lines, then tells what is inside: both legs, and where they overlap.
    """
    bands = shapely.buffer(lines, half_widths, cap_style="flat", quad_segs=arc_segments)
    if np.all(shapely.is_valid(bands)):
        return bands
    return shapely.make_valid(bands, method="structure", keep_collapsed=False)


def _indexed_points(connections: Sequence[Connection]) -> tuple[Points, Any]:
    """Return the points of all paths with their heads and tails (n, 2), and the number of each one's path, shape (n,)."""
    points = [joined([part for part in (c.head, c.path.points, c.tail) if part is not None]) for c in connections]
    return np.concatenate(points), np.repeat(np.arange(len(points)), [len(part) for part in points])


def inside_part(spine: Polyline, outline: Points) -> Points | None:
    """Return the first part of a lane, points (k, 2), that lies inside a junction's outline (n, 2); None if it is short.

    Some maps let an edge begin in the middle of its junction: traffic on it then still crosses the others.
    """
    reach = np.arange(0.0, min(spine.length, TAIL_REACH_M), REGION_STEP_M)
    points = np.array([spine.at(s) for s in reach])
    if len(outline) < 3 or len(points) == 0:
        return None
    inside = shapely.contains_xy(shapely.polygons(outline), points)
    length = len(points) if inside.all() else int(np.argmin(inside))
    return points[:length] if length * REGION_STEP_M >= MIN_TAIL_M else None


def hold_back(approach: Polyline, ways: Sequence[Points]) -> tuple[float, tuple[int, ...]]:
    """Return how far before the end of an approach lane (m) a body must stop to stay out of the bands swept along `ways`,
    and the numbers of the ways that reach over it.

    `ways` are paths of traffic from other lanes, each with the start of the lane behind it. On most maps none of them
    reaches over the stop line.
    """
    start = max(approach.length - HOLD_BACK_REACH_M, 0.0)
    line = shapely.linestrings(cut(approach, start, approach.length))
    band = _bands(line, 0.5 * SWEPT_WIDTH_M)
    near = [i for i, way in enumerate(ways) if _bounds_meet(band.bounds, way)]
    if not near:
        return 0.0, ()
    bands = _bands([shapely.linestrings(ways[i]) for i in near], 0.5 * SWEPT_WIDTH_M)
    overlaps = shapely.intersection(band, bands)
    found = {i: part for i, part in zip(near, overlaps, strict=True) if part.area > UNDECLARED_REGION_AREA_M2}
    if not found:
        return 0.0, ()
    corners = shapely.points(shapely.get_coordinates(list(found.values())))
    return float(line.length - shapely.line_locate_point(line, corners).min()), tuple(found)


def ways_near(own: Connection, behind: Polyline, junction: Junction) -> tuple[str, ...]:
    """Return the connections from other roads, no pedestrian crossings, nearer than LONG_REACH_M to an `own` one or
    the lane `behind` it."""
    road, line = road_of(own.from_lane), joined([own.path.points, cut(behind, 0.0, min(behind.length, HOLD_BACK_REACH_M))])
    others = [c for c in junction.connections if not c.is_crossing and road_of(c.from_lane) != road]
    if not others:
        return ()
    points, numbers = _indexed_points(others)
    away = shapely.distance(shapely.linestrings(line), shapely.linestrings(points, indices=numbers))
    return tuple(c.id for c, distance in zip(others, away.tolist(), strict=True) if distance < LONG_REACH_M)


def _bounds_meet(bounds: tuple[float, ...], way: Points) -> bool:
    (x0, y0), (x1, y1) = way.min(axis=0) - SWEPT_WIDTH_M, way.max(axis=0) + SWEPT_WIDTH_M
    return bool(x0 < bounds[2] and bounds[0] < x1 and y0 < bounds[3] and bounds[1] < y1)


def _regions_of(i: int, junction: Junction, lines: Any, sweeps: Any) -> tuple[ConflictRegion, ...]:
    own = junction.connections[i]
    overlaps = shapely.intersection(sweeps[i], sweeps)
    areas = shapely.area(overlaps)
    found = []
    for j, other in enumerate(junction.connections):
        kind = conflict_kind(own, other)
        if j == i or not _meet(own, other, kind, areas[j], junction):
            continue
        parts = _parts(overlaps[j], kind, (lines[i], lines[j])) if areas[j] > 0.0 else [_touch(own, kind)]
        for number, part in enumerate(parts):
            if not _on_separate_levels(own, other, part):
                end = 0 if kind is ConflictKind.DIVERGING else len(parts) - 1
                meets = kind if number == end else ConflictKind.CROSSING
                found.append(_region(own, other, meets, part, (lines[i], lines[j]), number))
    return tuple(sorted(found, key=lambda region: (region.own.start, region.other_id)))


def conflict_kind(own: Connection, other: Connection) -> ConflictKind:
    """Return how two paths meet, if they meet."""
    if own.from_lane == other.from_lane:
        return ConflictKind.DIVERGING
    return ConflictKind.MERGING if own.to_lane == other.to_lane else ConflictKind.CROSSING


def _meet(own: Connection, other: Connection, kind: ConflictKind, area: float, junction: Junction) -> bool:
    """Whether an overlap of `area` m² is a conflict: paths that share an end always meet, declared foes mostly do, and those
    who come towards each other straight on a narrow road pass each other there as on the road."""
    if kind is not ConflictKind.CROSSING:
        return True
    table = junction.right_of_way
    if table.in_conflict(own.index, other.index) or table.in_conflict(other.index, own.index):
        return area > MIN_REGION_AREA_M2
    return area > UNDECLARED_REGION_AREA_M2 and not _pass_each_other(own.path, other.path)


def _pass_each_other(own: Polyline, other: Polyline) -> bool:
    """Whether two paths lead towards each other, straight all the way and beside each other."""
    if float(np.abs(own.offsets(other.points)).min()) < PASSED_BESIDE_M:
        return False
    out = own.heading_at(0.0)
    ways, back = np.diff(own.points, axis=0), -np.diff(other.points, axis=0)
    off = [np.arctan2(way[:, 1], way[:, 0]) - out for way in (ways, back)]
    return bool(np.cos(np.concatenate(off)).min() > STRAIGHT_COSINE)


def _parts(overlap: Any, kind: ConflictKind, lines: tuple[Any, Any]) -> list[Any]:
    """Return the areas of an overlap where one vehicle at a time may be, in order along the own one of `lines`.

    Ways may cross twice, and are one area where nobody could stand in between; those from one lane part, and may cross then.
    """
    areas = [part for part in shapely.get_parts(overlap) if part.area > 0.0]
    areas.sort(key=lambda part: float(_places(lines[0], part).min()))
    parted = 1 if kind is ConflictKind.DIVERGING else 0
    found: list[Any] = areas[:parted]
    for area in areas[parted:]:
        if parted and area.area < UNDECLARED_REGION_AREA_M2:
            continue
        if len(found) > parted and min(_between(line, found[-1], area) for line in lines) < CROSSED_TWICE_M:
            found[-1] = shapely.convex_hull(shapely.geometrycollections([found[-1], area]))
        else:
            found.append(area)
    return found


def _between(line: Any, one: Any, other: Any) -> float:
    """Return how much of a line lies between two areas along it, m; negative where they overlap."""
    s, t = _places(line, one), _places(line, other)
    return float(max(t.min() - s.max(), s.min() - t.max()))


def _places(line: Any, area: Any) -> Any:
    """Return the arc lengths on a line of the corners of an area, m."""
    return shapely.line_locate_point(line, shapely.points(shapely.get_coordinates(area)))


def _touch(own: Connection, kind: ConflictKind) -> Any:
    """Return the area (half a body wide around) of the end that two paths share although their sweeps are disjoint."""
    s = 0.0 if kind is ConflictKind.DIVERGING else own.path.length
    return shapely.buffer(shapely.points(*own.path.at(s)), 0.5 * SWEPT_WIDTH_M, quad_segs=_ARC_SEGMENTS)


def _region(
    own: Connection, other: Connection, kind: ConflictKind, overlap: Any, lines: tuple[Any, Any], number: int
) -> ConflictRegion:
    """Return the region of an overlap; `number`: how many the own way shares with the other one before it."""
    outline = shapely.points(shapely.get_coordinates(shapely.segmentize(overlap, REGION_STEP_M)))
    own_stretch = _stretch(lines[0], outline, kind, own.hold_back)
    region_id = f"{own.id}|{other.id}" + (f"|{number + 1}" if number else "")
    return ConflictRegion(
        id=region_id,
        kind=kind,
        own_id=own.id,
        other_id=other.id,
        own=own_stretch,
        other=_stretch(lines[1], outline, kind, other.hold_back),
        polygon=shapely.get_coordinates(shapely.get_exterior_ring(overlap))[:-1],
        post=PostConflictRegion(own.id, own_stretch.end, region_id),
    )


def _stretch(line: Any, outline: Any, kind: ConflictKind, head: float) -> Interval:
    """Return the arc lengths (m) over which a body's cross-section meets the area that the points `outline` enclose.

    The `line` begins `head` m before the stop line, so that a region on the approach lane starts at a negative place.
    """
    s = shapely.line_locate_point(line, outline)
    start = 0.0 if kind is ConflictKind.DIVERGING else float(s.min()) - head
    end = (float(line.length) if kind is ConflictKind.MERGING else float(s.max())) - head
    return Interval(start, max(start, end))


def _on_separate_levels(own: Connection, other: Connection, overlap: Any) -> bool:
    """Whether one path passes over the other where they overlap."""
    middle = shapely.centroid(overlap)
    own_height, other_height = _height(own, middle.x, middle.y), _height(other, middle.x, middle.y)
    return own_height is not None and other_height is not None and abs(own_height - other_height) > SEPARATE_LEVELS_M


def _height(connection: Connection, x: float, y: float) -> float | None:
    """Return the elevation (m) of a connection's path where it is closest to (x, y); None in a flat network."""
    if connection.heights is None:
        return None
    s, _ = connection.path.project(x, y)
    return float(np.interp(s, connection.path.arc_lengths, connection.heights))
