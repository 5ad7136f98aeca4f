"""The eyes of all egos: each road user and each light is read once a step, whoever looks at it."""

from __future__ import annotations

import math
from collections.abc import Container, Iterator, Mapping
from functools import cached_property
from typing import NamedTuple

import libsumo

from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import BOX_BYTES, Body, RoadUser, packed_boxes
from sumo_reactive.sumo.asking import askers_of
from sumo_reactive.sumo.config import OBSTACLE_POLYGONS
from sumo_reactive.sumo.net_file import edge_id_of
from sumo_reactive.sumo.stand_ins import is_stand_in
from sumo_reactive.sumo.static_obstacles import StaticObstacles
from sumo_reactive.sumo.vehicle_type import heading_of, size_of_body

FIXED_PROGRAM = 0
"""SUMO's type of a light whose phases last as long as the program says."""

PERSON_DECELERATION = 5.0
"""m/s²; a pedestrian stops within a step."""

TRACTOR_M = 9.5
"""SUMO shows a trailer, however long, along the heading of so much of it."""

STEPPING_ON_M = 4.0
"""Somebody on a walking area who is this near to the crossing that he heads for is about to step on: 3 s of walking."""


class Signals(NamedTuple):
    """What SUMO's lights rule: `links` maps ways over a stop line to (light, index of its letter), `before` edges to the
    lights at their ends.

    A way is (lane, lane), or (edge, lane inside the junction): SUMO may have a body that swings out on the lane beside.
    """

    links: dict[tuple[str, str], tuple[str, int]]
    before: dict[str, tuple[str, ...]]


def read_signals() -> Signals:
    """Return what the lights of the running simulation rule."""
    links: dict[tuple[str, str], tuple[str, int]] = {}
    before: dict[str, tuple[str, ...]] = {}
    for light in libsumo.trafficlight.getIDList():
        for index, ways in enumerate(libsumo.trafficlight.getControlledLinks(light)):
            for lane, behind, inside in ways:
                edge = edge_id_of(lane)
                links[lane, behind] = links[lane, inside] = links[edge, inside] = light, index
                before[edge] = tuple(dict.fromkeys((*before.get(edge, ()), light)))
    return Signals(links, before)


class StopLines:
    """Watches one vehicle."""

    def __init__(self, signals: Signals) -> None:
        self._signals = signals
        self._lane = ""
        self._letters: dict[str, str] = {}

    def crossed(self, lane_id: str) -> str:
        """Return the letters that the light showed before a step and in it, if the vehicle crosses its stop line in that
        step; else an empty text. `lane_id`: where SUMO has the vehicle after the step (empty: nowhere)."""
        found, links = "", self._signals.links
        if lane_id and lane_id != self._lane:
            link = links.get((self._lane, lane_id)) or links.get((edge_id_of(self._lane), lane_id))
            if link is not None:
                light, index = link
                found = self._letters[light][index] + libsumo.trafficlight.getRedYellowGreenState(light)[index]
            self._lane = lane_id
        ahead = self._signals.before.get(edge_id_of(self._lane), ())
        self._letters = {light: libsumo.trafficlight.getRedYellowGreenState(light) for light in ahead}
        return found


LONGEST_YELLOW_S = 10.0
"""What is yellow for longer does not end by a program."""

ROUTE_AHEAD = 16
"""Edges of another vehicle's route that are kept."""


class SeenLane(NamedTuple):
    """A lane to look at: its edge, spine metres per position metre, and whether it lies inside a junction."""

    lane_id: str
    edge_id: str
    scale: float
    is_internal: bool


class OnLane(NamedTuple):
    """Who is on a lane, and their boxes, packed."""

    users: tuple[RoadUser, ...]
    boxes: bytes

    def without(self, name: str) -> OnLane:
        """Return the others."""
        k = next(k for k, user in enumerate(self.users) if user.id == name)
        return OnLane(
            self.users[:k] + self.users[k + 1 :], self.boxes[: k * BOX_BYTES] + self.boxes[(k + 1) * BOX_BYTES :]
        )


