"""What the ego can see: road users on the lanes that matter, and the lights before it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import libsumo

from sumo_reactive.messages.plan import NominalPlan
from sumo_reactive.messages.traffic import Body, RoadUser, Traffic
from sumo_reactive.parameters import (
    LANES_REFRESH_M,
    OBSTACLE_POLYGONS,
    PERSON_DECELERATION,
    ROUTE_REFRESH_S,
    STANDING_SPEED,
    STEPPING_ON_M,
)
from sumo_reactive.perception.attention import in_sight, lanes_in_sight
from sumo_reactive.sumo.ghosts import is_ghost
from sumo_reactive.sumo.net_file import edge_id_of
from sumo_reactive.sumo.static_obstacles import StaticObstacles
from sumo_reactive.sumo.units import heading_of
from sumo_reactive.world.junction import Connection
from sumo_reactive.world.lane import Lane
from sumo_reactive.world.road_graph import RoadGraph

ROUTE_AHEAD = 16
"""Edges of another vehicle's route that are kept."""


class _Known(NamedTuple):
    """What is kept of a vehicle: its body, and its route as read on edge `edge_id`, to be read anew at time `until` (s)."""

    body: Body
    until: float
    edge_id: str
    route: tuple[str, ...]


class _Crossing(NamedTuple):
    """A pedestrian crossing: its edge and lane, the walking areas at its ends, and these ends: x, y, position (m), direction
    (rad) in which somebody steps on."""

    edge_id: str
    lane_id: str
    walks: tuple[str, ...]
    ends: tuple[tuple[float, float, float, float], ...]


