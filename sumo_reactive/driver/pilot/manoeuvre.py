"""The proof by simulation that a way past somebody, out and back, meets nobody (F&L 1991, §2)."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import Floats, eased, moved_aside
from sumo_reactive.driver.nouns.forecast import PATH_STEP_M, LaneBeside
from sumo_reactive.driver.nouns.plan import Aside, NominalPlan, lateral_of
from sumo_reactive.driver.nouns.snapshot import PathObstacle
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.driver.pilot.assessment import ASSESSMENT_STEP_S, Way, first_contact, followed, leader_table, simulate
from sumo_reactive.driver.pilot.instructions import PASSING_HEADWAY
from sumo_reactive.driver.pilot.passed import (
    FIND_REACH_M,
    Passed,
    ahead_on_lane,
    find,
    is_in_queue,
    lane_in_use,
    lateral_for,
    legal_end,
    passed,
    with_next,
)
from sumo_reactive.driver.pilot.situation import Proof, Situation
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.travel_time import side_step_length

PROOF_ROOM_M = 0.2
"""Room around the ego's body that the proof asks for before it pulls out."""

UNDER_WAY_SHARE = 0.6
"""Share of the margins that must remain while the ego passes: a small error does not call it back."""

NEARER_BY_M = 0.1
"""Who joins those who are being passed is passed nearer than he should by no more than this."""

LANE_WIDTH_M = 3.2
"""SUMO's usual lane; sets only how long a move aside takes."""


_SHARES = np.linspace(0.0, 1.0, 101)
_MADE = eased(_SHARES)
"""How much of a move aside is made after each share of its length."""


class Margin(NamedTuple):
    """What a manoeuvre leaves to the others: they may be this much earlier than foreseen, or half of it later (s), when they
    come towards the ego, or drive its way; `room` (m) is left around the ego's body."""

    oncoming: float
    same_way: float
    room: float


def before(parameters: Parameters) -> Margin:
    """Return what is asked for before the ego pulls out."""
    return Margin(parameters.overtaking_margin_s, parameters.merge_margin_s, PROOF_ROOM_M)


def under_way(parameters: Parameters) -> Margin:
    """Return what is asked for while it passes: less, so that a small error does not call it back."""
    share = UNDER_WAY_SHARE
    return Margin(share * parameters.overtaking_margin_s, share * parameters.merge_margin_s, 0.0)


def proof(situation: Situation, x: PathObstacle) -> Proof:
    """Simulate pulling out, passing X and coming back; the others keep their behaviour (F&L 1991, §2)."""

    def tried(target: Passed) -> Proof:
        lateral, lane = lateral_for(situation, target)
        if lateral == 0.0:
            return Proof(None, "no lane to pass on")
        end = legal_end(situation, target, lane)
        return prove(situation, target, lateral, lane, end, before(situation.limits.parameters))

    target = passed(situation, x)
    if not target.is_halted and is_in_queue(situation, target):
        return Proof(None, f"{x.user.id} is in a queue")
    return _with_those_before(situation, target, tried)


def proof_under_way(situation: Situation, x: Passed, lateral: float) -> Proof:
    """Simulate the rest of a pass under way, `lateral` m beside C; whoever would need more room is none to pass so."""
    lane = lane_in_use(situation, lateral)

    def tried(target: Passed) -> Proof:
        newest = find(situation, target.user_ids[len(x.user_ids) :])
        if newest is not None and abs(lateral_for(situation, newest)[0]) > abs(lateral) + NEARER_BY_M:
            return Proof(None, "no room to swing out")
        end = legal_end(situation, target, lane)
        return prove(situation, target, lateral, lane, end, under_way(situation.limits.parameters))

    return _with_those_before(situation, x, tried)


def _with_those_before(situation: Situation, x: Passed, tried: Callable[[Passed], Proof]) -> Proof:
    """Return the proof for passing X or, if who drives slowly before it leaves no room to come back, both; if they cannot
    be passed either, why X cannot."""
    first = found = tried(x)
    while found.aside is None:
        longer = with_next(situation, x, found.obstacle)
        if longer is None:
            return first
        x, found = longer, tried(longer)
    return found


