"""Watching a vehicle that SUMO itself drives: where it is, and who is near."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import libsumo
from libsumo import constants as tc

from sumo_reactive.driver.nouns.traffic import Body, RoadUser
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.sumo.net_file import edge_id_of
from sumo_reactive.sumo.stop_lines import StopLines, read_signals
from sumo_reactive.sumo.units import heading_of
from sumo_reactive.sumo.vehicle_type import limits_of

_SEEN = (
    tc.VAR_POSITION, tc.VAR_ANGLE, tc.VAR_SPEED, tc.VAR_LANE_ID, tc.VAR_LANEPOSITION, tc.VAR_LENGTH, tc.VAR_WIDTH,
)  # fmt: skip


class View(NamedTuple):
    """The vehicle and the others near it after a step, and the letters of a light whose stop line it crosses (`Scene`)."""

    own: RoadUser
    others: tuple[RoadUser, ...]
    crossed: str


class Spectator:
    """Sees a running vehicle and all vehicles and pedestrians within `reach` m of it; the simulation goes on unchanged."""

    def __init__(self, vehicle_id: str, reach: float) -> None:
        self.id = vehicle_id
        self.limits: VehicleLimits = limits_of(vehicle_id)
        self.departure = float(libsumo.vehicle.getDeparture(vehicle_id))
        self.arrived = False
        self.teleports = 0
        self._reach = reach
        self._stop_lines = StopLines(read_signals())
        self._routes: dict[str, tuple[str, tuple[str, ...]]] = {}
        libsumo.vehicle.subscribeContext(vehicle_id, tc.CMD_GET_VEHICLE_VARIABLE, reach, list(_SEEN))

    def look(self) -> View | None:
        """Return what there is to see after a step; None while SUMO has the vehicle off the road, or it has arrived."""
        self.arrived = self.arrived or self.id in libsumo.simulation.getArrivedIDList()
        self.teleports += self.id in libsumo.simulation.getStartingTeleportIDList()
        seen = {} if self.arrived else libsumo.vehicle.getContextSubscriptionResults(self.id)
        if self.id not in seen:
            return None
        users = {name: self._user(name, values) for name, values in seen.items()}
        own = users.pop(self.id)
        return View(own, (*users.values(), *self._persons(own)), self._stop_lines.crossed(own.lane_id))

    def _user(self, name: str, seen: Mapping[int, Any]) -> RoadUser:
        """Return a vehicle as subscribed."""
        (x, y), angle, speed, lane_id, position, length, width = (seen[variable] for variable in _SEEN)
        body = Body(length, width, emergency_deceleration=math.nan, max_speed=math.nan)
        route = self._route(name, lane_id)
        return RoadUser(name, x, y, heading_of(angle), speed, lane_id, position, body, route)

    def _route(self, name: str, lane_id: str) -> tuple[str, ...]:
        """Return the edges that a vehicle has still to drive, its present one first; inside a junction the next one."""
        edge = edge_id_of(lane_id)
        known = self._routes.get(name)
        if known is None or known[0] != edge:
            first = max(libsumo.vehicle.getRouteIndex(name) + edge.startswith(":"), 0)
            known = self._routes[name] = edge, tuple(libsumo.vehicle.getRoute(name)[first:])
        return known[1]

    def _persons(self, own: RoadUser) -> Iterator[RoadUser]:
        """Yield who is near on foot."""
        person = libsumo.person
        for name in person.getIDList():
            (x, y), lane_id = person.getPosition(name), person.getLaneID(name)
            if math.hypot(x - own.x, y - own.y) < self._reach and not person.getVehicle(name):
                body = Body(person.getLength(name), person.getWidth(name), math.nan, math.nan, is_person=True)
                heading, position = heading_of(person.getAngle(name)), person.getLanePosition(name)
                yield RoadUser(name, x, y, heading, person.getSpeed(name), lane_id, position, body)
