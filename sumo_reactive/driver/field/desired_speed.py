"""v_d, the desired speed: the least that road, time constraints and leaders leave (F&L 1991, §3.3.3).

The formulas are kernels over the rows of `demands`; what follows them asks one of them alone.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.field.command_grid import gentlest_brake
from sumo_reactive.driver.field.demands import (
    HIS_BRAKING,
    IS_BEHIND,
    IS_CERTAIN,
    IS_ON_SCHEDULE,
    PLACE,
    SPEED,
    TIME,
    Manner,
    bend_window,
    bends_of,
    hard_ones,
    hard_rows,
    manner_in,
    manner_of,
    slot_rows,
    speed_rows,
    timed_rows,
)
from sumo_reactive.driver.field.velocity import carried_out, cruise_speed, rolling_speed
from sumo_reactive.driver.geometry.polyline import Floats, wrapped
from sumo_reactive.driver.nouns.completed_plan import CompletedPlan
from sumo_reactive.driver.nouns.record import BEND, STOP_PLACE
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.safe_speed import (
    HARD_STOP_MARGIN_M,
    SAFE_GAP_M,
    following_speed,
    stopping_speed,
)

ROLLING_APPROACH_S = 3.0
"""Time constant with which the ego slows down for a gap that is foreseen to open."""

SPEED_SLACK = 0.5
"""m/s above the road's speed that comfortable braking takes back…"""

EXCESS_GAIN = 2.0
"""…beyond it the ego brakes harder by this much per m/s (1/s)."""

BRAKING_SHARE = 0.8
"""Share of the way to the hard margin within which a late stop is planned, where the comfortable margin is used up."""

BEND_SHARE = 0.9
"""Share of the largest lateral acceleration that a bend may take which comes too soon for the comfortable one."""

BEND_ENTRY_S = 0.5
"""s; what a bend asks for nearer than this is braked for harder than planned only if the car would be carried off C…"""

BEND_ROOM_M = 0.7
"""…by more than this: a car of 1.8 m in the middle of a lane of 3.2 m leaves it."""

HARDER_BY = 1e-3
"""m/s²; rounding."""

SLIGHTLY_M = (0.1, 0.03)
"""Carried off C this much farther is not worth an emergency; what an emergency goes on for."""

NO_HAZARD, OF_BEND = -1, -2
"""What stands for the hazard, in place of the number of a hard constraint."""


class Wish(NamedTuple):
    """v_d (m/s); whether braking for it must not wait for the comfortable jerk (`is_pressing`); what planned braking would
    not stop clear of (`hazard`, empty: nothing)."""

    speed: float
    is_pressing: bool = False
    hazard: str = ""


class OnCurve(NamedTuple):
    """The ego at `time` (s): front axle at `s` of C, `d` m to its left, front bumper at `front` m; `heading` and steering
    `angle` (rad), `speed` (m/s) and the `acceleration` (m/s²) commanded last."""

    time: float
    s: float
    d: float
    front: float
    heading: float
    speed: float
    angle: float
    acceleration: float


