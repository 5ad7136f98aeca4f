"""Leaving a queue that is held up, or somebody slower, for a lane beside that leads on as well."""

from __future__ import annotations

import math

from sumo_reactive.driver.nouns.constraint import stop_at
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Reason
from sumo_reactive.driver.nouns.forecast import Outlook, Queue, Queued
from sumo_reactive.driver.nouns.plan import NominalPlan, ParallelLane
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import CREEPING_SPEED, STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import QUEUED_SPEED
from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.driver.pilot.behaviours.changing_lanes import MIN_LANE_CHANGE_LENGTH_M, leaves_gap, pending_change
from sumo_reactive.driver.pilot.behaviours.normal import follow_curve
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.passages import Crossing, View
from sumo_reactive.driver.pilot.rules.lights import SHUT, letter_of
from sumo_reactive.driver.pilot.situation import BehaviourRule, LaneChanging, Situation
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.travel_time import LANE_CHANGE_DURATION_S

TURNERS_FEARED = 2
"""More of them in one queue are not counted: nobody knows how many go in one gap."""

HEAD_STANDS_S = 2.0
"""The head of a queue that stands for less while it may go is about to start; for longer, it waits for something else."""

HALTS_S = 20.0
"""Who has halted is expected to stay for no less: a bus at its stop does."""

SWING_OUT_M = 7.0
"""Room behind somebody who stands that a car needs to leave the lane past him; `halted_room_m` is what it keeps if it
can."""

_CREEPING_ROOM_M = 0.5
"""Beyond its braking distance: who creeps is not stopped on the spot."""

_LEAST_COST = 0.5
"""A change that the route asks for later anyway still costs this much of one now, so that it is not made for nothing."""

LEAVES_FOR = (Reason.QUEUE_CHANGE, Reason.FASTER_LANE)
"""Why the ego leaves a lane that leads on."""

OUTER_PASSING_SPEED = 22.3
"""m/s, 80 km/h; where more is allowed, nobody is passed on the outer side."""

STARTING_S, STOPPING_S = 10.0, 5.0
"""Who gains speed is expected to do so for so long, and who loses speed for so long."""

_NEAR_HEAD_M = 12.0
"""Who stands so near behind somebody who drives off will do so next."""


def released(snapshot: Snapshot, ways: tuple[Crossing, ...], memory: PilotMemory) -> tuple[str, float]:
    """Return by which connection the ego may go next as far as its light is concerned (empty: by none), since when (s)."""
    way = _next_way(snapshot, ways)
    if way is None or letter_of(way.connection, snapshot) in SHUT:
        return "", snapshot.time
    return memory.released if memory.released[0] == way.connection.id else (way.connection.id, snapshot.time)


def leave_queue(
    snapshot: Snapshot,
    plan: NominalPlan,
    outlook: Outlook,
    ways: tuple[Crossing, ...],
    memory: PilotMemory,
    limits: VehicleLimits,
) -> LaneChanging:
    """Change to a lane beside whose queue is expected to be over sooner, as soon as there is a gap; keep room for it.

    It is left for good: on the other lane the ego waits its turn and does not come back on this road. An ego that stands
    at a red light stays; where no junction is in sight, nothing but the queue itself can hold it up.
    """
    if not outlook.queues or not _is_free_to_choose(snapshot, plan, memory):
        return LaneChanging()
    way = _next_way(snapshot, ways)
    go = math.inf if way is None else snapshot.time - memory.released[1] if memory.released[0] else 0.0
    if go <= 0.0 and snapshot.ego.speed < CREEPING_SPEED:
        return LaneChanging()
    own, *others = outlook.queues
    best = min(others, key=lambda queue: _cost(queue, go, limits.parameters))
    cause = _holds_up(own, go)
    if best.way is None or cause is None or expected_wait(own, go, limits.parameters) < _cost(best, go, limits.parameters):
        return LaneChanging()
    room = math.inf if way is None else way.line - snapshot.front
    if room < max(MIN_LANE_CHANGE_LENGTH_M, 0.8 * LANE_CHANGE_DURATION_S * snapshot.ego.speed):
        return LaneChanging()
    return _leave(snapshot, best, best.way, cause, limits)


