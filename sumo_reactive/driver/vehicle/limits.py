"""Dimensions and limits of the controlled car."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import cached_property

from sumo_reactive.driver.parameters import USUAL, Parameters

LARGEST = {"length": 100.0, "width": 10.0, "wheelbase": 100.0, "front_overhang": 100.0, "max_steering_angle": 0.5 * math.pi}
"""What no road vehicle exceeds, m and rad; the longest road trains have 54 m."""
LARGEST_OTHERWISE = 1000.0
"""The same for every other limit, in its unit."""


@dataclass(frozen=True, kw_only=True)
class VehicleLimits:
    """Dimensions in m, speeds in m/s, accelerations in m/s² (all positive), angles in rad.

    `comfort_deceleration` is what planned braking uses, `service_deceleration` what the vehicle type states as its own,
    `emergency_deceleration` its physical limit. `front_overhang` is from the front axle to the front bumper.
    `time_headway` (s) and `standstill_gap` (m) are what the driver keeps to a leader, `parameters` all else that its driver
    goes by. `vehicle_class`, SUMO's name for it, tells which lanes are open to it.
    """

    length: float
    width: float
    wheelbase: float
    front_overhang: float
    max_speed: float
    max_acceleration: float
    comfort_deceleration: float
    service_deceleration: float
    emergency_deceleration: float
    max_steering_angle: float
    max_steering_rate: float
    max_lateral_acceleration: float
    comfort_lateral_acceleration: float
    time_headway: float = 1.0
    standstill_gap: float = 2.0
    parameters: Parameters = USUAL
    vehicle_class: str = "passenger"

    def __post_init__(self) -> None:
        positive = {k: v for k, v in vars(self).items() if k not in ("front_overhang", "parameters", "vehicle_class")}
        for name, value in positive.items():
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"vehicle {name} must be positive and finite, got {value}")
            if value > (most := LARGEST.get(name, LARGEST_OTHERWISE)):
                raise ValueError(f"vehicle {name} is {value:g}, more than {most:g}")
        if not (self.front_overhang >= 0.0 and self.rear_overhang >= 0.0):
            raise ValueError("wheelbase and front overhang do not fit the vehicle's length")

    def __hash__(self) -> int:
        """Return the hash of all limits, found once: what is worked out for a car is looked up by it at every step."""
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash(tuple(getattr(self, field.name) for field in fields(self)))

    @cached_property
    def rear_overhang(self) -> float:
        """From the rear bumper to the rear axle, m."""
        return self.length - self.wheelbase - self.front_overhang

    @cached_property
    def front_to_rear_axle(self) -> float:
        """From the rear axle to the front bumper, m."""
        return self.wheelbase + self.front_overhang

    @cached_property
    def planned_deceleration(self) -> float:
        """The hardest braking that is no emergency, m/s²."""
        return min(self.parameters.planned_deceleration, self.service_deceleration)

    @cached_property
    def acceleration_in_plan(self) -> float:
        """What the pilot counts on when it foresees the ego's motion, m/s²."""
        return min(self.parameters.max_acceleration_in_plan, self.max_acceleration)

    @cached_property
    def max_curvature(self) -> float:
        """Largest curvature that the front axle can follow for ever: sin φmax / L ≤ tan φmax / L, 1/m."""
        return math.sin(self.max_steering_angle) / self.wheelbase
