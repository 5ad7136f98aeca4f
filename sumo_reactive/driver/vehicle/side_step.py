"""How long a car needs to move aside."""

from __future__ import annotations

import math

from sumo_reactive.driver.parameters import (
    FAST_CHANGE_GROWTH,
    FAST_CHANGE_SPEED,
    LANE_CHANGE_DURATION_S,
    MAX_START_BLEND_M,
    MIN_START_BLEND_M,
    START_CURVATURE_SHARE,
)
from sumo_reactive.driver.vehicle.limits import VehicleLimits

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
