"""v_d, the desired speed: the least that road, time constraints and leaders leave (F&L 1991, §3.3.3)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.field.command_grid import gentlest_brake
from sumo_reactive.driver.field.velocity import carried_out, cruise_speed, rolling_speed
from sumo_reactive.driver.geometry.polyline import wrapped
from sumo_reactive.driver.nouns.completed_plan import CompletedPlan
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Instruction, Reason
from sumo_reactive.driver.nouns.record import BEND, STOP_PLACE
from sumo_reactive.driver.nouns.snapshot import Neighbour, Snapshot
from sumo_reactive.driver.nouns.state import VehicleState
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.safe_speed import (
    CURVATURE_WINDOW_M,
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


class Wish(NamedTuple):
    """v_d (m/s); whether braking for it must not wait for the comfortable jerk (`is_pressing`); what planned braking would
    not stop clear of (`hazard`, empty: nothing)."""

    speed: float
    is_pressing: bool = False
    hazard: str = ""


class _Braking(NamedTuple):
    """A deceleration (m/s²), whether it must not wait, and whether milder, planned braking would not stop clear."""

    rate: float
    is_pressing: bool = False
    is_emergency: bool = False


def desired_speed(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, period: float) -> Wish:
    """v_d: the least speed that the time constraint, the road ahead, the stop and every leader leave.

    It falls with the comfortable deceleration, with up to the planned one where a stop or a leader presses, and only where
    that would not stop clear, harder: then it names the hazard.
    """
    speed, front, profile = snapshot.ego.speed, snapshot.front, completed.tuning.profile
    comfort = min(limits.comfort_deceleration * profile.deceleration, limits.planned_deceleration)
    easing = _easing(snapshot, completed, limits, comfort)
    free = _cruise(snapshot, completed, limits, period)
    eased = speed - easing.rate * period  # carried off C, it must be slower than C asks for, to come back to it
    wish = Wish(eased, True, BEND) if easing.is_emergency else Wish(max(free, eased), easing.is_pressing)
    headway = limits.time_headway * profile.headway
    for constraint in _hard(snapshot, completed):
        if constraint.behind:
            away, final = constraint.s - front - limits.standstill_gap, constraint.speed
            asked = following_speed(away, final, comfort, headway)
        else:
            away, final = constraint.s - snapshot.parameters.stop_line_margin_m - front, 0.0
            asked = stopping_speed(away, comfort, period)
            if constraint.time < math.inf and snapshot.parameters.has(Mechanism.TIMES):
                asked = min(asked, _gently(speed, _rolling(constraint, snapshot, limits, comfort), period))
        if asked < wish.speed:
            braking = _braking(speed, final, away, _room(constraint, front), limits, comfort)
            wish = _lower(wish, asked, speed, braking, period, constraint.behind or STOP_PLACE)
    for constraint in completed.slots:
        slot = _slot(snapshot, constraint.behind)
        if slot is not None:
            gap = slot.ahead - slot.user.body.length
            following = following_speed(gap, slot.user.speed, comfort, snapshot.parameters.slot_headway_s)
            wish = _lower(wish, following, speed, _Braking(comfort), period, "")
    return wish if wish.speed >= 0.0 else wish._replace(speed=0.0)


def _hard(snapshot: Snapshot, completed: CompletedPlan) -> Iterator[TimeConstraint]:
    """Yield the constraints that the ego can stop for: the pilot's, and the leaders, who move.

    Who stands is no leader of an ego that squeezes out of a local minimum: only that no command may touch him holds it.
    """
    yield from completed.hard
    squeezes = completed.instruction is Instruction.WIDEN
    yield from (leader for leader in snapshot.leaders if leader.speed > 0.0 or not squeezes)


def _rolling(constraint: TimeConstraint, snapshot: Snapshot, limits: VehicleLimits, comfort: float) -> float:
    """Return the speed (m/s) to fall to so as to be at a place in its time (infinite: it need not fall). For one only
    foreseen the ego slows down when it is near; `comfort`: its braking, m/s²."""
    p, speed, left = snapshot.parameters, snapshot.ego.speed, constraint.time - snapshot.time
    away = constraint.s - p.stop_line_margin_m - snapshot.front
    if constraint.is_certain:
        return rolling_speed(speed, away, left, ROLLING_APPROACH_S, comfort)
    if away * 2.0 * p.rolling_share * comfort >= speed * speed:
        return math.inf
    return cruise_speed(speed, constraint.s - snapshot.front, left, math.inf, limits.max_acceleration)


def _lower(wish: Wish, asked: float, speed: float, braking: _Braking, period: float, hazard: str) -> Wish:
    """Return `wish` lowered to the `asked` speed (m/s), as far as `braking` takes the ego's `speed` (m/s) there."""
    reached = max(asked, speed - braking.rate * period)
    if reached >= wish.speed:
        return wish
    return Wish(reached, braking.is_pressing or wish.is_pressing, hazard if braking.is_emergency else wish.hazard)


