"""Passing somebody: where the law allows it, how far aside, and the proof by simulation that it meets nobody."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.geometry.curve import project_on_curve
from sumo_reactive.geometry.polyline import moved_aside
from sumo_reactive.messages.decision import Reason
from sumo_reactive.messages.forecast import LaneBeside
from sumo_reactive.messages.plan import Aside, NominalPlan, lateral_of
from sumo_reactive.messages.snapshot import PathObstacle
from sumo_reactive.parameters import (
    ASSESSMENT_STEP_S,
    CORRIDOR_MARGIN_M,
    EDGE_MARGIN_M,
    HALTED_END_M,
    HALTED_GAP_M,
    MERGE_MARGIN_S,
    OVERTAKING_END_M,
    OVERTAKING_MARGIN_S,
    OVERTAKING_S,
    PASSING_CLEARANCE_M,
    PATH_STEP_M,
    PROOF_ROOM_M,
    RETURN_GAP_M,
    RETURN_HEADWAY_S,
    SLOWER_BY,
    STANDING_SPEED,
    TWO_WHEELER_CLEARANCE_M,
    TWO_WHEELER_WIDTH_M,
)
from sumo_reactive.pilot.assessment import Way, first_contact, followed, leader_table, simulate
from sumo_reactive.pilot.situation import Proof, Situation
from sumo_reactive.vehicle.limits import VehicleLimits
from sumo_reactive.vehicle.side_step import side_step_length

Array = NDArray[np.float64]

LANE_WIDTH_M = 3.2
"""SUMO's usual lane; sets only how long a move aside takes."""


FIND_REACH_M = 80.0
"""Who is passed is looked for on C this far around the ego."""


_SHARES = np.linspace(0.0, 1.0, 101)
_QUINTIC = _SHARES**3 * (10.0 - 15.0 * _SHARES + 6.0 * _SHARES**2)
"""How much of a move aside is made after each share of its length."""


class Margin(NamedTuple):
    """What a manoeuvre leaves to the others: they may be this much earlier than foreseen, or half of it later (s), when they
    come towards the ego, or drive its way; `room` (m) is left around the ego's body."""

    oncoming: float
    same_way: float
    room: float


BEFORE = Margin(OVERTAKING_MARGIN_S, MERGE_MARGIN_S, PROOF_ROOM_M)
"""Asked for before the ego pulls out."""

UNDER_WAY = Margin(0.6 * OVERTAKING_MARGIN_S, 0.3 * MERGE_MARGIN_S, 0.0)
"""Asked for while it passes: less, so that a small error does not call it back."""


class Passed(NamedTuple):
    """X, who is passed: rear and front on C (m), speed along C (m/s), the extent of its body left of C (m), its width."""

    user_id: str
    rear: float
    front: float
    speed: float
    left: float
    right: float
    width: float
    is_halted: bool

    @property
    def gap(self) -> float:
        """What the ego leaves in front of X before it comes back, m."""
        return HALTED_GAP_M if self.is_halted else RETURN_GAP_M + RETURN_HEADWAY_S * self.speed


def passed(situation: Situation, x: PathObstacle) -> Passed:
    """Return X as the manoeuvre sees it."""
    curve, user = situation.plan.curve, x.user
    s, d = project_on_curve(user.x, user.y, curve.x, curve.y, curve.step, x.end, user.body.length + 5.0)
    turned = user.heading - curve.at(s)[2]
    half = 0.5 * (user.body.width * abs(math.cos(turned)) + user.body.length * abs(math.sin(turned)))
    middle = d - 0.5 * user.body.length * math.sin(turned)
    moving = max(x.along, 0.0)
    return Passed(user.id, x.start, max(s, x.end), moving, middle + half, middle - half, user.body.width, user.is_halted)


