"""Turning round where the road is too narrow for one sweep: forwards and backwards by turns, wheels at full lock."""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.curve import CURVE_STEP_M
from sumo_reactive.driver.geometry.polyline import Floats, Polyline, cut, joined
from sumo_reactive.driver.geometry.swept import steering_along
from sumo_reactive.driver.nouns.plan import MOVE_SPEED, Move
from sumo_reactive.driver.nouns.state import Pose
from sumo_reactive.driver.path.reference import Reference
from sumo_reactive.driver.path.trajectory import CurveStart, trajectory
from sumo_reactive.driver.path.turning import STEERING_MARGIN
from sumo_reactive.driver.path.way_back import TURNAROUNDS_KEPT, Around, leads_back, way_over
from sumo_reactive.driver.vehicle.bicycle import advance_pose
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph

MOVE_CHANGE_S = 1.5
"""What changing between forwards and backwards takes, with the wheels turned from lock to lock, s."""

TURNAROUND_LEAD_M = 30.0
"""A turn's sweep is tried from this far before it to this far behind it, more than a car needs to swing out and back."""

ARC_STEP_M = 0.15
"""Poses on an arc are looked at this far apart."""
LONGEST = 90
"""Most poses of an arc, that is 13.5 m: half a circle of a car."""
SWEEP_SPEED = 3.0
"""m/s; how fast a tight turn is approached when its sweep is tried."""
ATTEMPTS = ((3, 0.0, 0.0), (3, 1.0, 0.0), (5, 0.0, 0.0), (7, 1.0, 0.0), (7, 1.0, 0.6), (9, 1.0, 1.2), (9, 1.0, 1.8))
"""Most moves; how far the middles of the bumpers may leave the road, as a share of half the car's width without
OFF_ROAD_SPARE_M; and how much farther the rear one, m. Three moves are preferred to five, and all of them to leaving the
road with the rear wheels, which a road hardly wider than the car asks for."""
OFF_ROAD_SPARE_M = 0.25
"""A front that leaves the road by half the car's width is off it; a turn stays clear of that by this much."""
BEGINNINGS_M = (1.0, 2.5, 4.0, 6.0)
"""How far before the end of its lane the turn may begin: SUMO maps a stand-in nearer to it to the lane behind."""
SHARES = (1.0, 0.6)
"""A move ends where the road does, or after so much of that way."""
LOCKS = (1.0, 0.8, 0.6, 0.4)
"""Shares of the full lock with which the last move may be driven."""
INTO_LANE_M = 0.4
"""The front axle ends the turn this near to the middle of its lane."""
MOST_TRIED = 500
"""Moves that are tried until a turn is given up."""
SAME_M, SAME_RAD = 0.4, 0.08
"""Poses that differ by less are one."""


class MultiPointTurn(NamedTuple):
    """A turn in `moves` from a stand with the front bumper `before` m before the end of the lane; it takes `duration` s and
    ends with the front `into` m along the lane behind."""

    before: float
    moves: tuple[Move, ...]
    duration: float
    into: float


def road_near(lines: Sequence[tuple[Polyline, float]], x: float, y: float) -> Floats:
    """Return the road that `lines` of some width (m) cover within TURNAROUND_LEAD_M of (x, y): segments from (x, y) to
    (x, y) with half their width, (k, 5), m."""
    chains = [line.points for line, _ in lines]
    half = np.concatenate([np.full(len(line.points) - 1, 0.5 * width) for line, width in lines])
    ground = np.column_stack((np.vstack([c[:-1] for c in chains]), np.vstack([c[1:] for c in chains]), half))
    near = [_beyond(segment[None], x, y) < TURNAROUND_LEAD_M for segment in ground]
    return ground[near]


@kernel
def _beyond(ground: Floats, x: float, y: float) -> float:
    """Return how far off the `ground` (k, 5) a place is, m; negative on it."""
    least = math.inf
    for k in range(len(ground)):
        wx, wy = ground[k, 2] - ground[k, 0], ground[k, 3] - ground[k, 1]
        ox, oy = x - ground[k, 0], y - ground[k, 1]
        share = min(max((ox * wx + oy * wy) / max(wx * wx + wy * wy, 1e-9), 0.0), 1.0)
        least = min(least, math.hypot(ox - share * wx, oy - share * wy) - ground[k, 4])
    return least


@kernel
def _arc(
    x: float, y: float, heading: float, gear: int, angle: float, wheelbase: float, ahead: float, behind: float,
    ground: Floats, front_beyond: float, rear_beyond: float,
) -> Floats:  # fmt: skip
    """Return the poses (n, 3), ARC_STEP_M apart, that follow with the wheels at `angle` (rad) as long as the bumpers,
    `ahead` and `behind` m from the rear axle, leave the `ground` (k, 5) by no more than is allowed (m)."""
    found = np.empty((LONGEST, 3))
    for k in range(LONGEST):
        px, py, ph = advance_pose(x, y, heading, gear * ARC_STEP_M * (k + 1), angle, wheelbase, 1.0)
        c, s = math.cos(ph), math.sin(ph)
        if _beyond(ground, px + ahead * c, py + ahead * s) > front_beyond:
            return found[:k]
        if _beyond(ground, px - behind * c, py - behind * s) > rear_beyond:
            return found[:k]
        found[k] = px, py, ph
    return found


