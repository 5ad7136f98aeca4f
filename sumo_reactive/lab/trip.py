"""One ego's trip through a running simulation: observe, control, place, step, verify; plan anew where needed."""

from __future__ import annotations

import contextlib
import gc
import math
import time as clock
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from sumo_reactive.driver.compilation import interrupts_kept
from sumo_reactive.driver.controller import Controller, Drive, Profile, Step, replanned
from sumo_reactive.driver.kernels import load_kernels
from sumo_reactive.driver.nouns.completed_plan import Replanning, Request
from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.nouns.plan import Aside, LaneSegment, NominalPlan
from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.nouns.traffic import Traffic
from sumo_reactive.driver.parameters import DETOUR_PATIENCE_S, OFF_CURVE_M, PLAN_RESERVE_M, STANDING_SPEED, STUCK_S
from sumo_reactive.driver.path.lane_choice import choose_lanes
from sumo_reactive.driver.path.planner import PlanStart, plan
from sumo_reactive.driver.pilot.lights import has_passed, letter_of
from sumo_reactive.driver.pilot.schedule import Delays
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.errors import PlanError
from sumo_reactive.lab.rerouting import WayRound, way_round
from sumo_reactive.sumo.ego import Ego
from sumo_reactive.sumo.net_reader import WorldSource
from sumo_reactive.sumo.observed_vehicle import Bystanders
from sumo_reactive.sumo.observer import EgoObserver
from sumo_reactive.sumo.routes import RouteWindow, unmapped_lanes
from sumo_reactive.sumo.sensor import Sensor, StopLines
from sumo_reactive.sumo.session import Session
from sumo_reactive.sumo.stand_ins import Occupant, OccupiedLane, StandIns, ahead_of_mapping, left_behind, occupied_lane
from sumo_reactive.sumo.vehicle_type import front_of

SELDOM = 100_000
"""Objects made and not freed until rubbish is looked for while egos drive."""


class Order(NamedTuple):
    """What a control step came to: the step, the letter of a light whose line it crosses, its wall-clock time (µs)."""

    step: Step
    light: str
    control_us: float