class SeenCrossing(NamedTuple):
    """A pedestrian crossing: its edge and lane, the walking areas at its ends, and these ends: x, y, position (m), direction
    (rad) in which somebody steps on."""

    edge_id: str
    lane_id: str
    walks: tuple[str, ...]
    ends: tuple[tuple[float, float, float, float], ...]


class _Known(NamedTuple):
    """What is kept of a vehicle: its body, and what is left of the route `route_id` on edge `edge_id`."""

    body: Body
    route_id: str
    edge_id: str
    route: tuple[str, ...]


class Sensor:
    """Reads SUMO through plain getters, and keeps what does not change from step to step.

    What one ego has looked at in a step is not read again for the next one; nor does what one sees depend on who has looked.
    """

    def __init__(self, polygon_type: str = OBSTACLE_POLYGONS) -> None:
        self.static = StaticObstacles(polygon_type)
        self._known: dict[str, _Known] = {}
        self._walkers: dict[str, Body] = {}
        self._now = -math.inf
        self._looked_at = set[str]()
        self._seen: dict[str, OnLane] = {}
        self._lane_of: dict[str, str] = {}
        self._letters: dict[str, str] = {}
        self._programs: dict[tuple[str, str], tuple[tuple[float, str], ...]] = {}

    def look(self) -> float:
        """Begin to look at the present step, unless another ego has; return simulation time, s."""
        now = float(libsumo.simulation.getTime())
        if now != self._now:
            has_missed = now > self._now + 1.5 * libsumo.simulation.getDeltaT()
            self._now = now
            self._looked_at.clear()
            self._seen.clear()
            self._lane_of.clear()
            self._letters.clear()
            if has_missed:
                self.static.look_again()
            else:
                self.static.update()
        return now

    def asker_of(self, ego_id: str, lanes: Container[str]) -> str:
        """Return the first of the egos on `lanes`, as just looked at, that ask this one to let them in (empty: none)."""
        asking = askers_of(ego_id)
        return next((asker for asker in asking if self._lane_of.get(asker, "") in lanes), "") if asking else ""

    @cached_property
    def signals(self) -> Signals:
        """What the lights rule: read once for all egos."""
        return read_signals()

    def letters(self, light_id: str) -> str:
        """Return a light's letters."""
        found = self._letters.get(light_id)
        if found is None:
            found = self._letters[light_id] = libsumo.trafficlight.getRedYellowGreenState(light_id)
        return found

    def yellow_until(self, letters: Mapping[str, str]) -> dict[str, float]:
        """Return when the lights that show yellow switch, s, by id, of those that show these `letters`; but for such as are
        set from outside, since nobody knows."""
        ends = {light: float(libsumo.trafficlight.getNextSwitch(light)) for light, shown in letters.items() if "y" in shown}
        return {light: until for light, until in ends.items() if until <= self._now + LONGEST_YELLOW_S}

    def switches(self, light_id: str, horizon: float) -> tuple[tuple[float, str], ...]:
        """Return when a light of a fixed program will switch within `horizon` s, and its letters from then on."""
        lights = libsumo.trafficlight
        running = light_id, lights.getProgram(light_id)
        phases = self._programs.get(running)
        if phases is None:
            phases = self._programs[running] = _fixed_phases(*running)
        if not phases:
            return ()
        found, k, time = list[tuple[float, str]](), lights.getPhase(light_id), float(lights.getNextSwitch(light_id))
        while time <= self._now + horizon:
            k = (k + 1) % len(phases)
            found.append((time, phases[k][1]))
            time += phases[k][0]
        return tuple(found)

    def vehicles(self, lanes: Mapping[str, SeenLane], ego_id: str = "") -> list[OnLane]:
        """Return who drives or stands on each of `lanes`, by id, the ego and stand-ins left out; nothing of an empty one."""
        seen, names_on = self._seen, libsumo.lane.getLastStepVehicleIDs
        for lane_id in lanes.keys() - self._looked_at:
            self._looked_at.add(lane_id)
            if names := names_on(lane_id):
                users = self._read(names, *lanes[lane_id])
                if users:
                    seen[lane_id] = OnLane(users, packed_boxes(users))
        own = self._lane_of.get(ego_id)
        return [seen[one].without(ego_id) if one == own else seen[one] for one in lanes if one in seen]

    def _read(
        self, names: tuple[str, ...], lane_id: str, edge_id: str, scale: float, internal: bool
    ) -> tuple[RoadUser, ...]:
        vehicle, known_ones, found = libsumo.vehicle, self._known, list[RoadUser]()
        for name in names:
            known = known_ones.get(name)
            if known is None and is_stand_in(name):
                continue
            route_id = vehicle.getRouteID(name)
            if known is None or known.edge_id != edge_id or known.route_id != route_id:
                known = self._know(name, known, route_id, edge_id, internal)
            body, _, _, route = known
            x, y = vehicle.getPosition(name)
            heading, speed = heading_of(vehicle.getAngle(name)), vehicle.getSpeed(name) * scale
            position, gain, waiting, halted = vehicle.getLanePosition(name) * scale, 0.0, 0.0, False
            if speed > STANDING_SPEED:
                gain = vehicle.getAcceleration(name) * scale
            else:
                waiting, halted = vehicle.getWaitingTime(name), bool(vehicle.isStopped(name))
            self._lane_of[name] = lane_id
            found.append(RoadUser(name, x, y, heading, speed, lane_id, position, body, route, waiting, halted, gain))
        return tuple(found)

    def on_crossing(self, crossing: SeenCrossing) -> Iterator[RoadUser]:
        """Yield who walks over a crossing."""
        person = libsumo.person
        for name in libsumo.edge.getLastStepPersonIDs(crossing.edge_id):
            yield self._walker(name, crossing.lane_id, heading_of(person.getAngle(name)), person.getLanePosition(name))

    def about_to_cross(self, crossing: SeenCrossing) -> Iterator[RoadUser]:
        """Yield who is about to step on a crossing: at a negative position, or one beyond its length."""
        for edge_id in crossing.walks:
            for name in libsumo.edge.getLastStepPersonIDs(edge_id):
                if libsumo.person.getNextEdge(name) == crossing.edge_id:
                    yield from self._stepping_on(name, crossing)

    def _stepping_on(self, name: str, crossing: SeenCrossing) -> Iterator[RoadUser]:
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
            length, width = size_of_body(name, person.getLength(name), person.getWidth(name))
            body = Body(length, width, PERSON_DECELERATION, person.getMaxSpeed(name), is_person=True)
            self._walkers[name] = body
        x, y = person.getPosition(name)
        return RoadUser(name, x, y, heading, person.getSpeed(name), lane_id, position, body)

    def _know(self, name: str, known: _Known | None, route_id: str, edge_id: str, internal: bool) -> _Known:
        """Read what changes seldom: the body once, the edges still to drive on a new edge or another route."""
        index = max(libsumo.vehicle.getRouteIndex(name) + (1 if internal else 0), 0)
        route = tuple(libsumo.vehicle.getRoute(name)[index : index + ROUTE_AHEAD])
        found = self._known[name] = _Known(known.body if known else _body(name), route_id, edge_id, route)
        return found


def _fixed_phases(light_id: str, program_id: str) -> tuple[tuple[float, str], ...]:
    """Return duration (s) and letters of each phase, in order, of a program that keeps to them; none of any other."""
    logics = (one for one in libsumo.trafficlight.getAllProgramLogics(light_id) if one.programID == program_id)
    logic = next(logics, None)
    if logic is None or logic.type != FIXED_PROGRAM or any(phase.next or phase.duration <= 0.0 for phase in logic.phases):
        return ()
    return tuple((phase.duration, phase.state) for phase in logic.phases)


def _body(name: str) -> Body:
    vehicle = libsumo.vehicle
    braking = max(vehicle.getDecel(name), vehicle.getEmergencyDecel(name))
    length, width = size_of_body(name, vehicle.getLength(name), vehicle.getWidth(name))
    first_part = min(length, TRACTOR_M) if vehicle.getVehicleClass(name) == "trailer" else 0.0
    gains = vehicle.getAccel(name)
    return Body(length, width, braking, vehicle.getMaxSpeed(name), first_part=first_part, acceleration=gains)
