"""The baseline: a trip with SUMO's own driver at the wheel, which is only watched."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.errors import NetworkError, SimulationError
from sumo_reactive.lab.metrics.moment import JUDGED_REACH_M
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.sumo.config import given_options, option_words
from sumo_reactive.sumo.net_reader import NetFile, read_net
from sumo_reactive.sumo.observed_vehicle import ObservedVehicle
from sumo_reactive.sumo.outputs import AS_READ, TripInfo, read_trips
from sumo_reactive.sumo.session import Session

PROFILE = "sumo"
"""Profile of a result whose ego SUMO's own driver has driven."""

TRIP_OUTPUT = "tripinfo-output"


class WatchedTrip:
    """A vehicle in the hands of SUMO's own driver, from departure to arrival, where nothing is commanded.

    The right of way is judged in the world around the edges that it has still to drive: it may take another route on its
    way. `time_loss` and `distance` are told by SUMO's `tripinfo` when all is over.
    """

    distance = time_loss = stopped = 0.0
    ghosts_made, is_placed, failure = 0, False, ""

    def __init__(self, session: Session, vehicle_id: str, net_file: Path, stuck_s: float) -> None:
        self._session, self._vehicle = session, ObservedVehicle(vehicle_id, JUDGED_REACH_M)
        self.id, self.limits, self.profile = vehicle_id, self._vehicle.limits, PROFILE
        self.departure, self.end = self._vehicle.departure, session.time
        self.arrived, self.stuck = False, ""
        self._world: RoadGraph | None = None
        self._moved, self._longest = session.time, stuck_s
        self._route: tuple[str, ...] = ()
        self._net: NetFile | None = None
        with contextlib.suppress(NetworkError):
            self._net = read_net(net_file)

    @property
    def figures(self) -> dict[str, float | int | None]:
        """How often SUMO has moved the vehicle out of a jam."""
        return {"teleports": self._vehicle.teleports}

    def command(self) -> None:
        """Leave all to SUMO."""

    def scene(self) -> Scene | None:
        """Return what there is to judge after a simulation step; None while SUMO has the vehicle off the road."""
        view, self.end = self._vehicle.look(), self._session.time
        self.arrived = self._vehicle.arrived
        if view is not None and view.own.speed >= STANDING_SPEED:
            self._moved = self.end
        if self.end - self._moved >= self._longest:
            self.stuck = f"stood still for {self._longest:g} s"
        if view is None:
            return None
        own = view.own
        self._follow(own.route)
        record = StepRecord(self.end, own.x, own.y, own.heading, own.speed, own.lane_id)
        others, apart = tuple(map(self._placed, view.others)), self._vehicle.junctions.are_apart
        return Scene(record, others, view.crossed, (), self.id, self._world, apart=apart)

    def arrive(self) -> bool:
        """Leave the arrival to SUMO."""
        return False

    def release(self) -> None:
        """Leave the vehicle where it is."""

    def _follow(self, route: tuple[str, ...]) -> None:
        """Have it judged in the world around the edges that the vehicle has still to drive."""
        if self._net is not None and route and self._route[-len(route) :] != route:
            self._route, self._world = route, self._net.build(route)

    def _placed(self, user: RoadUser) -> RoadUser:
        """Return a user with its position measured along the lane as the world has it, m."""
        lane = self._world.lanes.get(user.lane_id) if self._world else None
        return user if lane is None else user._replace(lane_position=user.lane_position * lane.scale)


def trip_output(sumo_options: Sequence[str], folder: Path) -> tuple[list[str], Path]:
    """Return options that make SUMO tell of unfinished trips, too, and the file that it writes: the user's, if asked for."""
    given = given_options(sumo_options)
    path = Path(given.get(TRIP_OUTPUT, folder / "trips.xml"))
    wanted = {TRIP_OUTPUT: str(path), f"{TRIP_OUTPUT}.write-unfinished": "true", **AS_READ}
    return option_words({name: value for name, value in wanted.items() if name not in given}), path


def as_told(results: Iterable[TrialResult], trips: Path) -> Iterator[TrialResult]:
    """Yield results with departure, arrival, time loss and way of the egos as SUMO's `tripinfo` tells them."""
    told = {trip.vehicle_id: trip for trip in read_trips(trips)}
    for result in results:
        if result.ego not in told:
            raise SimulationError(f"{trips}: SUMO tells no trip of ego '{result.ego}'")
        yield _as_told(result, told[result.ego])


def _as_told(result: TrialResult, trip: TripInfo) -> TrialResult:
    return replace(
        result,
        departure_s=result.departure_s if trip.departure is None else trip.departure,
        end_s=result.end_s if trip.arrival is None else trip.arrival,
        time_loss_s=trip.time_loss,
        distance_m=trip.length_m,
    )