def prove(
    situation: Situation, x: Passed, lateral: float, lane: LaneBeside | None, end: float, margin: Margin
) -> Proof:
    """Return the proof for passing X `lateral` m beside C, on `lane` (None: the own one), back by `end` (m of C).

    `margin`: what it must leave to the others.
    """
    snapshot, plan, limits = situation.snapshot, situation.plan, situation.limits
    way, longest = _way_out(situation, x, lateral), limits.parameters.overtaking_s
    leaders = _leaders(situation, x, lateral)
    trace = simulate(snapshot, way, leaders, limits, longest, headway=PASSING_HEADWAY)
    fronts = x.front + x.speed * ASSESSMENT_STEP_S * np.arange(len(trace))
    rear = trace[:, 4] + limits.front_overhang - limits.length
    clear = rear >= fronts + x.gap(limits.parameters)
    if not clear.any():
        return Proof(None, "no room to swing out" if x.is_halted else _no_room_before(situation, x))
    at = int(np.argmax(clear))
    back = float(trace[at, 4])
    until = back + _way_back(lateral, float(trace[at, 3]), end - limits.front_overhang - back, limits)
    if until + limits.front_overhang > end:
        return Proof(None, "the road ahead is too short")
    aside = Aside(lateral, back, until)
    last = int(np.argmax(trace[:, 4] >= until)) if trace[-1, 4] >= until else len(trace) - 1
    duration = (last + 1) * ASSESSMENT_STEP_S
    if lane is not None and lane.is_oncoming and not _is_in_sight(situation, lane, until, duration):
        return Proof(None, "the oncoming lane is not in sight far enough")
    full = displaced(way, lateral_of(aside, plan.curve.step * np.arange(len(way.x))) - lateral, back)
    trace = simulate(snapshot, full, leaders, limits, duration, headway=PASSING_HEADWAY)
    return _meeting(situation, trace, x.user_ids, aside, margin)


def _no_room_before(situation: Situation, x: Passed) -> str:
    """Return who is next before X, and so leaves no room to come back, or that X alone is too fast."""
    before_x = [one for one in ahead_on_lane(situation) if one.rear > x.rear and one.user_ids[0] not in x.user_ids]
    return min(before_x, key=lambda one: one.rear).user_ids[0] if before_x else f"{x.user_ids[0]} is too fast to pass"


def _way_back(lateral: float, speed: float, room: float, limits: VehicleLimits) -> float:
    """Return the length of the return, m: comfortable, or as short as `room` (m) asks; C then slows the ego down."""
    comfortable, shortest = (side_step_length(abs(lateral), 0.0, v, LANE_WIDTH_M, limits) for v in (speed, 0.0))
    return min(comfortable, max(shortest, room))


def _way_out(situation: Situation, x: Passed, lateral: float) -> Way:
    """Return the way aside without an end: along C as far as it already leads aside, else moved out from here."""
    plan, snapshot, limits = situation.plan, situation.snapshot, situation.limits
    faster = max(snapshot.ego.speed, plan.road_speed(snapshot.s)) + limits.parameters.slower_by
    reach = limits.parameters.overtaking_s * faster
    whole, samples = _along(plan, snapshot.s + reach)
    if plan.aside is not None:
        return displaced(whole, lateral - lateral_of(plan.aside, samples), plan.aside.back)
    out = side_step_length(abs(lateral), 0.0, snapshot.ego.speed, LANE_WIDTH_M, limits)
    t = np.clip((samples - snapshot.s) / out, 0.0, 1.0)
    return displaced(whole, lateral * eased(t), snapshot.s)


def _along(plan: NominalPlan, end: float) -> tuple[Way, Floats]:
    """Return C up to arc length `end` (m), and the arc length of each sample (n,)."""
    curve = plan.curve
    n = min(len(curve.x), int(end / curve.step) + 2)
    samples = np.linspace(0.0, curve.step * (n - 1), n, dtype=np.float64)
    return Way(curve.x[:n], curve.y[:n], curve.heading[:n], plan.speed_limits[:n], curve.step), samples


def displaced(way: Way, lateral: Floats, start: float) -> Way:
    """Return `way` moved to its left by `lateral` (n,), m, from arc length `start` on; as it is, if it ends before."""
    first = max(int(start / way.step) - 1, 0)
    if first > len(way.x) - 2:
        return way
    line = moved_aside(np.column_stack([way.x, way.y])[first:], lateral[first:])
    along = np.gradient(line, axis=0)
    heading = way.heading.copy()
    turned = np.arctan2(along[:, 1], along[:, 0])
    heading[first:] += np.remainder(turned - heading[first:] + math.pi, 2.0 * math.pi) - math.pi
    x, y = way.x.copy(), way.y.copy()
    x[first:], y[first:] = line[:, 0], line[:, 1]
    return way._replace(x=x, y=y, heading=heading)


def _leaders(situation: Situation, x: Passed, lateral: float) -> Floats:
    """Return the leaders for the simulation: X until the way past it leads aside, the others for ever, and so those on the
    lane that C comes back to."""
    snapshot, plan, limits = situation.snapshot, situation.plan, situation.limits
    out = side_step_length(abs(lateral), 0.0, snapshot.ego.speed, LANE_WIDTH_M, limits)
    needed = (x.left if lateral > 0.0 else -x.right) + 0.5 * limits.width + limits.parameters.corridor_margin_m
    share = float(np.interp(needed / abs(lateral), _MADE, _SHARES))
    beside = snapshot.s + share * out if plan.aside is None else share * plan.joins
    table = leader_table(snapshot)
    on_path = [obstacle.user.id for obstacle in followed(snapshot)]
    table[[user_id in x.user_ids for user_id in on_path], 2] = beside
    known = {*x.user_ids, *on_path}
    more = [(one.rear, one.speed, math.inf) for one in ahead_on_lane(situation) if known.isdisjoint(one.user_ids)]
    return np.vstack([table, more]) if more else table


