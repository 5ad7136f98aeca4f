"""Whom the ego must stay behind: who drives ahead, stands in the way, comes towards it or crosses, or is first at a narrow
place, where nobody has room beside somebody on a neighbour way through a junction."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from sumo_reactive.driver.nouns.constraint import TimeConstraint, stay_behind
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import PathObstacle
from sumo_reactive.driver.nouns.state import STANDING_SPEED, VehicleState
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.travel_time import travel_time
from sumo_reactive.driver.world.junction import HOLD_BACK_REACH_M, Connection
from sumo_reactive.driver.world.lateral_conflict import beside, lateral_conflicts, off_tracking_on
from sumo_reactive.driver.world.road_graph import RoadGraph

LONGEST_BESIDE_M = 12.0
"""The longest ordinary body, a bus's."""

WIDEST_BESIDE_M = 2.5
"""The widest ordinary body, a truck's or bus's."""

LEAST_BESIDE_M = 0.1
"""Who would be nearer than this beside the ego is not passed, nor let pass."""

CROSSER_MARGIN_S = 0.5
"""A crossing car counts as gone if it leaves the corridor this long before the ego comes."""

ORDINARY_M = 6.0
"""Bodies up to this length cut corners by what is left to them beside a car anyway."""

BEFORE_LONG_M = 3.0
"""A long body begins to cut the corner so long before its front does: in its turn, its rear is still on the road."""

OVERSHOT_M = 0.5
"""Who stands so little behind the beginning of a narrow place still waits before it."""

FASTER = 2.0
"""m/s; the ego may speed up by so much until it meets somebody."""


def leaders(on_path: Iterable[PathObstacle], front: float, speed: float, limits: VehicleLimits) -> list[TimeConstraint]:
    """Return a leader for each body in the corridor that will not be gone; ego's bumper at `front` m of C, `speed` m/s."""
    found = []
    for obstacle in on_path:
        user, start, along = obstacle.user, obstacle.start, obstacle.along
        brakes, gap = user.body.emergency_deceleration, start - front
        if drives_along(obstacle):
            found.append(stay_behind(user.id, start, max(along, 0.0), brakes))
        elif comes_towards(obstacle):
            found.append(stay_behind(user.id, front + gap * speed / (speed - along), 0.0, brakes))
        else:
            leaves = (user.body.length + limits.width) / abs(obstacle.across)
            if gap <= 0.0 or gap / max(speed, 0.1) <= leaves + CROSSER_MARGIN_S:
                found.append(stay_behind(user.id, start, 0.0, brakes))
    return found


def time_to_meet(obstacle: PathObstacle, front: float, speed: float) -> float:
    """Return when somebody who comes towards the ego or crosses must have left its corridor, s; infinite for others.

    That is the earliest time at which they meet, or a margin before the ego comes where he crosses. The ego's bumper is at
    `front` m of C, its `speed` in m/s.
    """
    gap = max(obstacle.start - front, 0.0)
    if comes_towards(obstacle):
        return gap / (speed + FASTER + obstacle.user.speed)
    return math.inf if drives_along(obstacle) else max(gap / max(speed, 0.1) - CROSSER_MARGIN_S, 0.0)


def drives_along(obstacle: PathObstacle) -> bool:
    """Whether somebody in the corridor drives along C more than across it, or stands: he neither comes towards the ego nor
    crosses."""
    return obstacle.along >= -STANDING_SPEED and abs(obstacle.across) <= max(obstacle.along, STANDING_SPEED)


def comes_towards(obstacle: PathObstacle) -> bool:
    """Whether somebody in the corridor drives against the ego's way more than across it."""
    return obstacle.along < -STANDING_SPEED and abs(obstacle.across) < -obstacle.along


class Narrow(NamedTuple):
    """Between `start` and `end` of C (m) the way of `other`, or the middle of a body on it, is `clearance` m beside it at
    the least, on that way between `other_start` and `other_end` m behind its stop line. `passage` is the plan's; `to_edge`
    is where `other` leads; `is_long`: for bodies longer than ORDINARY_M, or for all others; `pace` (m/s): no faster than
    this can the ego be all along it."""

    passage: int
    start: float
    end: float
    other: Connection
    to_edge: str
    other_start: float
    other_end: float
    clearance: float
    is_long: bool
    pace: float


def narrows_of(plan: NominalPlan, graph: RoadGraph, limits: VehicleLimits) -> tuple[Narrow, ...]:
    """Return the narrow places along C."""
    curve, found = plan.curve, []
    for i, passage in enumerate(plan.passages):
        first = max(int(passage.start / curve.step), 0)
        last = min(int((passage.end + HOLD_BACK_REACH_M) / curve.step) + 1, len(curve.x))
        if last - first < 2:
            continue
        places = np.column_stack((curve.x[first:last], curve.y[first:last]))
        for other, way in lateral_conflicts(graph, passage.connection_id):
            offsets = beside(way, places)
            aside, nearest = np.abs(offsets), float(offsets[np.argmin(np.abs(offsets))])
            for is_long in (False, True):
                inside = off_tracking_on(way, LONGEST_BESIDE_M)[0 if nearest > 0.0 else 1] if is_long else 0.0
                at = np.flatnonzero(aside < 0.5 * (limits.width + WIDEST_BESIDE_M) + LEAST_BESIDE_M + inside)
                if len(at):
                    start, end = ((first + float(k)) * curve.step for k in (at[0], at[-1]))
                    start -= BEFORE_LONG_M * is_long
                    along, until = way.arc_lengths_at(places[at[[0, -1]]]).tolist()
                    edge = graph.lanes[other.to_lane].edge_id
                    clearance = abs(nearest) - inside
                    pace = max(float(plan.speed_limits[first + at[0] : first + at[-1] + 1].min()), 1.0)
                    found.append(Narrow(i, start, end, other, edge, along, until, clearance, is_long, pace))
    return tuple(found)


