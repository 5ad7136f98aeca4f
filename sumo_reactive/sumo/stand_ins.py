"""Stand-ins: they show others what SUMO hides from them, above all the ego on a lane that its body occupies but SUMO does
not map it to."""

from __future__ import annotations

import math
from typing import NamedTuple

import libsumo

from sumo_reactive.driver.nouns.plan import LaneSegment, NominalPlan, Turnaround, segment_at
from sumo_reactive.driver.nouns.state import CREEPING_SPEED, STANDING_SPEED, VehicleState
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.view.corridor import lane_at_side, off_tracking_of
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.sumo.orders import AT_ONCE, Tell, nothing
from sumo_reactive.sumo.vehicle_type import KEEP_ROUTE_EXACT, angle_of, front_of

OFF_TRACKING_SEEN_S = 2.0
"""So long before, at the present speed: who comes from behind needs as much to fall back."""

OCCUPIED_LANE_M = 0.1
"""A body nearer than this to a lane border is taken to reach over it."""

UNSEEN_REAR_M = 0.2
"""No less of a rear than this is shown where SUMO does not see it."""

PREFIX = "reactive.ghost."
"""Ids of stand-ins begin with this; no figure counts them."""

_BEFORE_END_M = 0.01
"""Who has passed the end of the lane is shown this far before it: at the end itself SUMO has it in the junction."""

_VAPORIZED = 3
_NO_LIMIT = 100.0
_SPEED_FACTOR = 2.0
"""Enough for every ego; a large one makes each of SUMO's steps ten times slower."""

_SILENT_DEVICES = ("tripinfo", "fcd", "vehroute", "ssm", "emissions", "battery")


class Occupant(NamedTuple):
    """Who occupies lanes: an ego on segment `here` of its plan, which SUMO has on lane `mapped` (empty: none)."""

    graph: RoadGraph
    plan: NominalPlan
    here: LaneSegment
    ego: VehicleState
    limits: VehicleLimits
    mapped: str = ""

    @property
    def front(self) -> tuple[float, float]:
        """The middle of the front bumper, m."""
        return front_of(self.ego.pose, self.limits)

    def behind_front(self, way: float) -> tuple[float, float]:
        """Return the point `way` m behind the front on the body's axis, m."""
        (x, y), heading = self.front, self.ego.pose.heading
        return x - way * math.cos(heading), y - way * math.sin(heading)


def mapped_next(by: Occupant, before: VehicleState) -> str:
    """Return the lane that SUMO will have the ego on after a step from `before`: the one of C if the front comes nearer to
    its middle in this step than to that of the lane beside where it is mapped, else as it is."""
    if by.mapped == by.here.lane_id:
        return by.mapped
    own = by.graph.lanes[by.here.lane_id]
    beside = next((one for one in by.graph.neighbours(own.id) if one is not None and one.id == by.mapped), None)
    if beside is None:
        return by.mapped
    fronts = front_of(before.pose, by.limits), by.front
    was, is_still = (abs(beside.spine.project(*one)[1]) < abs(own.spine.project(*one)[1]) for one in fronts)
    return own.id if was and not is_still else by.mapped


class OccupiedLane(NamedTuple):
    """A stand-in's place: lane, the point (m) beside which its front bumper is, speed (m/s), the edges that it drives.

    `waits`: it does not appear where somebody already is; `ways`: nor while somebody drives there, on these or, unless it
    `is_early`, on that lane; `is_early`: who would have to brake hard for it goes first; `length`: m (0: the ego's).
    """

    lane: Lane
    x: float
    y: float
    speed: float
    edges: tuple[str, ...]
    waits: bool = False
    ways: tuple[str, ...] = ()
    is_early: bool = False
    length: float = 0.0