def seek_faster(view: View, outlook: Outlook, memory: PilotMemory) -> LaneChanging:
    """Change to a lane beside that gets on faster than the ego's, as soon as there is a gap; until then, wish to.

    It must gain `faster_gain_s` on the ego's lane in the next `faster_lane_s` for each lane change that it costs. Who is
    queued or about to be is passed, or his queue is left, as is one before a light that is not green.
    """
    snapshot, plan, limits, _, ways = view
    p, speed = limits.parameters, snapshot.ego.speed
    next_way = _next_way(snapshot, ways)
    must_stop = speed < CREEPING_SPEED or (next_way is not None and not memory.released[0])
    if not outlook.queues or must_stop or not _is_free_to_choose(snapshot, plan, memory):
        return LaneChanging()
    (own, *others), top = outlook.queues, plan.road_speed(snapshot.s)
    least = _way_in(own, top, own.speed_limit, limits)
    slowest = min(own.users, key=lambda one: _way_behind(one, top, p.faster_lane_s, limits), default=None)
    soon = (one.user.speed + min(one.user.acceleration, 0.0) * STOPPING_S for one in own.users)
    if slowest is None or min(soon) < QUEUED_SPEED:
        return LaneChanging()

    def gain(queue: Queue) -> float:
        way = queue.way
        if way is None or not (way.is_inner or own.speed_limit <= OUTER_PASSING_SPEED):
            return -math.inf
        needed = p.faster_gain_s * max(way.cost, _LEAST_COST) * top
        return _way_in(queue, top, own.speed_limit, limits) - least - needed

    best = max(others, key=gain)
    room = math.inf if next_way is None else next_way.line - snapshot.front
    if best.way is None or gain(best) < 0.0 or room < max(MIN_LANE_CHANGE_LENGTH_M, LANE_CHANGE_DURATION_S * speed):
        return LaneChanging()
    if not all(leaves_gap(one, speed, limits, 0.0) for one in best.near):
        return LaneChanging(wishes=True)
    why = Decision(
        behaviour=Behaviour.CHANGING_QUEUES, reason=Reason.FASTER_LANE, region=best.way.to_lane, cause=slowest.user.id,
        passes=True,
    )  # fmt: skip
    return LaneChanging(best.way.side, why=why)


def _way_in(queue: Queue, top: float, limit: float, limits: VehicleLimits) -> float:
    """Return how far (m) the ego comes on a lane in `faster_lane_s`: at `top` (m/s) where `limit` is allowed, and behind all
    whom it catches up with there."""
    free = top * min(queue.speed_limit / max(limit, CREEPING_SPEED), 1.0)
    horizon = limits.parameters.faster_lane_s
    return min(free * horizon, *(_way_behind(one, free, horizon, limits) for one in queue.users), math.inf)


def _way_behind(one: Queued, free: float, horizon: float, limits: VehicleLimits) -> float:
    """Return how far (m) the ego comes within a `horizon` (s) that it ends behind somebody, no faster than `free` (m/s)."""
    speed = min(one.user.speed + max(one.user.acceleration, 0.0) * STARTING_S, free)
    gap = one.user.body.length + limits.standstill_gap + limits.time_headway * speed
    return max(one.ahead - gap, 0.0) + speed * horizon


def expected_wait(queue: Queue, go: float, parameters: Parameters) -> float:
    """Return how long (s) the queue is expected to hold up the ego at a light that has let it `go` for some time (s).

    Its cars pass one after the other; turners wait for their gaps; a head that stands though it may go, for reasons that
    nobody knows, will stand for about as long as it has stood.
    """
    queued = [one for one in queue.users if one.user.speed < QUEUED_SPEED]
    turners = min(sum(one.yields for one in queued), TURNERS_FEARED)
    return parameters.queue_headway_s * len(queued) + parameters.turner_wait_s * turners + _stuck_for(queue, go)


def _cost(queue: Queue, go: float, parameters: Parameters) -> float:
    """Return the wait (s) that a lane beside promises, with what the change to it costs."""
    changes = max(queue.way.cost, _LEAST_COST) if queue.way else math.inf
    return expected_wait(queue, go, parameters) + parameters.queue_gain_s * changes


