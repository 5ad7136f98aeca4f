"""The room behind an intersection: M enters it only if it can clear it without stopping in a region (F&L 1991, §2)."""

from __future__ import annotations

import math
from collections.abc import Iterable

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Occupancy, PostConflictState, Reason
from sumo_reactive.driver.nouns.plan import CALL_OFF_SHARE, NominalPlan
from sumo_reactive.driver.nouns.snapshot import PathObstacle, Snapshot
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import FOLLOWER_STANDSTILL_GAP_M, QUEUED_SPEED
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.passages import Crossing
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.safe_speed import HARD_STOP_MARGIN_M
from sumo_reactive.driver.vehicle.travel_time import travel_time

_LIGHTS = (Reason.RED_LIGHT, Reason.YELLOW_LIGHT)

_MADE_THERE = (Reason.SCHEDULED_STOP, Reason.STOP_SIGN)
"""Stops that are made where they are asked for: whoever waited elsewhere for their end would wait for ever."""

LACKING_M_S = 0.1
"""Who has waited in vain is content with so much less room behind a junction for each further second (SUMO's own drivers
for each second: `MSVehicle::checkRewindLinkLanes`), lest it wait for ever for room that its green never brings."""


def is_clear_at(way: Crossing, limits: VehicleLimits) -> float:
    """Return how far on C (m) the ego's front is when its rear has left every region of a passage where it may not stand."""
    return way.post + limits.length


def taken_by(way: Crossing, snapshot: Snapshot, memory: PilotMemory, limits: VehicleLimits) -> str:
    """Return who leaves no room behind the last region of a passage (empty: nobody): the post-conflict region.

    Nobody is in danger: the ego does not brake harder than planned for it. Where the map says that a junction need not be
    kept clear, it does not wait for ever, nor where nobody comes whom it would block.
    """
    if not snapshot.parameters.has(Mechanism.ROOM_BEHIND):
        return ""
    p, waited = limits.parameters, memory.waited_at(way.connection.id, snapshot.time)
    if _may_wait(way, snapshot, limits.service_deceleration) and waited < p.queue_patience_s:
        nose = _nose_in_the_way(way, snapshot, limits)  # the ego has to brake for that body anyway
        if nose:
            return nose
    if way.post == -math.inf or not _may_wait(way, snapshot, p.planned_deceleration):
        return ""
    if not way.connection.keep_clear and waited > _patience(way, snapshot):
        return ""
    lacking = LACKING_M_S * max(waited - p.queue_patience_s, 0.0)
    behind = is_clear_at(way, limits) + limits.standstill_gap - lacking
    time = travel_time(behind - snapshot.front, snapshot.ego.speed, limits.acceleration_in_plan, way.pace)
    ahead = (o for o in snapshot.on_path if o.start > snapshot.front and o.along > -STANDING_SPEED)
    along = [o for o in ahead if abs(o.across) <= max(o.along, 1.0)]
    braking = math.nan if waited > p.queue_patience_s else snapshot.parameters.comfort_deceleration
    return _too_near(along, time, (way.passage.start, behind), braking)


def _nose_in_the_way(way: Crossing, snapshot: Snapshot, limits: VehicleLimits) -> str:
    """Return who stands on another road with his body in the ego's way through the junction or out of it (empty: nobody),
    since the map draws his line there: he goes if the ego does not, and else both wait for each other."""
    own = way.connection.from_lane, way.connection.to_lane
    last = way.passage.end + limits.length  # turning out of it, the body still covers what is beside its lane
    met = (o for o in snapshot.on_path if way.passage.start < o.start < last and o.user.speed < QUEUED_SPEED)
    waiting = (o.user for o in met if not o.user.is_halted and not o.user.lane_id.startswith(":"))
    return next((user.id for user in waiting if user.lane_id not in own and not user.body.is_person), "")