def occupied_lane(by: Occupant, s: float, edges: tuple[str, ...], stop: float = math.inf) -> OccupiedLane | None:
    """Return where to show the ego besides; None: nowhere. `edges`: its route from its lane segment on; `s`, `stop`: where
    its front axle is and where its front bumper is to stop, m of C.

    On the oncoming lane the stand-in stands, its front where the ego's rear is: SUMO knows no driving backwards.
    """
    graph, speed, own = by.graph, by.ego.speed, by.graph.lanes[by.here.lane_id]
    x, y = by.front
    if by.plan.aside is None:
        if not own.reaches(x, y, by.limits.width):
            return _swung_out(by, own, edges)
        lane = lane_in_change(by, s)
        if lane is not None:
            return OccupiedLane(lane, x, y, speed, edges)
        lane, is_early = lane_off_tracked(by, s, stop)
        return None if lane is None else OccupiedLane(lane, x, y, speed, edges, waits=True, is_early=is_early)
    lane = _beside(graph, own.id, by.plan.aside.lateral)
    if lane is None or abs(lane.spine.project(x, y)[1]) >= 0.5 * (lane.width + by.limits.width) - OCCUPIED_LANE_M:
        return None
    if lane.edge_id == own.edge_id:
        mapped = abs(own.spine.project(x, y)[1]) > abs(lane.spine.project(x, y)[1])
        return OccupiedLane(own if mapped else lane, x, y, speed, edges)
    pose, back = by.ego.pose, -by.limits.rear_overhang
    rear = pose.x + back * math.cos(pose.heading), pose.y + back * math.sin(pose.heading)
    return OccupiedLane(lane, *rear, 0.0, (lane.edge_id,))


def mapped_elsewhere(by: Occupant, s: float, edges: tuple[str, ...]) -> OccupiedLane | None:
    """Return where to show an ego whom SUMO has on the lane beside its own, or on a lane of a junction that its plan does
    not use, so that those behind it see its rear; None: SUMO has it where it drives. `s`: where its front axle is, m of C;
    `edges`: its route."""
    if by.mapped == by.here.lane_id:
        return None
    if any(lane is not None and lane.id == by.mapped for lane in by.graph.neighbours(by.here.lane_id)):
        return OccupiedLane(by.graph.lanes[by.here.lane_id], *by.front, by.ego.speed, edges[by.here.route_index :])
    if not by.mapped.startswith(":") or any(segment.lane_id == by.mapped for segment in by.plan.segments):
        return None
    middle = segment_at(by.plan, s + by.limits.front_overhang - 0.5 * by.limits.length)
    return OccupiedLane(by.graph.lanes[middle.lane_id], *by.front, by.ego.speed, edges[middle.route_index :])


def rear_beside(by: Occupant, s: float, edges: tuple[str, ...]) -> OccupiedLane | None:
    """Return where to show an ego that has left a road with its front while its rear still reaches over a lane beside the
    one that it has left it by: up to the end of that lane, as long as the rear there; None: it does not. `s`: where its
    front axle is, m of C; `edges`: its route.

    SUMO shows it to those who come on its own lanes only. While it still has the ego there, nobody else is: it is shown
    already then, since SUMO may lose it from one step to the next.
    """
    if s + by.limits.front_overhang - by.here.start + by.here.lane_offset > by.limits.length:
        return None
    here, rear = by.graph.lanes[by.here.lane_id], by.behind_front(by.limits.length)
    ways = [by.graph.connection_of[here.id]] if here.is_internal else by.graph.ways_into(here.id)
    came = [by.graph.lanes[way.from_lane] for way in ways if way.from_lane in by.graph.lanes]
    index = by.here.route_index - (not here.is_internal)
    if not came or index < 0:
        return None
    own = min(came, key=lambda one: abs(one.spine.project(*rear)[1]))
    reach = by.limits.width - 2.0 * OCCUPIED_LANE_M
    over = [one for one in by.graph.edge_lanes.get(own.edge_id, ()) if one.id != own.id and one.reaches(*rear, reach)]
    if not over or own.edge_id != edges[index]:
        return None
    lane = min(over, key=lambda one: abs(one.spine.project(*rear)[1]))
    length = lane.spine.length - lane.spine.project(*rear)[0]
    if length < OCCUPIED_LANE_M:
        return None
    end = lane.spine.at(lane.spine.length)
    return OccupiedLane(lane, *end, by.ego.speed, edges[index:], waits=by.mapped != lane.id, length=length)


