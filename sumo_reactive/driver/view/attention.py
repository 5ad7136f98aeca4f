"""Where to look: the lanes that matter at a place of the plan, and who on them can reach a conflict region on the way."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from sumo_reactive.driver.caching import PLANS_KEPT, kept
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import Conflict, Foe
from sumo_reactive.driver.nouns.traffic import Body, RoadUser, Traffic
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.view.ahead import conflicts_of, passages_ahead
from sumo_reactive.driver.view.corridor import next_off_tracking, off_tracking_of
from sumo_reactive.driver.view.leaders import ORDINARY_M
from sumo_reactive.driver.view.long_foes import Size, conflicts_with_long, size_of
from sumo_reactive.driver.view.swept_conflict import swept_conflicts
from sumo_reactive.driver.world.road_graph import RoadGraph

ATTENTION_TIME_S = 8.0
"""The ego looks this long ahead at its present speed."""

ATTENTION_MIN_AHEAD_M = 60.0
"""The ego looks at least this far ahead, however slow it is."""

ATTENTION_BEHIND_M = 90.0
"""How far back a lane is watched before changing onto it: 3 s at 30 m/s of closing speed."""


class ConflictingLane(NamedTuple):
    """A lane from which a conflict can arise.

    A user at arc length p of the lane has `distance` − p m to its stop line, if its route begins with `edges`; the region
    lies from `start` to `end` m behind that line.
    """

    conflict: Conflict
    distance: float
    edges: tuple[str, ...]
    start: float
    end: float


@kept(4096)
def watches_of(graph: RoadGraph, connection_id: str) -> Mapping[str, tuple[ConflictingLane, ...]]:
    """Return, by lane id, what a user on that lane may mean for a passage by the connection."""
    own = graph.connections[connection_id]
    return _lanes_to(graph, conflicts_of(graph, own, graph.regions_on(own)))


def _lanes_to(
    graph: RoadGraph, conflicts: tuple[Conflict, ...], length: float = 0.0
) -> Mapping[str, tuple[ConflictingLane, ...]]:
    """Return, by lane id, what a user there may mean for somebody to whom the `conflicts` are; `length` (m): of whom they
    hold all along, from front to rear. Who comes from the same lane counts in the junction: until then he drives ahead or
    follows."""
    table: dict[str, list[ConflictingLane]] = {}
    for conflict in conflicts:
        region, other = conflict.region, conflict.other
        stretch = region.other.start, region.other.end - length
        for lane_id, behind in graph.lanes_behind(other):
            table.setdefault(lane_id, []).append(ConflictingLane(conflict, -behind, (), *stretch))
        is_beside = graph.connections[region.own_id].from_lane != other.from_lane
        for lane in graph.approaches.get(other.id, ()) if is_beside else ():
            table.setdefault(lane.lane_id, []).append(ConflictingLane(conflict, lane.distance, lane.edges, *stretch))
    return {lane_id: tuple(entries) for lane_id, entries in table.items()}


@kept(4096)
def lanes_around(graph: RoadGraph, connection_id: str) -> tuple[str, ...]:
    """Return every lane to look at while passing a junction: inside, before, behind as far as long bodies reach back, and
    where foes come from."""
    junction = graph.junctions[graph.connections[connection_id].junction_id]
    lanes = (lane for c in junction.connections for lane in (*c.parts, c.from_lane, c.to_lane) if lane in graph.lanes)
    behind = (lane for c in junction.connections for lane in graph.beyond.get(c.to_lane, ()))
    return tuple(dict.fromkeys((*lanes, *behind, *watches_of(graph, connection_id))))


@kept(1024)
def lane_axis(graph: RoadGraph, lane_id: str) -> Mapping[str, float]:
    """Return, by lane id, the arc length at which lanes before and behind `lane_id` start on its own axis (m).

    The axis runs through the lane's predecessors, `ATTENTION_BEHIND_M` back, and through its successors as far ahead.
    """
    lane = graph.lanes[lane_id]
    axis = {lane_id: 0.0}
    queue = [(lane_id, 0.0)]
    while queue:
        here, start = queue.pop()
        for connection in graph.ways_into(here):
            at = start
            for part in reversed(connection.parts):
                at -= graph.lanes[part].spine.length
                axis.setdefault(part, at)
            before = connection.from_lane
            if before in graph.lanes and before not in axis:
                axis[before] = at - graph.lanes[before].spine.length
                if at > -ATTENTION_BEHIND_M:
                    queue.append((before, axis[before]))
    queue = [(lane_id, lane.spine.length)]
    while queue:
        here, end = queue.pop()
        for connection in graph.ways_from(here):
            *parts, (behind, at) = graph.lanes_behind(connection)
            for part, start in parts:
                axis.setdefault(part, end + start)
            if behind in graph.lanes and behind not in axis:
                axis[behind] = end + at
                if axis[behind] < lane.spine.length + ATTENTION_BEHIND_M:
                    queue.append((behind, axis[behind] + graph.lanes[behind].spine.length))
    return axis


@kept(1024)
def axis_before(graph: RoadGraph, lane_id: str) -> Mapping[str, tuple[tuple[float, tuple[str, ...]], ...]]:
    """Return, by lane id, where lanes start on the axis of `lane_id` (m) that W holds as approaches to it alone, and the
    edges that who comes from there has before him.

    Their ends are at most `ATTENTION_BEHIND_M` before its start.
    """
    axis, found = lane_axis(graph, lane_id), dict[str, tuple[tuple[float, tuple[str, ...]], ...]]()
    for connection in graph.ways_into(lane_id):
        line = -sum(graph.lanes[part].spine.length for part in connection.parts)
        for one in graph.approaches.get(connection.id, ()):
            start = line - one.distance
            if one.lane_id not in axis and start + graph.lanes[one.lane_id].spine.length > -ATTENTION_BEHIND_M:
                found[one.lane_id] = (*found.get(one.lane_id, ()), (start, one.edges))
    return found


def in_sight(plan: NominalPlan, front: float, speed: float) -> tuple[int, ...]:
    """Return the indices of the passages that matter with the front bumper at `front` (m) and `speed` (m/s)."""
    reach = front + max(ATTENTION_MIN_AHEAD_M, ATTENTION_TIME_S * speed)
    behind, found = front - ATTENTION_MIN_AHEAD_M / 3, []
    for i, passage in enumerate(plan.passages):  # in order along C
        if passage.start > reach:
            break
        if passage.end >= behind:
            found.append(i)
    return tuple(found)


def lane_sought(graph: RoadGraph, plan: NominalPlan, limits: VehicleLimits, front: float, speed: float) -> str:
    """Return the lane that the ego would enter if it made the next change here, if a gap for it matters already at its
    `speed` (m/s); empty: none.

    Where C makes the change on a later road, that is the lane beside its own, which leads to the same place; inside a
    junction, or where it may not begin yet, that on the road behind. Without a change it is the lane that the own one merges
    into.
    """
    change = plan.next_change(front) if plan.lane_changes else None
    if change is None or not plan.may_be_sought(change, front, speed, limits.parameters.comfort_deceleration):
        merge = plan.merging(front)
        return "" if merge is None else merge.to_lane
    if not plan.may_begin(change, front):
        return change.to_lane
    ahead = (segment for segment in plan.segments if segment.end > front)
    here = next((segment for segment in ahead if not graph.lanes[segment.lane_id].is_internal), None)
    if here is None or graph.lanes[here.lane_id].edge_id == graph.lanes[change.to_lane].edge_id:
        return change.to_lane
    left, right = graph.neighbours(here.lane_id)
    beside = left if change.side > 0 else right
    return change.to_lane if beside is None else beside.id


def place_beside(graph: RoadGraph, plan: NominalPlan, lane_id: str, front: float, x: float, y: float) -> float:
    """Return the arc length (m) on a lane beside C of the front bumper, which is at `x`, `y` (m) and at `front` on C.

    It is negative by the way along C that is still to go to the lane's road.
    """
    lane = graph.lanes[lane_id]
    segments = (segment for segment in plan.segments if segment.end > front)
    there = next((segment for segment in segments if graph.lanes[segment.lane_id].edge_id == lane.edge_id), None)
    if there is not None and there.start > front:
        return there.lane_offset - (there.start - front)
    return lane.spine.project(x, y)[0]


def lanes_in_sight(
    graph: RoadGraph, plan: NominalPlan, limits: VehicleLimits, front: float, speed: float, sight: float = 0.0
) -> tuple[str, ...]:
    """Return the ids of the lanes whose users matter now, each once; `sight` (m): how far to look at the own road."""
    reach = front + max(ATTENTION_MIN_AHEAD_M, ATTENTION_TIME_S * speed)
    far, behind = max(reach, front + sight), front - ATTENTION_BEHIND_M
    ways = tuple(i for i, one in enumerate(plan.segments) if one.start <= far and one.end >= behind)
    beside, change = lane_sought(graph, plan, limits, front, speed), plan.next_change(front)
    if not beside and change is not None and change.opens <= front + ATTENTION_MIN_AHEAD_M:
        beside = change.to_lane
    cut = next_off_tracking(off_tracking_of(plan, graph, limits), front - limits.front_overhang, front)
    onto = tuple(lane for lane in (beside, cut.lane_id if cut else "") if lane)
    return _lanes_of(plan, graph, limits, (ways, plan.segments[-1].start <= reach, in_sight(plan, front, speed), onto))


@kept(PLANS_KEPT)
def _lanes_of(
    plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits,
    seen: tuple[tuple[int, ...], bool, tuple[int, ...], tuple[str, ...]],
) -> tuple[str, ...]:  # fmt: skip
    """Return the lanes of and around what is `seen` of a plan: segments, whether that is all, passages, lanes beside that
    the body comes onto."""
    lanes: dict[str, None] = {}
    ways, is_all, passages, onto = seen
    for i in ways:
        lane = graph.lanes[plan.segments[i].lane_id]
        lanes.update((one.id, None) for one in graph.edge_lanes.get(lane.edge_id, (lane,)))
        lanes.update((one.id, None) for one in graph.oncoming(lane.edge_id))
    if is_all:
        lanes.update(dict.fromkeys(_lanes_beyond(graph, graph.lanes[plan.segments[-1].lane_id].edge_id)))
    for i in passages:
        lanes.update(dict.fromkeys(lanes_around(graph, plan.passages[i].connection_id)))
        lanes.update(dict.fromkeys(_lanes_to(graph, swept_conflicts(plan, graph, limits).get(i, ()))))
    for lane_id in onto:
        lanes.update(dict.fromkeys((*lane_axis(graph, lane_id), *axis_before(graph, lane_id))))
    return tuple(lanes)


@kept(1024)
def _lanes_beyond(graph: RoadGraph, edge_id: str) -> tuple[str, ...]:
    """Return the lanes that lead on from an edge: who has left the last one of the way may still reach back over it."""
    ways = (way for lane in graph.edge_lanes.get(edge_id, ()) for way in graph.ways_from(lane.id) if not way.is_crossing)
    lanes = (lane for way in ways for lane in (*way.parts, way.to_lane, *graph.beyond.get(way.to_lane, ())))
    return tuple(dict.fromkeys(lane for lane in lanes if lane in graph.lanes))


_Meaning = tuple[int, Conflict, float, tuple[str, ...], float, float]
"""A passage, and what a user of a lane may do to the ego on it: the fields of a `ConflictingLane`.