def _too_near(obstacles: list[PathObstacle], time: float, post: tuple[float, float], braking: float) -> str:
    """Return whose rear will not have left a junction and the room behind it, `post` (from, to, m of C), after `time` s
    (empty: everybody's).

    Who moves gets no farther than those ahead let him, and who crawls may stop at once, by `braking` (m/s²; NaN: he goes on
    crawling, as he has done while the ego waited). Who is still
    before the line may yet turn off, and counts only where he would fill up a queue.
    """
    ahead: list[tuple[float, float]] = []
    for obstacle in sorted(obstacles, key=lambda one: -one.start):
        way = max(obstacle.along, 0.0) * time
        if obstacle.along < QUEUED_SPEED and not math.isnan(braking):
            way = min(way, max(obstacle.along, 0.0) * (1.0 + 0.5 * obstacle.along / braking))
        is_inside = obstacle.start > post[0]
        own = obstacle.start + way if is_inside else math.inf
        ends = [rear for start, rear in ahead if start >= obstacle.end]
        taken = FOLLOWER_STANDSTILL_GAP_M + obstacle.user.body.length
        rear = max(min([own, *(end - taken for end in ends)]), obstacle.start)
        if rear < post[1]:
            return obstacle.user.id
        ahead.append((obstacle.start, rear))
    return ""


def _may_wait(way: Crossing, snapshot: Snapshot, braking: float) -> bool:
    """Whether `braking` (m/s²) still stops the ego before the junction."""
    room = way.line - HARD_STOP_MARGIN_M - snapshot.front
    return snapshot.front <= way.passage.start and snapshot.ego.speed**2 <= 2.0 * braking * max(room, 0.0)


def _patience(way: Crossing, snapshot: Snapshot) -> float:
    """Return how long (s) to wait for room where nobody asks for it: short when nobody comes who would be blocked."""
    blocked = any(foe.passage == way.number and foe.user.speed >= STANDING_SPEED for foe in snapshot.foes)
    return snapshot.parameters.missed_turn_s if blocked else snapshot.parameters.foe_patience_s


def wait_before(
    way: Crossing,
    stops: Iterable[TimeConstraint],
    snapshot: Snapshot,
    memory: PilotMemory,
    limits: VehicleLimits,
) -> TimeConstraint | None:
    """Return the first of the `stops` behind a junction at which M would stand in a region of it, or with its rear not yet
    in it, moved before its line.

    None: it would stand clear, can no longer stop before the line, or has waited there in vain, for a light behind through
    a whole green of its own. A stop of the route is made where the route says, and a full stop at its line: M goes on then.
    """
    p = limits.parameters
    if not p.has(Mechanism.ROOM_BEHIND) or way.last == -math.inf:
        return None
    clear = max(is_clear_at(way, limits), way.passage.start + limits.length)
    waited = memory.waited_at(way.connection.id, snapshot.time)
    if not _may_wait(way, snapshot, p.planned_deceleration) or waited > p.queue_patience_s:
        return None
    inside = (stop for stop in stops if way.line < stop.s < clear and stop.reason not in _MADE_THERE)
    first = min(inside, key=lambda stop: stop.s, default=None)
    if first is None or (first.reason in _LIGHTS and memory.lost == way.connection.id):
        return None
    return first._replace(s=way.line)


def states_of(
    way: Crossing, blocked: TimeConstraint | None, before: TimeConstraint | None, front: float, limits: VehicleLimits
) -> tuple[PostConflictState, ...]:
    """Return the state of the room behind a passage, if it has one, by the stops `before` it: for it is `blocked`, or the
    ego would stop in it."""
    if way.post == -math.inf:
        return ()
    waits = blocked or before
    occupancy = Occupancy.OCCUPIED if blocked else Occupancy.OWN if front > way.passage.start else Occupancy.FREE
    end = is_clear_at(way, limits) + limits.standstill_gap
    state = PostConflictState(
        connection_id=way.connection.id, start=way.post, end=end, occupancy=occupancy, cause=waits.cause if waits else "",
        waits=waits is not None,
    )  # fmt: skip
    return (state,)


def clear_of(
    stop: TimeConstraint | None,
    ways: Iterable[Crossing],
    plan: NominalPlan,
    front: float,
    limits: VehicleLimits,
) -> TimeConstraint | None:
    """Return the stop before a change of lanes, moved on until an ego that is inside a junction already is clear of it, but
    not so far that its body crosses the line between the lanes."""
    change = None if stop is None else next((c for c in plan.lane_changes if c.end > front), None)
    if stop is None or change is None or stop.reason is not Reason.NO_GAP or stop.region != change.to_lane:
        return stop
    clear = max((is_clear_at(way, limits) for way in ways if way.passage.start < front), default=-math.inf)
    farthest = change.start + CALL_OFF_SHARE * (change.end - change.start)
    return stop._replace(s=max(stop.s, min(clear, farthest)))
