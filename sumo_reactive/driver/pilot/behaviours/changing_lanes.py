"""Changing to the lane that the route needs, or cutting into the lane beside: if there is a gap, else waiting for one."""

from __future__ import annotations

import math
from operator import itemgetter

from sumo_reactive.driver.nouns.constraint import stop_at
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Reason
from sumo_reactive.driver.nouns.plan import (
    CALL_OFF_SHARE,
    LANE_CHANGE_CLEARANCE_M,
    LATE_LANE_CHANGE_LENGTH_M,
    LaneChange,
    NominalPlan,
    segment_at,
)
from sumo_reactive.driver.nouns.snapshot import Neighbour, OffTracking, Snapshot
from sumo_reactive.driver.nouns.state import CREEPING_SPEED, STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import FOLLOWER_STANDSTILL_GAP_M, RoadUser
from sumo_reactive.driver.pilot.behaviours.normal import follow_curve
from sumo_reactive.driver.pilot.passages import Crossing
from sumo_reactive.driver.pilot.rules.gaps import gap_for_follower
from sumo_reactive.driver.pilot.situation import BehaviourRule, LaneChanging, Situation
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.travel_time import LANE_CHANGE_DURATION_S
from sumo_reactive.driver.world.lane import road_of

MIN_LANE_CHANGE_LENGTH_M = 12.0
"""Room of a lane change at walking speed: a car of 3.6 m turning radius moves 3.2 m aside in 6.4 m; twice that is smooth."""

_LEAST_SHARE = 0.8
"""Of the usual duration of a change, a smooth one takes no less than this."""

_LEAST_RATE = 0.01
"""m/s²; who gains on an ego that cannot gain speed, and is not asked, gains without end."""


def pending_change(snapshot: Snapshot, plan: NominalPlan) -> LaneChange | None:
    """Return the next lane change if it is time to seek a gap for it."""
    if not plan.lane_changes:
        return None
    change, front = plan.next_change(snapshot.front), snapshot.front
    if change is None or change.start <= snapshot.s or change.start - front > _horizon(snapshot) or _is_made(change, plan):
        return None
    speed, braking = snapshot.ego.speed, snapshot.parameters.comfort_deceleration
    return change if plan.may_be_sought(change, front, speed, braking) else None


def just_begun(snapshot: Snapshot, plan: NominalPlan) -> LaneChange | None:
    """Return the change that the ego has begun when it was asked to, while its body is still on its own side of the line."""
    change = next(iter(plan.lane_changes), None)
    if change is None or not _is_made(change, plan) or snapshot.s > CALL_OFF_SHARE * change.end:
        return None
    return change


def _is_made(change: LaneChange, plan: NominalPlan) -> bool:
    """Whether C begins with the change: it comes from where the car was when it was asked for."""
    return change.start <= 0.0 and change.end == plan.joins


def seeks(snapshot: Snapshot, plan: NominalPlan) -> bool:
    """Whether it is time to seek a gap on the lane beside, or to see that it stays open."""
    if snapshot.off_tracking is not None or not plan.lane_changes:
        return snapshot.off_tracking is not None
    return pending_change(snapshot, plan) is not None or just_begun(snapshot, plan) is not None


def _horizon(snapshot: Snapshot) -> float:
    p = snapshot.parameters
    return max(p.lane_change_look_ahead_m, p.lane_change_look_ahead_s * snapshot.ego.speed)


def seek_gap(snapshot: Snapshot, plan: NominalPlan, limits: VehicleLimits, waited: float = 0.0) -> LaneChanging:
    """Begin the change that the route needs as soon as a gap allows; without one, stop where C would begin it.

    A change whose gap has closed before the body is over the line is called off, if there is still way to wait for another.
    Where the body will cut into the lane beside, stop before, unless nobody comes there; the longer the ego has `waited`
    (s), the smaller a gap it takes.
    """
    begun = just_begun(snapshot, plan)
    if begun is not None:
        return _called_off(snapshot, plan, begun, limits)
    if snapshot.off_tracking is not None:
        return _before_off_tracking(snapshot, snapshot.off_tracking, plan, limits, waited)
    change = pending_change(snapshot, plan)
    if change is None:
        return LaneChanging()
    left = change.start - snapshot.front
    urgency = _urgency(snapshot, left)
    blocker = _blocker(snapshot, limits, urgency)
    if not blocker:
        return LaneChanging(side=change.side if _has_room(snapshot, plan, change) else 0)
    stop = stop_at(change.start, Reason.NO_GAP, region=change.to_lane, cause=blocker)
    slot, asked = _slot(snapshot, plan, left, limits, urgency)
    return LaneChanging(stop=stop, slot=slot, why=_asking(asked, change.to_lane))


