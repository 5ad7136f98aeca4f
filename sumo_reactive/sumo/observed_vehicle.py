"""Watching a vehicle from outside, whoever drives it: where it is, and who is near."""

from __future__ import annotations

import math
import re
from collections.abc import Container, Iterator, Mapping, Sequence
from operator import itemgetter
from typing import Any, NamedTuple

import libsumo
from libsumo import constants as tc

from sumo_reactive.driver.nouns.traffic import Body, RoadUser
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.sumo.net_file import edge_id_of
from sumo_reactive.sumo.sensor import StopLines, read_signals
from sumo_reactive.sumo.stand_ins import is_stand_in
from sumo_reactive.sumo.vehicle_type import heading_of, limits_of, size_of_body

TOUCHING_M = 40.0
"""Bodies whose fronts are farther apart do not touch: two long ones, rear to rear."""

SAME_LEVEL_M = 3.0
"""Who differs more in height is on a bridge above, or on the road below."""

_ON_CROSSING = re.compile(r":.*_c\d+$")
"""Edges that are pedestrian crossings."""

_SEEN = (
    tc.VAR_POSITION3D, tc.VAR_ANGLE, tc.VAR_SPEED, tc.VAR_LANE_ID, tc.VAR_LANEPOSITION, tc.VAR_LENGTH, tc.VAR_WIDTH,
    tc.VAR_ACCELERATION,
)  # fmt: skip
_values_of = itemgetter(*_SEEN)

_PLACES = tc.VAR_POSITION3D, tc.VAR_LANE_ID
"""What tells who is near: turning a value into one of Python's costs more than SUMO's search."""


class VehicleScene(NamedTuple):
    """The vehicle and the others near it after a step, and the letters of a light whose stop line it crosses (`Scene`)."""

    own: RoadUser
    others: tuple[RoadUser, ...]
    crossed: str


class Junctions:
    """Which junctions the lanes of the running simulation join."""

    def __init__(self) -> None:
        self._ends: dict[str, frozenset[str]] = {}

    def are_apart(self, one: str, other: str) -> bool:
        """Whether two lanes, by id, have no junction in common; not known of one that is none (empty)."""
        here, there = self._ends_of(one), self._ends_of(other)
        return bool(here and there) and not here & there

    def _ends_of(self, lane_id: str) -> frozenset[str]:
        """Return the junctions that a lane joins, one for a lane inside a junction, none where there is no lane."""
        edge = edge_id_of(lane_id) if lane_id else ""
        if edge and edge not in self._ends:
            self._ends[edge] = frozenset((libsumo.edge.getFromJunction(edge), libsumo.edge.getToJunction(edge)))
        return self._ends.get(edge, frozenset())


class ObservedVehicle:
    """Sees a running vehicle, and all vehicles, and pedestrians on crossings, within `reach` m of it; the simulation goes on
    unchanged."""

    def __init__(self, vehicle_id: str, reach: float) -> None:
        self.id = vehicle_id
        self.limits: VehicleLimits = limits_of(vehicle_id)
        self.departure = float(libsumo.vehicle.getDeparture(vehicle_id))
        self.arrived = False
        self.teleports = 0
        self._reach = reach
        self._stop_lines = StopLines(read_signals())
        self._routes: dict[str, tuple[str, str, tuple[str, ...]]] = {}
        self._bodies: dict[str, Body] = {}
        self.junctions = Junctions()
        _subscribe(vehicle_id, reach, _SEEN)

    def look(self) -> VehicleScene | None:
        """Return what there is to see after a step; None while SUMO has the vehicle off the road, or it has arrived."""
        self.arrived = self.arrived or self.id in libsumo.simulation.getArrivedIDList()
        self.teleports += self.id in libsumo.simulation.getStartingTeleportIDList()
        seen = {} if self.arrived else _seen_from(self.id)
        if self.id not in seen:
            return None
        bodies = self._bodies
        users = {name: _user(name, one, bodies, self._route(name, one[tc.VAR_LANE_ID])) for name, one in seen.items()}
        own = users.pop(self.id)
        return VehicleScene(own, (*users.values(), *self._persons(own)), self._stop_lines.crossed(own.lane_id))

    def leave(self) -> None:
        """Look no more, before the vehicle is taken off the road from outside."""
        _unsubscribe(self.id, self._reach)

    def _route(self, name: str, lane_id: str) -> tuple[str, ...]:
        """Return the edges that a vehicle has still to drive, its present one first; inside a junction the next one."""
        known = self._routes.get(name)
        if known is not None and known[0] == lane_id:
            return known[2]
        edge = edge_id_of(lane_id)
        if known is not None and known[1] == edge:
            route = known[2]
        else:
            first = max(libsumo.vehicle.getRouteIndex(name) + edge.startswith(":"), 0)
            route = tuple(libsumo.vehicle.getRoute(name)[first:])
        self._routes[name] = lane_id, edge, route
        return route

    def _persons(self, own: RoadUser) -> Iterator[RoadUser]:
        """Yield who walks over a crossing near."""
        person = libsumo.person
        for name in person.getIDList():
            if not _ON_CROSSING.match(person.getRoadID(name)):
                continue
            (x, y), lane_id = person.getPosition(name), person.getLaneID(name)
            if math.hypot(x - own.x, y - own.y) < self._reach:
                size = size_of_body(name, person.getLength(name), person.getWidth(name))
                body = Body(*size, math.nan, math.nan, is_person=True)
                heading, position = heading_of(person.getAngle(name)), person.getLanePosition(name)
                yield RoadUser(name, x, y, heading, person.getSpeed(name), lane_id, position, body)