def _is_in_sight(situation: Situation, lane: LaneBeside, until: float, duration: float) -> bool:
    """Whether somebody who comes into sight now on the oncoming lane, at its speed limit, is met only after the return: as
    far away as the ego looks, or where the lane begins if others enter there."""
    sight = min(situation.snapshot.front + situation.outlook.sight, lane.end if lane.is_entry else math.inf)
    return sight - lane.speed_limit * (duration + before(situation.limits.parameters).oncoming) > until


def _meeting(situation: Situation, trace: Floats, passes: tuple[str, ...], aside: Aside, margin: Margin) -> Proof:
    """Return the proof, after a look at everybody: where foreseen, earlier by the margin, later by half of it; at those whom
    the ego `passes` until it comes back: from then on they follow it."""
    forecast, duration = situation.outlook.forecast, len(trace) * ASSESSMENT_STEP_S
    lane = lane_in_use(situation, aside.lateral)
    side = math.copysign(1.0, aside.lateral) if lane is not None and lane.is_oncoming else 0.0
    speeds, oncoming = _speeds(situation, side)
    is_passed = np.array([user_id in passes for user_id in forecast.user_ids], np.bool_)
    early = np.where(oncoming, margin.oncoming, margin.same_way)
    others = np.where(is_passed, np.nan, speeds)
    beside = trace[: int(np.sum(trace[:, 4] < aside.back))]
    looks = ((beside, np.where(is_passed, speeds, np.nan), 0.0), *((trace, others, share) for share in (0.0, -0.5, 1.0)))
    for part, driven, share in looks:
        k = _met(situation, part, driven, share * early, margin.room)
        if k >= 0:
            return Proof(None, forecast.user_ids[k], duration, only_margin=share != 0.0)
    return Proof(aside, "", duration, passes=passes)


def _met(situation: Situation, trace: Floats, speeds: Floats, leads: Floats, room: float) -> int:
    """Return whose path (its number) the ego meets first, -1: nobody's; see `first_contact`."""
    forecast, limits = situation.outlook.forecast, situation.limits
    k, _ = first_contact(
        trace, limits.length + 2.0 * room, limits.width + 2.0 * room, forecast.points, forecast.first, forecast.counts,
        forecast.bodies, speeds, leads, ASSESSMENT_STEP_S, PATH_STEP_M,
    )  # fmt: skip
    return int(k)


def _speeds(situation: Situation, side: float) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the speed of each path, m/s (NaN: its user need not be looked at), and which come towards the ego.

    Oncoming traffic that moves is taken at its lane's limit if it is slower, and so is who overtakes the ego on the oncoming
    lane at its `side` (1: left, -1: right, 0: it does not pull out there); who follows on the ego's own lane brakes.
    """
    forecast, pose, limits = situation.outlook.forecast, situation.snapshot.ego.pose, situation.limits
    speeds = np.array(forecast.bodies[:, 2])
    if not len(speeds):
        return speeds, np.zeros(0, np.bool_)
    at = forecast.points[forecast.first]
    dx, dy = at[:, 0] - pose.x, at[:, 1] - pose.y
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    ahead, beside = dx * c + dy * s, dy * c - dx * s + forecast.bodies[:, 1]
    along = np.cos(at[:, 2] - pose.heading)
    oncoming = along < -0.5
    follows = (ahead < limits.front_to_rear_axle - 0.5 * limits.length) & (along > 0.5)
    overtakes = follows & (beside * side > 0.5 * limits.width + 0.5)
    gains = (oncoming | overtakes) & (speeds > STANDING_SPEED)
    speeds = np.where(gains, np.maximum(speeds, forecast.bodies[:, 5]), speeds)
    speeds[follows & (np.abs(beside) < 0.5 * limits.width + 0.5)] = np.nan
    return speeds, oncoming


def in_the_way_back(situation: Situation, way: Aside) -> str:
    """Return whom the ego would meet if it came back from `way` now; empty: nobody."""
    snapshot, plan, limits = situation.snapshot, situation.plan, situation.limits
    length = side_step_length(abs(way.lateral), 0.0, snapshot.ego.speed, LANE_WIDTH_M, limits)
    now = Aside(way.lateral, snapshot.s, snapshot.s + length)
    whole, samples = _along(plan, now.until + FIND_REACH_M)
    returning = displaced(whole, lateral_of(now, samples) - lateral_of(way, samples), now.back)
    duration = length / max(snapshot.ego.speed, 2.0) + 2.0
    trace = simulate(snapshot, returning, leader_table(snapshot), limits, duration)
    found = _meeting(situation, trace, (), now, Margin(0.0, 0.0, PROOF_ROOM_M))
    return "" if found.aside is not None else found.obstacle


