"""The ego before a junction of the project's own networks, others placed by hand, and what the controller makes of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from pathlib import Path

from helpers.cars import BODY, CAR
from sumo_reactive.driver.controller import Controller, Drive, Step
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Instruction
from sumo_reactive.driver.nouns.event import Event
from sumo_reactive.driver.nouns.forecast import Outlook
from sumo_reactive.driver.nouns.plan import Aside, NominalPlan
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import Pose, VehicleState
from sumo_reactive.driver.nouns.traffic import RoadUser, Traffic
from sumo_reactive.driver.parameters import Delays, Profile
from sumo_reactive.driver.path.planner import PlanStart, plan
from sumo_reactive.driver.pilot import situation as pilot
from sumo_reactive.driver.pilot.assessment import assess
from sumo_reactive.driver.pilot.behaviours.overtaking import try_out
from sumo_reactive.driver.pilot.memory import Overtaking, PilotMemory
from sumo_reactive.driver.pilot.passages import View, crossings
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.view.ahead import passages_ahead
from sumo_reactive.driver.view.attention import foes_of
from sumo_reactive.driver.view.outlook import outlook
from sumo_reactive.driver.view.perceive import locate, perceive
from sumo_reactive.driver.world.junction import Connection
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route, ScheduledStop
from sumo_reactive.sumo.net_reader import read_net

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
    limits: VehicleLimits = CAR

    @property
    def line(self) -> float:
        """Arc length of the first stop line on C, m."""
        return self.plan.passages[0].start

    @property
    def connection(self) -> Connection:
        """The connection by which the ego passes the junction."""
        return self.graph.connections[self.plan.passages[0].connection_id]

    def other(
        self, name: str, lane_id: str, position: float, speed: float, route: tuple[str, ...], waiting=0.0, halted=False
    ) -> RoadUser:
        """Return a car whose front is `position` m along a lane; negative positions count from its end."""
        spine = self.graph.lanes[lane_id].spine
        at = position if position >= 0.0 else spine.length + position
        return RoadUser(name, *spine.at(at), spine.heading_at(at), speed, lane_id, at, BODY, route, waiting, halted)

    def ahead(self, name: str, gap: float, speed: float, halted: bool = False) -> RoadUser:
        """Return a car on the ego's lane whose rear is `gap` m before the ego's bumper; `gap` < 0: it drives behind."""
        lane_id = self.plan.segments[0].lane_id
        front = self.graph.lanes[lane_id].spine.project(*self._front())[0] + gap + BODY.length
        return self.other(name, lane_id, front, speed, self.route, 30.0 if halted else 0.0, halted)

    def _front(self) -> tuple[float, float]:
        p, reach = self.ego.pose, self.limits.front_to_rear_axle
        return p.x + reach * math.cos(p.heading), p.y + reach * math.sin(p.heading)

    def later(self, user: RoadUser, seconds: float) -> RoadUser:
        """Return a car that has kept its speed on its lane for so long."""
        spine = self.graph.lanes[user.lane_id].spine
        at = user.lane_position + user.speed * seconds
        return self.other(user.id, user.lane_id, min(at, spine.length), user.speed, user.route)

    def having_stood(self, seconds: float) -> Situation:
        """Return the situation of an ego that has made its full stop at the line, `seconds` ago."""
        since = self.time - seconds
        memory = PilotMemory(standing_since=since, stopped_at=self.connection.id, stopped_since=since)
        return replace(self, memory=memory)

    def at_speed(self, speed: float) -> Situation:
        """Return the situation of an ego at the same place, on the same plan, at another speed."""
        return replace(self, ego=self.ego._replace(speed=speed))

    def traffic(self, *users: RoadUser, sight: float = 0.0) -> Traffic:
        """Return what is observed without lights."""
        return Traffic(time=self.time, users=users, lights={}, sight=sight)

    def late_by(self, seconds: float) -> Situation:
        """Return the situation of an ego that should have been here so long ago."""
        return replace(self, plan=replace(self.plan, times=self.plan.times - seconds))

    def passing(self, user_id: str, instruction: Instruction = Instruction.OVERTAKE) -> Situation:
        """Return the situation of an ego that is about to overtake somebody."""
        return self.remembering(overtaking=Overtaking((user_id,), self.time, instruction))

    def remembering(self, **what) -> Situation:
        """Return the situation of a pilot that remembers this too."""
        return replace(self, memory=self.memory._replace(**what))

    def seen(self, *users: RoadUser, lights: dict[str, str] | None = None) -> Snapshot:
        """Return what the ego perceives."""
        traffic, place = Traffic(
            time=self.time, users=users, lights=lights or {}
        ), locate(self.ego, self.plan, self.limits, 0.0)
        snapshot = perceive(traffic, self.ego, self.plan, self.graph, self.limits, place)
        return snapshot._replace(foes=foes_of(traffic, self.plan, self.graph, self.limits, snapshot.passages))

    def outlook(self, *users: RoadUser, sight: float = 0.0) -> Outlook:
        """Return what the pilot is told of the others' ways and the lanes beside its own."""
        return outlook(
            Traffic(time=self.time, users=users, lights={}, sight=sight), self.seen(*users), self.plan, self.graph,
            self.limits,
        )  # fmt: skip

    def considered(
        self,
        *users: RoadUser,
        stop: TimeConstraint | None = None,
        events: tuple[Event, ...] = (),
        sight: float = 0.0,
        lights: dict[str, str] | None = None,
    ) -> pilot.Situation:
        """Return what the behaviours look at; `stop`: where the highway code makes the ego stop."""
        snapshot, view = self.seen(*users, lights=lights), self.outlook(*users, sight=sight)
        ahead = passages_ahead(self.graph, self.plan, self.limits, snapshot.passages)
        ways = tuple(crossings(snapshot, self.plan, ahead))
        assessment = assess(View(snapshot, self.plan, self.limits, ahead, ways), view.forecast, stop, None, ())
        x = pilot.next_on_way(snapshot)
        found = pilot.Situation(
            snapshot, self.plan, self.limits, self.memory, events, ahead, ways, x, stop, assessment, view
        )
        return found._replace(proof=try_out(found))

    def drive(self) -> Drive:
        """Return what the first step starts from."""
        return Drive(self.ego, self.plan, 0.0, self.memory)

    def step(self, *users: RoadUser, lights: dict[str, str] | None = None, drive: Drive | None = None, time=None) -> Step:
        """Return one control step of the default profile."""
        traffic = Traffic(time=self.time if time is None else time, users=users, lights=lights or {})
        return Controller(graph=self.graph, limits=self.limits).step(traffic, drive or self.drive(), PERIOD)

    def stop(self, *users: RoadUser, lights: dict[str, str] | None = None) -> TimeConstraint | None:
        """Return the place where the pilot wants to stop, and why."""
        return self.step(*users, lights=lights).completed.stop

    def driven(
        self, seconds: float, *users: RoadUser, lights=None, profile=Profile.DEFAULT, delays=Delays.REPLAN
    ) -> list[Step]:
        """Return the control steps of `seconds` of driving past others that stand still."""
        return self.driven_among(lambda _: users, seconds, lambda _: lights or {}, profile, delays)

    def driven_among(
        self,
        users: Callable[[float], Sequence[RoadUser]],
        seconds: float,
        lights: Callable[[float], dict[str, str]] = lambda _: {},
        profile=Profile.DEFAULT,
        delays=Delays.REPLAN,
    ) -> list[Step]:
        """Return the control steps of `seconds` of driving; others and lights as they are so many seconds on."""
        controller, drive, steps = Controller(
            graph=self.graph, limits=self.limits, profile=profile, delays=delays
        ), self.drive(), []
        for k in range(round(seconds / PERIOD)):
            past = k * PERIOD
            sight = drive.completed.sight if drive.completed else 0.0
            traffic = Traffic(time=self.time + past, users=tuple(users(past)), lights=lights(past), sight=sight)
            steps.append(controller.step(traffic, drive, PERIOD))
            drive = steps[-1].drive
        return steps


def before(
    network: str,
    route: tuple[str, ...],
    away: float,
    speed: float,
    lane: int = 0,
    stops: tuple[ScheduledStop, ...] = (),
    aside: Aside | None = None,
    to_left: float = 0.0,
) -> Situation:
    """Return the ego on `route`, its front bumper `away` m before the end of its first edge and `to_left` m beside its
    lane's centre; with `aside`, on its way past somebody."""
    graph = graph_of(network, route)
    lane_id = f"{route[0]}_{lane}"
    spine = graph.lanes[lane_id].spine
    at = spine.length - away
    (x, y), heading, back = spine.at(at), spine.heading_at(at), CAR.front_to_rear_axle
    x, y = x - to_left * math.sin(heading), y + to_left * math.cos(heading)
    state = VehicleState(Pose(x - back * math.cos(heading), y - back * math.sin(heading), heading), speed, 0.0)
    start = PlanStart(state.pose, speed, 0.0, 100.0, lane_id, at, 0)
    return Situation(graph, route, state, plan(graph, Route(route, stops=stops), CAR, start, aside=aside))
