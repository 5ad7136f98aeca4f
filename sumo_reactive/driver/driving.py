"""The driver whole: it controls, and from where that leaves the car it plans anew where needed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple, Protocol

from sumo_reactive.driver.controller import Controller, Drive, Step, replanned
from sumo_reactive.driver.nouns.completed_plan import Replanning, Request
from sumo_reactive.driver.nouns.plan import Aside, NominalPlan, segment_at
from sumo_reactive.driver.nouns.state import CREEPING_SPEED, VehicleState
from sumo_reactive.driver.nouns.traffic import Traffic
from sumo_reactive.driver.path.lane_choice import LaneChoice, choose_lanes
from sumo_reactive.driver.path.planner import PlanStart, plan
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route
from sumo_reactive.errors import PlanError

PLAN_RESERVE_M = 600.0
"""C is prolonged when less than this is left of it and the goal is not on it (braking from 50 m/s takes 500 m)."""

OFF_CURVE_M = 1.5
"""An ego this far from C plans anew from where it is."""


class Ways(Protocol):
    """What knows the roads beyond W, for a driver that has missed its turn."""

    def build(self, edges: Sequence[str], /) -> RoadGraph:
        """Return a world that holds a route of edges."""

    def quickest_way(self, firsts: Sequence[str], goals: Sequence[str], /) -> tuple[str, ...]:
        """Return the edges of the quickest way from one of `firsts` by all `goals` in order; empty: there is none."""


class Rerouting(NamedTuple):
    """A new route from the car's edge on, the lanes of the world around it, and how much longer it takes, s.

    `missed`: the edge that the old route turned to.
    """

    route: Route
    choice: LaneChoice
    longer: float
    missed: str


class Driving(NamedTuple):
    """A car on its way: its `controller`, its `route` with the lanes it can be driven on, and how far it has come.

    Each `step` is followed by `after`, once the world has moved on as well. `speed_factor` scales the lanes' limits.
    Without `ways` there is no other way to the goal than the route. `looked`: route index and lane on which another way was
    looked for last, and what was found.
    """

    controller: Controller
    route: Route
    choice: LaneChoice
    drive: Drive
    speed_factor: float = 1.0
    ways: Ways | None = None
    looked: tuple[int, str, Rerouting | None] = (-1, "", None)

    @property
    def graph(self) -> RoadGraph:
        """The world around the route."""
        return self.controller.graph

    @property
    def front(self) -> float:
        """Where the front bumper is on C, m."""
        return self.drive.s + self.controller.limits.front_overhang

    @property
    def left(self) -> float:
        """The way that the front bumper has left to the goal, m; infinite while the plan does not reach it."""
        goal = self.drive.plan.goal
        return math.inf if goal is None else goal - self.front

    def step(self, traffic: Traffic, duration: float) -> Step:
        """Drive for `duration` s on the present plan."""
        return self.controller.step(traffic, self.drive, duration)

    def after(self, step: Step, time: float) -> Driving:
        """Go on at `time` (s) from where a step has led: on a new plan where the pilot asks for one, C ends or was left.

        Raises PlanError if no plan leads to the goal any more.
        """
        here, asked = self._replace(drive=step.drive), step.completed.request
        if asked.what is Replanning.ROUTE:
            later = self._later(time)
            if later is not None:
                return later
            start = here._start(time)
            here, way = here._looked_for_rerouting(start)
            if way is not None and here._is_worth(way, time):
                return here._rerouted(way, start)
        return here._replanned(step, time) if here._needs_curve(step) else here

    def _later(self, time: float) -> Driving | None:
        """Return the driving that changes lanes on a later edge, if the car waits for it here and its lane leads on."""
        here, plan_now = segment_at(self.drive.plan, self.front), self.drive.plan
        lane = self.graph.lanes[here.lane_id]
        changes = any(one.from_lane == here.lane_id and one.start > self.drive.s for one in plan_now.lane_changes)
        if not changes or lane.is_internal or plan_now.stays_on == here.route_index:
            return None
        start = replace(self._start(time), stays_on=here.route_index)
        number = self.choice.stage_at(here.route_index, start.lane_position / lane.scale)
        if self.choice.onward[number][lane.index].cost == math.inf:
            return None
        memory = self.drive.memory._replace(waiting_since=None, progress_time=time)
        return self._replace(drive=self.drive._replace(memory=memory))._on(self._plan(start), time)

    def _needs_curve(self, step: Step) -> bool:
        plan_now = self.drive.plan
        if step.completed.request.what is Replanning.CURVE:
            return True
        runs_out = plan_now.goal is None and plan_now.curve.length - self.drive.s < PLAN_RESERVE_M
        return not step.completed.move and (runs_out or abs(step.snapshot.d) >= OFF_CURVE_M)

    def _replanned(self, step: Step, time: float) -> Driving:
        asked, s = step.completed.request, self.drive.s
        aside = asked.aside if asked.what is Replanning.CURVE else self.drive.plan.aside
        if aside is not None:
            aside = replace(aside, back=aside.back - s, until=aside.until - s)
        start = self._start_onto(asked, time) if asked.onto else self._start(time)
        if asked.stays:
            start = replace(start, stays_on=start.route_index)
        if asked.change_lane:
            with suppress(PlanError):  # carried onto another lane, from which there is no such change
                return self._on(self._plan(start, asked.change_lane, aside), time)
        try:
            return self._on(self._plan(start, aside=aside), time)._with_turn_in_reach(start)
        except PlanError:  # carried past the last place to change lanes
            here, way = self._looked_for_rerouting(start)
            if way is None:
                raise
            return here._rerouted(way, start)

    def _with_turn_in_reach(self, start: PlanStart) -> Driving:
        """Return the driving on another way, if there is one, where the car cannot be steered to the lane of its turn."""
        limits = self.controller.limits
        change = next((one for one in self.drive.plan.lane_changes if one.from_lane == start.lane_id), None)
        if change is None:
            return self
        aside = self.graph.lanes[change.to_lane].spine.project(*start.pose.ahead(limits.wheelbase))[1]
        if change.end - change.start > shortest_change(abs(aside), limits.max_curvature):
            return self
        here, way = self._looked_for_rerouting(start)
        return self if way is None else here._rerouted(way, start)

    def _on(self, new_plan: NominalPlan, time: float) -> Driving:
        return self._replace(drive=replanned(self.drive, new_plan, time))

    def _plan(self, start: PlanStart, change_now: int = 0, aside: Aside | None = None) -> NominalPlan:
        control = self.controller
        return plan(control.graph, self.route, control.limits, start, change_now=change_now, aside=aside)

    def _start(self, time: float) -> PlanStart:
        here, ego = segment_at(self.drive.plan, self.front), self.drive.ego
        position = here.lane_offset + (self.front - here.start) / here.stretch
        return PlanStart(
            ego.pose, ego.speed, ego.steering_angle, time, here.lane_id, position, here.route_index, self.speed_factor,
            self.drive.plan.stays_on,
        )  # fmt: skip

    def _start_onto(self, asked: Request, time: float) -> PlanStart:
        """Return the start on the lane that the car has turned into, or on what is behind it that its front has reached."""
        pose, reach = self.drive.ego.pose, self.controller.limits.front_to_rear_axle
        x, y = pose.x + reach * math.cos(pose.heading), pose.y + reach * math.sin(pose.heading)
        lane, index = self.graph.lanes[asked.onto], asked.route_index
        position = lane.spine.project(x, y)[0]
        while position >= lane.spine.length and (onward := self._onward(lane, index)) is not None:
            reached = onward.spine.project(x, y)[0]
            if reached <= 0.0:
                break
            lane, index, position = onward, index + (not onward.is_internal), reached
        return replace(self._start(time), lane_id=lane.id, lane_position=position, route_index=index)

    def _onward(self, lane: Lane, index: int) -> Lane | None:
        """Return what leads on from a lane of, or behind, the route's edge `index`; None: nothing."""
        following, graph = self.route.edges[index + 1 : index + 2], self.graph
        inside = graph.connection_of.get(lane.id)
        for way in graph.ways_from(lane.id) if inside is None else (inside,):
            if way.to_lane in graph.lanes and graph.lanes[way.to_lane].edge_id in following:
                names = lane.id, *way.parts, way.to_lane
                return graph.lanes[names[names.index(lane.id, 1 if inside else 0) + 1]]
        return None

    def _looked_for_rerouting(self, start: PlanStart) -> tuple[Driving, Rerouting | None]:
        """Return the other way from the lane of a start to the goal, looked for once on each lane."""
        if self.looked[:2] == (start.route_index, start.lane_id):
            return self, self.looked[2]
        found = self._rerouting(self.ways, start) if self.ways else None
        return self._replace(looked=(start.route_index, start.lane_id, found)), found

    def _rerouting(self, ways: Ways, start: PlanStart) -> Rerouting | None:
        """Return the quickest other way to the goal that the lane of a start leads to without a change; None: there is none.

        It passes the stops of the route that are not served yet.
        """
        graph, route, index = self.graph, self.route, start.route_index
        lane = graph.lanes[start.lane_id]
        stops = tuple(stop for stop in route.stops if stop not in self.drive.memory.served)
        goals = [*(graph.lanes[stop.lane_id].edge_id for stop in stops), route.edges[-1]]
        if lane.is_internal or index + 1 >= len(route.edges) or lane.edge_id in goals[:-1]:
            return None
        missed, vehicle_class = route.edges[index + 1], self.choice.vehicle_class
        onward = [graph.lanes[way.to_lane] for way in graph.ways_from(lane.id)]
        firsts = [one.edge_id for one in onward if one.allows(vehicle_class) and one.edge_id != missed]
        way = ways.quickest_way(firsts, goals)
        if not way:
            return None
        new = Route((lane.edge_id, *way), route.arrival_position, route.arrival_lane, stops)
        world = ways.build(new.edges)
        lanes = choose_lanes(world, new, vehicle_class)
        if lanes.onward[0][lane.index].cost == math.inf:
            return None
        return Rerouting(new, lanes, _duration(world, new.edges) - _duration(graph, route.edges[index:]), missed)

    def _is_worth(self, way: Rerouting, time: float) -> bool:
        """Whether the car has waited for its turn as long as the other way takes longer."""
        since = self.drive.memory.waiting_since
        return since is not None and time - since >= min(way.longer, self.controller.limits.parameters.detour_patience_s)

    def _rerouted(self, way: Rerouting, start: PlanStart) -> Driving:
        """Return the driving on the other way from a start, in the world around it."""
        start = replace(start, route_index=0, stays_on=-1)
        memory = self.drive.memory._replace(waiting_since=None, escapes=0, progress_time=start.time)
        other = self._replace(
            controller=replace(self.controller, graph=way.choice.graph), route=way.route, choice=way.choice,
            drive=self.drive._replace(memory=memory), looked=(-1, "", None),
        )  # fmt: skip
        return other._on(replace(other._plan(start), missed=way.missed), start.time)


def set_out(
    controller: Controller, route: Route, start: PlanStart, ways: Ways | None = None
) -> Driving:
    """Return the driving of a route from its start.

    Raises PlanError naming the edges that no lane sequence connects.
    """
    graph, limits = controller.graph, controller.limits
    nominal = plan(graph, route, limits, start)
    drive = Drive(VehicleState(start.pose, start.speed, start.steering_angle), nominal, 0.0)
    choice = choose_lanes(graph, route, limits.vehicle_class)
    return Driving(controller, route, choice, drive, start.speed_factor, ways)._with_turn_in_reach(start)


def shortest_change(aside: float, curvature: float) -> float:
    """Return the least way (m) on which a car moves by `aside` (m), one arc of its `curvature` (1/m) after another."""
    return math.sqrt(max(aside * (4.0 / curvature - aside), 0.0))


def _duration(graph: RoadGraph, edges: Sequence[str]) -> float:
    """Return the time that a free drive along `edges` takes, s."""
    return sum(lane.length / max(lane.speed_limit, CREEPING_SPEED) for lane, *_ in map(graph.edge_lanes.__getitem__, edges))
