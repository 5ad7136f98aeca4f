"""Who is passed: where it is, how far aside it is passed, and how far the law lets that go."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sumo_reactive.driver.geometry.curve import project_on_curve
from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.nouns.forecast import PATH_STEP_M, LaneBeside
from sumo_reactive.driver.nouns.plan import lateral_of
from sumo_reactive.driver.nouns.snapshot import PathObstacle
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import TWO_WHEELER_WIDTH_M
from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.driver.pilot.situation import Situation

HALTED_END_M = 3.0
"""Somebody who has halted is passed no nearer to an intersection than this."""

EDGE_MARGIN_M = 0.1
"""Room kept to the border of the own lane when somebody is passed within it."""

HALTED_GAP_M = 1.0
"""Gap left in front of somebody who has halted, before coming back."""

ROLLING_SPEED = 0.3
"""m/s; who rolls no faster is about to stand: he is none to overtake."""

FIND_REACH_M = 80.0
"""Who is passed is looked for on C this far around the ego."""

MOST_PASSED = 6
"""So many are passed in one go; more are a queue."""


class Passed(NamedTuple):
    """X, who is passed: rear and front on C (m), speed along C (m/s), the extent of its body left of C (m), its width.

    Several are a column: `user_ids` from its last to its first, whose speed it has.
    """

    user_ids: tuple[str, ...]
    rear: float
    front: float
    speed: float
    left: float
    right: float
    width: float
    is_halted: bool

    def gap(self, parameters: Parameters) -> float:
        """What the ego leaves in front of X before it comes back, m."""
        return HALTED_GAP_M if self.is_halted else parameters.return_gap_m + parameters.return_headway_s * self.speed

    def behind(self, other: Passed) -> Passed:
        """Return the column of this one and another before it."""
        return Passed(
            self.user_ids + other.user_ids, min(self.rear, other.rear), max(self.front, other.front), other.speed,
            max(self.left, other.left), min(self.right, other.right), max(self.width, other.width),
            self.is_halted and other.is_halted,
        )  # fmt: skip


def passed(situation: Situation, x: PathObstacle) -> Passed:
    """Return X as the manoeuvre sees it."""
    curve, user = situation.plan.curve, x.user
    s, d = project_on_curve(user.x, user.y, curve.x, curve.y, curve.step, x.end, user.body.length + 5.0)
    turned = user.heading - curve.at(s)[2]
    half = 0.5 * (user.body.width * abs(math.cos(turned)) + user.body.length * abs(math.sin(turned)))
    middle = d - 0.5 * user.body.length * math.sin(turned)
    moving = max(x.along, 0.0)
    return Passed((user.id,), x.start, max(s, x.end), moving, middle + half, middle - half, user.body.width, user.is_halted)


def lateral_for(situation: Situation, x: Passed) -> tuple[float, LaneBeside | None]:
    """Return how far to the left of C the ego must run to pass X (m; right in left-hand traffic), and the lane that it
    uses for that: None when its own is wide enough. (0, None) when there is no lane."""
    limits, outlook, p = situation.limits, situation.outlook, situation.limits.parameters
    clearance = p.two_wheeler_clearance_m if x.width < TWO_WHEELER_WIDTH_M else p.passing_clearance_m
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
    away = HALTED_END_M if x.is_halted else situation.limits.parameters.overtaking_end_m
    ends = [p.start - away for p in plan.passages if p.end > front]
    ends += [change.start for change in plan.lane_changes if change.end > front]
    ends += [stop.s for stop in plan.stops if stop.s > front]
    ends += [] if situation.stop is None or situation.stop.reason is Reason.BLOCKED else [situation.stop.s]
    ends += [] if plan.goal is None else [plan.goal]
    ends += [] if lane is None else [lane.end]
    return min(ends, default=plan.curve.length)


def find(situation: Situation, user_ids: tuple[str, ...]) -> Passed | None:
    """Return where those who are being passed are now; None when nobody sees any of them any more."""
    seen = [one for one in (_seen(situation, user_id) for user_id in user_ids) if one is not None]
    return functools.reduce(Passed.behind, seen) if seen else None


def with_next(situation: Situation, x: Passed, user_id: str) -> Passed | None:
    """Return X with somebody who drives before it and whom the ego would overtake as well; None: he is none."""
    one = next((one for one in ahead_on_lane(situation) if one.user_ids[0] == user_id), None)
    if one is None or len(x.user_ids) >= MOST_PASSED or one.rear < x.rear or user_id in x.user_ids:
        return None
    road = situation.plan.road_speed(situation.snapshot.s)
    return x.behind(one) if is_slow(one.speed, road, situation.limits.parameters) else None


def is_in_queue(situation: Situation, x: Passed) -> bool:
    """Whether somebody who moves is slow only because those before it are: one behind the other up to somebody who has
    halted, farther than the ego sees them, or more than are passed in one go."""
    p, last, number = situation.limits.parameters, x, 1
    slow = p.slow_share * situation.plan.road_speed(situation.snapshot.s)
    before = (one for one in ahead_on_lane(situation) if one.rear >= x.front)
    for one in sorted(before, key=lambda one: one.rear):
        if one.rear - last.front > follows_within(last.speed, p) or one.speed > slow:
            return False
        if one.speed <= ROLLING_SPEED:
            return True
        last, number = one, number + 1
    return number > MOST_PASSED or last.front + follows_within(last.speed, p) > situation.snapshot.front + FIND_REACH_M


def follows_within(speed: float, parameters: Parameters) -> float:
    """Return how near behind the next one somebody of this `speed` (m/s) follows it, m."""
    return parameters.following_m + parameters.following_s * speed


def is_slow(speed: float, road: float, parameters: Parameters) -> bool:
    """Whether somebody drives so slowly (m/s), on a road for `road` (m/s), that he is worth overtaking."""
    return ROLLING_SPEED < speed < min(parameters.slow_share * road, road - parameters.slower_by)


def _seen(situation: Situation, user_id: str) -> Passed | None:
    """Return where the forecast has somebody now; None: it does not know him."""
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
    across = lateral if abs(d + off - lateral) < 0.5 * situation.outlook.lane_width else d + off  # exact on the ego's lane
    if abs(across) > situation.outlook.lane_width:  # he has left the ego's lane
        return None
    left, right = across + 0.5 * width, across - 0.5 * width
    return Passed((user_id,), s - length, s, speed, left, right, width, speed < STANDING_SPEED)


def ahead_on_lane(situation: Situation) -> Iterator[Passed]:
    """Yield who drives ahead, near, on the lane of C, though C may lead beside it."""
    forecast, snapshot, limits = situation.outlook.forecast, situation.snapshot, situation.limits
    pose, half = snapshot.ego.pose, 0.5 * limits.width + limits.parameters.corridor_margin_m
    x, y, heading = forecast.points[forecast.first].T
    along = (x - pose.x) * math.cos(pose.heading) + (y - pose.y) * math.sin(pose.heading)
    near = (np.cos(heading - pose.heading) > 0.0) & (along > -PATH_STEP_M) & (along < FIND_REACH_M)
    for user_id in dict.fromkeys(forecast.user_ids[k] for k in np.flatnonzero(near).tolist()):
        one = _seen(situation, user_id)
        if one is not None and one.rear > snapshot.front and one.left > -half and one.right < half:
            yield one


def is_clear_of(situation: Situation, x: Passed) -> bool:
    """Whether the ego may come back in front of X: its rear is a gap and a headway ahead."""
    rear = situation.snapshot.front - situation.limits.length
    return rear >= x.front + x.gap(situation.limits.parameters)


def lane_in_use(situation: Situation, lateral: float) -> LaneBeside | None:
    """Return the lane that a way `lateral` m beside C uses; None when the own one is wide enough."""
    outlook = situation.outlook
    if abs(lateral) <= 0.5 * (outlook.lane_width - situation.limits.width):
        return None
    return outlook.beside[0] if outlook.beside else None
