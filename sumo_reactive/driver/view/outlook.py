"""What the pilot asks for when an event has activated it: the others' foreseen ways, and the room beside C."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sumo_reactive.driver.geometry.footprint import boxes_overlap
from sumo_reactive.driver.geometry.polyline import Points
from sumo_reactive.driver.nouns.forecast import FREE_GROUND, PATH_STEP_M, Hindered, Outlook, TurningGround
from sumo_reactive.driver.nouns.plan import TURNAROUND_REACHED_M, NominalPlan, Turnaround
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import STANDING_SPEED, Pose, VehicleState
from sumo_reactive.driver.nouns.traffic import FOLLOWER_STANDSTILL_GAP_M, QUEUED_SPEED, RoadUser, Traffic
from sumo_reactive.driver.vehicle.bicycle import advance_pose
from sumo_reactive.driver.vehicle.body import box_of, own_box
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.safe_speed import SAFE_GAP_M
from sumo_reactive.driver.view.attention import ATTENTION_MIN_AHEAD_M
from sumo_reactive.driver.view.beside import lanes_beside, queues
from sumo_reactive.driver.view.foresee import FORECAST_REACH_M, foresee, paths_ahead, places_after
from sumo_reactive.driver.world.road_graph import RoadGraph


def outlook(
    traffic: Traffic, snapshot: Snapshot, plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits,
    *, looks_around: bool = False,
) -> Outlook:  # fmt: skip
    """Return the forecast of all whom the ego could meet on its way (of all in sight, if it looks far), the lanes
    beside it and the queues there if there is anybody to pass, and who is in the way of a turn in several moves; and whom
    an ego that does not get on and `looks_around` may keep from going."""
    front, p = snapshot.front, limits.parameters
    users, duration = _concerned(snapshot), p.assessed_s
    if traffic.sight > 0.0:
        users, duration = traffic.users, p.overtaking_s
    slowest, road = min((obstacle.along for obstacle in snapshot.on_path), default=math.inf), plan.road_speed(snapshot.s)
    passing = plan.aside is not None or slowest < p.slow_share * road
    beside = tuple(lanes_beside(graph, plan, front, FORECAST_REACH_M)) if passing else ()
    here = next((segment for segment in plan.segments if front < segment.end), None)
    width = graph.lanes[here.lane_id].width if here else 0.0
    hinders = plan.aside is not None or slowest < SLOWER_SHARE * road
    waiting = queues(traffic, snapshot, plan, here, graph) if hinders and here is not None else ()
    ground = ground_of(traffic.users, snapshot, plan, graph, limits)
    sight = max(traffic.sight, ATTENTION_MIN_AHEAD_M)
    hindered = tuple(hindered_by(traffic.users, snapshot, graph, limits)) if looks_around else ()
    return Outlook(foresee(graph, users, duration), beside, width, sight, waiting, ground, hindered)


def _concerned(snapshot: Snapshot) -> tuple[RoadUser, ...]:
    """Return who stands or drives on the ego's way, who can reach a region on it, who is beside a lane change: each once."""
    users = {obstacle.user.id: obstacle.user for obstacle in snapshot.on_path}
    users.update((foe.user.id, foe.user) for foe in snapshot.foes)
    users.update((neighbour.user.id, neighbour.user) for neighbour in snapshot.neighbours)
    pose, time = snapshot.ego.pose, snapshot.parameters.assessed_s
    reach = time * snapshot.ego.speed + ATTENTION_MIN_AHEAD_M / 2
    return tuple(u for u in users.values() if abs(u.x - pose.x) + abs(u.y - pose.y) < 1.5 * (reach + time * u.speed))


SLOWER_SHARE = 0.95
"""Who drives no slower than this share of the road's speed hinders nobody."""

HINDERED_WITHIN_M = 20.0
"""Who is farther away, front to front, does not wait for a standing ego."""

HINDERED_S = 10.0
"""Who has stood for less may be about to go anyway."""

_PAST_M, _PAST_STEP_M = 15.0, 0.5
"""Who goes on is looked at so far along his way, in such steps: past a car…"""

_APART_M, _BY_M = 0.1, 3.0
"""…from which he keeps at least so far; who keeps so far from the ego does not wait for it."""


def hindered_by(
    users: tuple[RoadUser, ...], snapshot: Snapshot, graph: RoadGraph, limits: VehicleLimits
) -> Iterator[Hindered]:
    """Yield the vehicles that have not halted and whose ways lead by a standing ego, those behind it left out, and whether
    each could go on without touching it."""
    ego = snapshot.ego.pose
    front, boxes = ego.ahead(limits.front_to_rear_axle), [own_box(ego, limits, around) for around in (_BY_M, _APART_M)]
    for user in users:
        away = user.x - front[0], user.y - front[1]
        if user.is_halted or user.body.is_person or math.hypot(*away) > HINDERED_WITHIN_M:
            continue
        ahead = away[0] * math.cos(ego.heading) + away[1] * math.sin(ego.heading)
        if ahead < -limits.length and math.cos(user.heading - ego.heading) > 0.0:
            continue
        ways = np.arange(_PAST_STEP_M, _PAST_M + user.body.length, _PAST_STEP_M)
        places = [place for way in ways for place in places_after(graph, user._replace(speed=1.0), way)[1:]]
        bodies = [box_of(*place[:3], *place[4:]) for place in places]
        comes_by, touches = (any(boxes_overlap(*own, *body) for body in bodies) for own in boxes)
        if comes_by:
            yield Hindered(user.id, user.waiting_time >= HINDERED_S, not touches)


