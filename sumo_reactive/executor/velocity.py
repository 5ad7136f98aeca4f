"""U₃, velocity: the desired speed v_d that time constraint, road, stop and leaders leave (F&L 1991, §3.3.3)."""

from __future__ import annotations

import math

from sumo_reactive.compilation import kernel


@kernel
def velocity_potential(speed: float, desired_speed: float) -> float:
    """U₃ = |v − v_d|, m/s (F&L 1991, §3.3.3)."""
    return abs(speed - desired_speed)


def cruise_speed(speed: float, distance: float, time_left: float, top_speed: float, acceleration: float) -> float:
    """Cruising speed of the accelerate–cruise profile that covers `distance` d₂ (m) in `time_left` (s).

    The last phase, decelerate, is in the speed limits along C and in the stop. `top_speed` when the time is too short.
    (F&L 1991, §3.3.3.)
    """
    if distance <= 0.0 or time_left <= 0.0:
        return top_speed
    mean = distance / time_left
    if mean <= speed:
        return min(top_speed, mean)
    # distance = c·T − (c − v)² / (2a), solved for the smaller cruising speed c
    b = speed + acceleration * time_left
    root = b * b - speed * speed - 2.0 * acceleration * distance
    return top_speed if root <= 0.0 else min(top_speed, b - math.sqrt(root))
