"""A trip with a driver of the user's at the wheel: its view, its answer, and what comes of it, judged like any other."""

from __future__ import annotations

import math
import time as clock
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from sumo_reactive.driver.geometry.polyline import Points, cut, joined
from sumo_reactive.driver.nouns.completed_plan import Intent
from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.nouns.state import STANDING_SPEED, Command, VehicleState
from sumo_reactive.driver.nouns.surroundings import Surroundings
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.path.lane_choice import LaneChoice, choose_lanes, lane_path
from sumo_reactive.errors import DriverError
from sumo_reactive.lab.drivers.answers import placed, plan_after, speed_after, steered
from sumo_reactive.lab.drivers.protocol import Driver, DriverAnswer, DriverView, LaneCommand, Mission, TripEnd, Waypoint
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.sumo.ego import Ego
from sumo_reactive.sumo.hand_over import LanesAround, move_on_lane
from sumo_reactive.sumo.net_reader import WorldSource
from sumo_reactive.sumo.observed_vehicle import ObservedVehicle, VehicleScene
from sumo_reactive.sumo.session import Session
from sumo_reactive.sumo.vehicle_type import front_of, pose_of

SEEN_REACH_M = 150.0
"""A driver sees who is nearer."""

_HERE = Path(__file__).parent
"""Frames of these files are left out of the traceback of the user's code."""

STEP_LIMIT_S = 10.0
"""A driver that takes longer for a step (wall clock) has failed."""