class _Task(NamedTuple):
    """Where to turn: on what ground (k, 5), how far beyond it with front and rear (m), into what `line` and on along it, up
    to which headings of its segments (n − 1,), rad, to which side (1: left)."""

    ground: Floats
    beyond: tuple[float, float]
    line: Polyline
    headings: Floats
    side: int
    limits: VehicleLimits

    def arc(self, pose: Pose, gear: int, angle: float) -> Floats:
        """Return the poses (n, 3) that follow `pose` in `gear` with the wheels at `angle`, as long as they are allowed."""
        own = self.limits
        sizes = own.wheelbase, own.front_to_rear_axle, own.rear_overhang
        return _arc(pose.x, pose.y, pose.heading, gear, angle, *sizes, self.ground, *self.beyond)

    def move(self, gear: int, angle: float, until: float, *, is_last: bool = False) -> Move:
        """Return the move in `gear` with the wheels at `angle` up to heading `until`."""
        return Move(
            gear=gear, steering_angle=angle, bend=math.sin(angle) / self.limits.wheelbase, until=until, is_last=is_last
        )

    def turned(self, arc: Floats) -> int:
        """Return how many of an arc's poses it takes to turn to the way along the line, the front axle on the line; too
        many, where they do not."""
        axles = arc[:, :2] + self.limits.wheelbase * np.column_stack((np.cos(arc[:, 2]), np.sin(arc[:, 2])))
        segments = np.searchsorted(self.line.arc_lengths[1:-1], self.line.arc_lengths_at(axles), side="right")
        beyond = self.side * (arc[:, 2] - self.headings[segments])
        is_along = (beyond >= 0.0) & (beyond < SAME_RAD)
        found = np.flatnonzero(is_along & (np.abs(self.line.offsets(axles)) < INTO_LANE_M))
        return int(found[0]) + 1 if len(found) else len(arc) + 1

    def turns_back(self, arc: Floats) -> int:
        """Return how many of an arc's poses do not turn beyond the way into the line."""
        return int(np.searchsorted(self.side * arc[:, 2], self.side * self.headings[0]))

    def front_along(self, pose: Pose) -> float:
        """Return how far along the line the front bumper is, m."""
        (x, y), end, line = pose.ahead(self.limits.front_to_rear_axle), self.line.length, self.line
        (ex, ey), heading = line.at(end), line.heading_at(end)
        past = (x - ex) * math.cos(heading) + (y - ey) * math.sin(heading)
        along = line.project(x, y)[0]
        return along if along < end else end + max(past, 0.0)


@kept(TURNAROUNDS_KEPT)
def turn_in_moves(
    graph: RoadGraph, connection_ids: tuple[str, ...], limits: VehicleLimits, around: Around | None = None,
    latest: float | None = None,
) -> MultiPointTurn | None:  # fmt: skip
    """Return how the car turns round on a way back; None: in one sweep, or no moves are found.

    As few moves as possible, and if it can be with the middles of its bumpers on the road, to which the lanes `around`
    belong. On a stub it may begin on a lane before it; who cannot stop there begins where he can, his front `latest` m
    before the end of the lane.
    """
    way, around = way_over(graph, connection_ids), around or Around()
    inside = [graph.lanes[name] for name in (*way.parts, *around.before, *around.behind)]
    before, exits = (
        [lane for lane in graph.edge_lanes[edge_id] if lane.allows(limits.vehicle_class)]
        for edge_id in (way.own.edge_id, way.behind.edge_id)
    )
    if not leads_back(graph, connection_ids) or _is_swept(graph, connection_ids, limits, [*before, *inside, *exits]):
        return None
    lanes = [graph.lanes[name] for name in around.before]
    approach = Polyline(np.vstack([lane.spine.points for lane in (*lanes, way.own)]))
    ground = _ground(graph, [way.own, *inside, *exits], around.apron, way.own)
    line = _onward(graph, way.behind, around)
    heading, side = way.own.spine.heading_at(way.own.spine.length) + way.turned, 1 if way.turned > 0.0 else -1
    ways = np.diff(line.points, axis=0)
    headings = heading + np.unwrap(np.arctan2(ways[:, 1], ways[:, 0])) - line.heading_at(0.0)
    places = [way.hold_back + more for more in BEGINNINGS_M] if latest is None else [latest]
    for most, share, more in ATTEMPTS:
        aside = share * max(0.5 * limits.width - OFF_ROAD_SPARE_M, 0.0)
        task = _Task(ground, (aside, aside + more), line, headings, side, limits)
        found = _searched(task, _beginnings(approach, places, limits), most)
        if found is not None:
            return found
    return None


def _onward(graph: RoadGraph, behind: Lane, around: Around) -> Polyline:
    """Return the line of lane `behind` and of what follows on it."""
    lines = [graph.lanes[name].spine for name in (behind.id, *around.behind)]
    if around.apron is not None:
        lines.append(graph.connections[around.apron[0]].path)
    return Polyline(joined([line.points for line in lines]))


