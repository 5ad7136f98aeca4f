"""Where a stand-in has to show the ego: the lane that its body covers besides the one that SUMO maps it to."""

from __future__ import annotations

import math
from typing import NamedTuple

from sumo_reactive.driver.nouns.plan import LaneSegment, NominalPlan, Turnaround
from sumo_reactive.driver.nouns.state import VehicleState
from sumo_reactive.driver.parameters import CUT_SEEN_S, STOP_LINE_MARGIN_M, STRADDLE_M
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.view.corridor import lane_at_side, off_tracking_of
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph

LEAVING_M = 0.4
"""A front this far beside the middle of its lane begins to leave it…"""
ALONG = 0.95
"""…as does one whose car is turned by more than the angle with this cosine."""


class Haunt(NamedTuple):
    """A stand-in's place: lane, the point (m) beside which its front bumper is, speed (m/s), the edges that it drives.

    `waits`: it does not appear where somebody already is.
    """

    lane: Lane
    x: float
    y: float
    speed: float
    edges: tuple[str, ...]
    waits: bool = False


def haunt(
    graph: RoadGraph, plan: NominalPlan, here: LaneSegment, ego: VehicleState, s: float, limits: VehicleLimits,
    edges: tuple[str, ...], stop: float = math.inf,
) -> Haunt | None:  # fmt: skip
    """Return where to show the ego besides; None: nowhere. `edges`: its route from lane segment `here` on; `stop`: where its
    front bumper is to stop, m of C.

    On the oncoming lane the stand-in stands, its front where the ego's rear is: SUMO knows no driving backwards.
    """
    pose, front = ego.pose, limits.front_to_rear_axle
    x, y = pose.x + front * math.cos(pose.heading), pose.y + front * math.sin(pose.heading)
    if plan.aside is None:
        own = graph.lanes[here.lane_id]
        if not own.reaches(x, y, limits.width):
            return _swung_out(graph, own, ego, limits, edges)
        lane = lane_to_haunt(graph, plan, here.lane_id, x, y, s, limits)
        if lane is not None:
            return Haunt(lane, x, y, ego.speed, edges)
        lane = cut_lane(graph, plan, here, s, ego.speed, limits, stop)
        return None if lane is None else Haunt(lane, x, y, ego.speed, edges, waits=True)
    lane = _beside(graph, here.lane_id, plan.aside.lateral)
    if lane is None or not _covers(lane, x, y, limits):
        return None
    if lane.edge_id == graph.lanes[here.lane_id].edge_id:
        mapped = abs(graph.lanes[here.lane_id].spine.project(x, y)[1]) > abs(lane.spine.project(x, y)[1])
        return Haunt(graph.lanes[here.lane_id] if mapped else lane, x, y, ego.speed, edges)
    back = -limits.rear_overhang
    return Haunt(
        lane, pose.x + back * math.cos(pose.heading), pose.y + back * math.sin(pose.heading), 0.0, (lane.edge_id,)
    )


def left_behind(
    graph: RoadGraph, plan: NominalPlan, turn: Turnaround, ego: VehicleState, limits: VehicleLimits, edges: tuple[str, ...]
) -> Haunt | None:
    """Return where to show an ego that turns round in several moves: where it began, so that those behind leave it the room
    to back up; None: it is still in the middle of that lane. `edges`: its route from there on."""
    pose, own = ego.pose, graph.lanes[turn.from_lane]
    turned = math.cos(pose.heading - own.spine.heading_at(own.spine.length))
    if abs(own.spine.project(*_bumper(ego, limits))[1]) < LEAVING_M and turned > ALONG:
        return None
    place = plan.curve.at(turn.start - STOP_LINE_MARGIN_M)
    return Haunt(own, place[0], place[1], 0.0, edges)


def ahead_of_mapping(
    graph: RoadGraph, turn: Turnaround, ego: VehicleState, limits: VehicleLimits, edges: tuple[str, ...]
) -> Haunt | None:
    """Return where to show an ego that turns round in several moves, on the lane that it turns into; None: SUMO maps it to
    that lane. `edges`: its route from there on."""
    (x, y), own, into = _bumper(ego, limits), graph.lanes[turn.from_lane], graph.lanes[turn.to_lane]
    if abs(own.spine.project(x, y)[1]) > abs(into.spine.project(x, y)[1]):
        return None
    back = x - limits.length * math.cos(ego.pose.heading), y - limits.length * math.sin(ego.pose.heading)
    rear = min(into.spine.project(x, y)[0], into.spine.project(*back)[0])
    return Haunt(into, *into.spine.at(rear + limits.length), 0.0, edges)