def _braking(speed: float, final: float, away: float, room: float, limits: VehicleLimits, comfort: float) -> _Braking:
    """Return how hard to brake from `speed` to `final` (m/s) within `away` m, of which a margin may go that leaves `room`.

    The planned braking is enough as long as it stays within `room`; it presses where its gentle onset would not.
    """
    planned = limits.planned_deceleration
    needed = _needed(speed, final, max(away, BRAKING_SHARE * room), limits)
    is_late = needed > planned and _needed(speed, final, room, limits) > planned + HARDER_BY
    if is_late and limits.parameters.has(Mechanism.ROOM_TO_STOP):
        return _Braking(needed, is_pressing=True, is_emergency=True)
    onset = (speed - final) * planned / (2.0 * limits.parameters.comfort_jerk)
    is_pressing = speed * speed - final * final > 2.0 * planned * max(room - onset, 0.0) and speed > final
    return _Braking(min(comfort + limits.parameters.pressing_gain * max(needed - comfort, 0.0), planned), is_pressing)


def _easing(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, comfort: float) -> _Braking:
    """Return the braking towards the road's speed: comfortable, harder where the ego is too fast for it, an emergency where
    planned braking would not hold the bend ahead or the one that it is in."""
    speed, road, planned = snapshot.ego.speed, completed.plan.road_speed(snapshot.s), limits.planned_deceleration
    is_off = abs(snapshot.d) > BEND_ROOM_M
    if is_off or speed * speed * limits.comfort_deceleration > road * road * planned:
        ahead = _braking_for_bend(snapshot, completed, limits)
        needed = _braking_in_bend(snapshot, completed, limits, max(ahead, planned))
        if needed > planned:
            return _Braking(needed, is_pressing=True, is_emergency=True)
    return _Braking(min(comfort + EXCESS_GAIN * max(speed - road - SPEED_SLACK, 0.0), planned))


def _braking_for_bend(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits) -> float:
    """Return the deceleration (m/s²) that the tightest bend within the planned way to stop needs."""
    curve, speed = completed.plan.curve, snapshot.ego.speed
    window = max(int(CURVATURE_WINDOW_M / curve.step), 1)
    near = max(BEND_ENTRY_S * speed, curve.step)
    first = int((snapshot.s + near) / curve.step)
    reach = int(speed * speed / (2.0 * limits.planned_deceleration) / curve.step) + window
    bends = np.abs(curve.curvature[first : first + reach + 1])
    if len(bends) <= window:
        return 0.0
    bends = np.convolve(bends, np.full(window, 1.0 / window), "valid")
    lateral = BEND_SHARE * limits.max_lateral_acceleration
    way = near + curve.step * np.arange(len(bends))
    needed = (speed * speed - lateral / np.maximum(bends, 1e-6)) / (2.0 * way)
    return float(min(max(needed.max(), 0.0), limits.emergency_deceleration))


