"""The ego inside SUMO: take-over, placing, verification, arrival, release."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import libsumo

from sumo_reactive.driver.geometry.polyline import wrapped
from sumo_reactive.driver.nouns.completed_plan import Intent
from sumo_reactive.driver.nouns.state import STANDING_SPEED, VehicleState
from sumo_reactive.driver.parameters import USUAL, Parameters
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route, ScheduledStop
from sumo_reactive.errors import ScenarioError, SimulationError
from sumo_reactive.sumo.orders import AT_ONCE, Tell, nothing
from sumo_reactive.sumo.stand_ins import is_stand_in
from sumo_reactive.sumo.vehicle_type import (
    FREE_EXACT,
    KEEP_ROUTE_EXACT,
    NOT_ROAD_CARS,
    angle_of,
    arrival_of,
    front_of,
    heading_of,
    limits_of,
    pose_of,
)

TELEPORT_GUARD_S = 5.0
"""The ego ends its waiting time this long before SUMO would teleport it."""

_REMOVE_ARRIVED = 2
_GO_NEXT_SPEED = 0.05
"""m/s; at an all-way stop it says "I go next"."""

_NO_CHANGES = 0
_ASK_FOR_ROOM = 513
"""SUMO's mode of lane changing: it wants the changes that the route needs, and respects the others' gaps."""

_BRAKING_TOLERANCE = 0.1
"""m/s²; the ego brakes harder than its type says if it does by more than this."""

_AT_END_M = 0.05
"""A front this near to the end of its lane, or past it, is at it."""

_SAME_LANE_M = 0.1
"""SUMO looks for leaders beyond the lane so far: hardly at all, which is cheap."""

_BEFORE_END_M = 0.005
"""What stands on the end of its lane is put this far before it: at the end itself SUMO has it in the junction, where it
would keep off others while it waits at red."""

_IGNORED = "junctionModel.ignoreIDs"
"""SUMO's parameter of a vehicle: ids, with spaces between, of those for whom it does not wait inside junctions."""

_LEFT_SHARE = 0.5
"""Of the gap in which the ego stands behind others, so much is enough for SUMO to have one change lanes into it."""

_NUDGE_SPEED = 0.2
"""m/s; announced for one step, with the pose frozen, it ends SUMO's count of waiting time before a teleport."""


def give_back(vehicle_id: str, gap: float | None = None) -> None:
    """Leave a vehicle to SUMO's own driver, with another `gap` (m) if one is given."""
    if gap is not None:
        libsumo.vehicle.setMinGap(vehicle_id, gap)
    libsumo.vehicle.setSpeed(vehicle_id, -1.0)
    libsumo.vehicle.setSpeedMode(vehicle_id, 31)
    libsumo.vehicle.setLaneChangeMode(vehicle_id, 1621)


class _Put(NamedTuple):
    """Where an ego is to be: announced speed (m/s); gap (m) and deceleration (m/s²) told of it, None: as before; edge, lane
    index, x, y (m), SUMO's angle and mode."""

    speed: float
    gap: float | None
    deceleration: float | None
    place: tuple[str, int, float, float, float, int]


