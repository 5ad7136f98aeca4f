"""How long a way takes a car, and how long a way it takes to move aside."""

from __future__ import annotations

import math

from sumo_reactive.driver.vehicle.limits import VehicleLimits

LANE_CHANGE_DURATION_S = 3.0
"""Time of a lane change at road speed."""

FAST_CHANGE_SPEED = 15.0
"""m/s; above it a lane change takes longer, for a road that bends leaves less of the lateral acceleration and jerk…"""

FAST_CHANGE_GROWTH = 0.06
"""…by this much per m/s (s²/m): 3.9 s at 30 m/s, with a lateral jerk of 60·3.5 m / T³ = 3.5 m/s³."""

MIN_START_BLEND_M = 8.0
"""Shortest transition from the car's pose to the lane's centre: about two car radii."""

MAX_START_BLEND_M = 160.0
"""Longest transition from the car's pose: a lane change at 40 m/s."""

START_CURVATURE_SHARE = 0.6
"""Share of the car's curvature that the transition to the centre line may use; the road's own bend needs the rest."""


def travel_time(distance: float, speed: float, acceleration: float, top_speed: float) -> float:
    """Least time (s) to cover `distance` m from `speed`, with `acceleration` up to `top_speed`; 0 when behind."""
    if distance <= 0.0:
        return 0.0
    if speed >= top_speed:
        return distance / max(speed, 0.1)
    to_top = (top_speed * top_speed - speed * speed) / (2.0 * acceleration)
    if distance <= to_top:
        return (math.sqrt(speed * speed + 2.0 * acceleration * distance) - speed) / acceleration
    return (top_speed - speed) / acceleration + (distance - to_top) / top_speed


QUINTIC_STEP_CURVATURE = 5.77
"""Peak curvature of a quintic lateral step, times length² / offset."""
QUINTIC_TURN_CURVATURE = 3.6
"""Peak curvature of a quintic that takes out a heading error, times length / error."""


def side_step_length(offset: float, error: float, speed: float, width: float, limits: VehicleLimits) -> float:
    """Return the length (m) of a transition by `offset` m to the side and a heading `error` (rad) at `speed` m/s.

    `width` (m) is that of a lane: a whole one takes LANE_CHANGE_DURATION_S.
    """
    drivable = limits.comfort_lateral_acceleration / max(speed, 1.0) ** 2
    bend = START_CURVATURE_SHARE * min(limits.max_curvature, drivable)
    lateral = math.sqrt(QUINTIC_STEP_CURVATURE * offset / bend)
    turning = QUINTIC_TURN_CURVATURE * error / bend
    duration = LANE_CHANGE_DURATION_S + FAST_CHANGE_GROWTH * max(speed - FAST_CHANGE_SPEED, 0.0)
    comfortable = speed * duration * min(offset / width, 1.0)
    return min(max(MIN_START_BLEND_M, lateral, turning, comfortable), MAX_START_BLEND_M)