It is plain because every user near is held against it at every step: a named tuple takes longer to take apart.
"""


def foes_of(
    traffic: Traffic, plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits, sight: tuple[int, ...]
) -> tuple[Foe, ...]:
    """Return who can reach a region of the plan's passages in `sight`, once for each region."""
    found: list[Foe] = []
    meanings = _meanings(graph, plan, limits, sight) if sight else {}
    of_long = dict[Body, Mapping[str, tuple[_Meaning, ...]]]()
    for user in (*traffic.users, *traffic.beside) if meanings else ():
        body, known = user.body, meanings
        length = body.length
        if length > ORDINARY_M:
            known = of_long.get(body) or of_long.setdefault(body, _meanings(graph, plan, limits, sight, size_of(body)))
        watched = known.get(user.lane_id)
        if watched is None:
            continue
        at, is_person, route = user.lane_position, body.is_person, user.route
        for passage, conflict, distance, edges, start, end in watched:
            if edges and route and edges != route[: len(edges)] and not (start < 0.0 and route == edges[:-1]):
                continue  # who ends his trip before the line comes to what lies there all the same
            if is_person:
                foe = _walker(user, passage, conflict, start, end)
                if foe.to_clear > 0.0:
                    found.append(foe)
                continue
            to_line = distance - at
            to_clear = to_line + end + length
            if to_clear > 0.0:
                found.append(Foe._make((user, passage, conflict, to_line, to_line + start, to_clear)))
    return tuple(found)