def rear_unseen(by: Occupant, edges: tuple[str, ...]) -> OccupiedLane | None:
    """Return where to show the rear of a slow ego on a lane that is declared longer than it is drawn: SUMO takes it for as
    long there as it is over ground, and those behind come so much nearer; None: there is nothing to show. `edges`: its
    route from its lane segment on."""
    lane, length = by.graph.lanes[by.here.lane_id], by.limits.length
    unseen = length - length * lane.scale
    if unseen < UNSEEN_REAR_M or by.ego.speed > CREEPING_SPEED or lane.is_internal:
        return None
    front = lane.spine.project(*by.front)[0]
    if front < length:
        return None
    seen = length * lane.scale + OCCUPIED_LANE_M  # and as much clear of that: it waits where somebody is, and so is the ego
    x, y = lane.spine.at(front - seen)
    return OccupiedLane(lane, x, y, by.ego.speed, edges, waits=True, length=(length - seen) / lane.scale)


def left_behind(by: Occupant, turn: Turnaround, edges: tuple[str, ...]) -> OccupiedLane:
    """Return where to show an ego that turns round in several moves: where it began, from the first move on, so that those
    behind leave it the room to back up. `edges`: its route from there on."""
    x, y = by.plan.curve.at(turn.start - by.limits.parameters.stop_line_margin_m)[:2]
    return OccupiedLane(by.graph.lanes[turn.from_lane], x, y, 0.0, edges)


def ahead_of_mapping(by: Occupant, turn: Turnaround, edges: tuple[str, ...]) -> OccupiedLane | None:
    """Return where to show an ego that turns round in several moves, on the lane that it turns into; None: SUMO has it
    there, its front ahead of its rear. `edges`: its route from there on.

    Before its front comes there, who is on his way through the junction to that lane is let pass: he would brake hard, and
    might come to a stand where the ego has to go.
    """
    into = by.graph.lanes[turn.to_lane]
    front, rear = (into.spine.project(*place)[0] for place in (by.front, by.behind_front(by.limits.length)))
    if by.mapped == into.id and rear < front:
        return None
    rear = min(front, rear)
    is_there = into.reaches(*by.front, by.limits.width)
    ways = [part for way in by.graph.ways_into(into.id) for part in (way.from_lane, *way.parts) if not is_there]
    return OccupiedLane(into, *into.spine.at(rear + by.limits.length), 0.0, edges, waits=True, ways=tuple(ways))


def _swung_out(by: Occupant, own: Lane, edges: tuple[str, ...]) -> OccupiedLane:
    """Return where to show an ego whose front has swung out of its `own` lane.

    On its own lane, while SUMO maps it to another of the edge; where it maps it to none, on the one under its middle, with
    its rear where the ego's is: who follows would else see it jump towards him.
    """
    graph, width = by.graph, by.limits.width
    approach = graph.connection_of[own.id].from_lane if own.is_internal else own.id
    lanes = graph.edge_lanes[graph.lanes[approach].edge_id]
    if not any(lane.reaches(*by.front, width) for lane in lanes):
        middle = by.behind_front(0.5 * by.limits.length)
        under = min(lanes, key=lambda lane: abs(lane.spine.project(*middle)[1]))
        if under.reaches(*middle, width):
            rear = min(_along(under, *place) for place in (by.front, by.behind_front(by.limits.length)))
            return OccupiedLane(under, *under.spine.at(rear + by.limits.length), by.ego.speed, edges)
    return OccupiedLane(own, *by.front, by.ego.speed, edges)


def _along(lane: Lane, x: float, y: float) -> float:
    """Return the spine arc length of `lane` beside (x, y), m; negative before its start."""
    s, _ = lane.spine.project(x, y)
    (x0, y0), heading = lane.spine.at(0.0), lane.spine.heading_at(0.0)
    return s if s > 0.0 else min((x - x0) * math.cos(heading) + (y - y0) * math.sin(heading), 0.0)


def _beside(graph: RoadGraph, lane_id: str, lateral: float) -> Lane | None:
    """Return the lane to the left (`lateral` > 0) or right of a lane: of its own edge, or the oncoming one."""
    left, right = graph.neighbours(lane_id)
    oncoming = graph.edge_lanes.get(graph.opposite.get(graph.lanes[lane_id].edge_id, ""), ())
    return (left if lateral > 0.0 else right) or (oncoming[-1] if oncoming else None)


