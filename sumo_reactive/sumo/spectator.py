"""Watching a vehicle that SUMO itself drives: where it is, and who is near."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import libsumo
from libsumo import constants as tc

from sumo_reactive.messages.traffic import Body, RoadUser
from sumo_reactive.sumo.units import heading_of
from sumo_reactive.sumo.vehicle_type import limits_of
from sumo_reactive.vehicle.limits import VehicleLimits

_SEEN = (
    tc.VAR_POSITION, tc.VAR_ANGLE, tc.VAR_SPEED, tc.VAR_LANE_ID, tc.VAR_LANEPOSITION, tc.VAR_LENGTH, tc.VAR_WIDTH,
)  # fmt: skip


class View(NamedTuple):
    """The vehicle and the other vehicles near it after a step."""

    own: RoadUser
    others: tuple[RoadUser, ...]


class Spectator:
    """Sees a running vehicle and all vehicles within `reach` m of it; the simulation goes on unchanged."""

    def __init__(self, vehicle_id: str, reach: float) -> None:
        self.id = vehicle_id
        self.limits: VehicleLimits = limits_of(vehicle_id)
        self.departure = float(libsumo.vehicle.getDeparture(vehicle_id))
        self.arrived = False
        self.teleports = 0
        libsumo.vehicle.subscribeContext(vehicle_id, tc.CMD_GET_VEHICLE_VARIABLE, reach, list(_SEEN))

    def look(self) -> View | None:
        """Return what there is to see after a step; None while SUMO has the vehicle off the road, or it has arrived."""
        self.arrived = self.arrived or self.id in libsumo.simulation.getArrivedIDList()
        self.teleports += self.id in libsumo.simulation.getStartingTeleportIDList()
        seen = {} if self.arrived else libsumo.vehicle.getContextSubscriptionResults(self.id)
        if self.id not in seen:
            return None
        users = {name: _user(name, values) for name, values in seen.items()}
        return View(users.pop(self.id), tuple(users.values()))


def _user(name: str, seen: Mapping[int, Any]) -> RoadUser:
    """Return a vehicle as subscribed."""
    (x, y), angle, speed, lane_id, position, length, width = (seen[variable] for variable in _SEEN)
    body = Body(length, width, emergency_deceleration=math.nan, max_speed=math.nan)
    return RoadUser(name, x, y, heading_of(angle), speed, lane_id, position, body)