def _urgency(snapshot: Snapshot, left: float) -> float:
    """Return how a gap presses (0..1) with `left` m to the place where the change has to begin."""
    p = snapshot.parameters
    return min(1.0, max(0.0, 1.0 - left / max(p.urgent_m, p.urgent_s * snapshot.ego.speed)))


def merge_early(
    snapshot: Snapshot, plan: NominalPlan, ways: tuple[Crossing, ...], limits: VehicleLimits
) -> LaneChanging:
    """Leave a lane that ends in a merge, as an on-ramp's does, for the one that it yields to, as soon as there is a gap;
    fall in behind who is ahead there meanwhile.

    Without a gap the ego goes on to the end, where the merge has its rule; a gap presses where it must brake for that.
    """
    merge = plan.merging(snapshot.front)
    if merge is None or snapshot.s < plan.joins or plan.aside is not None:
        return LaneChanging()
    speed = snapshot.ego.speed
    line = next((way.line for way in ways if way.passage.start > snapshot.front), math.inf)
    if line - snapshot.front < _least_length(speed):
        return LaneChanging()
    left = line - snapshot.front - speed * speed / (2.0 * limits.comfort_deceleration)
    urgency = _urgency(snapshot, left)
    if _blocker(snapshot, limits, urgency):
        slot, asked = _slot(snapshot, plan, left, limits, urgency)
        return LaneChanging(slot=slot, why=_asking(asked, merge.to_lane))
    beside = min(snapshot.neighbours, key=lambda one: abs(one.ahead), default=None)
    cause = beside.user.id if beside else ""
    why = Decision(
        behaviour=Behaviour.CHANGING_LANES, reason=Reason.MERGE_AHEAD, region=merge.to_lane, cause=cause, passes=True
    )
    return LaneChanging(merge.side, why=why)


def _called_off(snapshot: Snapshot, plan: NominalPlan, begun: LaneChange, limits: VehicleLimits) -> LaneChanging:
    """Stay on the old lane if not even the smallest gap is left on the new one, and the change may still wait.

    Who creeps up from behind only comes as near as cars stand behind each other.
    """
    creeping = snapshot.parameters.lane_change_gap_m / 2.0 + limits.length
    closing = (n for n in snapshot.neighbours if n.user.speed > CREEPING_SPEED or n.ahead > -creeping)
    blocker = next((n.user.id for n in closing if not leaves_gap(n, snapshot.ego.speed, limits, 1.0)), "")
    if not blocker or not _may_wait(snapshot, plan, limits):
        return LaneChanging()
    why = Decision(behaviour=Behaviour.CHANGING_LANES, reason=Reason.GAP_CLOSED, region=begun.to_lane, cause=blocker)
    return LaneChanging(why=why, calls_off=True)


def _may_wait(snapshot: Snapshot, plan: NominalPlan, limits: VehicleLimits) -> bool:
    """Whether the ego can still stop comfortably before the last place for this change and those behind it on this road."""
    ends = [passage.start for passage in plan.passages if passage.start > snapshot.front]
    ends += [stop.s for stop in plan.stops if stop.s > snapshot.front]
    end = min(ends, default=plan.curve.length)
    changes = sum(change.start < end for change in plan.lane_changes)
    last = end - LANE_CHANGE_CLEARANCE_M - changes * LATE_LANE_CHANGE_LENGTH_M
    return last - snapshot.front > snapshot.ego.speed**2 / (2.0 * limits.comfort_deceleration)