def lane_in_change(by: Occupant, s: float) -> Lane | None:
    """Return which of the two lanes of a change under way SUMO does not map the ego to; None when there is no change.

    SUMO maps it to the one whose centre is nearer to its front bumper. `s`: arc length of the front axle on C. During the
    change both lanes must see the ego, and the old one until the rear has left it.
    """
    width, lane_id = by.limits.width, by.here.lane_id
    change = next((c for c in by.plan.lane_changes if c.start <= s <= c.end + by.limits.length), None)
    lane = by.graph.lanes.get(lane_id)
    if change is None or lane is None or lane.is_internal:
        return None
    is_old = lane_id == change.from_lane or (lane_id != change.to_lane and s < 0.5 * (change.start + change.end))
    left, right = by.graph.neighbours(lane_id)
    other = left if (change.side > 0) is is_old else right
    if other is None:
        return None
    d = change.side * lane.spine.project(*by.front)[1]
    if not is_old and s > change.end and 0.5 * width - d < 0.5 * lane.width - OCCUPIED_LANE_M:
        return None
    return other if abs(d) <= abs(other.spine.project(*by.front)[1]) else lane


def lane_off_tracked(by: Occupant, s: float, stop: float = math.inf) -> tuple[Lane | None, bool]:
    """Return the lane beside the ego's that a long body covers in a bend, and whether only soon; None: there is none.

    The rear cuts to the inside of a bend, the front swings out of it. Who comes there from behind must see it before the
    body is across, but not while the ego means to `stop` before. `s`: arc length of the front axle on C, m.
    """
    graph, front = by.graph, s + by.limits.front_overhang
    rear, ahead = front - by.limits.length, max(min(front + by.ego.speed * OFF_TRACKING_SEEN_S, stop), front)
    for place in off_tracking_of(by.plan, graph, by.limits):
        if rear < place.end and place.start < ahead:
            beside = lane_at_side(graph, by.here.lane_id, place.left)
            lane = graph.lanes[place.lane_id] if beside is None and place.lane_id.startswith(":") else beside
            return lane, front < place.start
    return None, False


def is_stand_in(vehicle_id: str) -> bool:
    """Whether a vehicle id is a stand-in's."""
    return vehicle_id.startswith(PREFIX)


class StandIns:
    """At most one stand-in of the ego, created when it is needed and removed when it is not; `label` tells it from others.

    `made`: how many have been created. SUMO is told of it by `tell`.
    """

    def __init__(self, ego_id: str, label: str = "", tell: Tell = AT_ONCE) -> None:
        self.made = 0
        self._ego_id, self._tell = ego_id, tell
        self._name = f"{PREFIX}{ego_id}{label}"
        self._type = f"{PREFIX}type.{ego_id}{label}"
        self._present = ""
        self._edges: tuple[str, ...] = ()

    def show(self, place: OccupiedLane | None) -> None:
        """Put it where it has to be, or remove it where it need not be (None)."""
        if place is None:
            self.hide()
            return
        lane, x, y, speed, edges, waits, ways, is_early, fixed = place
        s, new = min(lane.spine.project(x, y)[0], lane.spine.length - _BEFORE_END_M), None
        if self._present and not lane.is_internal and lane.edge_id not in self._edges:
            self.hide()
        if not self._present:
            length = fixed or libsumo.vehicle.getLength(self._ego_id)
            if waits and _is_taken(lane, s / lane.scale, length):
                return
            if is_early and _is_forced(lane, s / lane.scale - length, speed):
                return
            if ways and not is_early and self._is_driven(lane.id, s / lane.scale):
                return
            if any(self._is_driven(way) for way in ways):
                return
            self.made += 1
            self._present, self._edges = f"{self._name}.{self.made}", edges
            starts_there = lane.edge_id == edges[0]  # from an internal lane it is moved there at once
            where = (str(lane.index), str(round(s / lane.scale, 2))) if starts_there else ("best", "0.0")
            new = _New(self._type, self.made == 1, edges, where, str(round(speed, 2)))
        at = (*lane.spine.at(s), angle_of(lane.spine.heading_at(s)))
        self._tell(_put, self._present, self._ego_id, new, fixed, speed, at, failed=self._is_gone)

    def hide(self) -> None:
        """Remove the stand-in, if there is one."""
        if self._present:
            self._tell(_remove, self._present, failed=nothing)  # SUMO may have taken it off the road already
            self._present = ""

    def _is_gone(self) -> None:
        """It has been taken off the road: the next step makes another; or its class may not be there."""
        self._present = ""

    def _is_driven(self, lane_id: str, end: float = math.inf) -> bool:
        """Whether somebody else than the ego moves on a lane before `end`, m on it, and on one before a junction is too near
        to stop there with half his usual braking."""
        vehicle, is_inside = libsumo.vehicle, end < math.inf or lane_id.startswith(":")
        for one in set(libsumo.lane.getLastStepVehicleIDs(lane_id)) - {self._ego_id}:
            speed, at = vehicle.getSpeed(one), vehicle.getLanePosition(one)
            braking_way = math.inf if is_inside else speed * speed / vehicle.getDecel(one)
            if speed > STANDING_SPEED and at < end and libsumo.lane.getLength(lane_id) - at < braking_way:
                return True
        return False


