"""Where a driver's answer leaves the car: pure functions of answer, state and time."""

from __future__ import annotations

import math
from collections.abc import Sequence

from sumo_reactive.driver.geometry.polyline import wrapped
from sumo_reactive.driver.nouns.state import Command, Pose, VehicleState
from sumo_reactive.driver.vehicle.bicycle import advance
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.errors import DriverError
from sumo_reactive.lab.drivers.protocol import DriverAnswer, LaneCommand, MotionPlan, Placement, Waypoint

MOST_ACCELERATION = 100.0
"""m/s²; an answer beyond it is a slip, not a wish."""

FARTHEST_AHEAD_M = 10.0
"""A place may be this much farther than the speed of the car at the end of the step allows; beyond it is a leap."""

_NUMBERS = int | float


def require_finite(*numbers: float) -> None:
    """Raise DriverError unless all are numbers that a car can be told."""
    for number in numbers:
        if not isinstance(number, _NUMBERS) or not math.isfinite(number):
            raise DriverError(f"answered {number!r} where a finite number is due")


def speed_after(answer: LaneCommand, speed: float, limits: VehicleLimits, duration: float) -> float:
    """Return the speed (m/s) that an answer leads to after `duration` s."""
    require_finite(answer.acceleration)
    if abs(answer.acceleration) > MOST_ACCELERATION:
        raise DriverError(f"answered an acceleration of {answer.acceleration:g}")
    return min(max(0.0, speed + answer.acceleration * duration), limits.max_speed)


def steered(answer: Command, state: VehicleState, limits: VehicleLimits, duration: float) -> VehicleState:
    """Return the state after holding a command for `duration` s, as far as the car can: its limits bound what is wished."""
    require_finite(*answer)
    lowest, highest = -limits.emergency_deceleration, limits.max_acceleration
    acceleration = min(max(answer.acceleration, lowest), highest, (limits.max_speed - state.speed) / duration)
    rate = min(max(answer.steering_rate, -limits.max_steering_rate), limits.max_steering_rate)
    angle = min(max(state.steering_angle + rate * duration, -limits.max_steering_angle), limits.max_steering_angle)
    held = Command(acceleration, (angle - state.steering_angle) / duration)
    return advance(state, held, limits.wheelbase, duration)


def plan_after(answer: DriverAnswer, before: Sequence[Waypoint], time: float) -> tuple[Waypoint, ...]:
    """Return the waypoints in force after an answer that is to hold at `time` (s)."""
    if isinstance(answer, MotionPlan):
        found = tuple(answer.waypoints)
    elif isinstance(answer, Placement):
        found = (Waypoint(time, *answer),)
    elif answer is None:
        found = tuple(before)
    else:
        raise DriverError(f"answered a {type(answer).__name__}, which is none of the answers that there are")
    if not found:
        raise DriverError("answered nothing, and there is no plan to go on with")
    return found


def placed(
    plan: Sequence[Waypoint], state: VehicleState, limits: VehicleLimits, time: float, duration: float
) -> VehicleState:
    """Return the state at `time` (s) on a plan; raise DriverError for a leap that no car can make in `duration` s."""
    point = at_time(plan, time)
    require_finite(*point)
    rear = limits.front_to_rear_axle
    pose = Pose(point.x - rear * math.cos(point.heading), point.y - rear * math.sin(point.heading), point.heading)
    leap = math.dist(pose[:2], state.pose[:2])
    if leap > max(abs(point.speed), state.speed) * duration + FARTHEST_AHEAD_M:
        raise DriverError(f"answered a place {leap:.1f} m away, at {point.speed:.1f} m/s")
    return VehicleState(pose, max(0.0, point.speed), 0.0, (point.speed - state.speed) / duration)


def at_time(plan: Sequence[Waypoint], time: float) -> Waypoint:
    """Return the place of a plan at a time (s), straight between two waypoints, beyond the ends the last one."""
    later = next((k for k, point in enumerate(plan) if point.time >= time), len(plan) - 1)
    second, first = plan[later], plan[max(later - 1, 0)]
    span = second.time - first.time
    if span <= 0.0 or time >= second.time:
        return second
    share = (time - first.time) / span
    x, y, speed = (a + share * (b - a) for a, b in ((first.x, second.x), (first.y, second.y), (first.speed, second.speed)))
    return Waypoint(time, x, y, first.heading + share * wrapped(second.heading - first.heading), speed)