@kernel
def wished(
    ego: OnCurve, manner: Manner, period: float, hard: Floats, timed: Floats, speeds: Floats, slots: Floats,
    ch: Floats, curvature: Floats, bends: Floats, limits_along: Floats, times: Floats, step: float,
) -> tuple[float, bool, int]:  # fmt: skip
    """Return v_d (m/s), whether braking for it must not wait, and the number of the row in `hard` that planned braking would
    not stop clear of (NO_HAZARD: none, OF_BEND: the bend).

    It falls with the comfortable deceleration, with up to the planned one where a stop or a leader presses, and only where
    that would not stop clear, harder. `hard`, `timed`, `speeds` (n, 7): see `demands`; `slots` (n, 2): gap (m) to whom the
    ego falls in behind, his speed (m/s). C: its heading `ch` (rad), `curvature` (1/m), `bends` (1/m), the speed limit (m/s)
    and the time on schedule (s) every `step` m.
    """
    speed, comfort = ego.speed, manner.comfort
    rate, is_pressing, is_emergency = _easing(ego, manner, ch, curvature, bends, limits_along, step)
    free = _cruise(ego, manner, period, timed, speeds, limits_along, times, step)
    eased = speed - rate * period  # carried off C, it must be slower than C asks for, to come back to it
    wish, hazard = eased if is_emergency else max(free, eased), OF_BEND if is_emergency else NO_HAZARD
    for k in range(len(hard)):
        row = hard[k]
        if row[IS_BEHIND] > 0.0:
            away, final = row[PLACE] - ego.front - manner.gap, row[SPEED]
            asked = following_speed(away, final, comfort, manner.headway)
        else:
            away, final = row[PLACE] - manner.line_margin - ego.front, 0.0
            asked = stopping_speed(away, comfort, period)
            if row[TIME] < np.inf and manner.has_times > 0.0:
                asked = min(asked, _gently(speed, _rolling(row, ego, manner), period))
        if asked < wish:
            braking, presses, is_late = _braking(speed, final, away, room_before(row, ego.front, HARD_STOP_MARGIN_M), manner)
            reached = max(asked, speed - braking * period)
            if reached < wish:
                wish, is_pressing, hazard = reached, presses or is_pressing, k if is_late else hazard
    for k in range(len(slots)):
        wish = min(wish, max(_falling_in(slots[k, 0], slots[k, 1], comfort, manner.slot_headway), speed - comfort * period))
    return wish if wish >= 0.0 else 0.0, is_pressing, hazard


@kernel
def _falling_in(gap: float, leader_speed: float, comfort: float, headway: float) -> float:
    """Return the speed (m/s) with which to fall in behind who is beside, whose rear is `gap` m ahead (negative:
    abreast): slower than he by as much as is regained, with half of `comfort` (m/s²), on the way that is still missing.
    """
    missing = headway * leader_speed - gap
    if missing <= 0.0:
        return following_speed(gap, leader_speed, comfort, headway)
    return max(leader_speed - math.sqrt(comfort * missing), 0.0)


@kernel
def _rolling(row: Floats, ego: OnCurve, manner: Manner) -> float:
    """Return the speed (m/s) to fall to so as to be at a place in its time (infinite: it need not fall). For one only
    foreseen the ego slows down when it is near."""
    left, away = row[TIME] - ego.time, row[PLACE] - manner.line_margin - ego.front
    if row[IS_CERTAIN] > 0.0:
        return rolling_speed(ego.speed, away, left, ROLLING_APPROACH_S, manner.comfort)
    if away * 2.0 * manner.rolling_share * manner.comfort >= ego.speed * ego.speed:
        return np.inf
    return cruise_speed(ego.speed, row[PLACE] - ego.front, left, np.inf, manner.most)


@kernel
def _braking(speed: float, final: float, away: float, room: float, manner: Manner) -> tuple[float, bool, bool]:
    """Return how hard (m/s²) to brake from `speed` to `final` (m/s) within `away` m, of which a margin may go that leaves
    `room`; whether that must not wait, and whether milder, planned braking would not stop clear.

    The planned braking is enough as long as it stays within `room`; it presses where its gentle onset would not.
    """
    planned = manner.planned
    needed = _needed(speed, final, max(away, BRAKING_SHARE * room), manner)
    is_late = needed > planned and _needed(speed, final, room, manner) > planned + HARDER_BY
    if is_late and manner.has_room > 0.0:
        return needed, True, True
    onset = (speed - final) * planned / (2.0 * manner.jerk)
    is_pressing = speed * speed - final * final > 2.0 * planned * max(room - onset, 0.0) and speed > final
    return min(manner.comfort + manner.pressing_gain * max(needed - manner.comfort, 0.0), planned), is_pressing, False


@kernel
def _needed(speed: float, final: float, distance: float, manner: Manner) -> float:
    """Deceleration (m/s²) that reaches `final` speed within `distance` m, at most the emergency's."""
    if speed <= final:
        return 0.0
    return min((speed * speed - final * final) / (2.0 * max(distance, 0.1)), manner.emergency)