class Ego:
    """One vehicle of a running simulation, moved from outside.

    `passing`: whom it passes on its lane, while SUMO has it behind him (empty: nobody). SUMO is told of it by `tell`.
    """

    def __init__(
        self, vehicle_id: str, parameters: Parameters = USUAL, *, says_arrival: bool = True, tell: Tell = AT_ONCE
    ) -> None:
        vehicle_class = libsumo.vehicle.getVehicleClass(vehicle_id)
        if vehicle_class in NOT_ROAD_CARS:
            raise ScenarioError(f"ego '{vehicle_id}' is not a road car: its class is '{vehicle_class}'")
        self.id, self._tell = vehicle_id, tell
        self.limits: VehicleLimits = limits_of(vehicle_id, parameters)
        self.departure = float(libsumo.vehicle.getDeparture(vehicle_id))
        self.speed_factor: float = libsumo.vehicle.getSpeedFactor(vehicle_id)
        self._refuse_oncoming_side()
        self.route = self._read_route(says_arrival)
        self._standing = 0.0
        self._unmapped = self._was_unmapped = False
        self.passing = ""
        self._let_go = set[str]()
        self._trusted_deceleration = float(libsumo.vehicle.getApparentDecel(vehicle_id))
        self._brakes_hard = False
        self._asks = False
        self._leaves_by: Lane | None = None
        self._min_gap = float(libsumo.vehicle.getMinGap(vehicle_id))
        self._told_gap = self._min_gap
        self._teleport_after = float(libsumo.simulation.getOption("time-to-teleport"))

    def take_over(self, step_length: float) -> VehicleState:
        """Take the wheel at SUMO's exact pose and speed; return that state."""
        self._tell(_take_over, self.id, step_length)
        return self.observed()

    def observed(self) -> VehicleState:
        """Return the state that SUMO reports, the wheels straight."""
        x, y = libsumo.vehicle.getPosition(self.id)
        heading = heading_of(libsumo.vehicle.getAngle(self.id))
        return VehicleState(pose_of(x, y, heading, self.limits), max(0.0, libsumo.vehicle.getSpeed(self.id)), 0.0)

    def laid_along(self, lane: Lane, state: VehicleState) -> VehicleState:
        """Return the `state` of an ego that SUMO has just inserted, its body along its lane if it could not be steered back
        there within the lane; any other as it is.

        While the rear would be before the start of the lane, SUMO shows an angle up to 95° off. Its speed there is in the
        lane's own metres; from here on it is that over ground, also where it is announced: else the others would see the ego
        brake or speed up at once from lane to lane.
        """
        state = state if lane.scale == 1.0 else state._replace(speed=state.speed * lane.scale)
        front, own = float(libsumo.vehicle.getLanePosition(self.id)) * lane.scale, self.limits
        if not self._hangs_over(front):
            return state
        (x, y), (sx, sy), start = lane.spine.at(front), lane.spine.at(0.0), lane.spine.heading_at(0.0)
        back = own.length - front
        heading = math.atan2(y - sy + back * math.sin(start), x - sx + back * math.cos(start))
        turned = wrapped(state.pose.heading - heading)
        drifts = (turned * state.speed) ** 2 > own.max_lateral_acceleration * (lane.width - own.width)  # v²ε²/2a to the side
        if not drifts and abs(turned) < 0.5 * math.pi:
            return state
        return state._replace(pose=pose_of(*front_of(state.pose, own), heading, own))

    def _hangs_over(self, front: float) -> bool:
        """Whether SUMO has just inserted the ego with its front `front` m behind the start of a lane, its rear before it."""
        length = self.limits.length
        return front < length and float(libsumo.vehicle.getDistance(self.id)) < length

    def place(
        self, state: VehicleState, intent: Intent, duration: float, lane: Lane | None, is_told: bool = False,
        follow: Callable[[], None] = nothing,
    ) -> None:  # fmt: skip
        """Announce the intent and command the state that the next simulation step ends in.

        `lane`: where C is there, None while it leads beside its lane; `is_told`: SUMO would not find the ego on it.
        `follow` may tell SUMO another route, in whose lanes it then looks for the ego.

        SUMO maps the ego to a lane of its route. Where it finds none, though the ego is on one (several connections
        between the same two edges), it is told the lane, until the ego is out of the junction, and where another road of
        its route lies over this one; but not where the front swings out of that lane: SUMO would take it for on another
        road, lose its route and, with sublanes, crash.
        """
        self._unmapped |= is_told and (lane is None or lane.is_internal)
        if lane is not None and not lane.is_internal:
            self._leaves_by = lane
        x, y = front_of(state.pose, self.limits)
        for lane_id, position in (*self._in_order(is_aside=lane is None), *self._connected(x, y)):
            self._tell(_move_to, self.id, lane_id, position)
        follow()
        gap, braking = self._left_gap(stands=state.speed < STANDING_SPEED), self._expected_braking(-state.acceleration)
        edge, index, mode = "", -1, KEEP_ROUTE_EXACT
        if lane is not None and (is_told or self._unmapped) and lane.reaches(x, y, self.limits.width):
            edge, index, mode = lane.edge_id, lane.index, FREE_EXACT
        if state.speed <= 0.0 and self._is_on_line():
            x, y = x - _BEFORE_END_M * math.cos(state.pose.heading), y - _BEFORE_END_M * math.sin(state.pose.heading)
        place = edge, index, x, y, angle_of(state.pose.heading), mode
        self._tell(_put, self.id, _Put(self._announced(state.speed, intent, duration), gap, braking, place))

    def let_go(self, users: tuple[str, ...]) -> None:
        """Let these go first in a junction although they would wait for the standing ego, and nobody else any more."""
        for user in sorted(self._let_go.symmetric_difference(users)):  # who has left SUMO does not know any more
            self._tell(_heed if user in self._let_go else _ignore, user, self.id, failed=nothing)
        self._let_go = set(users)

    def _is_on_line(self) -> bool:
        """Whether SUMO has the front on the end of a lane before a junction, to less than the ego may be put amiss."""
        lane_id = libsumo.vehicle.getLaneID(self.id)
        if not lane_id or lane_id.startswith(":"):
            return False
        return bool(libsumo.vehicle.getLanePosition(self.id) > libsumo.lane.getLength(lane_id) - 2.0 * _BEFORE_END_M)

    def _connected(self, x: float, y: float) -> tuple[tuple[str, float], ...]:
        """Return the lane that C leaves by, and a position on it, where SUMO has the ego on another lane of the edge though
        the front, to be at (x, y), passes the end.

        From that other lane SUMO finds no connection to where the ego goes on: it would stop it for a step, for all behind
        it to see. Where others drive on the lane, it is left at that: who sees the ego appear would brake as hard.
        """
        vehicle, lane = libsumo.vehicle, self._leaves_by
        mapped = vehicle.getLaneID(self.id)
        if lane is None or mapped == lane.id or mapped.rpartition("_")[0] != lane.edge_id:
            return ()
        ahead = vehicle.getRoute(self.id)[vehicle.getRouteIndex(self.id) + 1 :][:1]
        if not any(link[0].rpartition("_")[0] in ahead for link in libsumo.lane.getLinks(lane.id)):
            return ()  # C is still about to change away from it
        is_past = lane.spine.project(x, y)[0] > lane.spine.length - _AT_END_M
        if is_past and all(is_stand_in(one) for one in libsumo.lane.getLastStepVehicleIDs(lane.id)):
            return ((lane.id, min(vehicle.getLanePosition(self.id), libsumo.lane.getLength(lane.id))),)
        return ()

    def _in_order(self, *, is_aside: bool) -> tuple[tuple[str, float], ...]:
        """Return by which lane SUMO sorts the ego in anew where it has passed somebody on its lane, as soon as he need not
        brake for it; and behind him until then, where SUMO comes to see it on its lane again.

        SUMO keeps the vehicles of a lane in the order in which they came and does not look whether one that is moved from
        outside has passed another: who has been passed would go on without a leader, and drive into the ego. Only a move
        over another lane sorts it in. `is_aside`: it leaves its lane to pass.
        """
        vehicle, lane_id, is_back = libsumo.vehicle, libsumo.vehicle.getLaneID(self.id), self._was_unmapped
        is_on_road = bool(lane_id) and not lane_id.startswith(":")
        self._was_unmapped = not lane_id
        other, gap = vehicle.getLeader(self.id, _SAME_LANE_M) or ("", 0.0)  # looks no farther than that beyond the lane
        is_next = is_on_road and bool(other) and vehicle.getLaneID(other) == lane_id
        self.passing = other if is_next and (is_aside or gap < -self._told_gap) else ""
        has_passed = is_next and gap <= -self.limits.length
        if not is_on_road or not (is_back or has_passed):
            return ()
        position, others = vehicle.getLanePosition(self.id), libsumo.lane.getLastStepVehicleIDs(lane_id)
        near = [vehicle.getLanePosition(one) for one in others if self._is_near_behind(one, position)]
        over = self._another_lane() if bool(near) is not has_passed else ""
        if not over:
            return ()
        self.passing = ""
        return (over, 0.0), (lane_id, max(0.0, min(near) - _BEFORE_END_M) if near else position)

    def _is_near_behind(self, other: str, position: float) -> bool:
        """Whether somebody on the lane is behind the front of the ego, at `position` (m), and would have to brake for it."""
        vehicle, at = libsumo.vehicle, libsumo.vehicle.getLanePosition(other)
        gap = position - self.limits.length - at - vehicle.getMinGap(other)
        is_slower = vehicle.getSpeed(self.id) < vehicle.getSpeed(other)
        return bool(at < position and gap <= (0.0 if is_slower else vehicle.getSpeed(other) * vehicle.getTau(other)))

    def _another_lane(self) -> str:
        """Return a lane of the route's next edge or the one before; empty when there is no other edge."""
        edges, index = libsumo.vehicle.getRoute(self.id), libsumo.vehicle.getRouteIndex(self.id)
        other = edges[index + 1] if index + 1 < len(edges) else edges[index - 1] if index > 0 else ""
        return f"{other}_{libsumo.edge.getLaneNumber(other) - 1}" if other else ""

    def ask_for_room(self, wants_room: bool) -> None:
        """Let the others know whether the ego seeks a gap on the lane that its route needs, as a driver who indicates.

        SUMO's cars then make room as they do for each other. SUMO itself changes no lanes for a vehicle moved from outside.
        """
        if wants_room != self._asks:
            self._asks = wants_room
            self._tell(_set_lane_change_mode, self.id, _ASK_FOR_ROOM if wants_room else _NO_CHANGES)

    def _announced(self, speed: float, intent: Intent, duration: float) -> float:
        if speed >= STANDING_SPEED:
            self._standing = 0.0
            return speed
        self._standing += duration
        if 0.0 < self._teleport_after < self._standing + TELEPORT_GUARD_S:
            self._standing = 0.0
            return _NUDGE_SPEED
        if intent is Intent.GO_NEXT:
            return _GO_NEXT_SPEED
        return 0.0 if intent is Intent.YIELD else max(speed, 0.0)

    def _left_gap(self, *, stands: bool) -> float | None:
        """Return another gap (m) for SUMO to take for large enough to change lanes into before the ego: standing, it is
        nearer behind others than SUMO's cars are, and one whose lane ends there would wait for it to go as it waits for
        him."""
        gap = min(self._min_gap, _LEFT_SHARE * self.limits.standstill_gap) if stands else self._min_gap
        if gap == self._told_gap:
            return None
        self._told_gap = gap
        return gap

    def _expected_braking(self, braking: float) -> float | None:
        """Return other braking (m/s²) for those behind to expect: the hardest while the ego brakes harder than its type
        says, and else what they expect of any vehicle of the type: SUMO's cars choose their gaps behind the ego, when they
        change lanes and enter the road, by the type's, and would brake hard as soon as they find that the ego can do more.
        """
        hard = braking > self._trusted_deceleration + _BRAKING_TOLERANCE
        if hard == self._brakes_hard:
            return None
        self._brakes_hard = hard
        return max(self._trusted_deceleration, self.limits.emergency_deceleration if hard else 0.0)

    def lane(self, state: VehicleState) -> str:
        """Return the lane that SUMO maps the ego to ('' : none), after checking that it is where it was put."""
        x, y = front_of(state.pose, self.limits)
        try:
            px, py = libsumo.vehicle.getPosition(self.id)
        except libsumo.TraCIException as error:
            raise SimulationError(f"SUMO has taken ego '{self.id}' off the road: {error}") from error
        if math.hypot(px - x, py - y) > 0.01:
            raise SimulationError(f"SUMO moved ego '{self.id}' to ({px:.2f}, {py:.2f}) instead of ({x:.2f}, {y:.2f})")
        if float(libsumo.vehicle.getSpeed(self.id)) < state.speed - STANDING_SPEED:
            self._keep_speed(state)
        lane_id = str(libsumo.vehicle.getLaneID(self.id))
        if not lane_id:
            self._unmapped = True
        elif self._unmapped and not lane_id.startswith(":"):
            self._unmapped = False
            self._restore_route(lane_id.rpartition("_")[0])
        return lane_id

    def _keep_speed(self, state: VehicleState) -> None:
        """Have the others see the ego's speed where SUMO has stopped it for a step: it finds no way on from the end of the
        lane that it has the ego on, though the ego is past it. Whoever follows would brake as for a standing car."""
        self._tell(_set_previous_speed, self.id, state.speed, state.acceleration)

    def reroute(self, route: Route) -> None:
        """Take another route, which begins on the edge that the ego is on, and tell SUMO."""
        self.route = route
        self._tell(_set_route, self.id, route.edges)

    def _restore_route(self, edge_id: str) -> None:
        """Give SUMO the route again, from `edge_id` on, if telling it the lane has replaced it."""
        edges = self.route.edges
        left = tuple(libsumo.vehicle.getRoute(self.id))[max(0, libsumo.vehicle.getRouteIndex(self.id)) :]
        if edge_id in edges and left != edges[len(edges) - len(left) :]:
            self._tell(_set_route, self.id, edges[edges.index(edge_id) :])

    def lane_position(self, graph: RoadGraph, lane_id: str) -> float:
        """Return the front's arc length on the spine of its lane, m."""
        return float(libsumo.vehicle.getLanePosition(self.id)) * graph.lanes[lane_id].scale

    def time_loss(self) -> float:
        """Return SUMO's count of the time lost by driving slower than possible, s."""
        return float(libsumo.vehicle.getTimeLoss(self.id))

    def arrive(self) -> None:
        """Take the ego off the road as arrived, so that SUMO's outputs hold its trip."""
        self.let_go(())
        self._tell(_remove, self.id)

    def release(self) -> None:
        """Give the ego back to SUMO's own driver."""
        self.let_go(())
        self._tell(give_back, self.id, self._left_gap(stands=False))

    def _refuse_oncoming_side(self) -> None:
        lane_id = libsumo.vehicle.getLaneID(self.id)
        if not lane_id:
            raise ScenarioError(f"ego '{self.id}' is on no lane at {libsumo.simulation.getTime():.1f} s")
        position = float(libsumo.vehicle.getLanePosition(self.id))
        if self._hangs_over(position):
            return
        along = heading_of(libsumo.lane.getAngle(lane_id, position))
        if math.cos(along - heading_of(libsumo.vehicle.getAngle(self.id))) < 0.0:
            place = f"on the oncoming side of lane '{lane_id}'"
            raise ScenarioError(f"ego '{self.id}' is {place}; it cannot be taken over there")

    def _read_route(self, says_arrival: bool) -> Route:
        index = max(0, libsumo.vehicle.getRouteIndex(self.id))
        position, lane = arrival_of(self.id) if says_arrival else (None, None)
        edges = tuple(libsumo.vehicle.getRoute(self.id)[index:])
        if position is not None and position < 0.0:  # counted from the end of the lane
            position = max(0.0, position + float(libsumo.lane.getLength(f"{edges[-1]}_0")))
        return Route(edges, position, lane, tuple(_stop(s) for s in libsumo.vehicle.getStops(self.id) if s.lane))


