"""Angles in radians, counter-clockwise from the x axis."""

import math

from sumo_reactive.driver.compilation import kernel


@kernel
def wrapped(angle: float) -> float:
    """Return `angle` (rad) in (-π, π]."""
    return math.pi - (math.pi - angle) % (2.0 * math.pi)
