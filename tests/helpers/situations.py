"""The ego before a junction of the project's own networks, others placed by hand, and what the controller makes of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from pathlib import Path

from helpers.cars import BODY, CAR
from sumo_reactive.controller import Controller, Drive, Profile, Step
from sumo_reactive.messages.decision import StopAt
from sumo_reactive.messages.plan import NominalPlan
from sumo_reactive.messages.snapshot import Snapshot
from sumo_reactive.messages.state import Pose, VehicleState
from sumo_reactive.messages.traffic import RoadUser, Traffic
from sumo_reactive.perception.perceive import perceive
from sumo_reactive.pilot.memory import PilotMemory
from sumo_reactive.planner.planner import PlanStart, plan
from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.world.junction import Connection
from sumo_reactive.world.road_graph import RoadGraph
from sumo_reactive.world.route import Route, ScheduledStop

NETWORKS = Path(__file__).resolve().parents[2] / "networks"
PERIOD = 0.1
_read = lru_cache(maxsize=None)(read_net)


@cache
def graph_of(network: str, edges: tuple[str, ...]) -> RoadGraph:
    """Return the part of an own network that a route touches."""
    return _read(NETWORKS / network / f"{network}.net.xml").build(edges)


@dataclass(frozen=True, eq=False)
class Situation:
    """The ego on its route through the first junction; `lights` are the letters in force by light id."""

    graph: RoadGraph
    route: tuple[str, ...]
    ego: VehicleState
    plan: NominalPlan
    memory: PilotMemory = field(default_factory=PilotMemory)
    time: float = 100.0

    @property
    def line(self) -> float:
        """Arc length of the first stop line on C, m."""
        return self.plan.passages[0].start

    @property
    def connection(self) -> Connection:
        """The connection by which the ego passes the junction."""
        return self.graph.connections[self.plan.passages[0].connection_id]

    def other(self, name: str, lane_id: str, position: float, speed: float, route: tuple[str, ...], waiting=0.0) -> RoadUser:
        """Return a car whose front is `position` m along a lane; negative positions count from its end."""
        spine = self.graph.lanes[lane_id].spine
        at = position if position >= 0.0 else spine.length + position
        return RoadUser(name, *spine.at(at), spine.heading_at(at), speed, lane_id, at, BODY, route, waiting)

    def having_stood(self, seconds: float) -> Situation:
        """Return the situation of an ego that has made its full stop at the line, `seconds` ago."""
        memory = PilotMemory(standing_since=self.time - seconds, stopped_at=self.connection.id)
        return replace(self, memory=memory)

    def seen(self, *users: RoadUser, lights: dict[str, str] | None = None) -> Snapshot:
        """Return what the ego perceives."""
        return perceive(Traffic(self.time, users, lights or {}), self.ego, self.plan, self.graph, CAR, 0.0)

    def drive(self) -> Drive:
        """Return what the first step starts from."""
        return Drive(self.ego, self.plan, 0.0, self.memory)

    def step(self, *users: RoadUser, lights: dict[str, str] | None = None, drive: Drive | None = None, time=None) -> Step:
        """Return one control step of the default profile."""
        traffic = Traffic(self.time if time is None else time, users, lights or {})
        return Controller(self.graph, CAR).step(traffic, drive or self.drive(), PERIOD)

    def stop(self, *users: RoadUser, lights: dict[str, str] | None = None) -> StopAt | None:
        """Return the place where the pilot wants to stop, and why."""
        return self.step(*users, lights=lights).completed.stop

    def driven(self, seconds: float, *users: RoadUser, lights=None, profile=Profile.DEFAULT) -> list[Step]:
        """Return the control steps of `seconds` of driving past others that stand still."""
        controller, drive, steps = Controller(self.graph, CAR, profile), self.drive(), []
        for k in range(round(seconds / PERIOD)):
            steps.append(controller.step(Traffic(self.time + k * PERIOD, users, lights or {}), drive, PERIOD))
            drive = steps[-1].drive
        return steps


def before(
    network: str, route: tuple[str, ...], away: float, speed: float, lane: int = 0, stops: tuple[ScheduledStop, ...] = ()
) -> Situation:
    """Return the ego on `route`, its front bumper `away` m before the end of its first edge."""
    graph = graph_of(network, route)
    lane_id = f"{route[0]}_{lane}"
    spine = graph.lanes[lane_id].spine
    at = spine.length - away
    (x, y), heading, back = spine.at(at), spine.heading_at(at), CAR.front_to_rear_axle
    state = VehicleState(Pose(x - back * math.cos(heading), y - back * math.sin(heading), heading), speed, 0.0)
    start = PlanStart(state.pose, speed, 0.0, 100.0, lane_id, at, 0)
    return Situation(graph, route, state, plan(graph, Route(route, stops=stops), "passenger", CAR, start))