def _bumper(ego: VehicleState, limits: VehicleLimits) -> tuple[float, float]:
    """Return the middle of the front bumper, m."""
    pose, reach = ego.pose, limits.front_to_rear_axle
    return pose.x + reach * math.cos(pose.heading), pose.y + reach * math.sin(pose.heading)


def _swung_out(graph: RoadGraph, own: Lane, ego: VehicleState, limits: VehicleLimits, edges: tuple[str, ...]) -> Haunt:
    """Return where to show an ego whose front has swung out of its `own` lane.

    On its own lane, while SUMO maps it to another of the edge; where it maps it to none, on the one under its middle.
    """
    pose, reach = ego.pose, limits.front_to_rear_axle
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    x, y = pose.x + reach * c, pose.y + reach * s
    approach = graph.connection_of[own.id].from_lane if own.is_internal else own.id
    lanes = graph.edge_lanes[graph.lanes[approach].edge_id]
    if not any(lane.reaches(x, y, limits.width) for lane in lanes):
        mx, my = x - 0.5 * limits.length * c, y - 0.5 * limits.length * s
        under = min(lanes, key=lambda lane: abs(lane.spine.project(mx, my)[1]))
        if under.reaches(mx, my, limits.width):
            return Haunt(under, mx, my, ego.speed, edges)
    return Haunt(own, x, y, ego.speed, edges)


def _beside(graph: RoadGraph, lane_id: str, lateral: float) -> Lane | None:
    """Return the lane to the left (`lateral` > 0) or right of a lane: of its own edge, or the oncoming one."""
    left, right = graph.neighbours(lane_id)
    own = left if lateral > 0.0 else right
    oncoming = graph.edge_lanes.get(graph.opposite.get(graph.lanes[lane_id].edge_id, ""), ())
    return own or (oncoming[-1] if oncoming else None)


def _covers(lane: Lane, x: float, y: float, limits: VehicleLimits) -> bool:
    return abs(lane.spine.project(x, y)[1]) < 0.5 * (lane.width + limits.width) - STRADDLE_M


def lane_to_haunt(
    graph: RoadGraph, plan: NominalPlan, lane_id: str, x: float, y: float, s: float, limits: VehicleLimits
) -> Lane | None:
    """Return which of the two lanes of a change under way SUMO does not map the ego to; None when there is no change.

    `lane_id` is the one that C follows here; SUMO maps the ego to the one whose centre is nearer to its front bumper `x`,
    `y` (m). `s`: arc length of the front axle on C. During the change both lanes must see the ego, and the old one until
    the rear has left it.
    """
    change = next((c for c in plan.lane_changes if c.start <= s <= c.end + limits.length), None)
    lane = graph.lanes.get(lane_id)
    if change is None or lane is None or lane.is_internal:
        return None
    is_old = lane_id == change.from_lane or (lane_id != change.to_lane and s < 0.5 * (change.start + change.end))
    left, right = graph.neighbours(lane_id)
    other = left if (change.side > 0) is is_old else right
    if other is None:
        return None
    d = change.side * lane.spine.project(x, y)[1]
    if not is_old and s > change.end and 0.5 * limits.width - d < 0.5 * lane.width - STRADDLE_M:
        return None
    return other if abs(d) <= abs(other.spine.project(x, y)[1]) else lane


def cut_lane(
    graph: RoadGraph, plan: NominalPlan, here: LaneSegment, s: float, speed: float, limits: VehicleLimits,
    stop: float = math.inf,
) -> Lane | None:  # fmt: skip
    """Return the lane beside the ego's that a long body covers in a bend, now or soon; None: there is none.

    The rear cuts to the inside of a bend, the front swings out of it. Who comes there from behind must see it before the
    body is across, but not while the ego means to `stop` before. `s`: arc length of the front axle on C, m.
    """
    front = s + limits.front_overhang
    rear, ahead = front - limits.length, max(min(front + speed * CUT_SEEN_S, stop), front)
    for cut in off_tracking_of(plan, graph, limits):
        if rear < cut.end and cut.start < ahead:
            beside = lane_at_side(graph, here.lane_id, cut.left)
            return graph.lanes[cut.lane_id] if beside is None and cut.lane_id.startswith(":") else beside
    return None
