"""The ego's dimensions and limits, read from its SUMO vehicle type."""

from __future__ import annotations

import math

import libsumo

from sumo_reactive.driver.parameters import (
    COMFORT_DECELERATION,
    COMFORT_LATERAL_ACCELERATION,
    FRONT_OVERHANG_FRACTION,
    LONG_VEHICLE_STEERING_ANGLE,
    MAX_LATERAL_ACCELERATION,
    MAX_STEERING_ANGLE,
    MAX_STEERING_RATE,
    STANDSTILL_GAP_M,
    TURNING_CIRCLE_M,
    WHEELBASE_FRACTION,
)
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.errors import ScenarioError

NOT_ROAD_CARS = frozenset(
    {"rail", "rail_urban", "rail_electric", "rail_fast", "tram", "subway", "cable_car", "ship", "aircraft", "drone"}
    | {"pedestrian", "wheelchair", "bicycle", "scooter", "container"}
)
"""What is not driven like a car."""


def limits_of(vehicle_id: str) -> VehicleLimits:
    """Read length, width, accelerations and speeds from SUMO; wheelbase and overhang are fractions of the length.

    Each can be overridden by a `<param key="reactive.NAME">` of the vehicle or its type, NAME a field of VehicleLimits.
    """
    vehicle = libsumo.vehicle
    length = vehicle.getLength(vehicle_id)
    service = vehicle.getDecel(vehicle_id)
    values = {
        "length": length,
        "width": vehicle.getWidth(vehicle_id),
        "wheelbase": WHEELBASE_FRACTION * length,
        "front_overhang": FRONT_OVERHANG_FRACTION * length,
        "max_speed": vehicle.getMaxSpeed(vehicle_id),
        "max_acceleration": vehicle.getAccel(vehicle_id),
        "comfort_deceleration": min(COMFORT_DECELERATION, service),
        "service_deceleration": service,
        "emergency_deceleration": max(service, vehicle.getEmergencyDecel(vehicle_id)),
        "max_steering_rate": MAX_STEERING_RATE,
        "max_lateral_acceleration": MAX_LATERAL_ACCELERATION,
        "comfort_lateral_acceleration": COMFORT_LATERAL_ACCELERATION,
        "time_headway": vehicle.getTau(vehicle_id),
        "standstill_gap": min(STANDSTILL_GAP_M, max(vehicle.getMinGap(vehicle_id), 1.0)),
    }
    values.update(_overrides(vehicle_id, (*values, "max_steering_angle")))
    sizes = values["wheelbase"], values["front_overhang"], values["width"]
    values.setdefault("max_steering_angle", steering_angle_of(*sizes))
    try:
        return VehicleLimits(**values)
    except ValueError as error:
        raise ScenarioError(f"vehicle '{vehicle_id}': {error}") from error


def steering_angle_of(wheelbase: float, front_overhang: float, width: float) -> float:
    """Return φmax, rad: a car's, or what a longer vehicle needs to keep its front corner within the turning circle.

    (L + overhang)² + (L / tanφ + width / 2)² = radius².
    """
    ahead = wheelbase + front_overhang
    rear = math.sqrt(max(TURNING_CIRCLE_M**2 - ahead * ahead, 0.0)) - 0.5 * width
    return min(max(MAX_STEERING_ANGLE, math.atan2(wheelbase, rear)), LONG_VEHICLE_STEERING_ANGLE)


def _overrides(vehicle_id: str, names: tuple[str, ...]) -> dict[str, float]:
    """Return the values of `reactive.*` parameters; the vehicle's own win over its type's."""
    type_id = libsumo.vehicle.getTypeID(vehicle_id)
    found = {}
    for name in names:
        key = f"reactive.{name}"
        text = libsumo.vehicle.getParameter(vehicle_id, key) or libsumo.vehicletype.getParameter(type_id, key)
        if text:
            try:
                found[name] = float(text)
            except ValueError:
                raise ScenarioError(f"vehicle '{vehicle_id}': parameter '{key}' is not a number: '{text}'") from None
    return found