_POSE_STEP_M = 0.5
"""Poses of a move are looked at this far apart."""


CRAWLING_ON_S = 1.0
"""Who crawls may stop after the way of this time, and what it takes him to brake."""


def ground_of(
    users: tuple[RoadUser, ...], snapshot: Snapshot, plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits
) -> TurningGround:
    """Return who keeps the ego from the turn in several moves that it is about to begin."""
    turn = next((one for one in plan.turnarounds if snapshot.front < one.end), None)
    if turn is None or snapshot.ego.speed >= STANDING_SPEED or turn.start - snapshot.front > TURNAROUND_REACHED_M:
        return FREE_GROUND
    return TurningGround(_who_comes_over(users, snapshot, turn, graph, limits), _who_stays(users, turn, limits))


def _who_stays(users: tuple[RoadUser, ...], turn: Turnaround, limits: VehicleLimits) -> str:
    """Return whose rear will still be where a turn ends, on the lane turned into (empty: nobody's): he keeps his speed until
    he comes up behind the next one, and who crawls may stop at once."""
    needed, ahead, braking = turn.into + SAFE_GAP_M, math.inf, limits.comfort_deceleration
    there = [user for user in users if user.lane_id == turn.to_lane and not user.body.is_person]
    for user in sorted(there, key=lambda one: -one.lane_position):
        speed = user.speed
        stops_in = speed * (CRAWLING_ON_S + 0.5 * speed / braking) if speed < QUEUED_SPEED else math.inf
        front = min(user.lane_position + min(speed * turn.duration, stops_in), ahead - FOLLOWER_STANDSTILL_GAP_M)
        ahead = max(front, user.lane_position) - user.body.length
        if ahead < needed:
            return user.id
    return ""


def _who_comes_over(
    users: tuple[RoadUser, ...], snapshot: Snapshot, turn: Turnaround, graph: RoadGraph, limits: VehicleLimits
) -> str:
    """Return who will drive over the ground of a turn that the ego begins now, before it has ended (empty: nobody).

    The regions of the connection tell about those whom SUMO's map lets cross it, and who is behind the ego waits; others may
    come by ways that touch the map's path of the turn nowhere, but the moves.
    """
    known = {foe.user.id for foe in snapshot.foes}
    ground = swept_ground(turn, snapshot.ego, limits)
    own_road = graph.lanes[turn.from_lane].edge_id
    for user in users:
        if user.id in known or user.lane_id == turn.from_lane or own_road in user.route[1:3]:  # he will be behind the ego
            continue
        if user.speed < STANDING_SPEED or user.body.is_person:
            continue
        if _turns_in(user, turn, graph) or _drives_over(user, ground, turn.duration, graph, limits):
            return user.id
    return ""


def _turns_in(user: RoadUser, turn: Turnaround, graph: RoadGraph) -> bool:
    """Whether a user will come onto the road that the ego turns into, by whatever way."""
    lane = graph.lanes.get(user.lane_id)
    if lane is None or graph.lanes[turn.to_lane].edge_id not in user.route[1:2]:
        return False
    return lane.spine.length - user.lane_position < user.speed * turn.duration


def _drives_over(
    user: RoadUser, ground: Points, duration: float, graph: RoadGraph, limits: VehicleLimits
) -> bool:
    """Whether a user who keeps its speed for `duration` s comes over the ground on a way that the map knows."""
    near = 0.5 * (limits.width + user.body.width) + SAFE_GAP_M
    first = max(int(user.lane_position / PATH_STEP_M), 0)
    last = first + 2 + int(user.speed * duration / PATH_STEP_M)
    ways = (path[first:last, :2] for path in paths_ahead(graph, user.lane_id, user.route[:3]))
    return any(len(way) and np.hypot(*(way[:, None, :] - ground).transpose(2, 0, 1)).min() < near for way in ways)


def swept_ground(turn: Turnaround, ego: VehicleState, limits: VehicleLimits) -> Points:
    """Return points (n, 2), m, on the middle of the body from bumper to bumper, in poses all along the moves of a turn."""
    pose, poses = ego.pose, [ego.pose]
    for move in turn.moves:
        way = max(move.left(pose.heading), 0.0)
        for _ in range(math.ceil(way / _POSE_STEP_M)):
            step = move.gear * min(_POSE_STEP_M, way)
            pose = Pose(*advance_pose(pose.x, pose.y, pose.heading, step, move.steering_angle, limits.wheelbase, 1.0))
            poses.append(pose)
    x, y, heading = np.array([(one.x, one.y, one.heading) for one in poses]).T
    along = np.linspace(-limits.rear_overhang, limits.front_to_rear_axle, 5)[:, None]
    return np.column_stack(((x + along * np.cos(heading)).ravel(), (y + along * np.sin(heading)).ravel()))
