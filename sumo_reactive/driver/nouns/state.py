"""The ego's pose, state and command."""

from __future__ import annotations

import math
from typing import NamedTuple

STANDING_SPEED = 0.1
"""m/s; SUMO counts a vehicle as waiting at or below it."""

CREEPING_SPEED = 1.0
"""m/s; who is slower than this creeps, and still waits."""


class Pose(NamedTuple):
    """Configuration q of M (F&L 1991, §3.1): rear-axle midpoint (m) and heading (rad, counter-clockwise from x)."""

    x: float
    y: float
    heading: float

    def ahead(self, distance: float) -> tuple[float, float]:
        """Return the point (x, y) that lies `distance` m ahead of the rear axle along the body."""
        return self.x + distance * math.cos(self.heading), self.y + distance * math.sin(self.heading)


class VehicleState(NamedTuple):
    """Pose of the rear axle, `speed` (m/s) and `steering_angle` (rad) of the velocity at the front axle.

    `acceleration` (m/s²) is the one last commanded; it lets the executor bound the jerk.
    """

    pose: Pose
    speed: float
    steering_angle: float
    acceleration: float = 0.0


class Command(NamedTuple):
    """Motion command (v̇, φ̇): m/s² and rad/s."""

    acceleration: float
    steering_rate: float
