"""What the ego can see: road users on the lanes that matter, and the lights before it."""

from __future__ import annotations

from collections.abc import Iterator

import libsumo

from sumo_reactive.messages.plan import NominalPlan
from sumo_reactive.messages.traffic import Body, RoadUser, Traffic
from sumo_reactive.parameters import (
    LANES_REFRESH_M,
    PERSON_DECELERATION,
    ROUTE_REFRESH_S,
    STANDING_SPEED,
)
from sumo_reactive.perception.attention import in_sight, lanes_in_sight
from sumo_reactive.sumo.ghosts import is_ghost
from sumo_reactive.sumo.units import heading_of
from sumo_reactive.world.road_graph import RoadGraph

ROUTE_AHEAD = 16
"""Edges of another vehicle's route that are kept."""


class Observer:
    """Reads SUMO through plain getters on the lanes in sight; keeps what does not change from step to step."""

    def __init__(self, ego_id: str) -> None:
        self._ego_id = ego_id
        self._bodies: dict[str, Body] = {}
        self._routes: dict[str, tuple[float, str, tuple[str, ...]]] = {}
        self._view: tuple[object, int] = (None, 0)
        self._lanes: tuple[tuple[str, str, float, bool], ...] = ()
        self._crossings: tuple[tuple[str, str], ...] = ()
        self._lights: tuple[str, ...] = ()

    def observe(self, graph: RoadGraph, plan: NominalPlan, front: float, speed: float) -> Traffic:
        """Return everything on the lanes in sight with the front bumper at `front` m of C and `speed` m/s."""
        view = (plan, int(front / LANES_REFRESH_M))
        if view[0] is not self._view[0] or view[1] != self._view[1]:
            self._look(graph, plan, front, speed)
            self._view = view
        now = libsumo.simulation.getTime()
        state = libsumo.trafficlight.getRedYellowGreenState
        lights = {light: state(light) for light in self._lights}
        return Traffic(now, (*self._vehicles(now), *self._persons()), lights)

    def _look(self, graph: RoadGraph, plan: NominalPlan, front: float, speed: float) -> None:
        """Choose lanes, crossings and lights for the next metres."""
        lanes, crossings = [], []
        for lane_id in lanes_in_sight(graph, plan, front, speed):
            lane = graph.lanes[lane_id]
            connection = graph.connection_of.get(lane_id)
            if connection is not None and connection.is_crossing:
                crossings.append((lane.edge_id, lane_id))
            else:
                lanes.append((lane_id, lane.edge_id, lane.scale, lane.is_internal))
        self._lanes, self._crossings = tuple(lanes), tuple(crossings)
        lights: dict[str, None] = {}
        for index in in_sight(plan, front, speed):
            junction = graph.junctions[plan.passages[index].junction_id]
            lights.update((c.light.light_id, None) for c in junction.connections if c.light)
        self._lights = tuple(lights)

    def _vehicles(self, now: float) -> Iterator[RoadUser]:
        on_lane, vehicle = libsumo.lane.getLastStepVehicleIDs, libsumo.vehicle
        for lane_id, edge_id, scale, internal in self._lanes:
            for name in on_lane(lane_id):
                if name == self._ego_id or is_ghost(name):
                    continue
                x, y = vehicle.getPosition(name)
                speed = vehicle.getSpeed(name)
                yield RoadUser(
                    name,
                    x,
                    y,
                    heading_of(vehicle.getAngle(name)),
                    speed,
                    lane_id,
                    vehicle.getLanePosition(name) * scale,
                    self._bodies.get(name) or self._body(name),
                    self._route(name, edge_id, internal, now),
                    vehicle.getWaitingTime(name) if speed <= STANDING_SPEED else 0.0,
                )

    def _persons(self) -> Iterator[RoadUser]:
        person = libsumo.person
        for edge_id, lane_id in self._crossings:
            for name in libsumo.edge.getLastStepPersonIDs(edge_id):
                x, y = person.getPosition(name)
                body = self._bodies.get(name)
                if body is None:
                    length, width = person.getLength(name), person.getWidth(name)
                    body = Body(length, width, PERSON_DECELERATION, person.getMaxSpeed(name), is_person=True)
                    self._bodies[name] = body
                heading = heading_of(person.getAngle(name))
                yield RoadUser(name, x, y, heading, person.getSpeed(name), lane_id, person.getLanePosition(name), body)

    def _body(self, name: str) -> Body:
        vehicle = libsumo.vehicle
        body = Body(
            vehicle.getLength(name),
            vehicle.getWidth(name),
            max(vehicle.getDecel(name), vehicle.getEmergencyDecel(name)),
            vehicle.getMaxSpeed(name),
        )
        self._bodies[name] = body
        return body

    def _route(self, name: str, edge_id: str, internal: bool, now: float) -> tuple[str, ...]:
        """Return the edges still to drive, present edge first; read anew on a new edge and every few seconds."""
        known = self._routes.get(name)
        if known is not None and known[1] == edge_id and now < known[0]:
            return known[2]
        index = libsumo.vehicle.getRouteIndex(name) + (1 if internal else 0)
        route = tuple(libsumo.vehicle.getRoute(name)[max(index, 0) : max(index, 0) + ROUTE_AHEAD])
        self._routes[name] = (now + ROUTE_REFRESH_S, edge_id, route)
        return route
