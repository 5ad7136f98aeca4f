"""What a driver of the user's is told and what it answers: SI units, radians, SUMO's own ids; map coordinates in m."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple, Protocol, runtime_checkable

from sumo_reactive.driver.geometry.polyline import Points
from sumo_reactive.driver.nouns.state import Command, VehicleState
from sumo_reactive.driver.nouns.surroundings import Surroundings
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route


class Mission(NamedTuple):
    """What a driver is to do: drive the vehicle `ego` along a `route` to its end, in steps of `step_length` s.

    `way` (n, 2) joins the middles of the lanes that lead there, m; where lanes have to be changed it leaps to the one
    beside. `roads` is the map around the route.
    """

    ego: str
    route: Route
    limits: VehicleLimits
    step_length: float
    seed: int
    way: Points
    roads: RoadGraph


class _Seen(NamedTuple):
    """What a `DriverView` holds from the start; `look` finds its surroundings."""

    time: float
    state: VehicleState
    ego: RoadUser
    users: tuple[RoadUser, ...]
    look: Callable[[], Surroundings | None]


class DriverView(_Seen):
    """What a driver sees at `time` (s): its own `state`, itself and all `users` near as others see them, the lanes around.

    `surroundings` is None while SUMO has the ego on no lane. They are looked for when they are first asked for, which must
    be before the next step is simulated: DriverError later.
    """

    @cached_property
    def surroundings(self) -> Surroundings | None:
        """The lanes around, who is next on them, and the next light."""
        return self.look()


class LaneCommand(NamedTuple):
    """Stay on the road's rails: gain speed by `acceleration` (m/s²), go to the lane `number` of the edge (None: keep it).

    SUMO moves the vehicle along its lanes then. `is_checked`: SUMO's own checks (gaps, right of way, lights) may slow it.
    """

    acceleration: float
    number: int | None = None
    is_checked: bool = False


class Placement(NamedTuple):
    """Be there at the end of the step: middle of the front bumper (m), heading (rad), speed (m/s)."""

    x: float
    y: float
    heading: float
    speed: float


class Waypoint(NamedTuple):
    """A `Placement` at a simulation time (s)."""

    time: float
    x: float
    y: float
    heading: float
    speed: float


class MotionPlan(NamedTuple):
    """Pass these waypoints, in order of time, with straight motion in between; in force until another answer."""

    waypoints: tuple[Waypoint, ...]


DriverAnswer = Command | LaneCommand | Placement | MotionPlan | None
"""`Command`: hold acceleration (m/s²) and steering rate (rad/s) in the bicycle model. None: go on with the plan."""


class TripEnd(NamedTuple):
    """How the trip has ended: whether at the goal, and why."""

    arrived: bool
    reason: str


@runtime_checkable
class Driver(Protocol):
    """A driver: made with its options as keywords, started once, asked in every step, told the end.

    What it raises ends the trip as its failure. An attribute `reason` (text), if it has one, is kept of each step as what
    the driver says of why.
    """

    def start(self, mission: Mission) -> None:
        """Get ready to drive."""

    def step(self, view: DriverView) -> DriverAnswer:
        """Return what to do until the next step."""

    def end(self, result: TripEnd) -> None:
        """Hear how it ended."""
