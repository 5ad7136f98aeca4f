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


def stopping_speed(distance: float, deceleration: float, period: float) -> float:
    """Largest speed after the next `period` (s) from which `deceleration` (m/s²) stops within `distance` m from now."""
    if distance <= 0.0:
        return 0.0
    b = deceleration * period
    return -b + math.sqrt(b * b + 2.0 * deceleration * distance)


def following_speed(gap: float, leader_speed: float, deceleration: float, time_headway: float) -> float:
    """Speed that keeps `time_headway` (s) behind a leader (m, m/s) and stops behind it when both brake alike.

    The safe speed of Krauss (1998): v = −bτ + √((bτ)² + v_l² + 2b·gap).
    """
    b = deceleration * time_headway
    root = b * b + leader_speed * leader_speed + 2.0 * deceleration * gap
    return max(0.0, -b + math.sqrt(root)) if root > 0.0 else 0.0
