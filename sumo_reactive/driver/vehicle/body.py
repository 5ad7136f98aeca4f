"""The ground that bodies cover: the ego's by its rear axle, the others' by their front bumpers."""

from __future__ import annotations

import math

from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.state import Pose
from sumo_reactive.driver.vehicle.limits import VehicleLimits

Box = tuple[float, float, float, float, float]
"""Centre (m, m), heading (rad), length, width (m), as `boxes_overlap` takes it."""

_ASIDE_M = 0.5
"""Who is no farther than this from the ego's side is behind it."""


def box_of(x: float, y: float, heading: float, length: float, width: float) -> Box:
    """Return the box of a body whose front bumper's centre is at (`x`, `y`), m."""
    half = 0.5 * length
    return x - half * math.cos(heading), y - half * math.sin(heading), heading, length, width


def own_box(pose: Pose, limits: VehicleLimits, around: float = 0.0, beside: float = 0.0) -> Box:
    """Return the box of the ego with its rear axle at `pose`, larger by `around` (m) on all sides and by `beside` on two."""
    x, y = pose.ahead(limits.front_to_rear_axle - 0.5 * limits.length)
    return x, y, pose.heading, limits.length + 2.0 * around, limits.width + 2.0 * (around + beside)


def clear_behind(boxes: Floats, pose: Pose, limits: VehicleLimits) -> float:
    """Return how far behind the ego's rear bumper the next body of `boxes` (n, ≥ 6) is, m (infinite: nobody near)."""
    c, s, clear = math.cos(pose.heading), math.sin(pose.heading), math.inf
    for x, y, heading, _, length, width, *_ in boxes.tolist():
        mx, my, *_ = box_of(x, y, heading, length, width)
        along, across = abs(math.cos(heading - pose.heading)), abs(math.sin(heading - pose.heading))
        reach, aside = 0.5 * (length * along + width * across), 0.5 * (length * across + width * along)
        behind = (pose.x - mx) * c + (pose.y - my) * s - limits.rear_overhang - reach
        is_aside = abs((my - pose.y) * c - (mx - pose.x) * s) >= 0.5 * limits.width + aside + _ASIDE_M
        if behind > -limits.length and not is_aside:
            clear = min(clear, behind)
    return clear
