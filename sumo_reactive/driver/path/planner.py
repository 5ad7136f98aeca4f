"""The planner: route and start in, nominal plan P = (C, {(l, t_l)}) out (F&L 1991, §1.3)."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from sumo_reactive.driver.geometry.curve import CURVE_STEP_M
from sumo_reactive.driver.geometry.polyline import Polyline, wrapped
from sumo_reactive.driver.nouns.plan import Aside, LaneChange, LaneSegment, NominalPlan, Passage, PlannedStop, Turnaround
from sumo_reactive.driver.nouns.state import Pose
from sumo_reactive.driver.path.lane_choice import LaneChoice, LaneStep, choose_lanes, lane_path, may_change, parallel_lanes
from sumo_reactive.driver.path.reference import Piece, Reference
from sumo_reactive.driver.path.time_constraints import speed_envelope, time_constraints
from sumo_reactive.driver.path.trajectory import PLAN_HORIZON_M, CurveStart, Trajectory, lanes_at, trajectory
from sumo_reactive.driver.path.turnaround import turn_in_moves
from sumo_reactive.driver.path.way_back import road_around, ways_back
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route
from sumo_reactive.errors import PlanError

LATE_M = 0.3
"""A car past the place where a turn in several moves begins by more than this begins where it can stop…"""
ASKEW_RAD = 0.1
"""…if it stands along its lane; else it turns in one sweep."""
SLANTED_M = 0.1
"""A line that C crosses slantwise is placed where that is if it is nearer than the nearest place by more than this,…"""
LINE_REACH_M, LINE_LANES = 6.0, 1.5
"""…but not by more than this, and C is there no farther beside the end of its lane than so many widths of it."""
PROJECTION_REACH_M = 15.0
"""The front axle is looked for this far around its stated lane position."""


@dataclass(frozen=True)
class PlanStart:
    """Where a plan begins: rear-axle `pose`, `speed` (m/s), `steering_angle` (rad), `time` (s), place on the network.

    `lane_position` is the front bumper's, in spine metres of `lane_id` (normal or internal). `route_index` is the edge
    that the car is on, or has just left when it is inside a junction. `speed_factor` scales lane limits. The edge of route
    index `stays_on` is left by the lane that the plan begins on, if it leads on.
    """

    pose: Pose
    speed: float
    steering_angle: float
    time: float
    lane_id: str
    lane_position: float
    route_index: int
    speed_factor: float = 1.0
    stays_on: int = -1

    def curve_start(self, wheelbase: float) -> CurveStart:
        """Return where the front axle is and how it moves (F&L 1991, §3.1)."""
        heading = self.pose.heading + self.steering_angle
        return CurveStart(*self.pose.ahead(wheelbase), heading, self.speed, self.steering_angle, self.speed_factor)


@dataclass(frozen=True, eq=False)
class LeftLane:
    """The lane that a change now leaves to `side`, and the front axle's spine arc length on it, m."""

    lane: Lane
    side: int
    offset: float


def plan(
    graph: RoadGraph, route: Route, limits: VehicleLimits, start: PlanStart, *,
    change_now: int = 0, aside: Aside | None = None,
) -> NominalPlan:  # fmt: skip
    """Return the nominal plan from `start` along `route`, at most PLAN_HORIZON_M ahead.

    `change_now` (+1 left, −1 right) begins the change to that neighbour lane at the car's pose; `aside` leads beside the
    lane's centre, its places counted from the front axle. PlanError names the edges that no lane sequence connects.
    """
    choice = choose_lanes(graph, route, limits.vehicle_class)
    reference, left = _reference(choice, route, limits, start, change_now)
    reference.cut_at(PLAN_HORIZON_M)
    turns = _turns(reference, route, limits, start)
    in_moves = [(turn.start, turn.end) for turn in turns]
    course = trajectory(reference, start.curve_start(limits.wheelbase), limits, aside, in_moves)
    nominal = _on_curve(reference, course, limits, start, left, turns)
    kept_aside = None if aside is None else replace(aside, back=course.s(aside.back), until=course.s(aside.until))
    return replace(nominal, aside=kept_aside, parallel_lanes=parallel_lanes(choice, nominal.segments))