def _before_off_tracking(
    snapshot: Snapshot, place: OffTracking, plan: NominalPlan, limits: VehicleLimits, waited: float
) -> LaneChanging:
    """Stop before a cut into the lane beside if somebody there is near when the ego comes to it, and it can still stop: he
    keeps his speed until then or, where both have to turn before they are there, comes down to the pace of the ego.

    An ego inside a junction waits there for nobody who has not come in yet: the regions say who of them goes first, and
    those behind on the lanes beside its own see its body. Nor does one before it for who stands before it on another road.
    """
    left, speed = place.start - snapshot.front, snapshot.ego.speed
    if left < speed * speed / (2.0 * limits.service_deceleration):
        return LaneChanging()
    pace = min(max(speed, CREEPING_SPEED), plan.road_speed(place.start))
    time, urgency = left / max(pace, CREEPING_SPEED), min(waited / snapshot.parameters.off_tracking_patience_s, 1.0)
    inside = any(one.start < snapshot.front and place.start < one.end + limits.length for one in plan.passages)
    is_behind = any(snapshot.front < one.start <= place.start for one in plan.passages)
    turns, road = speed > CREEPING_SPEED and is_behind, road_of(segment_at(plan, snapshot.front).lane_id)
    for neighbour in snapshot.neighbours:
        lane_id, his = neighbour.user.lane_id, neighbour.user.speed
        waits = is_behind and his < STANDING_SPEED and road_of(lane_id) != road
        is_before = neighbour.ahead < 0.0 and lane_id != place.lane_id and not lane_id.startswith(":")
        if is_before and (inside or waits):
            continue
        slower = min(his, pace) if turns else his
        soonest, latest = (neighbour.ahead + one * time - left for one in (his, slower))
        ends = (neighbour._replace(ahead=ahead) for ahead in (soonest, latest))
        if latest < 0.0 < soonest or not all(leaves_gap(one, pace, limits, urgency) for one in ends):
            return LaneChanging(stop=stop_at(place.start, Reason.NO_GAP, region=place.lane_id, cause=neighbour.user.id))
    return LaneChanging()


def _slot(snapshot: Snapshot, plan: NominalPlan, left: float, limits: VehicleLimits, urgency: float) -> tuple[str, str]:
    """Return the vehicle on the other lane that the ego will follow, and, if a gap presses, the next one, who is asked to
    let it in: it follows the nearest who leaves no gap behind it, once both drive equally fast, or of whom it cannot get
    clear on the `left` m with what its road allows.

    One that stands is not waited for (empty): the ego drives on to the last place for its change.
    """
    top, found, others = plan.road_speed(snapshot.s), list[tuple[float, RoadUser]](), list[tuple[float, RoadUser]]()
    asks = limits.parameters.asked_deceleration if urgency > 0.0 else 0.0
    for one in snapshot.neighbours:
        his = one.user.speed
        ahead = one.ahead + _gained(his, snapshot.ego.speed, left, asks, limits)
        passed = one._replace(ahead=ahead - max(top - his, 0.0) * max(left, 0.0) / max(his, CREEPING_SPEED))
        if ahead >= 0.0 or not leaves_gap(passed, his, limits, 1.0):
            found.append((ahead, one.user))
        elif asks > 0.0 and _can_let_in(one, ahead, snapshot.ego.speed, left, top, limits):
            others.append((ahead, one.user))
    user = min(found, key=itemgetter(0), default=(0.0, None))[1]
    asked = max(others, key=itemgetter(0), default=(0.0, None))[1]
    slot = "" if user is None or user.speed < STANDING_SPEED else user.id
    return slot, "" if asked is None else asked.id


def _can_let_in(
    one: Neighbour, ahead: float, own: float, left: float, top: float, limits: VehicleLimits
) -> bool:
    """Whether somebody who falls back to `ahead` m (negative) of the ego leaves it a gap there, or one that drives on the
    `left` m at `top` speed; one that stands does not back up."""
    his = one.user.speed
    if his < CREEPING_SPEED and not leaves_gap(one, own, limits, 1.0):
        return False
    way = max(left, 0.0) * max(1.0 - his / max(top, CREEPING_SPEED), 0.0) if own >= CREEPING_SPEED else 0.0
    return leaves_gap(one._replace(ahead=ahead - way), his, limits, 1.0)