def ahead_at_narrows(
    users: tuple[RoadUser, ...], narrows: tuple[Narrow, ...], graph: RoadGraph, ego: VehicleState, front: float,
    limits: VehicleLimits,
) -> Iterator[TimeConstraint]:  # fmt: skip
    """Yield a leader for everybody who is first at a narrow place before the ego; its bumper is at `front` m of C.

    Who is in it already is seen in the corridor. Where both would arrive at once the ego falls back: nobody else does.
    """
    for narrow in narrows:
        left = narrow.start - front
        if left > (-OVERSHOT_M if narrow.is_long else 0.0):
            coming = sorted(_coming(users, narrow, graph, limits.width), key=itemgetter(0))
            first, time = _turn(coming, narrow, left, ego.speed, limits)
            if first is not None:
                leader = _ahead_by(first, max(left, 0.0), time, front, ego.speed, limits)
                stop = narrow.start + limits.standstill_gap
                yield leader._replace(s=min(leader.s, stop)) if narrow.is_long else leader


def _coming(
    users: tuple[RoadUser, ...], narrow: Narrow, graph: RoadGraph, width: float
) -> Iterator[tuple[float, RoadUser]]:
    """Yield who comes to a narrow place that is too narrow for him beside the ego, and the way (m) to it."""
    for user in users:
        to_line = None if (user.body.length > ORDINARY_M) != narrow.is_long else _to_line(user, narrow, graph)
        if to_line is None or narrow.clearance - 0.5 * (width + user.body.width) > LEAST_BESIDE_M:
            continue
        if user.speed >= STANDING_SPEED or to_line <= 0.0:
            yield to_line + narrow.other_start, user


def _to_line(user: RoadUser, narrow: Narrow, graph: RoadGraph) -> float | None:
    """The way (m) to the stop line of a user who takes the other way through a narrow place; None: he does not."""
    other = narrow.other
    if user.lane_id == other.from_lane:
        if user.route[1:2] not in ((), (narrow.to_edge,)):
            return None
        return graph.lanes[other.from_lane].spine.length - user.lane_position
    inside = (-at - user.lane_position for part, at in graph.lanes_behind(other) if user.lane_id == part != other.to_lane)
    return next(inside, None)


def _turn(
    coming: list[tuple[float, RoadUser]], narrow: Narrow, left: float, speed: float, limits: VehicleLimits
) -> tuple[RoadUser | None, float]:
    """Return behind whom of `coming`, the nearest first, the ego passes a narrow place `left` m ahead (None: nobody need be
    waited for), and when it may be there (s from now).

    It goes before the first who comes well after it. It counts on half the speed allowed, or on what it has, in a bend on
    no more than that allows.
    """
    top, p = narrow.other.speed_limit, limits.parameters
    pace = min(max(speed, 0.5 * top), narrow.pace)
    own, inside = travel_time(left, speed, p.max_acceleration_in_plan, 0.5 * top), narrow.end - narrow.start
    last, turn = None, 0.0
    for theirs, user in coming:
        caught_up = max(inside / pace - inside / max(user.speed, 1.0), 0.0)
        clear = max(own, turn) + limits.length / pace + caught_up + p.narrow_lead_s
        if clear < travel_time(theirs, user.speed, user.body.gains(p.foe_acceleration), top):
            break
        if theirs + user.body.length > 0.0:
            pace_there = min(user.speed, top) if narrow.is_long else user.speed  # who is long turns slowly
            way, inside_way = max(theirs, 0.0), user.body.length + min(theirs, 0.0)
            gone = 2.0 * way / max(user.speed + pace_there, STANDING_SPEED) + inside_way / max(pace_there, STANDING_SPEED)
            last, turn = user, max(turn, gone + p.narrow_headway * limits.time_headway + limits.standstill_gap / pace)
    return last, turn


def _ahead_by(
    user: RoadUser, left: float, time: float, front: float, speed: float, limits: VehicleLimits
) -> TimeConstraint:
    """Return `user` as a leader behind whom the ego, at `speed`, comes to a narrow place `left` m ahead in `time` s.

    It drives at the pace that this takes, as far ahead as the ego follows at that pace, or as it needs to brake gently.
    """
    pace = left / time
    braking = 0.5 * (speed * speed - pace * pace) / limits.comfort_deceleration
    gap = max(pace * limits.time_headway, min(braking, left))
    return stay_behind(user.id, front + limits.standstill_gap + gap, pace, user.body.emergency_deceleration)