class Trip:
    """The ego from take-over to arrival.

    Each step is a `command` before the simulation step and a `scene` after it; `scenes` does both for an ego that drives
    alone. Several egos of one session share their `sensor`.
    """

    @interrupts_kept()
    def __init__(
        self, session: Session, ego_id: str, net: WorldSource, profile: Profile, delays: Delays, sensor: Sensor
    ) -> None:
        self.ego = Ego(ego_id)
        self.arrived = False
        self.departure, self.end = self.ego.departure, session.time
        self.step_length = session.step_length
        self.distance = self.time_loss = self.stopped = 0.0
        self.stuck = ""
        self._moved = session.time
        self._session = session
        self._net = net
        self._route = self.ego.route
        graph = net.build(self._route.edges)
        self.graphs = [graph]
        self._choice = choose_lanes(graph, self._route, self.ego.vehicle_class)
        self._controller = Controller(graph, self.ego.limits, profile, delays, self.ego.vehicle_class)
        self._observer = EgoObserver(ego_id, sensor)
        self._stand_ins = StandIns(ego_id), StandIns(ego_id, ".turning")
        self._unmapped = unmapped_lanes(graph, self._route.edges)
        self._window = RouteWindow(ego_id, self._route.edges, net.end_of)
        self._way_round: tuple[tuple[int, str], WayRound | None] = ((-1, ""), None)
        state = self.ego.take_over(session.step_length)
        lane_id = self.ego.lane(state)
        self._stop_lines = StopLines(sensor.signals)
        self._stop_lines.crossed(lane_id)
        self._bystanders = Bystanders(ego_id)
        state = self.ego.laid_along(graph.lanes[lane_id], state)
        start = PlanStart(
            state.pose, state.speed, 0.0, session.time,
            lane_id, self.ego.lane_position(graph, lane_id), 0, self.ego.speed_factor,
        )  # fmt: skip
        self._drive = Drive(state, self._plan(start), 0.0)
        self._traffic = self._observe()
        self._controller.step(self._traffic, self._drive, self.step_length)  # what it calls is loaded: a step is pure
        load_kernels()

    @property
    def has_ended(self) -> bool:
        """Whether the ego has arrived or stands for ever."""
        return self.arrived or bool(self.stuck)

    def scenes(self) -> Iterator[Scene]:
        """Drive step by step until the ego arrives or stands for ever."""
        with world_kept():
            while not self.has_ended:
                order = self.command()
                self._session.step()
                yield self.scene(order)
                if self.arrive():
                    self._session.step()

    def command(self) -> Order:
        """Control, and place the ego where the next simulation step shall end."""
        began = clock.perf_counter()
        step = self._controller.step(self._traffic, self._drive, self.step_length)
        control_us = 1e6 * (clock.perf_counter() - began)
        light = self._light_crossed(step)
        self._place(step)
        return Order(step, light, control_us)

    def scene(self, order: Order) -> Scene:
        """Verify what the simulation step has made of an order, plan anew where needed, observe."""
        step = order.step
        lane_id = self.ego.lane(step.drive.ego)
        self._count(step)
        self._drive = self._planned(step)
        self._traffic = self._observe()
        record = self._record(step, lane_id, order.light, order.control_us)
        return Scene(record, self._traffic.users, self._stop_lines.crossed(lane_id), self._bystanders.look())

    def release(self) -> None:
        """Give the ego back to SUMO's own driver."""
        self._show(None, None)
        self.ego.release()

    def arrive(self) -> bool:
        """Take the ego off the road if it has reached its goal; return whether it has.

        As with SUMO's own cars, the step in which it would pass the goal is the one in which it has arrived.
        """
        goal = self._drive.plan.goal
        way = max(self._drive.ego.speed, 0.0) * self.step_length
        left = math.inf if goal is None else goal - self._front(self._drive)
        self.arrived = left <= way
        if self.arrived:
            self.distance += max(left, 0.0)  # the way counts to the goal, as SUMO's does
            self._show(None, None)
            self._bystanders.leave()
            self.ego.arrive()
        return self.arrived

    @property
    def graph(self) -> RoadGraph:
        """The world around the route; `graphs` are those of all routes driven, this one last."""
        return self._controller.graph

    def _count(self, step: Step) -> None:
        self.end = self._session.time
        before, after = (front_of(state.pose, self.ego.limits) for state in (self._drive.ego, step.drive.ego))
        self.distance += math.dist(before, after)  # of the point that SUMO's positions mean; in a turn the rear axle cuts it
        if step.drive.memory.serving_until is not None and step.drive.ego.speed < STANDING_SPEED:
            self.stopped += self.step_length
        self.time_loss = self.ego.time_loss() - self.stopped
        if step.drive.ego.speed >= STANDING_SPEED:
            self._moved = self.end
        if self.end - self._moved >= STUCK_S:
            self.stuck = _reason(step)

    def _observe(self) -> Traffic:
        drive = self._drive
        sight = drive.completed.sight if drive.completed else 0.0
        return self._observer.observe(self.graph, drive.plan, self._front(drive), drive.ego.speed, sight)

    def _front(self, drive: Drive) -> float:
        return drive.s + self.ego.limits.front_overhang

    def _place(self, step: Step) -> None:
        """Put the ego, and its stand-in when it changes lanes, where the next simulation step shall end."""
        drive, graph = step.drive, self._controller.graph
        here = _segment(drive.plan, self._front(drive))
        self._window.follow(here.route_index)
        lane = graph.lanes[here.lane_id] if drive.plan.aside is None else None
        self.ego.place(drive.ego, step.completed.intent, self.step_length, lane, here.lane_id in self._unmapped)
        self.ego.ask_for_room(any(decision.reason is Reason.NO_GAP for decision in step.completed.decisions))
        self._show(*self._occupied(step, here))

    def _occupied(self, step: Step, here: LaneSegment) -> tuple[OccupiedLane | None, OccupiedLane | None]:
        """Return where to show the ego besides; in a turn in several moves at two places."""
        drive, edges = step.drive, self._route.edges
        by = Occupant(self.graph, drive.plan, here, drive.ego, self.ego.limits)
        if drive.memory.move is not None:
            turn = drive.plan.turnarounds[drive.memory.move[0]]
            behind = left_behind(by, turn, edges[turn.from_index :])
            return behind, ahead_of_mapping(by, turn, edges[turn.route_index :])
        stop = step.completed.stop.s if step.completed.stop else math.inf
        return occupied_lane(by, drive.s, edges[here.route_index :], stop), None

    def _show(self, *places: OccupiedLane | None) -> None:
        for stand_ins, place in zip(self._stand_ins, places, strict=True):
            stand_ins.appear(place)

    @property
    def ghosts_made(self) -> int:
        """How many stand-ins the trip has taken."""
        return sum(one.made for one in self._stand_ins)

    def _planned(self, step: Step) -> Drive:
        """Return the drive, on a new plan where the pilot asks for one, C runs out or the ego has left it."""
        drive, plan_now, asked = step.drive, step.drive.plan, step.completed.request
        if asked.what is Replanning.ROUTE and (way := self._other_way(drive)) and self._is_worth(way, drive):
            return self._rerouted(drive, way)
        wanted = asked.what is Replanning.CURVE
        runs_out = plan_now.goal is None and plan_now.curve.length - drive.s < PLAN_RESERVE_M
        if not wanted and (step.completed.move or (not runs_out and abs(step.snapshot.d) < OFF_CURVE_M)):
            return drive
        aside = asked.aside if wanted else plan_now.aside
        if aside is not None:
            aside = replace(aside, back=aside.back - drive.s, until=aside.until - drive.s)
        start = self._start_onto(drive, asked) if asked.onto else self._start(drive, self._front(drive))
        if asked.change_lane:
            with contextlib.suppress(PlanError):  # carried onto another lane, from which there is no such change
                return replanned(drive, self._plan(start, asked.change_lane, aside), self._session.time)
        try:
            return replanned(drive, self._plan(start, aside=aside), self._session.time)
        except PlanError:  # carried past the last place to change lanes
            found = self._other_way(drive)
            if found is None:
                raise
            return self._rerouted(drive, found)

    def _other_way(self, drive: Drive) -> WayRound | None:
        """Return the other way from the ego's lane to its goal, looked for once on each lane."""
        here = _segment(drive.plan, self._front(drive))
        place = here.route_index, here.lane_id
        if self._way_round[0] != place:
            found = way_round(self.ego.id, self._net, self._choice, self._route, here, drive.memory.served)
            self._way_round = place, found
        return self._way_round[1]

    def _is_worth(self, way: WayRound, drive: Drive) -> bool:
        """Whether the ego has waited for its turn as long as the other way takes longer."""
        since = drive.memory.waiting_since
        return since is not None and self._session.time - since >= min(way.longer, DETOUR_PATIENCE_S)

    def _rerouted(self, drive: Drive, way: WayRound) -> Drive:
        """Return the drive on the other way, with SUMO, the world and the plan set to it."""
        start = replace(self._start(drive, self._front(drive)), route_index=0)
        self.ego.reroute(way.route)
        self._route, self._choice, self._way_round = way.route, way.choice, ((-1, ""), None)
        self._controller = replace(self._controller, graph=way.graph)
        self.graphs.append(way.graph)
        self._unmapped = unmapped_lanes(way.graph, way.route.edges)
        self._window = RouteWindow(self.ego.id, way.route.edges, self._net.end_of, number=len(self.graphs))
        memory = drive.memory._replace(waiting_since=None, escapes=0, progress_time=self._session.time)
        new_plan = replace(self._plan(start), missed=way.missed)
        return replanned(drive._replace(memory=memory), new_plan, self._session.time)

    def _start(self, drive: Drive, front: float) -> PlanStart:
        here = _segment(drive.plan, front)
        position = here.lane_offset + (front - here.start) / here.stretch
        ego = drive.ego
        return PlanStart(
            ego.pose, ego.speed, ego.steering_angle, self._session.time,
            here.lane_id, position, here.route_index, self.ego.speed_factor,
        )  # fmt: skip

    def _start_onto(self, drive: Drive, asked: Request) -> PlanStart:
        """Return the start on the lane that the car has turned into, or on one behind it that its front has reached."""
        x, y = front_of(drive.ego.pose, self.ego.limits)
        lane, index = self.graph.lanes[asked.onto], asked.route_index
        position = lane.spine.project(x, y)[0]
        while position >= lane.spine.length and (onward := self._onward(lane, index)) is not None:
            reached = onward.spine.project(x, y)[0]
            if reached <= 0.0:
                break
            lane, index, position = onward, index + 1, reached
        start = self._start(drive, self._front(drive))
        return replace(start, lane_id=lane.id, lane_position=position, route_index=index)

    def _onward(self, lane: Lane, index: int) -> Lane | None:
        """Return a lane that leads on from one of the route's edge `index`; None: there is none."""
        following = self._route.edges[index + 1 : index + 2]
        ahead = (self.graph.lanes.get(way.to_lane) for way in self.graph.outgoing.get(lane.id, ()))
        return next((one for one in ahead if one is not None and one.edge_id in following), None)

    def _plan(self, start: PlanStart, change_now: int = 0, aside: Aside | None = None) -> NominalPlan:
        graph, ego = self._controller.graph, self.ego
        return plan(
            graph, self._route, ego.vehicle_class, ego.limits, start,
            change_now=change_now, aside=aside, choice=self._choice,
        )  # fmt: skip

    def _record(self, step: Step, lane_id: str, light: str, control_us: float) -> StepRecord:
        drive, execution, completed = step.drive, step.execution, step.completed
        x, y = front_of(drive.ego.pose, self.ego.limits)
        leader = min(step.snapshot.leaders, key=lambda one: one.s, default=None)
        return StepRecord(
            time=self._session.time,
            x=x,
            y=y,
            heading=drive.ego.pose.heading,
            speed=drive.ego.speed,
            acceleration=drive.ego.acceleration,
            steering_angle=drive.ego.steering_angle,
            lane_id=lane_id,
            s=step.snapshot.s,
            d=step.snapshot.d,
            command_acceleration=execution.command.acceleration,
            command_steering_rate=execution.command.steering_rate,
            desired_speed=execution.desired_speed,
            stop_s=completed.stop.s if completed.stop else float("nan"),
            u=execution.potentials.total,
            u1=execution.potentials.valley,
            u2=execution.potentials.shadow,
            u3=execution.potentials.velocity,
            leader=leader.user_id if leader else "",
            gap=leader.s - step.snapshot.front if leader else float("nan"),
            behaviour=completed.behaviour.value,
            instruction=completed.instruction.value,
            pilot=bool(completed.events),
            emergency=execution.emergency,
            hazard=execution.hazard,
            light=light,
            control_us=control_us,
            decisions=completed.decisions,
            events=completed.events,
            assessment=completed.assessment,
            regions=completed.regions,
            asked=step.asked,
        )

    def _light_crossed(self, step: Step) -> str:
        """Return the letter of the light whose line the front bumper crosses in this step."""
        before, after = self._front(self._drive), self._front(step.drive)
        for passage in self._drive.plan.passages:
            if has_passed(passage.start, after) and not has_passed(passage.start, before):
                return letter_of(self.graph.connections[passage.connection_id], step.snapshot)
        return ""


@contextlib.contextmanager
def world_kept() -> Iterator[None]:
    """Keep what has been built out of garbage collection, which would cost tens of milliseconds now and then.

    Steps make no cycles, so that hardly anything is left to collect: it is looked for seldom.
    """
    before = gc.get_threshold()
    gc.collect()
    gc.freeze()
    gc.set_threshold(SELDOM, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)
        gc.unfreeze()


def _reason(step: Step) -> str:
    """Say in a few words why the ego stands."""
    said = [d for d in step.completed.decisions if not d.passes]
    reasons = [f"{d.reason.value} by {d.cause}" if d.cause else d.reason.value for d in said]
    reasons += [f"behind {leader.user_id}" for leader in step.snapshot.leaders[:1]]
    return "; ".join(reasons) or "for no reason"


def _segment(plan_now: NominalPlan, front: float) -> LaneSegment:
    """Return the lane segment of C that holds the front bumper."""
    return next((g for g in plan_now.segments if front < g.end), plan_now.segments[-1])