def _asking(user_id: str, lane_id: str) -> Decision | None:
    """Return that somebody is asked to let the ego in on a lane (None: nobody is)."""
    if not user_id:
        return None
    return Decision(
        behaviour=Behaviour.CHANGING_LANES, reason=Reason.ASKS, region=lane_id, cause=user_id, passes=True
    )


def _gained(his: float, own: float, left: float, asks: float, limits: VehicleLimits) -> float:
    """Return the way (m) that somebody at speed `his` gains on the ego until it drives as he does: faster, he brakes as he
    is asked (m/s²), and the ego gains what speed it can on the `left` m."""
    faster = his - own
    if faster <= 0.0:
        return -faster * faster / (2.0 * limits.comfort_deceleration)
    gains = limits.acceleration_in_plan
    reached = math.sqrt(own * own + 2.0 * gains * max(left, 0.0))
    return faster * faster / (2.0 * (gains * min((reached - own) / faster, 1.0) + asks + _LEAST_RATE))


def _has_room(snapshot: Snapshot, plan: NominalPlan, change: LaneChange) -> bool:
    """Whether the lane goes on beside the other long enough to be left smoothly, here and now."""
    here = next((g for g in plan.segments if g.start <= snapshot.front < g.end), None)
    if here is None or here.lane_id.startswith(":"):
        return False
    end = change.end if here.lane_id == change.from_lane else here.end
    return end - snapshot.front > min(_least_length(snapshot.ego.speed), change.end - change.start)


def _least_length(speed: float) -> float:
    """Return how much of its lane (m) an ego at a speed (m/s) needs to leave it smoothly."""
    return max(MIN_LANE_CHANGE_LENGTH_M, _LEAST_SHARE * LANE_CHANGE_DURATION_S * speed)


def _blocker(snapshot: Snapshot, limits: VehicleLimits, urgency: float) -> str:
    """Return who leaves no gap on the other lane; empty when the gap is free."""
    for neighbour in snapshot.neighbours:
        if not leaves_gap(neighbour, snapshot.ego.speed, limits, urgency):
            return neighbour.user.id
    return ""


def leaves_gap(neighbour: Neighbour, speed: float, limits: VehicleLimits, urgency: float) -> bool:
    """Whether the one ahead need not be braked for, and the one behind need not brake hard.

    `urgency` (0..1) trades comfort for the change.
    """
    other, p = neighbour.user, limits.parameters
    least = p.lane_change_gap_m * (1.0 - 0.5 * urgency)
    if neighbour.ahead >= 0.0:
        reaction = p.lane_change_reaction_s + urgency * (p.urgent_reaction_s - p.lane_change_reaction_s)
        braking = p.follower_deceleration + urgency * (p.urgent_deceleration - p.follower_deceleration)
        closing = max(0.0, speed - other.speed)
        gap, needed = neighbour.ahead - other.body.length, least + reaction * speed + closing * closing / (2.0 * braking)
    else:
        headway = p.follower_headway_s + urgency * (p.urgent_reaction_s - p.follower_headway_s)
        braking = p.easy_stop_deceleration + urgency * (p.hard_stop_deceleration - p.easy_stop_deceleration)
        kept = FOLLOWER_STANDSTILL_GAP_M if other.speed > STANDING_SPEED else least
        gap = -neighbour.ahead - limits.length
        needed = max(least, kept, gap_for_follower(other.speed, speed, headway, braking))
    return gap > needed


def is_sought(situation: Situation) -> bool:
    """The route needs a lane beside soon, or the body will cut into it, or such a change has just begun."""
    why = situation.changing.why
    return seeks(situation.snapshot, situation.plan) or (why is not None and why.reason is Reason.MERGE_AHEAD)


def is_done(situation: Situation) -> bool:
    """No change of lanes is in reach any more."""
    return not is_sought(situation)


RULE = BehaviourRule(Behaviour.CHANGING_LANES, (is_sought,), follow_curve, (is_done,))