class Bystanders:
    """Sees who is so near to a vehicle that he might touch it, stand-ins left out; the simulation goes on unchanged.

    Roads that no junction joins lie on different levels where they cross, also in a network without heights.
    """

    def __init__(self, vehicle_id: str) -> None:
        self._vehicle_id = vehicle_id
        self.junctions = Junctions()
        _subscribe(vehicle_id, TOUCHING_M, _PLACES)

    def look(self, known: Container[str] = ()) -> tuple[RoadUser, ...]:
        """Return them after a step, those left out who are `known` already."""
        seen = libsumo.vehicle.getContextSubscriptionResults(self._vehicle_id)
        own = seen.get(self._vehicle_id)
        strangers = [name for name in seen if name not in known and name != self._vehicle_id and not is_stand_in(name)]
        if own is None or not strangers:
            return ()
        return tuple(_read(name, seen[name]) for name in strangers if self._is_beside(seen[name], own))

    def _is_beside(self, seen: Mapping[int, Any], own: Mapping[int, Any]) -> bool:
        """Whether somebody is on the vehicle's level, on a road that joins one of its road's junctions."""
        is_level = abs(seen[tc.VAR_POSITION3D][2] - own[tc.VAR_POSITION3D][2]) < SAME_LEVEL_M
        return is_level and not self.junctions.are_apart(own[tc.VAR_LANE_ID], seen[tc.VAR_LANE_ID])

    def leave(self) -> None:
        """Look no more, before the vehicle is taken off the road from outside."""
        _unsubscribe(self._vehicle_id, TOUCHING_M)


def _subscribe(vehicle_id: str, reach: float, variables: Sequence[int]) -> None:
    libsumo.vehicle.subscribeContext(vehicle_id, tc.CMD_GET_VEHICLE_VARIABLE, reach, list(variables))


def _unsubscribe(vehicle_id: str, reach: float) -> None:
    """End a subscription: SUMO fails in the next step if a vehicle that is watched is taken off the road from outside."""
    libsumo.vehicle.unsubscribeContext(vehicle_id, tc.CMD_GET_VEHICLE_VARIABLE, reach)


def _seen_from(vehicle_id: str) -> dict[str, Mapping[int, Any]]:
    """Return what is subscribed of a vehicle and of those near on its level, by id; empty while it is off the road."""
    seen = libsumo.vehicle.getContextSubscriptionResults(vehicle_id)
    if vehicle_id not in seen:
        return {}
    level = seen[vehicle_id][tc.VAR_POSITION3D][2]
    return {name: one for name, one in seen.items() if abs(one[tc.VAR_POSITION3D][2] - level) < SAME_LEVEL_M}


def _user(name: str, seen: Mapping[int, Any], bodies: dict[str, Body], route: tuple[str, ...] = ()) -> RoadUser:
    """Return a vehicle as subscribed; `bodies` keeps what does not change of it."""
    (x, y, _), angle, speed, lane_id, position, length, width, gain = _values_of(seen)
    body = bodies.get(name)
    if body is None or body.length != length or body.width != width:
        size = size_of_body(name, length, width)
        body = bodies[name] = Body(*size, emergency_deceleration=math.nan, max_speed=math.nan)
    return RoadUser(name, x, y, heading_of(angle), speed, lane_id, position, body, route, 0.0, False, gain)


def _read(name: str, seen: Mapping[int, Any]) -> RoadUser:
    """Return a vehicle of which the place alone is subscribed."""
    vehicle, (x, y, _) = libsumo.vehicle, seen[tc.VAR_POSITION3D]
    size = size_of_body(name, vehicle.getLength(name), vehicle.getWidth(name))
    body = Body(*size, emergency_deceleration=math.nan, max_speed=math.nan)
    return RoadUser(
        name, x, y, heading_of(vehicle.getAngle(name)), vehicle.getSpeed(name), seen[tc.VAR_LANE_ID],
        vehicle.getLanePosition(name), body, acceleration=vehicle.getAcceleration(name),
    )  # fmt: skip