def _stuck_for(queue: Queue, go: float) -> float:
    """Return how long (s) the head of what does not move in the queue has stood though it may go; 0: it has not.

    Who has halted does not wait; for how long he has held up the others, those behind him tell. With nobody between, he is
    passed, not his queue left.
    """
    head = _head(queue)
    if head is None:
        return 0.0
    waited = head.user.waiting_time
    if head.user.is_halted:
        behind = [one.user.waiting_time for one in queue.users if one.ahead < head.ahead]
        waited = max(HALTS_S, *behind) if behind else 0.0
    waited = min(waited, go)
    return waited if waited > HEAD_STANDS_S else 0.0


def _head(queue: Queue) -> Queued | None:
    """Return the first that stands, unless the queue before him is driving off already."""
    before, drives_off = math.inf, False
    for one in queue.users:
        stands = one.user.is_halted or one.user.waiting_time > 0.0
        drives_off = not stands or (drives_off and not one.user.is_halted and before - one.ahead < _NEAR_HEAD_M)
        if not drives_off:
            return one
        before = one.ahead - one.user.body.length
    return None


def _holds_up(queue: Queue, go: float) -> Queued | None:
    """Return whom to blame for the wait: the head that stands though it may go, else the first who has to let others go."""
    if _stuck_for(queue, go) > 0.0:
        return _head(queue)
    turner = next((one for one in queue.users if one.yields and one.user.speed < QUEUED_SPEED), None)
    return turner if turner is not None else next(iter(queue.users), None)


def _next_way(snapshot: Snapshot, ways: tuple[Crossing, ...]) -> Crossing | None:
    return next((way for way in ways if way.passage.start > snapshot.front), None)


def _is_free_to_choose(snapshot: Snapshot, plan: NominalPlan, memory: PilotMemory) -> bool:
    """Whether the ego is settled on its lane, and no other manoeuvre is under way or due."""
    under_way = memory.overtaking is not None or plan.aside is not None or snapshot.s < plan.joins
    return not under_way and pending_change(snapshot, plan) is None


def _leave(snapshot: Snapshot, queue: Queue, way: ParallelLane, cause: Queued, limits: VehicleLimits) -> LaneChanging:
    """Begin the change to the lane of `queue` if there is a gap there and room to swing out, else keep that room from where
    who is ahead can stop."""
    speed, twice = snapshot.ego.speed, 2.0 * limits.comfort_deceleration
    ahead = [obstacle for obstacle in snapshot.on_path if obstacle.start > snapshot.front]
    x = min((one.start for one in ahead), default=math.inf)
    needed = SWING_OUT_M + speed * speed / twice
    if x - snapshot.front >= needed and all(leaves_gap(one, speed, limits, 0.0) for one in queue.near):
        why = Decision(
            behaviour=Behaviour.CHANGING_QUEUES, reason=Reason.QUEUE_CHANGE, region=way.to_lane, cause=cause.user.id,
            passes=True,
        )  # fmt: skip
        return LaneChanging(way.side, why=why)
    stops = min((one.start + max(one.along, 0.0) ** 2 / twice for one in ahead), default=math.inf)
    place = stops - limits.parameters.halted_room_m
    nearest = snapshot.front + speed * speed / twice
    if place < nearest and speed >= CREEPING_SPEED:
        return LaneChanging()
    place = max(place, nearest + (_CREEPING_ROOM_M if speed > STANDING_SPEED else 0.0))
    if place == math.inf:
        return LaneChanging()
    return LaneChanging(stop=stop_at(place, Reason.QUEUE_CHANGE, way.to_lane, cause.user.id))


def is_worth_it(situation: Situation) -> bool:
    """The queue is held up, or somebody in it slower, and a lane beside leads on as well and is over sooner."""
    changing = situation.changing
    reasons = (changing.why and changing.why.reason, changing.stop and changing.stop.reason)
    return any(reason in LEAVES_FOR for reason in reasons)


def is_not_worth_it(situation: Situation) -> bool:
    """The ego has left the queue, or the queue goes on."""
    return not is_worth_it(situation)


RULE = BehaviourRule(Behaviour.CHANGING_QUEUES, (is_worth_it,), follow_curve, (is_not_worth_it,))