def _turns(
    reference: Reference, route: Route, limits: VehicleLimits, start: PlanStart
) -> list[Turnaround]:
    """Return the turns in several moves on the reference, their places in m of it, that begin ahead of the car."""
    found, graph = [], reference.graph
    ahead = [passage for passage in reference.passages if passage[1] >= 0.0]  # others have begun before the plan does
    for ways, began, ended in ways_back(graph, ahead):
        before = _piece_at(reference, began).route_index  # of the edge before the junction
        around = road_around(graph, ways, route.edges, before, limits)
        turn = turn_in_moves(graph, ways, limits, around)
        latest = began - limits.parameters.stop_line_margin_m - limits.front_overhang
        if turn is not None and turn.before >= latest + LATE_M:
            latest = round(latest - start.speed**2 / (2.0 * limits.service_deceleration), 1)
            is_along = _askew(graph.lanes[graph.connections[ways[0]].from_lane], start, limits) < ASKEW_RAD
            turn = turn_in_moves(graph, ways, limits, around, latest) if is_along else None
        if turn is None:
            continue
        own = _piece_at(reference, min(began - turn.before, began - CURVE_STEP_M))
        if not own.lane.is_internal:
            to_lane = graph.connections[ways[-1]].to_lane
            index = _index_behind(route, graph.lanes[to_lane].edge_id, before + len(ways) - 1)
            found.append(Turnaround(
                start=began - turn.before, line=began, end=ended, from_lane=own.lane.id, from_index=own.route_index,
                to_lane=to_lane, route_index=index, moves=turn.moves, duration=turn.duration, into=turn.into,
            ))  # fmt: skip
    return found


def _askew(lane: Lane, start: PlanStart, limits: VehicleLimits) -> float:
    """Return by how much the car is turned from a lane under its middle, or from its end if it is not on it, rad."""
    at = start.lane_position - 0.5 * limits.length if start.lane_id == lane.id else lane.spine.length
    return abs(wrapped(start.pose.heading - lane.spine.heading_at(at)))


def _piece_at(reference: Reference, u: float) -> Piece:
    return [piece for piece in reference.pieces if piece.u <= u][-1]


def _reference(
    choice: LaneChoice, route: Route, limits: VehicleLimits, start: PlanStart, change_now: int
) -> tuple[Reference, LeftLane | None]:
    """Return the joined centre line from the front axle on, and the lane that a change now leaves."""
    reference = Reference(choice.graph)
    lane = choice.graph.lanes.get(start.lane_id)
    if lane is None:
        raise PlanError(f"start lane '{start.lane_id}' is not in the network")
    if lane.is_internal:
        connection = choice.graph.connection_of[lane.id]
        following = choice.graph.lanes[connection.to_lane]
        index = _index_behind(route, following.edge_id, start.route_index)
        at = _axle_on(connection.path, dict(choice.graph.lanes_behind(connection))[lane.id], limits, start)
        reference.pass_junction(connection, start.route_index, at, at)
        _drive_on(reference, choice, lane_path(choice, choice.stage_at(index), following.index, 0.0), 0.0)
        return reference, None
    if route.edges[start.route_index] != lane.edge_id:
        raise PlanError(f"start lane '{lane.id}' is not on edge {start.route_index} of the route")
    driven = _neighbour(choice, lane, change_now) if change_now else lane
    at = _axle_on(driven.spine, 0.0, limits, start)
    number = choice.stage_at(start.route_index, start.lane_position / lane.scale)
    stays = start.stays_on == start.route_index and choice.onward[number][driven.index].cost < math.inf
    _drive_on(reference, choice, lane_path(choice, number, driven.index, at / driven.scale, stays=stays), at)
    return reference, LeftLane(lane, change_now, _axle_on(lane.spine, 0.0, limits, start)) if change_now else None


def _drive_on(reference: Reference, choice: LaneChoice, steps: Iterable[LaneStep], at: float) -> None:
    """Append the way of `steps`, the first from spine arc length `at` (m) of its lane, to the goal or the horizon."""
    for step in steps:
        joins, at = reference.drive(step, at), 0.0
        if reference.length > PLAN_HORIZON_M:
            return
        if step.connection is not None:
            at = reference.pass_junction(step.connection, step.stage.route_index, joins)
        elif step.stage is choice.stages[-1]:
            last = step.lanes[-1]
            reference.finish(last, min(step.stage.end * last.scale, last.spine.length))
        else:
            at = step.stage.end * step.lanes[-1].scale


def _on_curve(
    reference: Reference, course: Trajectory, limits: VehicleLimits, start: PlanStart, left: LeftLane | None,
    turns: list[Turnaround],
) -> NominalPlan:  # fmt: skip
    """Return the plan: the reference's places carried over to C, its speeds and times."""
    curve, s = course.curve, course.s
    arc = CURVE_STEP_M * np.arange(len(curve.x), dtype=np.float64)
    pace = lanes_at(reference.pieces, course.reference_at(arc))[0] * start.speed_factor
    turnarounds = tuple(replace(turn, start=s(turn.start), line=s(turn.line), end=s(turn.end)) for turn in turns)
    for turn in turnarounds:
        pace[(turn.line < arc) & (arc < turn.end)] = turn.pace
    envelope = speed_envelope(curve, pace, limits)
    passages = tuple(
        Passage(c.id, c.junction_id, _line_on(course, reference.graph.lanes[c.from_lane], a), s(b))
        for c, a, b in reference.passages
    )
    stops = tuple(PlannedStop(s(u), stop) for stop, u in reference.stops)
    goal = None if reference.goal is None else s(reference.goal)
    places = [p for passage in passages for p in (passage.start, passage.end)] + ([] if goal is None else [goal])
    now = start.time, start.speed
    constraints, times = time_constraints(curve.step, envelope, places, stops, limits, now)
    return NominalPlan(
        curve=curve,
        segments=_segments(reference, course, left),
        passages=passages,
        lane_changes=_lane_changes(reference, course, left),
        stops=stops,
        speed_limits=envelope,
        time_constraints=constraints,
        goal=goal,
        times=times,
        joins=course.blend_end,
        turnarounds=turnarounds,
        stays_on=start.stays_on,
    )