class Observer:
    """Reads SUMO through plain getters on the lanes in sight; keeps what does not change from step to step."""

    def __init__(self, ego_id: str, polygon_type: str = OBSTACLE_POLYGONS) -> None:
        self._ego_id = ego_id
        self._static = StaticObstacles(polygon_type, ego_id)
        self._known: dict[str, _Known] = {}
        self._walkers: dict[str, Body] = {}
        self._view: tuple[object, int, float] = (None, 0, 0.0)
        self._lanes: tuple[tuple[str, str, float, bool], ...] = ()
        self._crossings: tuple[_Crossing, ...] = ()
        self._lights: tuple[str, ...] = ()

    def observe(self, graph: RoadGraph, plan: NominalPlan, front: float, speed: float, sight: float) -> Traffic:
        """Return everything on the lanes in sight with the front bumper at `front` m of C and `speed` m/s.

        `sight` (m): how far the pilot wants to look along the road.
        """
        view = (plan, int(front / LANES_REFRESH_M), sight)
        if view[0] is not self._view[0] or view[1:] != self._view[1:]:
            self._look(graph, plan, front, speed, sight)
            self._view = view
        now = libsumo.simulation.getTime()
        state = libsumo.trafficlight.getRedYellowGreenState
        lights = {light: state(light) for light in self._lights}
        static = self._static.near(*plan.curve.at(front)[:2])
        users = (*self._vehicles(now), *self._persons(), *static.users)
        return Traffic(now, users, lights, sight, static.points, tuple(self._about_to_cross()))

    def _look(self, graph: RoadGraph, plan: NominalPlan, front: float, speed: float, sight: float) -> None:
        """Choose lanes, crossings and lights for the next metres."""
        lanes, crossings = [], []
        for lane_id in lanes_in_sight(graph, plan, front, speed, sight):
            lane = graph.lanes[lane_id]
            connection = graph.connection_of.get(lane_id)
            if connection is not None and connection.is_crossing:
                crossings.append(_crossing(connection, lane))
            else:
                lanes.append((lane_id, lane.edge_id, lane.scale, lane.is_internal))
        self._lanes, self._crossings = tuple(lanes), tuple(crossings)
        lights: dict[str, None] = {}
        for index in in_sight(plan, front, speed):
            junction = graph.junctions[plan.passages[index].junction_id]
            lights.update((c.light.light_id, None) for c in junction.connections if c.light)
        self._lights = tuple(lights)

    def _vehicles(self, now: float) -> Iterator[RoadUser]:
        on_lane, vehicle, known_ones = libsumo.lane.getLastStepVehicleIDs, libsumo.vehicle, self._known
        for lane_id, edge_id, scale, internal in self._lanes:
            for name in on_lane(lane_id):
                known = known_ones.get(name)
                if known is None and (name == self._ego_id or is_ghost(name)):
                    continue
                if known is None or known.edge_id != edge_id or now >= known.until:
                    known = self._know(name, known, edge_id, internal, now)
                x, y = vehicle.getPosition(name)
                heading, speed = heading_of(vehicle.getAngle(name)), vehicle.getSpeed(name)
                position = vehicle.getLanePosition(name) * scale
                if speed > STANDING_SPEED:
                    yield RoadUser(name, x, y, heading, speed, lane_id, position, known.body, known.route)
                    continue
                waiting, halted = vehicle.getWaitingTime(name), bool(vehicle.isStopped(name))
                yield RoadUser(name, x, y, heading, speed, lane_id, position, known.body, known.route, waiting, halted)

    def _persons(self) -> Iterator[RoadUser]:
        """Yield who walks over a crossing."""
        person, on_edge = libsumo.person, libsumo.edge.getLastStepPersonIDs
        for crossing in self._crossings:
            for name in on_edge(crossing.edge_id):
                yield self._walker(name, crossing.lane_id, heading_of(person.getAngle(name)), person.getLanePosition(name))

    def _about_to_cross(self) -> Iterator[RoadUser]:
        """Yield who is about to step on a crossing: at a negative position, or one beyond its length."""
        for crossing in self._crossings:
            for edge_id in crossing.walks:
                for name in libsumo.edge.getLastStepPersonIDs(edge_id):
                    if libsumo.person.getNextEdge(name) == crossing.edge_id:
                        yield from self._stepping_on(name, crossing)

    def _stepping_on(self, name: str, crossing: _Crossing) -> Iterator[RoadUser]:
        x, y = libsumo.person.getPosition(name)
        away, position, heading = min(
            (math.hypot(x - px, y - py), at, along) for px, py, at, along in crossing.ends
        )
        if away < STEPPING_ON_M:
            yield self._walker(name, crossing.lane_id, heading, position - away if position == 0.0 else position + away)

    def _walker(self, name: str, lane_id: str, heading: float, position: float) -> RoadUser:
        person = libsumo.person
        body = self._walkers.get(name)
        if body is None:
            length, width = person.getLength(name), person.getWidth(name)
            body = Body(length, width, PERSON_DECELERATION, person.getMaxSpeed(name), is_person=True)
            self._walkers[name] = body
        x, y = person.getPosition(name)
        return RoadUser(name, x, y, heading, person.getSpeed(name), lane_id, position, body)

    def _know(self, name: str, known: _Known | None, edge_id: str, internal: bool, now: float) -> _Known:
        """Read what changes seldom: the body once, the edges still to drive on a new edge and every few seconds."""
        index = max(libsumo.vehicle.getRouteIndex(name) + (1 if internal else 0), 0)
        route = tuple(libsumo.vehicle.getRoute(name)[index : index + ROUTE_AHEAD])
        self._known[name] = _Known(known.body if known else _body(name), now + ROUTE_REFRESH_S, edge_id, route)
        return self._known[name]


def _crossing(connection: Connection, lane: Lane) -> _Crossing:
    spine = lane.spine
    walks = dict.fromkeys(edge_id_of(end) for end in (connection.from_lane, connection.to_lane))
    first, last = spine.at(0.0), spine.at(spine.length)
    onto, back = spine.heading_at(0.0), spine.heading_at(spine.length) + math.pi
    return _Crossing(
        lane.edge_id, lane.id, tuple(walk for walk in walks if walk != lane.edge_id),
        ((*first, 0.0, onto), (*last, spine.length, back)),
    )  # fmt: skip


def _body(name: str) -> Body:
    vehicle = libsumo.vehicle
    return Body(
        vehicle.getLength(name),
        vehicle.getWidth(name),
        max(vehicle.getDecel(name), vehicle.getEmergencyDecel(name)),
        vehicle.getMaxSpeed(name),
    )