@kept(PLANS_KEPT)
def _meanings(
    graph: RoadGraph, plan: NominalPlan, limits: VehicleLimits, sight: tuple[int, ...], size: Size | None = None
) -> Mapping[str, tuple[_Meaning, ...]]:
    """Return, by lane id, what a user on that lane may mean for the plan's passages in `sight`; `size`: of one whose body
    is so long that it reaches beside his way."""
    table: dict[str, list[_Meaning]] = {}
    for i, connection, _ in passages_ahead(graph, plan, limits, sight):
        swept = _lanes_to(graph, swept_conflicts(plan, graph, limits).get(i, ()))
        known = watches_of(graph, connection.id)
        if size is not None:
            known = _lanes_to(graph, conflicts_with_long(graph, connection.id, size), size.length)
        for lane_id, watches in (*known.items(), *swept.items()):
            table.setdefault(lane_id, []).extend((i, *watch) for watch in watches)
    return {lane_id: tuple(meanings) for lane_id, meanings in table.items()}


def _walker(user: RoadUser, passage: int, conflict: Conflict, start: float, end: float) -> Foe:
    """A pedestrian may walk along the crossing's path or against it, and stand before it."""
    at, path = user.lane_position, conflict.other.path
    to_step_on = max(-at, at - path.length)
    forward = math.cos(user.heading - path.heading_at(at)) >= 0.0
    to_region, to_clear = (start - at, end - at) if forward else (at - end, at - start)
    return Foe(user, passage, conflict, to_step_on if to_step_on > 0.0 else -1.0, to_region, to_clear)