class UsersTrip:
    """An ego in the hands of a driver of the user's, which `make` makes, from take-over to arrival.

    Each simulation step is preceded by a `command` and followed by a `scene`. What the driver raises, or answers amiss, ends
    the trip: `stuck` says so in a line, `failure` holds the traceback of its code.
    """

    ghosts_made, stopped = 0, 0.0

    def __init__(
        self, session: Session, vehicle_id: str, net: WorldSource, scenario: Scenario, make: Callable[[], Driver]
    ) -> None:
        self._session = session
        self._ego = Ego(vehicle_id, scenario.parameters, says_arrival=session.says_arrivals)
        self._vehicle, self._lanes = ObservedVehicle(vehicle_id, SEEN_REACH_M), LanesAround(vehicle_id)
        self.id, self.limits, self.profile = vehicle_id, self._ego.limits, str(scenario.driver)
        self.departure, self.end = self._ego.departure, session.time
        self.arrived, self.stuck, self.failure = False, "", ""
        self.distance = self.time_loss = 0.0
        self._moved, self._longest = session.time, scenario.parameters.stuck_s
        self._graph = net.build(self._ego.route.edges)
        choice = choose_lanes(self._graph, self._ego.route, self.limits.vehicle_class)
        self._duration = session.step_length
        self._state = self._ego.take_over(self._duration)
        self._plan: tuple[Waypoint, ...] = ()
        self.is_placed = False
        self._control_us = 0.0
        self._view: DriverView | None = None
        seen = self._vehicle.look()
        assert seen is not None  # the ego has just been found on a lane
        self._own, self._users = seen.own, seen.others
        way = middle_of_the_lanes(choice, seen.own)
        mission = Mission(vehicle_id, self._ego.route, self.limits, self._duration, scenario.seed, way, self._graph)
        self._driver: Driver | None = None
        with self._blamed():
            self._driver = make()
            self._driver.start(mission)

    def view(self) -> DriverView:
        """Return what the driver sees now, looked at once a step."""
        if self._view is None:
            self._view = DriverView(self.end, self._state, self._own, self._users, partial(self._surroundings, self.end))
        return self._view

    def _surroundings(self, time: float) -> Surroundings | None:
        """Return what is around along the lanes, which SUMO knows of the present alone."""
        if time != self.end:
            raise DriverError(f"asked at {self.end:.1f} s for the surroundings at {time:.1f} s, which are past")
        return self._lanes.look(self._own.lane_id, self._own.lane_position)

    def command(self) -> None:
        """Ask the driver, and have the ego where it says at the end of the next simulation step."""
        if self._driver is None or self.failure:
            return
        try:  # as `_blamed`, which takes longer than all the rest
            view, began = self.view(), clock.perf_counter()
            answer = self._driver.step(view)
            took = clock.perf_counter() - began
            self._control_us = 1e6 * took
            if took > STEP_LIMIT_S:
                raise DriverError(f"took {took:.1f} s for a step, more than {STEP_LIMIT_S:g} s")
            self._carry_out(answer)
        except (Exception, SystemExit) as error:
            self._blame(error)

    def scene(self) -> Scene | None:
        """Return what there is to judge after a simulation step; None while SUMO has the vehicle off the road."""
        seen, self.end, self._view = self._vehicle.look(), self._session.time, None
        self.arrived = self._vehicle.arrived
        if self.failure:
            self.stuck = f"driver '{self.profile}' failed at {self.end:.1f} s: {self.failure.splitlines()[-1]}"
        if seen is None and self.is_placed and not self.arrived:
            seen = VehicleScene(self._off_the_road(), (), "")
        if seen is None:
            self._own = self._own._replace(lane_id="")
            return None
        self._follow(seen.own)
        self._users = seen.others
        own, angle = seen.own, self._state.steering_angle if self.is_placed else None
        record = StepRecord(
            self.end, own.x, own.y, own.heading, own.speed, own.lane_id, self._state.acceleration, angle,
            control_us=self._control_us, reason=str(getattr(self._driver, "reason", "")),
        )  # fmt: skip
        apart = self._vehicle.junctions.are_apart
        return Scene(record, seen.others, seen.crossed, (), self.id, self._graph, apart=apart)

    def arrive(self) -> bool:
        """Take the ego off the road if it has reached its goal where it was put; SUMO has those arrive that it moves."""
        at_goal = self.is_placed and self._left() <= max(self._own.speed, 0.0) * self._duration
        if at_goal and not self.arrived:
            self._vehicle.leave()
            self._ego.arrive()
        self.arrived = self.arrived or at_goal
        if self.arrived:
            self._farewell("arrived")
        return at_goal

    def release(self) -> None:
        """Give the ego back to SUMO's own driver."""
        self._farewell(self.stuck or "the run has ended")
        self._ego.release()

    @property
    def figures(self) -> dict[str, float | int | None]:
        """What only such a driver tells beside the judges: nothing."""
        return {}

    def _off_the_road(self) -> RoadUser:
        """Return the ego where it has been put, beside all roads: SUMO does not look for it there."""
        pose, (x, y) = self._state.pose, front_of(self._state.pose, self.limits)
        gain = self._state.acceleration
        return self._own._replace(x=x, y=y, heading=pose.heading, speed=self._state.speed, lane_id="", acceleration=gain)

    def _follow(self, own: RoadUser) -> None:
        """Count the way, and take the state over that SUMO has brought about, or check that it is as commanded."""
        self.distance += math.dist((self._own.x, self._own.y), (own.x, own.y))
        self.time_loss = self._ego.time_loss()
        if self.is_placed:
            self._ego.lane(self._state)
        else:
            gain = (own.speed - self._state.speed) / self._duration
            self._state = VehicleState(pose_of(own.x, own.y, own.heading, self.limits), own.speed, 0.0, gain)
        self._own = own
        if own.speed >= STANDING_SPEED:
            self._moved = self.end
        if self.end - self._moved >= self._longest:
            self.stuck = self.stuck or f"stood still for {self._longest:g} s"

    def _left(self) -> float:
        """Return the way that the front has left to the goal, m; infinite before the last edge."""
        lane, route = self._graph.lanes.get(self._own.lane_id), self._ego.route
        if lane is None or lane.edge_id != route.edges[-1]:
            return math.inf
        goal = lane.length if route.arrival_position is None else route.arrival_position
        return (goal - self._own.lane_position) * lane.scale

    def _carry_out(self, answer: DriverAnswer) -> None:
        duration = self._duration
        if isinstance(answer, LaneCommand):
            speed = speed_after(answer, self._own.speed, self.limits, duration)
            self.is_placed = False
            move_on_lane(self.id, speed, answer.number, duration, is_checked=answer.is_checked)
            return
        if isinstance(answer, Command):
            self._state, self._plan = steered(answer, self._state, self.limits, duration), ()
        else:
            time = self.end + duration
            self._plan = plan_after(answer, self._plan, time)
            self._state = placed(self._plan, self._state, self.limits, time, duration)
        self.is_placed = True
        self._ego.place(self._state, Intent.DRIVE, duration, None)

    def _farewell(self, reason: str) -> None:
        driver, self._driver = self._driver, None
        if driver is not None:
            with self._blamed():
                driver.end(TripEnd(self.arrived, reason))

    @contextmanager
    def _blamed(self) -> Iterator[None]:
        """Keep what the driver's code raises as its failure."""
        try:
            yield
        except (Exception, SystemExit) as error:  # whatever the user's code raises is told, and is no fault of this program
            self._blame(error)

    def _blame(self, error: BaseException) -> None:
        """Keep what was raised, with the frames of the user's code, unless something was before."""
        own = (frame for frame in traceback.extract_tb(error.__traceback__) if Path(frame.filename).parent != _HERE)
        told = str(error) if isinstance(error, DriverError) else "".join(traceback.format_exception_only(error)).strip()
        self.failure = self.failure or "".join((*traceback.format_list([*own]), told))


def middle_of_the_lanes(choice: LaneChoice, own: RoadUser) -> Points:
    """Return the middles of the lanes from where a car is to the end of its route, (n, 2), m."""
    graph, lane = choice.graph, choice.graph.lanes[own.lane_id]
    parts: list[Points] = []
    if lane.is_internal:
        connection = graph.connection_of[lane.id]
        parts.append(connection.path.points)
        lane, at = graph.lanes[connection.to_lane], 0.0
    else:
        at = own.lane_position
    number = choice.stage_at(next(k for k, stage in enumerate(choice.stages) if lane in stage.lanes))
    for step in lane_path(choice, number, lane.index, at):
        driven = step.lanes[-1]
        parts.append(cut(driven.spine, step.start * driven.scale, step.stage.end * driven.scale))
        parts += [step.connection.path.points] if step.connection is not None else []
    return joined(parts)