@kernel
def _easing(
    ego: OnCurve, manner: Manner, ch: Floats, curvature: Floats, bends: Floats, limits_along: Floats, step: float
) -> tuple[float, bool, bool]:
    """Return the braking (m/s²) towards the road's speed: comfortable, harder where the ego is too fast for it, an emergency
    where planned braking would not hold the bend ahead or the one that it is in; and whether it is that, twice."""
    speed, planned = ego.speed, manner.planned
    road = limits_along[min(max(int(ego.s / step), 0), len(limits_along) - 1)]
    if abs(ego.d) > BEND_ROOM_M or speed * speed * manner.eases > road * road * planned:
        ahead = _braking_for_bend(ego, manner, len(curvature), bends, step)
        needed = _braking_in_bend(ego, manner, ch, curvature, step, max(ahead, planned))
        if needed > planned:
            return needed, True, True
    return min(manner.comfort + EXCESS_GAIN * max(speed - road - SPEED_SLACK, 0.0), planned), False, False


@kernel
def _braking_for_bend(ego: OnCurve, manner: Manner, n: int, bends: Floats, step: float) -> float:
    """Return the deceleration (m/s²) that the tightest bend within the planned way to stop needs; C has `n` samples."""
    speed, window = ego.speed, bend_window(step)
    near = max(BEND_ENTRY_S * speed, step)
    first = int((ego.s + near) / step)
    reach = int(speed * speed / (2.0 * manner.planned) / step) + window
    if min(first + reach + 1, n) - first <= window:
        return 0.0
    lateral, most = BEND_SHARE * manner.lateral, 0.0
    for k in range(first, min(first + reach + 2 - window, len(bends))):
        way = near + step * (k - first)
        most = max(most, (speed * speed - lateral / max(bends[k], 1e-6)) / (2.0 * way))
    return min(most, manner.emergency)


@kernel
def _braking_in_bend(ego: OnCurve, manner: Manner, ch: Floats, curvature: Floats, step: float, least: float) -> float:
    """Return the deceleration (m/s²), `least` or harder, with which the ego is carried off C no farther than BEND_ROOM_M or
    than it is; the emergency's where none is enough."""
    u = min(max(ego.s / step, 0.0), len(ch) - 1.0)
    i = min(int(u), len(ch) - 2)
    error = wrapped(ego.heading + ego.angle - (ch[i] + (u - i) * (ch[i + 1] - ch[i])))
    lateral, is_braking = BEND_SHARE * manner.lateral, ego.acceleration < -manner.planned - HARDER_BY
    held = max(BEND_ROOM_M, abs(ego.d) + (SLIGHTLY_M[1] if is_braking else SLIGHTLY_M[0]))
    for rate in (least, 0.5 * (least + manner.emergency)):
        if carried_out(curvature, step, ego.s, ego.d, error, ego.speed, rate, lateral) <= held:
            return rate
    return manner.emergency


@kernel
def _cruise(
    ego: OnCurve, manner: Manner, period: float, timed: Floats, speeds: Floats, limits_along: Floats, times: Floats,
    step: float,
) -> float:  # fmt: skip
    """The speed that road and time constraint ask for, approached gently from below (m/s); of the schedule the next (l, t_l)
    ahead counts.

    Who is too early for it takes as much longer all along the way to l as he has longer for it: the road may be slow before
    l, which the mean speed does not tell.
    """
    speed = ego.speed
    sample = int((ego.s + speed * period) / step) + 1
    road = best = limits_along[min(max(sample, 0), len(limits_along) - 1)]
    for k in range(len(speeds)):
        if speeds[k, PLACE] <= ego.front:
            best = min(best, speeds[k, SPEED])
    is_first = True
    for k in range(len(timed)):
        row = timed[k]
        is_on_schedule = row[IS_ON_SCHEDULE] > 0.0
        if manner.has_times > 0.0 and row[PLACE] > ego.front and (is_first or not is_on_schedule):
            left = row[TIME] - ego.time - (manner.tolerance if is_on_schedule else 0.0)
            timely = cruise_speed(speed, row[PLACE] - ego.front, left, road, manner.gains)
            if is_on_schedule:
                planned = _time_at(ego.s + row[PLACE] - ego.front, times, step) - _time_at(ego.s, times, step)
                best = min(best, max(timely, road * min(planned / max(left, 1e-3), 1.0)))
            else:
                best = min(best, _gently(speed, timely, period))
        is_first = is_first and row[PLACE] <= ego.front
    return float(speed + (best - speed) * min(1.0, period / manner.approach) if best > speed else best)


