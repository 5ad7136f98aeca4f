"""One ego's trip through a running simulation: observe, control, place; verify, plan anew where needed."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

from sumo_reactive.driver.compilation import interrupts_kept
from sumo_reactive.driver.controller import PARTS, Controller, Parts, Step
from sumo_reactive.driver.driving import Driving, set_out
from sumo_reactive.driver.field.cast_shadows import cast_shadows
from sumo_reactive.driver.field.executor import field_over
from sumo_reactive.driver.field.ground import ground_field
from sumo_reactive.driver.kernel_folder import is_cached, mark_cached
from sumo_reactive.driver.kernels import load_kernels
from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.nouns.plan import LaneSegment, segment_at
from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import Traffic
from sumo_reactive.driver.parameters import Profile
from sumo_reactive.driver.path.lane_choice import choose_lanes
from sumo_reactive.driver.path.planner import PlanStart
from sumo_reactive.driver.pilot.rules.lights import has_passed, letter_of
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.sumo.asking import Asking
from sumo_reactive.sumo.ego import Ego
from sumo_reactive.sumo.lying_over import lane_lain_over, lane_turned_over
from sumo_reactive.sumo.net_reader import WorldSource
from sumo_reactive.sumo.observed_vehicle import Bystanders
from sumo_reactive.sumo.observer import EgoObserver
from sumo_reactive.sumo.orders import Tell
from sumo_reactive.sumo.passed_seen import passed_seen
from sumo_reactive.sumo.routes import RouteWindow, crossed_before, quickest_way, told_lanes
from sumo_reactive.sumo.sensor import Sensor, StopLines
from sumo_reactive.sumo.session import Session
from sumo_reactive.sumo.stand_ins import (
    Occupant,
    OccupiedLane,
    StandIns,
    ahead_of_mapping,
    left_behind,
    mapped_elsewhere,
    mapped_next,
    occupied_lane,
    rear_beside,
    rear_unseen,
)
from sumo_reactive.sumo.vehicle_type import front_of


class _Ways(NamedTuple):
    """What the network and SUMO's own routing know of the roads beyond an ego's world."""

    ego_id: str
    net: WorldSource
    tell: Tell

    def build(self, edges: Sequence[str], /) -> RoadGraph:
        return self.net.build(edges)

    def quickest_way(self, firsts: Sequence[str], goals: Sequence[str], /) -> tuple[str, ...]:
        return quickest_way(self.ego_id, firsts, goals, self.tell)


class Trip:
    """An ego in the hands of this project's driver, from take-over to arrival.

    Each simulation step is preceded by a `command` and followed by a `scene`. Several egos of one session share their
    `sensor`. `stuck` says why the ego stands for ever.
    """

    is_placed, failure = True, ""

    @interrupts_kept()
    def __init__(
        self, session: Session, ego_id: str, net: WorldSource, scenario: Scenario, sensor: Sensor, parts: Parts = PARTS
    ) -> None:
        tell = session.orders
        self._ego = ego = Ego(ego_id, scenario.parameters, says_arrival=session.says_arrivals, tell=tell)
        self._session, self._net = session, net
        self.id, self.limits, self.profile = ego_id, ego.limits, scenario.profile.value
        self.arrived, self.stuck = False, ""
        self.departure, self.end = ego.departure, session.time
        self.distance = self.time_loss = self.stopped = 0.0
        self._moved = session.time
        graph = net.build(ego.route.edges)
        self._routes = 1
        choose_lanes(graph, ego.route, ego.limits.vehicle_class)  # or an error, before the ego is taken over
        controller = Controller(
            graph=graph, limits=ego.limits, profile=scenario.profile, delays=scenario.delays, parts=parts
        )
        self._observer = EgoObserver(ego_id, sensor, ego.limits)
        self._stand_ins = tuple(StandIns(ego_id, label, tell) for label in ("", ".besides", ".third"))
        crossed = crossed_before(graph, ego.route.edges)
        self._told = told_lanes(graph, ego.route.edges, crossed)
        self._window = RouteWindow(ego_id, ego.route.edges, net.end_of, crossed, self._routes, tell)
        state = ego.take_over(session.step_length)
        lane_id = self._mapped = ego.lane(state)
        self._stop_lines = StopLines(sensor.signals)
        self._asking = Asking(ego_id, scenario.parameters.asked_deceleration, tell)
        self._stop_lines.crossed(lane_id)
        self._bystanders = Bystanders(ego_id)
        state = ego.laid_along(graph.lanes[lane_id], state)
        start = PlanStart(
            state.pose, state.speed, 0.0, session.time, lane_id, ego.lane_position(graph, lane_id), 0, ego.speed_factor
        )
        self._driving: Driving
        self._route = ego.route
        self._go_on(set_out(controller, ego.route, start, _Ways(ego_id, net, tell)))
        self._traffic = self._observe()
        self._step = self._driving.step(self._traffic, session.step_length)  # what it calls is loaded: a step is pure
        self._control_us, self._is_first = 0.0, True
        load_kernels()

    def command(self) -> None:
        """Control, and place the ego where the next simulation step shall end."""
        began = clock.perf_counter()
        self._step = self._driving.step(self._traffic, self._session.step_length)
        self._control_us = 1e6 * (clock.perf_counter() - began)
        self._place(self._step)

    def scene(self) -> Scene:
        """Verify what the simulation step has made of the command, plan anew where needed, observe."""
        step, world = self._step, self._driving.graph
        lane_id = self._mapped = self._ego.lane(step.drive.ego)
        plan, light = self._driving.drive.plan, self._light_crossed(step)
        self._count(step)
        seen = self._traffic.users
        self._go_on(self._driving.after(step, self._session.time))
        self._traffic = self._observe()
        if self._is_first and not is_cached():
            mark_cached()
        self._is_first = False
        front = front_of(step.drive.ego.pose, self.limits)
        record = _record(step, self._session.time, front, lane_id, light, self._control_us)
        crossed = self._stop_lines.crossed(lane_id)
        traffic = self._traffic
        beside = self._bystanders.look({user.id for user in traffic.users})
        period = min(self._session.step_length, self.limits.parameters.control_period_s)
        has_field = self.profile == Profile.DEFAULT.value
        field = partial(field_over, step.snapshot, step.completed, self.limits, period) if has_field else None
        ground = partial(ground_field, step.snapshot, step.completed, self.limits) if has_field else None
        shadows = partial(cast_shadows, step.snapshot, step.completed, self.limits, seen) if has_field else None
        return Scene(
            record, traffic.users, crossed, beside, self.id, world, plan, traffic.lights, field, ground, shadows,
            boxes=traffic.boxes, apart=self._bystanders.junctions.are_apart,
        )  # fmt: skip

    def release(self) -> None:
        """Give the ego back to SUMO's own driver."""
        self._show(None, None, None)
        self._asking.ask("")
        self._ego.release()

    def arrive(self) -> bool:
        """Take the ego off the road, with the next simulation step, if it has reached its goal; return whether it has.

        As with SUMO's own cars, the step in which it would pass the goal is the one in which it has arrived.
        """
        left = self._driving.left
        self.arrived = left <= max(self._driving.drive.ego.speed, 0.0) * self._session.step_length
        if self.arrived:
            self.distance += max(left, 0.0)  # the way counts to the goal, as SUMO's does
            self._show(None, None, None)
            self._asking.ask("")
            self._bystanders.leave()
            self._ego.arrive()
        return self.arrived

    @property
    def ghosts_made(self) -> int:
        """How many stand-ins the trip has taken."""
        return sum(one.made for one in self._stand_ins)

    @property
    def figures(self) -> dict[str, float | int | None]:
        """What only this driver tells beside the judges: nothing."""
        return {}

    def _count(self, step: Step) -> None:
        self.end = self._session.time
        ego, step_length = step.drive.ego, self._session.step_length
        before, after = (front_of(state.pose, self.limits) for state in (self._driving.drive.ego, ego))
        self.distance += math.dist(before, after)  # of the point that SUMO's positions mean; in a turn the rear axle cuts it
        if step.drive.memory.serving_until is not None and ego.speed < STANDING_SPEED:
            self.stopped += step_length
        self.time_loss = self._ego.time_loss() - self.stopped
        if ego.speed >= STANDING_SPEED:
            self._moved = self.end
        longest = self.limits.parameters.stuck_s
        if self.end - self._moved >= longest:
            self.stuck = f"stood still for {longest:g} s: {_reason(step)}"

    def _observe(self) -> Traffic:
        driving, drive = self._driving, self._driving.drive
        sight = drive.completed.sight if drive.completed else 0.0
        return self._observer.observe(driving.graph, drive.plan, driving.front, drive.ego.speed, sight)

    def _place(self, step: Step) -> None:
        """Put the ego, and its stand-in when it changes lanes, where the next simulation step shall end."""
        drive = step.drive
        here = segment_at(drive.plan, drive.s + self.limits.front_overhang)
        lane = self._driving.graph.lanes[here.lane_id] if drive.plan.aside is None else None
        is_told = here.lane_id in self._told
        follow = partial(self._window.follow, here.route_index)
        self._ego.place(drive.ego, step.completed.intent, self._session.step_length, lane, is_told, follow)
        self._ego.let_go(step.completed.let_go)
        decisions = step.completed.decisions
        self._ego.ask_for_room(any(decision.reason is Reason.NO_GAP for decision in decisions))
        self._asking.ask(next((one.cause for one in decisions if one.reason is Reason.ASKS), ""))
        self._show(*self._occupied(step, here))

    def _occupied(self, step: Step, here: LaneSegment) -> tuple[OccupiedLane | None, ...]:
        """Return where to show the ego besides, at two places at most, or three in a turn, and then whom it passes."""
        drive, edges = step.drive, self._driving.route.edges
        by = Occupant(self._driving.graph, drive.plan, here, drive.ego, self.limits, self._mapped)
        by = by._replace(mapped=mapped_next(by, self._driving.drive.ego))
        if drive.memory.move is not None:
            turn = drive.plan.turnarounds[drive.memory.move[0]]
            behind = left_behind(by, turn, edges[turn.from_index :])
            ahead = ahead_of_mapping(by, turn, edges[turn.route_index :])
            return behind, ahead, lane_turned_over(by, turn, {one.lane.id for one in (behind, ahead) if one})
        stop, onward = step.completed.stop.s if step.completed.stop else math.inf, edges[here.route_index :]
        place = mapped_elsewhere(by, drive.s, edges) or occupied_lane(by, drive.s, onward, stop)
        passed = self._ego.passing
        seen = passed_seen(by, self.id, passed, onward, self._session.step_length) if passed else None
        besides = lane_lain_over(by, drive.s, edges, place.lane.id if place else "") or rear_beside(by, drive.s, edges)
        return place, besides or rear_unseen(by, onward), seen

    def _show(self, *places: OccupiedLane | None) -> None:
        for stand_ins, place in zip(self._stand_ins, places, strict=True):
            stand_ins.show(place)

    def _go_on(self, after: Driving) -> None:
        """Set SUMO to another route if the driver has taken one."""
        if after.route is not self._route:
            self._route, edges = after.route, after.route.edges
            self._ego.reroute(after.route)
            self._routes += 1
            crossed = crossed_before(after.graph, edges)
            self._told = told_lanes(after.graph, edges, crossed)
            self._window = RouteWindow(self.id, edges, self._net.end_of, crossed, self._routes, self._session.orders)
        self._driving = after

    def _light_crossed(self, step: Step) -> str:
        """Return the letter of the light whose line the front bumper crosses in this step."""
        before, after = self._driving.front, step.drive.s + self.limits.front_overhang
        for passage in self._driving.drive.plan.passages:
            if has_passed(passage.start, after) and not has_passed(passage.start, before):
                return letter_of(self._driving.graph.connections[passage.connection_id], step.snapshot)
        return ""


