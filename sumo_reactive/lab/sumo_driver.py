"""The baseline: the same trial with SUMO's own driver at the wheel, looked at by the same judges."""

from __future__ import annotations

import contextlib
import math
import tempfile
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.parameters import STANDING_SPEED, STUCK_S
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.errors import NetworkError, SimulationError
from sumo_reactive.lab.metrics import Jury
from sumo_reactive.lab.metrics.moment import JUDGED_REACH_M, Figures
from sumo_reactive.lab.result import Override, TrialResult
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.start import Started, started
from sumo_reactive.lab.trial import find_ego, versions
from sumo_reactive.sumo.config import given_options
from sumo_reactive.sumo.launch import passed_end
from sumo_reactive.sumo.net_reader import NetFile, read_net
from sumo_reactive.sumo.observed_vehicle import ObservedVehicle, VehicleScene
from sumo_reactive.sumo.outputs import AS_READ, TripInfo, trip_of
from sumo_reactive.sumo.session import Progress

Observer = Callable[[Scene], None]

PROFILE = "sumo"
"""Profile of a result whose ego SUMO's own driver has driven."""

TURN_S = 1.0
"""SUMO turns its cars by a jerk at each corner of a lane's line; their yaw rate is the mean over this time."""

TRIP_OUTPUT = "tripinfo-output"

_NOT_JUDGED = ("off_road_s", "emergencies", "emergency_s")
_NOT_JUDGED_KINDS = ("pilot_", "highway_code_", "events_")

_UNKNOWN = StepRecord(
    time=0.0, x=0.0, y=0.0, heading=0.0, speed=0.0, acceleration=0.0, steering_angle=0.0, lane_id="", s=0.0, d=0.0,
    command_acceleration=0.0, command_steering_rate=0.0, desired_speed=0.0, stop_s=math.nan, u=0.0, u1=0.0, u2=0.0, u3=0.0,
    leader="", gap=math.nan, behaviour="", instruction="", pilot=False, emergency=False, light="", control_us=0.0,
    decisions=(),
)  # fmt: skip
"""The record of a vehicle that has neither pilot nor executor."""


def run_sumo_driver(
    scenario: Scenario, *, observer: Observer | None = None, progress: Progress | None = None
) -> TrialResult:
    """Run the scenario in this process with the ego in SUMO's hands until it has arrived; return the judged result.

    SUMO is started as `run_trial` starts it. Departure, arrival, duration, distance and time loss are those of SUMO's
    `tripinfo` of the ego. What only this project's driver has is None among the figures, and so is the right of way in a
    network that cannot be read; one figure is added, how often SUMO has teleported the ego. Raises what `run_trial` raises.
    """
    with tempfile.TemporaryDirectory(prefix="sumo_reactive_") as folder:
        options, trips = _trip_output(scenario.sumo_options, Path(folder))
        with started(scenario, options) as start:
            watch = _watched(start, scenario, observer, progress)
            if scenario.until_end:
                start.session.play_out(scenario.end_after(watch.departure), progress)
        trip = trip_of(trips, watch.spectator.id)
        if trip is None:
            raise SimulationError(f"{trips}: SUMO tells no trip of ego '{watch.spectator.id}'")
        overrides = (*start.overrides, *passed_end(start.config, watch.end, scenario.sumo_options))
        return _result(scenario, watch, trip, overrides)


def _trip_output(sumo_options: Sequence[str], folder: Path) -> tuple[list[str], Path]:
    """Return options that make SUMO tell of unfinished trips, too, and the file that it writes: the user's, if asked for."""
    given = given_options(sumo_options)
    path = Path(given.get(TRIP_OUTPUT, folder / "trips.xml"))
    wanted = {TRIP_OUTPUT: str(path), f"{TRIP_OUTPUT}.write-unfinished": "true", **AS_READ}
    return [word for name, value in wanted.items() if name not in given for word in (f"--{name}", value)], path


class _World:
    """The roads around the ego's route, which the right of way is judged on; it may take another route on its way."""

    def __init__(self, net_file: Path, jury: Jury) -> None:
        self._jury = jury
        self._net: NetFile | None = None
        self._graph: RoadGraph | None = None
        self._route: tuple[str, ...] = ()
        with contextlib.suppress(NetworkError):
            self._net = read_net(net_file)

    @property
    def is_known(self) -> bool:
        """Whether the network could be read."""
        return self._net is not None

    def follow(self, route: tuple[str, ...]) -> None:
        """Judge in the world around the edges that the ego has still to drive."""
        if self._net is not None and route and self._route[-len(route) :] != route:
            self._route, self._graph = route, self._net.build(route)
            self._jury.enter(self._graph)

    def placed(self, user: RoadUser) -> RoadUser:
        """Return a user with its position measured along the lane as the world has it, m."""
        lane = self._graph.lanes.get(user.lane_id) if self._graph else None
        return user if lane is None else user._replace(lane_position=user.lane_position * lane.scale)