@kernel
def _time_at(s: float, times: Floats, step: float) -> float:
    """Return when the front axle is at arc length `s` (m) on schedule, s."""
    u = min(max(s / step, 0.0), len(times) - 1.0)
    i = min(int(u), len(times) - 2)
    return float(times[i] + (u - i) * (times[i + 1] - times[i]))


@kernel
def _gently(speed: float, wanted: float, period: float) -> float:
    """Return a speed (m/s) on the way from the present one to a lower `wanted` one: a forecast is not worth a jerk."""
    return wanted if wanted >= speed else speed + (wanted - speed) * min(1.0, period / ROLLING_APPROACH_S)


@kernel
def without_jerk(wish: float, is_pressing: bool, ego: OnCurve, period: float, jerk: float) -> float:
    """Bound the fall of v_d, the `wish`, by the comfortable `jerk` (m/s³) as long as nothing presses (m/s)."""
    return wish if is_pressing else max(wish, ego.speed + gentlest_brake(ego.acceleration, period, jerk) * period)


@kernel
def room_left(hard: Floats, front: float, margin: float) -> float:
    """Way (m) in which the hardest braking must stop the front bumper: `margin` m before line or region, behind leaders."""
    room = np.inf
    for k in range(len(hard)):
        row = hard[k]
        braking = row[SPEED] * row[SPEED] / (2.0 * row[HIS_BRAKING]) if row[IS_BEHIND] > 0.0 else 0.0
        room = min(room, room_before(row, front, margin) + braking)
    return room


@kernel
def room_before(row: Floats, front: float, margin: float) -> float:
    """Way (m) to `margin` before a place, or to the least gap behind a leader, of which half may go where it is narrow
    already."""
    gap = row[PLACE] - front
    return float(max(gap - SAFE_GAP_M, 0.5 * gap) if row[IS_BEHIND] > 0.0 else gap - margin)


def on_curve(snapshot: Snapshot) -> OnCurve:
    """Return the ego of a snapshot."""
    pose, speed, angle, acceleration = snapshot.ego
    numbers = snapshot.time, snapshot.s, snapshot.d, snapshot.front, pose.heading, speed, angle, acceleration
    return OnCurve(*map(float, numbers))


def desired_speed(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, period: float) -> Wish:
    """v_d: the least speed that the time constraint, the road ahead, the stop and every leader leave; see `wished`."""
    plan, curve = completed.plan, completed.plan.curve
    speed, is_pressing, hazard = wished(
        on_curve(snapshot), manner_in(manner_of(completed, limits)), period, hard_rows(snapshot, completed),
        timed_rows(completed), speed_rows(completed), slot_rows(snapshot, completed, limits), curve.heading, curve.curvature,
        bends_of(plan), plan.speed_limits, plan.times, curve.step,
    )  # fmt: skip
    return Wish(speed, is_pressing, hazard_named(hazard, snapshot, completed))


def hazard_named(number: int, snapshot: Snapshot, completed: CompletedPlan) -> str:
    """Return what a number of `wished` stands for: a leader's id, one of the names of hazards, or nothing."""
    if number < 0:
        return BEND if number == OF_BEND else ""
    return hard_ones(snapshot, completed)[number].behind or STOP_PLACE


def room_to_brake(snapshot: Snapshot, completed: CompletedPlan, margin: float = HARD_STOP_MARGIN_M) -> float:
    """Way (m) in which the hardest braking must stop the front bumper; see `room_left`."""
    if not snapshot.parameters.has(Mechanism.ROOM_TO_STOP):
        return math.inf
    return room_left(hard_rows(snapshot, completed), float(snapshot.front), margin)
