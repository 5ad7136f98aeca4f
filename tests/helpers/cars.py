"""Cars to test with."""

from __future__ import annotations

import math

from sumo_reactive.driver.nouns.state import Pose, VehicleState
from sumo_reactive.driver.nouns.traffic import Body, RoadUser
from sumo_reactive.driver.vehicle.limits import VehicleLimits

CAR = VehicleLimits(
    length=4.0, width=1.8, wheelbase=2.4, front_overhang=0.8, max_speed=50.0, max_acceleration=2.6,
    comfort_deceleration=2.5, service_deceleration=4.5, emergency_deceleration=9.0, max_steering_angle=0.65,
    max_steering_rate=1.0, max_lateral_acceleration=4.0, comfort_lateral_acceleration=3.0,
)  # fmt: skip
"""A small car: its front axle can follow a circle of 4.0 m radius."""

BODY = Body(length=4.7, width=1.8, emergency_deceleration=8.0, max_speed=50.0)


def car_at(name: str, x: float, y: float, heading: float, speed: float, **more: object) -> RoadUser:
    """Return a car whose front bumper's centre is at (x, y), on no lane."""
    return RoadUser(name, x, y, heading, speed, "", 0.0, BODY, **more)


def front_axle(state: VehicleState, limits: VehicleLimits = CAR) -> tuple[float, float]:
    """Return the front axle's midpoint, m."""
    p = state.pose
    return p.x + limits.wheelbase * math.cos(p.heading), p.y + limits.wheelbase * math.sin(p.heading)


def with_front_at(x: float, y: float, heading: float, speed: float, limits: VehicleLimits = CAR) -> VehicleState:
    """Return a state whose front bumper's centre is at (x, y), wheels straight."""
    back = limits.front_to_rear_axle
    return VehicleState(Pose(x - back * math.cos(heading), y - back * math.sin(heading), heading), speed, 0.0)