def _record(
    step: Step, time: float, front: tuple[float, float], lane_id: str, light: str, control_us: float
) -> StepRecord:
    """Return what is kept of a step that has ended at `time` (s) with the middle of the front bumper at `front` (m)."""
    ego, execution, completed, snapshot = step.drive.ego, step.execution, step.completed, step.snapshot
    leader = min(snapshot.leaders, key=lambda one: one.s, default=None)
    potentials = execution.potentials
    return StepRecord(
        time=time, x=front[0], y=front[1], heading=ego.pose.heading, speed=ego.speed, lane_id=lane_id,
        acceleration=ego.acceleration, steering_angle=ego.steering_angle, s=snapshot.s, d=snapshot.d,
        command_acceleration=execution.command.acceleration, command_steering_rate=execution.command.steering_rate,
        desired_speed=execution.desired_speed, stop_s=completed.stop.s if completed.stop else math.nan,
        u=potentials.total, u1=potentials.valley, u2=potentials.shadow, u3=potentials.velocity,
        leader=leader.behind if leader else "", gap=leader.s - snapshot.front if leader else math.nan,
        behaviour=completed.behaviour.value, instruction=completed.instruction.value, pilot=step.runs,
        emergency=execution.emergency, hazard=execution.hazard, decisions=completed.decisions,
        events=completed.events, assessment=completed.assessment, regions=completed.regions, light=light,
        control_us=control_us, constraints=completed.hard, rooms=completed.rooms,
    )  # fmt: skip


def _reason(step: Step) -> str:
    """Say in a few words why the ego stands."""
    said = [d for d in step.completed.decisions if not d.passes]
    reasons = [f"{d.reason.value} by {d.cause}" if d.cause else d.reason.value for d in said]
    reasons += [f"behind {leader.behind}" for leader in step.snapshot.leaders[:1]]
    return "; ".join(reasons) or "for no reason"