def _line_on(course: Trajectory, lane: Lane, u: float) -> float:
    """Return the arc length on C where it first crosses the line across the end of `lane`, at `u` of the reference, m.

    Where C comes to it slantwise, from the lane beside or swinging out for a turn, that is before the place of C which is
    nearest to the lane's end.
    """
    near, curve = course.s(u), course.curve
    if not 0.0 < near < curve.length:
        return near
    (x, y), along = lane.spine.at(lane.spine.length), lane.spine.heading_at(lane.spine.length)
    places = np.arange(max(int((near - LINE_REACH_M) / curve.step), 0), min(int(near / curve.step) + 2, len(curve.x)))
    dx, dy, c, s = curve.x[places] - x, curve.y[places] - y, math.cos(along), math.sin(along)
    beyond, beside = dx * c + dy * s, np.abs(dy * c - dx * s)
    crossed = np.flatnonzero((beyond[:-1] < 0.0) & (beyond[1:] >= 0.0) & (beside[1:] < LINE_LANES * lane.width))
    if not len(crossed):
        return near
    k = crossed[0]
    line = curve.step * float(places[k] - beyond[k] / (beyond[k + 1] - beyond[k]))
    return line if line < near - SLANTED_M else near


def _segments(reference: Reference, course: Trajectory, left: LeftLane | None) -> tuple[LaneSegment, ...]:
    """Return the stretches of C on each lane; a change now drives on the old lane up to its middle."""
    places = [piece.u for piece in reference.pieces] + [float(course.reference_arc[-1])]
    segments = []
    for piece, u, behind in zip(reference.pieces, places, places[1:], strict=False):
        start, end = course.s(u), course.s(behind)
        stretch = (end - start) / (behind - u) if behind - u > CURVE_STEP_M else 1.0
        segments.append(LaneSegment(
            lane_id=piece.lane.id, start=start, end=end, lane_offset=piece.lane_offset, route_index=piece.route_index,
            stretch=stretch,
        ))  # fmt: skip
    if left is None:
        return tuple(segments)
    new, *rest = segments
    middle = min(0.5 * course.blend_end, new.end)
    entered = replace(new, start=middle, lane_offset=new.lane_offset + middle / new.stretch)
    before = LaneSegment(
        lane_id=left.lane.id, start=0.0, end=middle, lane_offset=left.offset, route_index=new.route_index,
        stretch=new.stretch,
    )  # fmt: skip
    return before, entered, *rest


def _lane_changes(reference: Reference, course: Trajectory, left: LeftLane | None) -> tuple[LaneChange, ...]:
    """Return the lane changes on C, the one made now first."""
    s, found = course.s, []
    if left is not None:
        entered = reference.pieces[0].lane.id
        found.append(
            LaneChange(from_lane=left.lane.id, to_lane=entered, side=left.side, opens=0.0, start=0.0, end=course.blend_end)
        )
    for change in reference.changes:
        found.append(LaneChange(
            from_lane=change.from_lane.id, to_lane=change.to_lane.id, side=change.side,
            opens=s(change.opens), start=s(change.start), end=s(change.end),
        ))  # fmt: skip
    return tuple(found)


def _neighbour(choice: LaneChoice, lane: Lane, side: int) -> Lane:
    """Return the lane to the left (+1) or right (−1) that the car may change to; PlanError when there is none."""
    lanes = choice.graph.edge_lanes[lane.edge_id]
    index = lane.index + (-side if choice.graph.left_hand else side)
    beside = lanes[index] if 0 <= index < len(lanes) else None
    if beside is None or not may_change(lane, beside, choice.vehicle_class, choice.graph.left_hand):
        raise PlanError(f"lane '{lane.id}' has no lane on side {side:+d} to change to")
    return beside


def _axle_on(line: Polyline, before: float, limits: VehicleLimits, start: PlanStart) -> float:
    """Return the front axle's arc length on `line`, where the start lane begins at `before`; it may be negative."""
    expected = before + start.lane_position - limits.front_overhang
    found = line.project(*start.pose.ahead(limits.wheelbase))[0]
    inside = 0.0 < found < line.length and abs(found - expected) < PROJECTION_REACH_M
    return found if inside else min(expected, line.length)


def _index_behind(route: Route, edge_id: str, route_index: int) -> int:
    """Return the route index of the edge behind the junction that the car is in."""
    for index in (route_index + 1, route_index):
        if index < len(route.edges) and route.edges[index] == edge_id:
            return index
    raise PlanError(f"the junction before edge '{edge_id}' is not on edge {route_index} of the route")
