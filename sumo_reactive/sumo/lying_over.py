"""Which lane the ego's body lies over although SUMO does not have it there: beside its own, or of others who come."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator
from typing import Any

import shapely

from sumo_reactive.driver.caching import PLANS_KEPT, kept
from sumo_reactive.driver.nouns.plan import LaneSegment, Turnaround, segment_at
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.view.corridor import OFF_TRACKING_M
from sumo_reactive.driver.view.swept_conflict import swept_conflicts
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.sumo.stand_ins import OCCUPIED_LANE_M, Occupant, OccupiedLane

_BEFORE_GOAL_M = 0.5
"""Who is to stand on a lane where his route ends stands this far before its end, else SUMO lets him arrive."""

_SOON_BEHIND_M = 30.0
"""Who comes out of a junction has to brake for what stands this near behind it."""

_WIDE_M = 2.5
"""The width of buses and trucks, m."""


def lane_lain_over(by: Occupant, s: float, edges: tuple[str, ...], shown: str = "") -> OccupiedLane | None:
    """Return where to show an ego whose body lies over a lane on which SUMO does not have it, nor is it `shown` there: the
    one that it covers most; None: it is within its lanes. `s`: where its front axle is, m of C; `edges`: its route.

    Beside its own lane it is shown driving along; where it passes somebody, not before he need not brake for it. On a lane
    of others who come towards it or from aside, it is shown as something that stands on the stretch that is covered, where
    nobody is yet nor would have to brake hard for it: nobody there would else look at it, nor would SUMO keep from putting
    somebody there.
    """
    front = s + by.limits.front_overhang
    ends = by.here, _rear_segment(by, front)
    if _are_near_middle(by, ends):
        return None
    corners = _corners(by)
    if _is_within(by.graph, ends, corners):
        return None
    around = dict(_lanes_around(by, ends, front, shown))
    lane, area = _most_covered(by, corners, around)
    if lane is None:
        return None
    along = around[lane]
    if along is None:
        return _standing_on(by.graph, lane, area)
    passes = by.plan.aside is not None
    return OccupiedLane(lane, *by.front, by.ego.speed, edges[along.route_index :], waits=passes, is_early=passes)


def lane_turned_over(by: Occupant, turn: Turnaround, shown: Collection[str]) -> OccupiedLane | None:
    """Return where to show an ego that turns round in several moves on the lane that it lies over most, of the roads that it
    turns from and into, as something that stands there; None: it is `shown` on all of them, or known to SUMO there."""
    roads = (by.graph.lanes[end].edge_id for end in (turn.from_lane, turn.to_lane))
    over = (lane for road in roads for lane in by.graph.edge_lanes[road] if lane.id != by.mapped and lane.id not in shown)
    lane, area = _most_covered(by, _corners(by), over)
    return None if lane is None else _standing_on(by.graph, lane, area)


def _most_covered(by: Occupant, corners: _Corners, lanes: Iterable[Lane]) -> tuple[Lane | None, Any]:
    """Return on which of the `lanes` that its like may drive on a body covers most, and the ground of it."""
    box, most, found, covered = shapely.polygons(corners), 0.0, None, None
    for lane in lanes:
        if not lane.allows(by.limits.vehicle_class):
            continue
        ground = shapely.intersection(box, _middle_of(lane, _left_beside(lane)))
        if shapely.area(ground) > most:
            most, found, covered = shapely.area(ground), lane, ground
    return found, covered


def _standing_on(graph: RoadGraph, lane: Lane, ground: Any) -> OccupiedLane | None:
    """Return what stands on a lane as long as its covered `ground`; None where that is behind its end."""
    reach = lane.spine.arc_lengths_at(shapely.get_coordinates(ground))
    first, last = float(reach.min()), min(float(reach.max()), lane.spine.length - _BEFORE_GOAL_M)
    if last <= first:
        return None
    place, ways = lane.spine.at(last), _ways_to(graph, lane, first)
    return OccupiedLane(lane, *place, 0.0, (lane.edge_id,), waits=True, ways=ways, is_early=True, length=last - first)


def _ways_to(graph: RoadGraph, lane: Lane, first: float) -> tuple[str, ...]:
    """Return the lanes by which others come to a lane that is covered from `first` m on, if that is near its start."""
    if first > _SOON_BEHIND_M:
        return ()
    return tuple(part for way in graph.ways_into(lane.id) for part in (way.from_lane, *way.parts))


def _rear_segment(by: Occupant, front: float) -> LaneSegment:
    """Return the segment of C that SUMO has the rear on: after a change of lanes that where the front is, too."""
    rear = segment_at(by.plan, front - by.limits.length)
    return by.here if _edge_of(by, rear) == _edge_of(by, by.here) else rear


def _edge_of(by: Occupant, segment: LaneSegment) -> str:
    return by.graph.lanes[segment.lane_id].edge_id


_Corners = tuple[tuple[float, float], ...]
"""Places (m), front left first and round."""


def _corners(by: Occupant) -> _Corners:
    """Return the four corners of the body."""
    heading, half = by.ego.pose.heading, 0.5 * by.limits.width
    (x, y), (rx, ry) = by.front, by.behind_front(by.limits.length)
    ax, ay = -half * math.sin(heading), half * math.cos(heading)
    return (x + ax, y + ay), (x - ax, y - ay), (rx - ax, ry - ay), (rx + ax, ry + ay)


def _are_near_middle(by: Occupant, ends: tuple[LaneSegment, LaneSegment]) -> bool:
    """Whether both ends of the body are so near to the middle of their lanes that no corner can be beside one, however the
    body is turned."""
    for segment, place in zip(ends, (by.front, by.behind_front(by.limits.length)), strict=True):
        lane = by.graph.lanes[segment.lane_id]
        if abs(lane.spine.offset(*place)) + 0.5 * by.limits.width > 0.5 * lane.width + OCCUPIED_LANE_M:
            return False
    return True


def _is_within(graph: RoadGraph, ends: tuple[LaneSegment, LaneSegment], corners: _Corners) -> bool:
    """Whether each corner is on the lane that C has that end of the body on, or hardly beside it."""
    for segment, places in zip(ends, (corners[:2], corners[2:]), strict=True):
        lane = graph.lanes[segment.lane_id]
        most, offset = 0.5 * lane.width + OCCUPIED_LANE_M, lane.spine.offset
        if any(abs(offset(x, y)) > most for x, y in places):
            return False
    return True


def _lanes_around(
    by: Occupant, ends: tuple[LaneSegment, LaneSegment], front: float, shown: str
) -> Iterator[tuple[Lane, LaneSegment | None]]:
    """Yield the lanes that the body may lie over, those left out where it is seen, each with the segment of C beside it;
    None: it leads elsewhere."""
    graph, seen = by.graph, {shown, *_known_to_sumo(by)}
    at_junction = any(graph.lanes[segment.lane_id].is_internal for segment in ends)
    is_passing = at_junction or by.ego.speed >= STANDING_SPEED  # on a road it would stand, and wait for who waits for it
    for segment in ends:
        own = graph.lanes[segment.lane_id]
        for edge in {graph.lanes[lane].edge_id for lane in _roads_of(graph, own)}:
            for lane in (*graph.edge_lanes[edge], *graph.oncoming(edge)):
                is_beside = lane.edge_id == own.edge_id
                if lane.id not in seen and (is_beside or is_passing):
                    seen.add(lane.id)
                    yield lane, segment if is_beside else None
    for i, conflicts in swept_conflicts(by.plan, graph, by.limits).items():
        passage, reach = by.plan.passages[i], by.limits.length
        if not passage.start - reach < front < passage.end + 2.0 * reach:
            continue
        for conflict in conflicts:
            lane = graph.lanes[conflict.other.from_lane]
            if conflict.region.other.start < 0.0 and lane.id not in seen:
                seen.add(lane.id)
                yield lane, None


def _known_to_sumo(by: Occupant) -> Iterator[str]:
    """Yield the lane that SUMO maps the ego to, and those of C behind its edge, on which it has the rear."""
    lanes = [segment.lane_id for segment in by.plan.segments]
    yield by.mapped
    behind = lanes[: lanes.index(by.mapped)] if by.mapped in lanes else ()
    yield from (lane for lane in behind if by.graph.lanes[lane].edge_id != by.graph.lanes[by.mapped].edge_id)


def _roads_of(graph: RoadGraph, own: Lane) -> tuple[str, ...]:
    """Return a lane itself, or those that a lane inside a junction leads from and to."""
    if not own.is_internal:
        return (own.id,)
    connection = graph.connection_of[own.id]
    return connection.from_lane, connection.to_lane


def _left_beside(lane: Lane) -> float:
    """Return how far a body may reach over a lane, and yet not be in the way of wide ones there, m."""
    return min(0.5 * (lane.width - _WIDE_M) + OCCUPIED_LANE_M, OFF_TRACKING_M)


@kept(PLANS_KEPT)
def _middle_of(lane: Lane, edge: float) -> Any:
    """Return the ground of a lane but for its outer `edge` (m) on either side."""
    half = max(0.5 * lane.width - edge, OCCUPIED_LANE_M)
    return shapely.buffer(shapely.linestrings(lane.spine.points), half, cap_style="flat")
