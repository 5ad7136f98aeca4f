"""From what is observed to what it means along C: one snapshot per step."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.geometry.curve import project_on_curve
from sumo_reactive.messages.plan import NominalPlan
from sumo_reactive.messages.snapshot import Foe, Neighbour, PathObstacle, Snapshot
from sumo_reactive.messages.state import VehicleState
from sumo_reactive.messages.traffic import RoadUser, Traffic
from sumo_reactive.parameters import (
    ATTENTION_MIN_AHEAD_M,
    ATTENTION_TIME_S,
    NEAR_M,
    PROJECTION_WINDOW_M,
    STANDING_SPEED,
    TURN_FORESEEN_S,
)
from sumo_reactive.perception.attention import Watch, in_sight, lane_axis, lane_sought, watches_of
from sumo_reactive.perception.corridor import band_of, blocked_stretches, near_boxes
from sumo_reactive.perception.cuts import next_cut
from sumo_reactive.perception.foresee import turn_rate
from sumo_reactive.perception.leaders import leaders
from sumo_reactive.perception.static import static_near
from sumo_reactive.vehicle.limits import VehicleLimits
from sumo_reactive.world.road_graph import RoadGraph

Array = NDArray[np.float64]

_NO_BOXES: Array = np.empty((0, 7))


def front_axle(ego: VehicleState, limits: VehicleLimits) -> tuple[float, float]:
    """Return control point F, the front axle's middle (m)."""
    p = ego.pose
    return p.x + limits.wheelbase * math.cos(p.heading), p.y + limits.wheelbase * math.sin(p.heading)


def locate(ego: VehicleState, plan: NominalPlan, limits: VehicleLimits, s_before: float) -> tuple[float, float]:
    """Return (s, d) of the front axle on C near `s_before` (m, left positive)."""
    curve, (x, y) = plan.curve, front_axle(ego, limits)
    return project_on_curve(x, y, curve.x, curve.y, curve.step, s_before, PROJECTION_WINDOW_M)


def perceive(
    traffic: Traffic, ego: VehicleState, plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits, s_before: float,
    vehicle_class: str = "passenger",
) -> Snapshot:  # fmt: skip
    """Relate `traffic` to the plan: who stands in the corridor, who can reach which region, who drives beside.

    `s_before` is the ego's last known arc length on C (m); its `vehicle_class` tells what is open to it.
    """
    s, d = locate(ego, plan, limits, s_before)
    front = s + limits.front_overhang
    boxes = _boxes(traffic.users, graph, ego)
    on_path = tuple(_on_path(traffic.users, boxes, plan, limits, front, ego.speed))
    sight = in_sight(plan, front, ego.speed)
    foes = tuple(_foes((*traffic.users, *traffic.beside), plan, graph, sight)) if sight else ()
    sought = lane_sought(plan, front)
    cut = None if sought else next_cut(plan, graph, limits, s, front)
    beside = cut.lane_id if cut else sought
    neighbours = tuple(_neighbours(traffic.users, beside, graph, ego, limits)) if beside else ()
    near = near_boxes(boxes, ego.pose.x, ego.pose.y, NEAR_M)
    static = static_near(graph, plan, vehicle_class, s, *front_axle(ego, limits), traffic.static)
    behind = tuple(leaders(on_path, front, ego.speed, limits))
    lights = traffic.lights
    return Snapshot(traffic.time, ego, s, d, front, near, static, on_path, behind, foes, neighbours, lights, sight, cut)


def _boxes(users: tuple[RoadUser, ...], graph: RoadGraph, ego: VehicleState) -> Array:
    if not users:
        return _NO_BOXES
    x, y = ego.pose.x, ego.pose.y
    flat: list[float] = []
    for u in users:
        turns = u.speed > STANDING_SPEED and abs(u.x - x) + abs(u.y - y) < NEAR_M and not u.body.is_person
        turning = turn_rate(graph, u, TURN_FORESEEN_S) if turns else 0.0
        flat += (u.x, u.y, u.heading, u.speed, u.body.length, u.body.width, turning)
    return np.array(flat).reshape(-1, 7)


def _on_path(
    users: tuple[RoadUser, ...], boxes: Array, plan: NominalPlan, limits: VehicleLimits, front: float, speed: float
) -> Iterator[PathObstacle]:
    curve = plan.curve
    reach = front + max(ATTENTION_MIN_AHEAD_M, ATTENTION_TIME_S * speed)
    band = band_of(curve, limits)
    stretches = blocked_stretches(boxes, curve.x, curve.y, curve.heading, curve.step, front, reach, *band)
    for user, (start, end, along, across) in zip(users, stretches.tolist(), strict=True):
        if start == start:  # not NaN
            yield PathObstacle(user, start, end, along, across)


def _foes(users: tuple[RoadUser, ...], plan: NominalPlan, graph: RoadGraph, sight: tuple[int, ...]) -> Iterator[Foe]:
    tables = [(i, watches_of(graph, plan.passages[i].connection_id)) for i in sight]
    for user in users:
        for i, table in tables:
            for watch in table.get(user.lane_id, ()):
                if not user.route or watch.edges == user.route[: len(watch.edges)]:
                    foe = _foe(user, i, watch)
                    if foe.to_clear > 0.0:
                        yield foe


def _foe(user: RoadUser, passage: int, watch: Watch) -> Foe:
    region = watch.conflict.region
    to_line = watch.distance - user.lane_position
    if not user.body.is_person:
        to_clear = to_line + region.other.end + user.body.length
        return Foe(user, passage, watch.conflict, to_line, to_line + region.other.start, to_clear)
    return _walker(user, passage, watch)


def _walker(user: RoadUser, passage: int, watch: Watch) -> Foe:
    """A pedestrian may walk along the crossing's path or against it, and stand before it."""
    conflict, at = watch.conflict, user.lane_position
    to_step_on = max(-at, at - conflict.other.path.length)
    start, end = conflict.region.other.start, conflict.region.other.end
    forward = math.cos(user.heading - conflict.other.path.heading_at(at)) >= 0.0
    to_region, to_clear = (start - at, end - at) if forward else (at - end, at - start)
    return Foe(user, passage, conflict, to_step_on if to_step_on > 0.0 else -1.0, to_region, to_clear)


def _neighbours(
    users: tuple[RoadUser, ...], lane_id: str, graph: RoadGraph, ego: VehicleState, limits: VehicleLimits
) -> Iterator[Neighbour]:
    axis = lane_axis(graph, lane_id)
    p, reach = ego.pose, limits.front_to_rear_axle
    x, y = p.x + reach * math.cos(p.heading), p.y + reach * math.sin(p.heading)
    own, _ = graph.lanes[lane_id].spine.project(x, y)
    for user in users:
        start = axis.get(user.lane_id)
        if start is not None:
            yield Neighbour(user, start + user.lane_position - own)
