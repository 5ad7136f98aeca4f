"""SUMO's units and frames, converted once."""

from __future__ import annotations

import math

from sumo_reactive.driver.nouns.state import Pose
from sumo_reactive.driver.vehicle.limits import VehicleLimits

KEEP_ROUTE_EXACT = 3
"""moveToXY: keep the route (bit 0) and the exact position (bit 1)."""

FREE_EXACT = 2
"""moveToXY: any lane, the exact position; the route may be replaced."""

INVALID = -1073741824.0
"""SUMO's mark for a value that is not set."""


def heading_of(angle: float) -> float:
    """Turn SUMO's navigational degrees (clockwise from north) into a heading, rad from the x axis."""
    return math.radians(90.0 - angle)


def angle_of(heading: float) -> float:
    """Turn a heading (rad) into navigational degrees in [0, 360)."""
    return (90.0 - math.degrees(heading)) % 360.0


def front_of(pose: Pose, limits: VehicleLimits) -> tuple[float, float]:
    """Return SUMO's reference point, the centre of the front bumper, of a rear-axle pose."""
    reach = limits.front_to_rear_axle
    return pose.x + reach * math.cos(pose.heading), pose.y + reach * math.sin(pose.heading)


def pose_of(x: float, y: float, heading: float, limits: VehicleLimits) -> Pose:
    """Return the rear-axle pose of a front-bumper point (m) and heading (rad)."""
    reach = limits.front_to_rear_axle
    return Pose(x - reach * math.cos(heading), y - reach * math.sin(heading), heading)