def lateral_for(situation: Situation, x: Passed) -> tuple[float, LaneBeside | None]:
    """Return how far to the left of C the ego must run to pass X (m; right in left-hand traffic), and the lane that it
    uses for that: None when its own is wide enough. (0, None) when there is no lane."""
    limits, outlook = situation.limits, situation.outlook
    clearance = TWO_WHEELER_CLEARANCE_M if x.width < TWO_WHEELER_WIDTH_M else PASSING_CLEARANCE_M
    beside = outlook.beside[0] if outlook.beside and outlook.beside[0].start <= situation.snapshot.front else None
    side = -1.0 if beside is not None and beside.lateral < 0.0 else 1.0
    needed = (x.left if side > 0.0 else -x.right) + clearance + 0.5 * limits.width
    if needed <= 0.5 * (outlook.lane_width - limits.width) - EDGE_MARGIN_M:
        return side * max(needed, 0.0), None
    if beside is None:
        return 0.0, None
    away = abs(beside.lateral)
    if not beside.is_oncoming:
        return (side * away, beside) if needed <= away + 0.5 * (beside.width - limits.width) else (0.0, None)
    return (side * needed, beside) if needed <= away + 0.5 * (beside.width - limits.width) else (0.0, None)


def legal_end(situation: Situation, x: Passed, lane: LaneBeside | None) -> float:
    """Return where the ego must be back on C at the latest, m of C.

    No overtaking near an intersection or rail crossing, past the end of the lane that it uses, of the route, or of the
    way to a lane change or a stop.
    """
    plan, front = situation.plan, situation.snapshot.front
    away = HALTED_END_M if x.is_halted else OVERTAKING_END_M
    ends = [p.start - away for p in plan.passages if p.end > front]
    ends += [change.start for change in plan.lane_changes if change.end > front]
    ends += [stop.s for stop in plan.stops if stop.s > front]
    ends += [] if situation.stop is None or situation.stop.reason is Reason.BLOCKED else [situation.stop.s]
    ends += [] if plan.goal is None else [plan.goal]
    ends += [] if lane is None else [lane.end]
    return min(ends, default=plan.curve.length)


def proof(situation: Situation, x: PathObstacle) -> Proof:
    """Simulate pulling out, passing X and coming back; the others keep their behaviour (F&L 1991, §2)."""
    target = passed(situation, x)
    lateral, lane = lateral_for(situation, target)
    if lateral == 0.0:
        return Proof(None, "no lane to pass on")
    return prove(situation, target, lateral, lane, legal_end(situation, target, lane))


def prove(
    situation: Situation, x: Passed, lateral: float, lane: LaneBeside | None, end: float, margin: Margin = BEFORE
) -> Proof:
    """Return the proof for passing X `lateral` m beside C, on `lane` (None: the own one), back by `end` (m of C).

    `margin`: what it must leave to the others.
    """
    snapshot, plan, limits = situation.snapshot, situation.plan, situation.limits
    way = _way_out(situation, x, lateral)
    trace = simulate(snapshot, way, None, _leaders(situation, x, lateral), limits, OVERTAKING_S, headway=0.6)
    fronts = x.front + x.speed * ASSESSMENT_STEP_S * np.arange(len(trace))
    rear = trace[:, 4] + limits.front_overhang - limits.length
    clear = rear >= fronts + x.gap
    if not clear.any():
        return Proof(None, "no room to swing out" if x.is_halted else f"{x.user_id} is too fast to pass")
    at = int(np.argmax(clear))
    back = float(trace[at, 4])
    until = back + _way_back(lateral, float(trace[at, 3]), end - limits.front_overhang - back, limits)
    if until + limits.front_overhang > end:
        return Proof(None, "the road ahead is too short")
    aside = Aside(x.user_id, lateral, back, until)
    last = int(np.argmax(trace[:, 4] >= until)) if trace[-1, 4] >= until else len(trace) - 1
    duration = (last + 1) * ASSESSMENT_STEP_S
    if lane is not None and lane.is_oncoming and not _is_in_sight(situation, lane, until, duration):
        return Proof(None, "the oncoming lane is not in sight far enough")
    full = _displaced(way, lateral_of(aside, plan.curve.step * np.arange(len(way.x))) - lateral, back)
    trace = simulate(snapshot, full, None, _leaders(situation, x, lateral), limits, duration, headway=0.6)
    return _meeting(situation, trace, x, aside, duration, margin)