def _braking_in_bend(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, least: float) -> float:
    """Return the deceleration (m/s²), `least` or harder, with which the ego is carried off C no farther than BEND_ROOM_M or
    than it is; the emergency's where none is enough."""
    curve, ego, planned = completed.plan.curve, snapshot.ego, limits.planned_deceleration
    error = wrapped(ego.pose.heading + ego.steering_angle - curve.heading_at(snapshot.s))
    lateral = BEND_SHARE * limits.max_lateral_acceleration
    held = max(BEND_ROOM_M, abs(snapshot.d) + SLIGHTLY_M[bool(ego.acceleration < -planned - HARDER_BY)])
    for rate in (least, 0.5 * (least + limits.emergency_deceleration)):
        away = carried_out(curve.curvature, curve.step, snapshot.s, snapshot.d, error, ego.speed, rate, lateral)
        if away <= held:
            return rate
    return limits.emergency_deceleration


def _slot(snapshot: Snapshot, user_id: str) -> Neighbour | None:
    return next((n for n in snapshot.neighbours if n.user.id == user_id), None)


def _targets(snapshot: Snapshot, completed: CompletedPlan) -> Iterator[TimeConstraint]:
    """Yield the (l, t_l) ahead that set no more than the desired speed; of those of the schedule the next one."""
    schedule = False
    for one in completed.timed_ones if snapshot.parameters.has(Mechanism.TIMES) else ():
        if one.s > snapshot.front:
            if one.reason is not Reason.ON_SCHEDULE or not schedule:
                yield one
            schedule = True


def _cruise(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, period: float) -> float:
    """The speed that road and time constraint ask for, approached gently from below (m/s)."""
    plan, speed = completed.plan, snapshot.ego.speed
    acceleration = limits.max_acceleration * completed.tuning.profile.acceleration
    sample = int((snapshot.s + speed * period) / plan.curve.step) + 1
    road = plan.speed_limits.item(min(max(sample, 0), len(plan.speed_limits) - 1))
    best = min([road, *(one.speed for one in completed.speeds if one.s <= snapshot.front)])
    for target in _targets(snapshot, completed):
        tolerance = snapshot.parameters.time_tolerance_s if target.reason is Reason.ON_SCHEDULE else 0.0
        left = target.time - snapshot.time - tolerance
        timely = cruise_speed(speed, target.s - snapshot.front, left, road, acceleration)
        best = min(best, timely if target.reason is Reason.ON_SCHEDULE else _gently(speed, timely, period))
    return speed + (best - speed) * min(1.0, period / snapshot.parameters.speed_approach_s) if best > speed else best


def _gently(speed: float, wanted: float, period: float) -> float:
    """Return a speed (m/s) on the way from the present one to a lower `wanted` one: a forecast is not worth a jerk."""
    return wanted if wanted >= speed else speed + (wanted - speed) * min(1.0, period / ROLLING_APPROACH_S)


def without_jerk(wish: Wish, ego: VehicleState, period: float, jerk: float) -> float:
    """Bound the fall of v_d by the comfortable `jerk` (m/s³) as long as nothing presses (m/s)."""
    if wish.is_pressing:
        return wish.speed
    return max(wish.speed, ego.speed + gentlest_brake(ego.acceleration, period, jerk) * period)


def _needed(speed: float, final: float, distance: float, limits: VehicleLimits) -> float:
    """Deceleration (m/s²) that reaches `final` speed within `distance` m, at most the emergency's."""
    if speed <= final:
        return 0.0
    needed = (speed * speed - final * final) / (2.0 * max(distance, 0.1))
    return min(needed, limits.emergency_deceleration)


def room_to_brake(snapshot: Snapshot, completed: CompletedPlan, margin: float = HARD_STOP_MARGIN_M) -> float:
    """Way (m) in which the hardest braking must stop the front bumper: `margin` m before line or region, behind leaders."""
    room = math.inf
    if not snapshot.parameters.has(Mechanism.ROOM_TO_STOP):
        return room
    for constraint in _hard(snapshot, completed):
        braking = constraint.speed * constraint.speed / (2.0 * constraint.braking) if constraint.behind else 0.0
        room = min(room, _room(constraint, snapshot.front, margin) + braking)
    return room


def _room(constraint: TimeConstraint, front: float, margin: float = HARD_STOP_MARGIN_M) -> float:
    """Way (m) to `margin` before a place, or to the least gap behind a leader, of which half may go where it is narrow
    already."""
    gap = constraint.s - front
    return max(gap - SAFE_GAP_M, 0.5 * gap) if constraint.behind else gap - margin
