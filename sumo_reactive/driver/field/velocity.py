"""U₃, velocity: the desired speed v_d that time constraint, road, stop and leaders leave (F&L 1991, §3.3.3)."""

from __future__ import annotations

import math

import numpy as np

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.polyline import Floats


@kernel
def velocity_potential(speed: float, desired_speed: float) -> float:
    """U₃ = |v − v_d|, m/s (F&L 1991, §3.3.3)."""
    return abs(speed - desired_speed)


@kernel
def cruise_speed(speed: float, distance: float, time_left: float, top_speed: float, acceleration: float) -> float:
    """Cruising speed of the accelerate–cruise profile that covers `distance` d₂ (m) in `time_left` (s).

    The last phase, decelerate, is in the speed limits along C, to which the times of P belong, and in the stop. `top_speed`
    when the time is too short. (F&L 1991, §3.3.3.)
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


@kernel
def rolling_speed(speed: float, room: float, time_left: float, lag: float, braking: float) -> float:
    """Speed c (m/s) to which a car falls that in `time_left` (s) is to be as near as it can still stop: `room` (m) less
    c²/2b from where it is, b the `braking` (m/s²). Infinite when the time is over.

    It falls to c as e^(−t/τ), τ the `lag` (s): in T it covers c·T + (v − c)·τ(1 − e^(−T/τ)) = room − c²/2b, solved for c.
    """
    if time_left <= 0.0:
        return np.inf
    late = lag * (1.0 - math.exp(-time_left / lag))
    b = braking * (time_left - late)
    return max(math.sqrt(max(b * b + 2.0 * braking * (room - speed * late), 0.0)) - b, 0.0)


@kernel
def carried_out(
    curvature: Floats, step: float, s: float, d: float, error: float, speed: float, deceleration: float, lateral: float
) -> float:
    """Return how far (m) from C a car is carried that brakes with `deceleration` (m/s²) and turns as tightly as `lateral`
    acceleration (m/s²) allows, until it heads along C again or is slow enough to follow it.

    It is at arc length `s` and `d` m to the left of C, whose `curvature` (n,), 1/m, is known every `step` m, drives at
    `speed` (m/s) and heads `error` rad to the left of C. Being carried to where it comes back to C does not count.
    """
    squared, away, farthest = speed * speed, d, 0.0
    for k in range(max(int(s / step), 0), len(curvature)):
        turn = lateral / max(squared, 1.0) * step
        error -= curvature[k] * step
        held = abs(error) <= turn
        error = 0.0 if held else error - math.copysign(turn, error)
        away += math.sin(error) * step
        if away * error > 0.0:
            farthest = max(farthest, abs(away))
        squared -= 2.0 * deceleration * step
        if squared <= 1.0:
            break
    return farthest
