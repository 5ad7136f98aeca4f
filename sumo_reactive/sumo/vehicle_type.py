"""What SUMO says of a vehicle: dimensions and limits of its type, where its trip ends, places in SUMO's units."""

from __future__ import annotations

import contextlib
import math
import re
import tempfile
from pathlib import Path

import libsumo

from sumo_reactive.driver.nouns.state import Pose
from sumo_reactive.driver.parameters import USUAL, Parameters
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.errors import ScenarioError

WHEELBASE_FRACTION = 0.6
"""Wheelbase / length; passenger cars range from 0.57 to 0.64."""

FRONT_OVERHANG_FRACTION = 0.18
"""From the front axle to the front bumper / length."""

MAX_STEERING_ANGLE = 0.65
"""rad, φmax: a car of 5 m then turns with a front-axle radius of 5 m."""

TURNING_CIRCLE_M = 12.5
"""Radius of the circle within which every vehicle must turn (Directive 96/53/EC, Annex I); long ones steer farther…"""

LONG_VEHICLE_STEERING_ANGLE = 0.9
"""…up to this, rad: the steering lock of buses and trucks."""

KEEP_ROUTE_EXACT = 3
"""moveToXY: keep the route (bit 0) and the exact position (bit 1)."""

FREE_EXACT = 2
"""moveToXY: any lane, the exact position; the route may be replaced."""


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


_ATTRIBUTE = re.compile(r'\b(arrivalPos|arrivalPosRandomized|arrivalLane)="([^"]*)"')


def arrival_of(vehicle_id: str) -> tuple[float | None, int | None]:
    """Return arrival position (m on the last lane, negative: from its end) and lane index of a running vehicle.

    None stands for what the trip leaves open: "max", "current" or nothing; "random" is what SUMO has drawn. Takes one
    saved state: 10 ms with 70 vehicles, 45 ms in a city; the run goes on unchanged.
    """
    with tempfile.TemporaryDirectory(prefix="sumo_reactive_") as folder:
        state = Path(folder) / "state.xml"
        try:
            libsumo.simulation.saveState(str(state))
        except libsumo.TraCIException:  # a scenario with parts that SUMO cannot save: the trip ends at the lane's end
            return None, None
        return _arrival_in(state, vehicle_id)


def _arrival_in(state: Path, vehicle_id: str) -> tuple[float | None, int | None]:
    start = f'<vehicle id="{vehicle_id}" '
    with state.open(encoding="utf-8", errors="replace") as lines:
        tag = next((line for line in lines if start in line), "")
    found = dict(_ATTRIBUTE.findall(tag))
    values: dict[str, float] = {}
    for name, text in found.items():
        with contextlib.suppress(ValueError):
            values[name] = float(text)
    lane = values.get("arrivalLane")
    position = values.get("arrivalPos", values.get("arrivalPosRandomized"))  # "random": SUMO has drawn it
    return position, None if lane is None else int(lane)


NOT_ROAD_CARS = frozenset(
    {"rail", "rail_urban", "rail_electric", "rail_fast", "tram", "subway", "cable_car", "ship", "aircraft", "drone"}
    | {"pedestrian", "wheelchair", "bicycle", "scooter", "container"}
)
"""What is not driven like a car."""


def limits_of(vehicle_id: str, parameters: Parameters = USUAL) -> VehicleLimits:
    """Read length, width, accelerations and speeds from SUMO; wheelbase and overhang are fractions of the length, the rest
    follows the `parameters` of the driver.

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
        "comfort_deceleration": min(parameters.comfort_deceleration, service),
        "service_deceleration": service,
        "emergency_deceleration": max(service, vehicle.getEmergencyDecel(vehicle_id)),
        "max_steering_rate": parameters.max_steering_rate,
        "max_lateral_acceleration": parameters.max_lateral_acceleration,
        "comfort_lateral_acceleration": parameters.comfort_lateral_acceleration,
        "time_headway": vehicle.getTau(vehicle_id),
        "standstill_gap": min(parameters.standstill_gap_m, max(vehicle.getMinGap(vehicle_id), 1.0)),
    }
    values.update(_overrides(vehicle_id, (*values, "max_steering_angle")))
    sizes = values["wheelbase"], values["front_overhang"], values["width"]
    values.setdefault("max_steering_angle", steering_angle_of(*sizes))
    try:
        return VehicleLimits(**values, parameters=parameters)
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