def _ground(graph: RoadGraph, lanes: Sequence[Lane], apron: tuple[str, float] | None, own: Lane) -> Floats:
    """Return the road (k, 5) near the end of lane `own` that `lanes` and the apron cover."""
    lines = [(lane.spine, lane.width) for lane in lanes]
    if apron is not None:
        way = graph.connections[apron[0]]
        lines.append((Polyline(cut(way.path, 0.0, apron[1])), way.width))
    return road_near(lines, *own.spine.at(own.spine.length))


def _is_swept(graph: RoadGraph, connection_ids: Sequence[str], limits: VehicleLimits, lanes: list[Lane]) -> bool:
    """Whether the car turns on a way back in one sweep, the middle of its front bumper not off the road."""
    way, reference = way_over(graph, connection_ids), Reference(graph)
    reference.follow(way.own, 0, way.own.spine.length - TURNAROUND_LEAD_M, way.own.spine.length)
    for one in connection_ids:
        reference.pass_junction(graph.connections[one], 0)
        lane = graph.lanes[graph.connections[one].to_lane]
        reference.follow(lane, 0, 0.0, min(TURNAROUND_LEAD_M, lane.spine.length))
    reference.run_out(TURNAROUND_LEAD_M)
    first, second = reference.points[0][:2]
    heading = math.atan2(second[1] - first[1], second[0] - first[0])
    start = CurveStart(float(first[0]), float(first[1]), heading, SWEEP_SPEED)
    curve = trajectory(reference, start, limits).curve
    along = curve.heading - steering_along(curve.heading, np.full(len(curve.x), curve.step), limits.wheelbase, 0.0)
    reach = limits.front_overhang
    bumper = np.column_stack((curve.x + reach * np.cos(along), curve.y + reach * np.sin(along)))
    near = int(TURNAROUND_LEAD_M / CURVE_STEP_M)
    ground = _ground(graph, lanes, None, way.own)
    return all(_beyond(ground, x, y) < 0.5 * limits.width for x, y in bumper[near // 2 : len(bumper) - near].tolist())


def _beginnings(spine: Polyline, places: Sequence[float], limits: VehicleLimits) -> list[tuple[float, Pose]]:
    """Return where the turn may begin: the bumper's way to the end of the lane (m), one of `places`, and the pose there."""
    found = []
    for before in places:
        if before < spine.length:
            way = cut(spine, 0.0, spine.length - before - limits.parameters.stop_line_margin_m)
            (x, y), heading = way[-1].tolist(), math.atan2(*(way[-1] - way[-2])[::-1])
            found.append((before, Pose(*Pose(x, y, heading).ahead(-limits.front_to_rear_axle), heading)))
    return found


def _searched(task: _Task, beginnings: list[tuple[float, Pose]], most: int) -> MultiPointTurn | None:
    """Return the turn with the fewest moves, at most `most`, among those the shortest; best first, equal poses once."""
    lock, number = task.side * STEERING_MARGIN * task.limits.max_steering_angle, itertools.count()
    queue: list[tuple[int, float, int, float, Pose, tuple[Move, ...]]] = []
    for before, pose in beginnings:
        heapq.heappush(queue, (0, 0.0, next(number), before, pose, ()))
    seen: set[tuple[int, ...]] = set()
    while queue and len(seen) < MOST_TRIED:
        count, way, _, before, pose, moves = heapq.heappop(queue)
        gear = -1 if count % 2 else 1
        place = gear, round(pose.x / SAME_M), round(pose.y / SAME_M), round(pose.heading / SAME_RAD)
        if place in seen or count >= most:
            continue
        seen.add(place)
        last = _last_move(task, pose, lock) if gear > 0 else None
        if last is not None:
            duration = (way + last[1]) / MOVE_SPEED + MOVE_CHANGE_S * (len(moves) + 1)
            return MultiPointTurn(before, _in_turn((*moves, last[0])), duration, task.front_along(last[2]))
        arc = task.arc(pose, gear, gear * lock)
        end = min(len(arc), task.turns_back(arc))
        for k in {int(share * end) for share in SHARES}:
            if k >= 2:
                after = Pose(*arc[k - 1].tolist())
                move = task.move(gear, gear * lock, after.heading)
                heapq.heappush(queue, (count + 1, way + k * ARC_STEP_M, next(number), before, after, (*moves, move)))
    return None


def _in_turn(moves: tuple[Move, ...]) -> tuple[Move, ...]:
    """Return the moves, each with the steering angle of the next."""
    return (*(replace(one, then=after.steering_angle) for one, after in pairwise(moves)), moves[-1])


def _last_move(task: _Task, pose: Pose, lock: float) -> tuple[Move, float, Pose] | None:
    """Return the move that ends in the lane, its way, m, and where it ends; None: there is none from `pose`."""
    for share in LOCKS:
        arc = task.arc(pose, 1, share * lock)
        k = task.turned(arc)
        if k <= len(arc):
            end = Pose(*arc[k - 1].tolist())
            return task.move(1, share * lock, end.heading, is_last=True), k * ARC_STEP_M, end
    return None