@dataclass
class _Watch:
    """What has been seen of a trip; times by SUMO's clock, s."""

    spectator: ObservedVehicle
    jury: Jury
    world: _World
    chosen: str
    step_length: float
    begin: float
    departure: float
    end: float
    ended: str = ""


def _watched(start: Started, scenario: Scenario, observer: Observer | None, progress: Progress | None) -> _Watch:
    """Judge the ego from its departure until it has arrived, stands (or is gone) too long, or the run ends."""
    session = start.session
    ego, chosen = find_ego(session, scenario, start.config, progress)
    spectator = ObservedVehicle(ego, JUDGED_REACH_M)
    limits = spectator.limits
    jury = Jury(limits.length, limits.width, limits.wheelbase)
    world = _World(start.config.net_file, jury)
    watch = _Watch(spectator, jury, world, chosen, session.step_length, start.begin, spectator.departure, session.time)
    until = scenario.end_after(watch.departure)
    moved, headings = session.time, deque[tuple[float, float]]()
    while not watch.ended:
        session.step()
        watch.end = session.time
        view = spectator.look()
        if view is not None:
            moved = watch.end if view.own.speed >= STANDING_SPEED else moved
            world.follow(view.own.route)
            scene = _scene(view, watch.end, headings, limits)
            jury.see(scene._replace(users=tuple(map(world.placed, scene.users))))
            if observer is not None:
                observer(scene)
        if progress is not None:
            progress(watch.end, "SUMO's own driver")
        watch.ended = _why_ended(spectator, watch.end, until, watch.end - moved)
    return watch


def _why_ended(spectator: ObservedVehicle, time: float, until: float | None, standing: float) -> str:
    """Return why the trip is over; empty: it is not."""
    if spectator.arrived:
        return "arrived"
    if until is not None and time >= until:
        return f"until {until:g} s"
    return f"stood still for {STUCK_S:g} s" if standing >= STUCK_S else ""


def _scene(view: VehicleScene, time: float, headings: deque[tuple[float, float]], limits: VehicleLimits) -> Scene:
    """Return the step of a car without wheels to steer: with the steering angle that its mean yaw rate would take."""
    own = view.own
    headings.append((time, own.heading))
    while time - headings[0][0] > TURN_S:
        headings.popleft()
    record = _UNKNOWN._replace(
        time=time, x=own.x, y=own.y, heading=own.heading, speed=own.speed, lane_id=own.lane_id,
        steering_angle=_steering_angle(own, time, headings[0], limits.wheelbase),
    )  # fmt: skip
    return Scene(record, view.others, view.crossed)


def _steering_angle(own: RoadUser, time: float, before: tuple[float, float], wheelbase: float) -> float:
    """Return φ of a car with heading `before[1]` at time `before[0]`: sin φ = L θ̇ / v, rad."""
    turn = (own.heading - before[1] + math.pi) % (2.0 * math.pi) - math.pi
    yaw_rate = turn / (time - before[0]) if time > before[0] else 0.0
    sine = yaw_rate * wheelbase / own.speed if own.speed >= STANDING_SPEED else 0.0
    return math.asin(min(1.0, max(-1.0, sine)))


def _result(scenario: Scenario, watch: _Watch, trip: TripInfo, overrides: tuple[Override, ...]) -> TrialResult:
    departure = watch.departure if trip.departure is None else trip.departure
    return TrialResult(
        scenario=str(scenario.source),
        ego=watch.spectator.id,
        chosen=watch.chosen,
        seed=scenario.seed,
        step_length_s=watch.step_length,
        profile=PROFILE,
        arrived=watch.spectator.arrived,
        ended=watch.ended,
        begin_s=watch.begin,
        departure_s=departure,
        end_s=watch.end if trip.arrival is None else trip.arrival,
        time_loss_s=trip.time_loss,
        distance_m=trip.length_m,
        figures=_figures(watch),
        timing={},
        collisions=watch.jury.collisions,
        violations=watch.jury.violations,
        hard_brakes=watch.jury.hard_brakes,
        overrides=overrides,
        versions=versions(),
    )


def _figures(watch: _Watch) -> Figures:
    """Return the judges' figures, None for what nobody judges where SUMO drives."""
    judged = watch.jury.figures()
    not_judged = _NOT_JUDGED if watch.world.is_known else (*_NOT_JUDGED, "right_of_way_violations")
    unknown = {name for name in judged if name in not_judged or name.startswith(_NOT_JUDGED_KINDS)}
    return {**judged, **dict.fromkeys(unknown), "teleports": watch.spectator.teleports}
