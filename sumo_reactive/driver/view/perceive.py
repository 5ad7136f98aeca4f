"""From what is observed to what it means along C: one snapshot per step."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from sumo_reactive.driver.caching import PLANS_KEPT, kept
from sumo_reactive.driver.geometry.curve import Curve, located
from sumo_reactive.driver.geometry.footprint import boxes_overlap
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.constraint import TimeConstraint, stay_behind
from sumo_reactive.driver.nouns.plan import NominalPlan, Passage
from sumo_reactive.driver.nouns.snapshot import Neighbour, OffTracking, PathObstacle, Snapshot
from sumo_reactive.driver.nouns.state import STANDING_SPEED, VehicleState
from sumo_reactive.driver.nouns.traffic import RoadUser, Traffic
from sumo_reactive.driver.vehicle.body import box_of
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.view.attention import (
    ATTENTION_MIN_AHEAD_M,
    ATTENTION_TIME_S,
    axis_before,
    in_sight,
    lane_axis,
    lane_sought,
    place_beside,
)
from sumo_reactive.driver.view.corridor import (
    TURN_FORESEEN_S,
    CorridorSides,
    band_of,
    blocking_ones,
    next_off_tracking,
    off_tracking_of,
    related,
)
from sumo_reactive.driver.view.foresee import places_after, turn_rate, way_left
from sumo_reactive.driver.view.lane_room import lane_room
from sumo_reactive.driver.view.leaders import (
    FASTER,
    Narrow,
    ahead_at_narrows,
    comes_towards,
    drives_along,
    leaders,
    narrows_of,
    time_to_meet,
)
from sumo_reactive.driver.view.levels import lanes_crossed, on_its_level
from sumo_reactive.driver.view.static import borders_along, static_near
from sumo_reactive.driver.world.road_graph import RoadGraph

MEETING_FORESEEN_S = 3.0
"""Who comes towards the ego or crosses is foreseen so far, to see whether he leaves the corridor before they meet: the
time that the comfortable deceleration takes from 7.5 m/s…"""

MEETING_STEP_S = 0.1
"""…in steps of at least this."""

SWUNG_STEP_M = 1.0
"""Who comes over C farther along his way is looked for in such steps."""

_NO_ONE_NEAR: Floats = np.empty((0, 8))


class _Course(NamedTuple):
    """C, and what the map says along it to a car: the corridor that it sweeps, where it covers the lane beside, where
    lanes are `crossed` on another level, the narrow places, the room (n,) to lean to the `left` and `right` (m), the
    borders, and the ways `inside` junctions."""

    curve: Curve
    band: CorridorSides
    off_tracking: tuple[OffTracking, ...]
    crossed: Mapping[str, tuple[float, ...]]
    narrows: tuple[Narrow, ...]
    left: Floats
    right: Floats
    borders: tuple[Sequence[float], Floats]
    inside: Mapping[str, tuple[tuple[Passage, float, float, float], ...]]


@kept(PLANS_KEPT)
def _course_of(plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits) -> _Course:
    return _Course(
        plan.curve, band_of(plan.curve, limits), off_tracking_of(plan, graph, limits), lanes_crossed(plan, graph),
        narrows_of(plan, graph, limits), *lane_room(plan, graph, limits), borders_along(plan, graph, limits.vehicle_class),
        _ways_inside(plan, graph),
    )  # fmt: skip


def locate(ego: VehicleState, plan: NominalPlan, limits: VehicleLimits, s_before: float) -> tuple[float, float]:
    """Return (s, d) of the front axle on C near `s_before` (m, left positive)."""
    curve = plan.curve
    return located(*ego.pose, limits.wheelbase, curve.x, curve.y, curve.step, s_before)


def perceive(
    traffic: Traffic, ego: VehicleState, plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits,
    place: tuple[float, float],
) -> Snapshot:  # fmt: skip
    """Relate `traffic` to the plan: who stands in the corridor, who drives beside; foes are looked for where they matter.

    `place` is (s, d) of the front axle on C (m, left positive), as `locate` finds it.
    """
    (s, d), course, step = place, _course_of(plan, graph, limits), plan.curve.step
    front = s + limits.front_overhang
    near, on_path = _related(traffic, course, graph, ego, limits, front)
    sight = in_sight(plan, front, ego.speed)
    sought = lane_sought(graph, plan, limits, front, ego.speed) if plan.lane_changes or plan.merges else ""
    off_tracking = next_off_tracking(course.off_tracking, s, front) if course.off_tracking else None
    if sought and (off_tracking is None or not _comes_first(off_tracking, plan, front)):
        off_tracking = None
    beside = off_tracking.lane_id if off_tracking else sought
    own = place_beside(graph, plan, beside, front, *ego.pose.ahead(limits.front_to_rear_axle)) if beside else 0.0
    neighbours = tuple(_neighbours(traffic.users, graph, beside, own)) if beside else ()
    static = static_near(course.borders, s, ego.pose, limits.wheelbase, traffic.static)
    met = [
        obstacle for obstacle in on_path
        if (obstacle.user.speed >= STANDING_SPEED or not _stands_beside(obstacle, ego, front, step, limits))
        and (drives_along(obstacle) or not _passes_by(obstacle, course, graph, limits, front, ego.speed))
    ]  # fmt: skip
    behind = tuple(leaders(met, front, ego.speed, limits)) if met else ()
    if inside := [user for user in traffic.users if user.lane_id in course.inside] if sight else ():
        behind += tuple(_swings_back(inside, on_path, course, graph, front))
    if course.narrows:
        near_ones = tuple(narrow for narrow in course.narrows if narrow.passage in sight)
        behind += tuple(ahead_at_narrows(traffic.users, near_ones, graph, ego, front, limits))
    lights, asker = traffic.lights, _asker(traffic, plan, graph, front) if traffic.asker else None
    sample = min(max(int(s / step), 0), len(plan.curve.x) - 1)
    left, right = (course.left.item(sample), course.right.item(sample)) if len(near) else (0.0, 0.0)
    return Snapshot(
        traffic.time, ego, s, d, front, near, static, on_path, behind, (), neighbours, lights, sight, off_tracking,
        (left, right), limits.parameters, traffic.switches, asker, traffic.yellow_until,
    )  # fmt: skip


def _comes_first(off_tracking: OffTracking, plan: NominalPlan, front: float) -> bool:
    """Whether the body covers the lane beside before the next change of lanes begins."""
    change = plan.next_change(front)
    return change is not None and off_tracking.start < change.start


def _related(
    traffic: Traffic, course: _Course, graph: RoadGraph, ego: VehicleState, limits: VehicleLimits, front: float
) -> tuple[Floats, tuple[PathObstacle, ...]]:
    """Return the boxes (m, 8) of those users who are near, and who blocks the corridor.

    Who cannot be touched within the foreseen time has no turn rate, and no end of his way.
    """
    users, boxes = on_its_level(traffic, course.crossed) if course.crossed else (traffic.users, traffic.boxes)
    if not users:
        return _NO_ONE_NEAR, ()
    curve, (x, y, heading), speed = course.curve, ego.pose, ego.speed
    reach = front + max(ATTENTION_MIN_AHEAD_M, ATTENTION_TIME_S * speed)
    near, touchable, blocking, stretches = related(
        boxes, x, y, heading, speed, limits.length,
        curve.x, curve.y, curve.heading, curve.step, front, reach, *course.band,
    )  # fmt: skip
    for row, k in touchable.tolist() if len(touchable) else ():
        user = users[k]
        if not user.body.is_person:
            near[row, 6], near[row, 7] = turn_rate(graph, user, TURN_FORESEEN_S), way_left(graph, user)
    if not len(blocking):
        return near, ()
    who = map(users.__getitem__, blocking.tolist())
    return near, tuple(map(PathObstacle, who, *stretches.T.tolist()))


def _passes_by(
    obstacle: PathObstacle, course: _Course, graph: RoadGraph, limits: VehicleLimits, front: float, speed: float
) -> bool:
    """Whether somebody who comes towards the ego or crosses will soon have left its corridor: before they meet there, and
    whether he goes on along his lane, wherever it leads, or straight on.

    Who comes towards the ego at first may be in its corridor nearer to it then, but out of it before it comes there.
    """
    user, time = obstacle.user, time_to_meet(obstacle, front, speed)
    if time > MEETING_FORESEEN_S or user.body.is_person:
        return False
    curve, band, own, behind = course.curve, course.band, speed + FASTER, max(front - limits.length, 0.0)
    while time <= MEETING_FORESEEN_S:
        boxes = np.array(places_after(graph, user, time))
        _, stretches = blocking_ones(boxes, curve.x, curve.y, curve.heading, curve.step, behind, obstacle.end, *band)
        if not len(stretches):
            return True
        gap = float(stretches[:, 0].min()) - front - own * time
        if gap <= 0.0 or not comes_towards(obstacle):
            return False
        time += max(gap / (own + user.speed), MEETING_STEP_S)
    return False


def _stands_beside(obstacle: PathObstacle, ego: VehicleState, front: float, step: float, limits: VehicleLimits) -> bool:
    """Whether somebody who stands reaches into the corridor beside the ego's front only, and not before it: nobody stays
    behind him any more. What the body sweeps as it drives on is tested exactly, command by command."""
    if obstacle.end >= front + step:
        return False
    user, (x, y) = obstacle.user, ego.pose.ahead(limits.front_to_rear_axle + 0.5 * step)
    box = box_of(user.x, user.y, user.heading, user.body.length, user.body.width)
    return not boxes_overlap(x, y, ego.pose.heading, step, limits.width, *box)


def _swings_back(
    users: Iterable[RoadUser], on_path: tuple[PathObstacle, ...], course: _Course, graph: RoadGraph, front: float
) -> Iterator[TimeConstraint]:
    """Yield a leader for each of `users` who is before the ego on its own way through a junction, beside C now, and will
    come over it: in a turn that the map draws too tight for the ego, C keeps off that way until its end."""
    curve, known = course.curve, {obstacle.user.id for obstacle in on_path}
    for user in users:
        for passage, at, scale, left in course.inside[user.lane_id] if user.id not in known else ():
            is_near = passage.start - ATTENTION_MIN_AHEAD_M < front < passage.end
            if not is_near or passage.start + (at + user.lane_position) * scale <= front:
                continue
            ways = np.arange(0.0, left - user.lane_position + user.body.length, SWUNG_STEP_M)
            boxes = np.array([place for way in ways for place in places_after(graph, user._replace(speed=1.0), way)[1:]])
            _, stretches = blocking_ones(
                boxes.reshape(-1, 6), curve.x, curve.y, curve.heading, curve.step, front, passage.end + user.body.length,
                *course.band,
            )
            if len(stretches):
                first = float(stretches[:, 0].min())
                yield stay_behind(user.id, first, 0.0, user.body.emergency_deceleration)


def _ways_inside(plan: NominalPlan, graph: RoadGraph) -> Mapping[str, tuple[tuple[Passage, float, float, float], ...]]:
    """Return, by lane inside a junction that the plan passes: the passage, where the lane starts behind the stop line (m),
    metres of C to one of the map's way, and that way's length from the start of the lane on (m)."""
    found: dict[str, tuple[tuple[Passage, float, float, float], ...]] = {}
    for passage in plan.passages:
        connection = graph.connections[passage.connection_id]
        length = connection.path.length
        scale = (passage.end - passage.start) / max(length, 0.1)
        for part, at in graph.lanes_behind(connection):
            if part != connection.to_lane:
                found[part] = (*found.get(part, ()), (passage, at, scale, length - at))
    return found


def _asker(traffic: Traffic, plan: NominalPlan, graph: RoadGraph, front: float) -> Neighbour | None:
    """Return who asks to be let in, if he is on a lane of the road that the front bumper, at `front` m of C, is on."""
    user = next((one for one in traffic.users if one.id == traffic.asker), None)
    here = next((one for one in plan.segments if one.start <= front < one.end), None)
    if user is None or here is None or graph.lanes[user.lane_id].edge_id != graph.lanes[here.lane_id].edge_id:
        return None
    return Neighbour(user, user.lane_position - (here.lane_offset + front - here.start))


def _neighbours(users: tuple[RoadUser, ...], graph: RoadGraph, lane_id: str, own: float) -> Iterator[Neighbour]:
    """Yield who is on the axis of a lane, on which the ego's front is at `own` m, or comes to it from farther back."""
    axis, before = lane_axis(graph, lane_id), axis_before(graph, lane_id)
    for user in users:
        start = axis.get(user.lane_id)
        if start is None and user.lane_id in before:
            ways = before[user.lane_id]
            start = next((at for at, edges in ways if user.route[: len(edges)] == edges), None)
        if start is not None:
            yield Neighbour(user, start + user.lane_position - own)