def _stop(data: Any) -> ScheduledStop:
    """Turn SUMO's stop data into a scheduled stop; a stop without duration or end lasts no time."""
    until = float(data.until)
    return ScheduledStop(data.lane, float(data.endPos), max(float(data.duration), 0.0), until if until > 0.0 else None)


def _take_over(vehicle_id: str, step_length: float) -> None:
    vehicle = libsumo.vehicle
    vehicle.setSpeedMode(vehicle_id, 32)
    vehicle.setLaneChangeMode(vehicle_id, _NO_CHANGES)
    vehicle.setActionStepLength(vehicle_id, step_length, True)
    while vehicle.getStops(vehicle_id):
        if vehicle.isStopped(vehicle_id):
            vehicle.resume(vehicle_id)
        else:
            vehicle.replaceStop(vehicle_id, 0, "")
    with contextlib.suppress(libsumo.TraCIException):  # no rerouting device
        vehicle.setParameter(vehicle_id, "device.rerouting.period", "0")


def _move_to(vehicle_id: str, lane_id: str, position: float) -> None:
    libsumo.vehicle.moveTo(vehicle_id, lane_id, position)


def _put(vehicle_id: str, put: _Put) -> None:
    vehicle = libsumo.vehicle
    if put.gap is not None:
        vehicle.setMinGap(vehicle_id, put.gap)
    vehicle.setSpeed(vehicle_id, put.speed)
    if put.deceleration is not None:
        vehicle.setApparentDecel(vehicle_id, put.deceleration)
    vehicle.moveToXY(vehicle_id, *put.place)


def _ignore(user: str, ego_id: str) -> None:
    ignored = libsumo.vehicle.getParameter(user, _IGNORED)
    libsumo.vehicle.setParameter(user, _IGNORED, f"{ignored} {ego_id}".strip())


def _heed(user: str, ego_id: str) -> None:
    ignored = libsumo.vehicle.getParameter(user, _IGNORED).split()
    libsumo.vehicle.setParameter(user, _IGNORED, " ".join(one for one in ignored if one != ego_id))


def _set_lane_change_mode(vehicle_id: str, mode: int) -> None:
    libsumo.vehicle.setLaneChangeMode(vehicle_id, mode)


def _set_previous_speed(vehicle_id: str, speed: float, acceleration: float) -> None:
    libsumo.vehicle.setPreviousSpeed(vehicle_id, speed, acceleration)


def _set_route(vehicle_id: str, edges: tuple[str, ...]) -> None:
    libsumo.vehicle.setRoute(vehicle_id, edges)


def _remove(vehicle_id: str) -> None:
    libsumo.vehicle.remove(vehicle_id, _REMOVE_ARRIVED)