class _New(NamedTuple):
    """How a stand-in is made: its type, whether that is new; its edges; lane and position, speed, as SUMO's texts."""

    type_id: str
    is_first: bool
    edges: tuple[str, ...]
    where: tuple[str, str]
    speed: str


def _put(name: str, ego_id: str, new: _New | None, length: float, speed: float, at: tuple[float, float, float]) -> None:
    """Put a stand-in, made before if it is `new`, `at` x, y (m) and SUMO's angle; it is as long as told (m; 0: as the ego),
    and leaves as much before it to those who change lanes as the ego does."""
    vehicle = libsumo.vehicle
    if new is not None:
        _make(name, ego_id, new)
    if (length := length or vehicle.getLength(ego_id)) != vehicle.getLength(name):
        vehicle.setLength(name, length)
    if (gap := vehicle.getMinGap(ego_id)) != vehicle.getMinGap(name):
        vehicle.setMinGap(name, gap)
    vehicle.setSpeed(name, speed)
    vehicle.moveToXY(name, "", -1, *at, KEEP_ROUTE_EXACT)


def _make(name: str, ego_id: str, new: _New) -> None:
    if new.is_first:
        _make_type(new.type_id, ego_id)
    libsumo.route.add(name, new.edges)
    index, position = new.where
    libsumo.vehicle.add(
        name, name, new.type_id, depart="now", departLane=index, departPos=position, departSpeed=new.speed
    )
    libsumo.vehicle.setSpeedMode(name, 32)
    libsumo.vehicle.setLaneChangeMode(name, 0)


def _make_type(type_id: str, ego_id: str) -> None:
    kinds = libsumo.vehicletype
    kinds.copy(libsumo.vehicle.getTypeID(ego_id), type_id)
    kinds.setMaxSpeed(type_id, _NO_LIMIT)  # SUMO inserts no vehicle above its own limit
    kinds.setSpeedDeviation(type_id, 0.0)  # SUMO would draw for ever for a factor within its bounds
    kinds.setSpeedFactor(type_id, _SPEED_FACTOR)
    for device in _SILENT_DEVICES:
        kinds.setParameter(type_id, f"has.{device}.device", "false")


def _remove(name: str) -> None:
    libsumo.vehicle.remove(name, _VAPORIZED)


def _is_taken(lane: Lane, position: float, length: float) -> bool:
    """Whether somebody is on `lane` where a body of `length` m with its front at `position` (m) would be."""
    vehicle = libsumo.vehicle
    fronts = ((vehicle.getLanePosition(other), other) for other in libsumo.lane.getLastStepVehicleIDs(lane.id))
    return any(front > position - length and front - vehicle.getLength(other) < position for front, other in fronts)


def _is_forced(lane: Lane, rear: float, speed: float) -> bool:
    """Whether somebody behind `rear` (m) on `lane` would have to brake harder than he usually does for a body there at
    `speed` (m/s)."""
    vehicle, step = libsumo.vehicle, libsumo.simulation.getDeltaT()
    for other in libsumo.lane.getLastStepVehicleIDs(lane.id):
        own, usual, behind = vehicle.getSpeed(other), vehicle.getDecel(other), rear - vehicle.getLanePosition(other)
        if own < STANDING_SPEED or behind < 0.0:
            continue
        if vehicle.getFollowSpeed(other, own, behind - vehicle.getMinGap(other), speed, usual) < own - usual * step:
            return True
    return False