def _way_back(lateral: float, speed: float, room: float, limits: VehicleLimits) -> float:
    """Return the length of the return, m: comfortable, or as short as `room` (m) asks; C then slows the ego down."""
    comfortable, shortest = (side_step_length(abs(lateral), 0.0, v, LANE_WIDTH_M, limits) for v in (speed, 0.0))
    return min(comfortable, max(shortest, room))


def _way_out(situation: Situation, x: Passed, lateral: float) -> Way:
    """Return the way aside without an end: along C as far as it already leads aside, else moved out from here."""
    plan, snapshot, limits = situation.plan, situation.snapshot, situation.limits
    reach = OVERTAKING_S * (max(snapshot.ego.speed, plan.road_speed(snapshot.s)) + SLOWER_BY)
    whole, samples = _along(plan, snapshot.s + reach)
    if plan.aside is not None:
        return _displaced(whole, lateral - lateral_of(plan.aside, samples), plan.aside.back)
    out = side_step_length(abs(lateral), 0.0, snapshot.ego.speed, LANE_WIDTH_M, limits)
    t = np.clip((samples - snapshot.s) / out, 0.0, 1.0)
    return _displaced(whole, lateral * t**3 * (10.0 - 15.0 * t + 6.0 * t**2), snapshot.s)


def _along(plan: NominalPlan, end: float) -> tuple[Way, Array]:
    """Return C up to arc length `end` (m), and the arc length of each sample (n,)."""
    curve = plan.curve
    n = min(len(curve.x), int(end / curve.step) + 2)
    samples = np.linspace(0.0, curve.step * (n - 1), n, dtype=np.float64)
    return Way(curve.x[:n], curve.y[:n], curve.heading[:n], plan.speed_limits[:n], curve.step), samples


def _displaced(way: Way, lateral: Array, start: float) -> Way:
    """Return `way` moved to its left by `lateral` (n,), m, from arc length `start` on."""
    first = max(int(start / way.step) - 1, 0)
    line = moved_aside(np.column_stack([way.x, way.y])[first:], lateral[first:])
    along = np.gradient(line, axis=0)
    heading = way.heading.copy()
    turned = np.arctan2(along[:, 1], along[:, 0])
    heading[first:] += np.remainder(turned - heading[first:] + math.pi, 2.0 * math.pi) - math.pi
    x, y = way.x.copy(), way.y.copy()
    x[first:], y[first:] = line[:, 0], line[:, 1]
    return way._replace(x=x, y=y, heading=heading)


def _leaders(situation: Situation, x: Passed, lateral: float) -> Array:
    """Return the leaders for the simulation: X until the way past it leads aside, the others for ever."""
    snapshot, plan, limits = situation.snapshot, situation.plan, situation.limits
    out = side_step_length(abs(lateral), 0.0, snapshot.ego.speed, LANE_WIDTH_M, limits)
    needed = (x.left if lateral > 0.0 else -x.right) + 0.5 * limits.width + CORRIDOR_MARGIN_M
    share = float(np.interp(needed / abs(lateral), _QUINTIC, _SHARES))
    beside = snapshot.s + share * out if plan.aside is None else share * plan.joins
    table = leader_table(snapshot)
    is_x = [obstacle.user.id == x.user_id for obstacle in followed(snapshot)]
    table[is_x, 2] = beside
    return table


def _is_in_sight(situation: Situation, lane: LaneBeside, until: float, duration: float) -> bool:
    """Whether somebody who comes into sight now on the oncoming lane, at its speed limit, is met only after the return."""
    sight = situation.snapshot.front + situation.outlook.sight
    return sight - lane.speed_limit * (duration + BEFORE.oncoming) > until


