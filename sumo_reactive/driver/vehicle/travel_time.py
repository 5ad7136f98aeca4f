"""How long a way takes a car that speeds up."""

from __future__ import annotations

import math


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