def _meeting(situation: Situation, trace: Array, x: Passed, aside: Aside, duration: float, margin: Margin) -> Proof:
    """Return the proof, after a look at everybody: where foreseen, earlier by the margin, later by half of it."""
    forecast, limits, room = situation.outlook.forecast, situation.limits, margin.room
    speeds, oncoming = _speeds(situation)
    early = np.where(oncoming, margin.oncoming, margin.same_way)
    early[[user_id == x.user_id for user_id in forecast.user_ids]] = 0.0
    for share in (0.0, -0.5, 1.0):
        leads = share * early
        k, _ = first_contact(
            trace, limits.length + 2.0 * room, limits.width + 2.0 * room, forecast.points, forecast.first, forecast.counts,
            forecast.bodies, speeds, leads, ASSESSMENT_STEP_S, PATH_STEP_M,
        )  # fmt: skip
        if k >= 0:
            return Proof(None, forecast.user_ids[k], duration, only_margin=share != 0.0)
    return Proof(aside, "", duration)


def _speeds(situation: Situation) -> tuple[Array, NDArray[np.bool_]]:
    """Return the speed of each path, m/s (NaN: its user need not be looked at), and which come towards the ego.

    Oncoming traffic that moves is taken at its lane's limit if it is slower; who follows on the ego's own lane brakes.
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
    faster = np.maximum(speeds, forecast.bodies[:, 5])
    speeds = np.where(oncoming & (speeds > STANDING_SPEED), faster, speeds)
    follows = (ahead < limits.front_to_rear_axle - 0.5 * limits.length) & (along > 0.5)
    speeds[follows & (np.abs(beside) < 0.5 * limits.width + 0.5)] = np.nan
    return speeds, oncoming


def in_the_way_back(situation: Situation, way: Aside) -> str:
    """Return whom the ego would meet if it came back from `way` now; empty: nobody."""
    snapshot, plan, limits = situation.snapshot, situation.plan, situation.limits
    length = side_step_length(abs(way.lateral), 0.0, snapshot.ego.speed, LANE_WIDTH_M, limits)
    now = Aside(way.user_id, way.lateral, snapshot.s, snapshot.s + length)
    whole, samples = _along(plan, now.until + FIND_REACH_M)
    returning = _displaced(whole, lateral_of(now, samples) - lateral_of(way, samples), now.back)
    duration = length / max(snapshot.ego.speed, 2.0) + 2.0
    trace = simulate(snapshot, returning, None, leader_table(snapshot), limits, duration)
    x = Passed(way.user_id, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, False)
    found = _meeting(situation, trace, x, now, duration, Margin(0.0, 0.0, PROOF_ROOM_M))
    return "" if found.aside is not None else found.obstacle


def find(situation: Situation, user_id: str) -> Passed | None:
    """Return where somebody who is being passed is now; None when nobody sees him any more."""
    forecast, curve = situation.outlook.forecast, situation.plan.curve
    if user_id not in forecast.user_ids:
        return None
    k = forecast.user_ids.index(user_id)
    along, lateral, speed, length, width, _ = forecast.bodies[k].tolist()
    x, y, heading = forecast.points[forecast.first[k]].tolist()
    c, w = math.cos(heading), math.sin(heading)
    x, y = x + along * c - lateral * w, y + along * w + lateral * c
    s, d = project_on_curve(x, y, curve.x, curve.y, curve.step, situation.snapshot.s, FIND_REACH_M)
    aside = situation.plan.aside
    off = 0.0 if aside is None else float(lateral_of(aside, np.array([s]))[0])
    return Passed(user_id, s - length, s, speed, d + off + 0.5 * width, d + off - 0.5 * width, width, speed < STANDING_SPEED)


def is_clear_of(situation: Situation, x: Passed) -> bool:
    """Whether the ego may come back in front of X: its rear is a gap and a headway ahead."""
    rear = situation.snapshot.front - situation.limits.length
    return rear >= x.front + x.gap


def lane_in_use(situation: Situation, lateral: float) -> LaneBeside | None:
    """Return the lane that a way `lateral` m beside C uses; None when the own one is wide enough."""
    outlook = situation.outlook
    if abs(lateral) <= 0.5 * (outlook.lane_width - situation.limits.width):
        return None
    return outlook.beside[0] if outlook.beside else None
