"""Which lanes a route can be driven on, at what cost, and which the plan drives: dynamic programming from its end."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.nouns.plan import LaneSegment, ParallelLane
from sumo_reactive.driver.vehicle.travel_time import LANE_CHANGE_DURATION_S
from sumo_reactive.driver.world.junction import Connection
from sumo_reactive.driver.world.lane import Lane, separation
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route, ScheduledStop
from sumo_reactive.errors import PlanError

LANE_CHANGE_ROOM_M = 40.0
"""Room that one lane change should find on an edge; a change with less costs more, so that the plan makes it earlier."""

SHARED_OVERLAP_M = 0.7
"""Lanes of opposite directions that overlap by more are one lane on the map: two cars of 1.8 m do not pass."""

SHARED_LANE_COST = 3.0
"""What such a lane costs, in lane changes."""

MIN_ROOM_M = 0.1


class LaneCost(NamedTuple):
    """What lies ahead on the cheapest way to the route's end: `cost` (inf: no way) and number of lane `changes`."""

    cost: float
    changes: int


BLOCKED = LaneCost(math.inf, 0)


@dataclass(frozen=True, eq=False)
class Stage:
    """An edge of the route, or its part up to a scheduled stop; `start`, `end` in position metres.

    `required` is the lane index to hold at `end`, None when every lane that leads on will do. `left_hand`: traffic
    drives on the left, so that lane 0 is the leftmost.
    """

    route_index: int
    lanes: tuple[Lane, ...]
    start: float
    end: float
    required: int | None = None
    stop: ScheduledStop | None = None
    left_hand: bool = False


@dataclass(frozen=True, eq=False)
class LaneChoice:
    """The route's stages with two costs per lane: `onward` without a change in the stage, `best` with changes."""

    graph: RoadGraph
    vehicle_class: str
    stages: tuple[Stage, ...]
    onward: tuple[tuple[LaneCost, ...], ...]
    best: tuple[tuple[LaneCost, ...], ...]

    def stage_at(self, route_index: int, position: float = 0.0) -> int:
        """Return the number of the stage that holds `position` (m) of edge `route_index`."""
        found = [n for n, stage in enumerate(self.stages) if stage.route_index == route_index]
        if not found:
            raise PlanError(f"the route has no edge number {route_index}")
        return next((n for n in found if position < self.stages[n].end), found[-1])

    def connections(self, number: int, lane_index: int) -> list[Connection]:
        """Return the connections that leave stage `number` by a lane along the route, the best first."""
        stage, following = self.stages[number], self.stages[number + 1]
        found = route_connections(self.graph, stage.lanes[lane_index], following.lanes, self.vehicle_class)
        costs = self.best[number + 1]

        def rank(connection: Connection) -> tuple[float, int]:
            target = self.graph.lanes[connection.to_lane]
            from_outer = target.index - lane_index
            from_inner = from_outer + len(stage.lanes) - len(following.lanes)
            return round(costs[target.index].cost, 6), min(abs(from_outer), abs(from_inner))

        return sorted((c for c in found if rank(c)[0] < math.inf), key=rank)


@kept(16)
def choose_lanes(graph: RoadGraph, route: Route, vehicle_class: str) -> LaneChoice:
    """Return the cost of every lane of the route; PlanError when the network lacks an edge or a stop lies off it."""
    stages = tuple(_stages(graph, route))
    onward: list[tuple[LaneCost, ...]] = []
    best: list[tuple[LaneCost, ...]] = []
    for number in reversed(range(len(stages))):
        stage = stages[number]
        following = None if number + 1 == len(stages) else stages[number + 1]
        leads = _onward(graph, vehicle_class, stage, following, best[-1] if best else ())
        onward.append(leads)
        best.append(tuple(_best(stage, k, leads, vehicle_class) for k in range(len(stage.lanes))))
    return LaneChoice(graph, vehicle_class, stages, tuple(reversed(onward)), tuple(reversed(best)))


def options(
    stage: Stage, lane_index: int, onward: tuple[LaneCost, ...], room: float, vehicle_class: str
) -> Iterator[tuple[int, LaneCost]]:
    """Yield (lane to leave by, cost) for all lanes that changes within `room` (m) reach, the own lane first."""
    yield lane_index, onward[lane_index]
    for step in (1, -1):
        k = lane_index
        while 0 <= k + step < len(stage.lanes):
            if not may_change(stage.lanes[k], stage.lanes[k + step], vehicle_class, stage.left_hand):
                break
            k += step
            changes = abs(k - lane_index)
            cost = onward[k].cost + changes * _change_cost(stage.lanes[k], room / changes)
            yield k, LaneCost(cost, onward[k].changes + changes)


def may_change(lane: Lane, neighbour: Lane, vehicle_class: str, left_hand: bool) -> bool:
    """Whether a vehicle of the class may change from `lane` to the lane beside it.

    Lane indices grow to the left, and in left-hand traffic to the right.
    """
    to_left = (neighbour.index > lane.index) != left_hand
    permitted = lane.allows_change_left(vehicle_class) if to_left else lane.allows_change_right(vehicle_class)
    return permitted and neighbour.allows(vehicle_class)


def route_connections(graph: RoadGraph, lane: Lane, targets: tuple[Lane, ...], vehicle_class: str) -> list[Connection]:
    """Return the connections from `lane` to any of `targets` that the class may drive."""
    edge_id = targets[0].edge_id
    found = []
    for connection in graph.ways_from(lane.id):
        target = graph.lanes.get(connection.to_lane)
        if target is None or connection.is_crossing or target.edge_id != edge_id or not target.allows(vehicle_class):
            continue
        if all(graph.lanes[part].allows(vehicle_class) for part in connection.parts):
            found.append(connection)
    return found


def _best(stage: Stage, lane_index: int, onward: tuple[LaneCost, ...], vehicle_class: str) -> LaneCost:
    """Return the cost of a lane at the stage's start, with the changes that it may need there."""
    if not stage.lanes[lane_index].allows(vehicle_class):
        return BLOCKED
    return min(found for _, found in options(stage, lane_index, onward, stage.end - stage.start, vehicle_class))


def _change_cost(lane: Lane, room: float) -> float:
    """Cost of one change with `room` m: 1, and more where the room is short of what the lane's speed needs."""
    needed = max(LANE_CHANGE_ROOM_M, lane.speed_limit * LANE_CHANGE_DURATION_S)
    return max(1.0, needed / max(room, MIN_ROOM_M))


def _onward(
    graph: RoadGraph, vehicle_class: str, stage: Stage, following: Stage | None, ahead: tuple[LaneCost, ...]
) -> tuple[LaneCost, ...]:
    """Return the cost of each lane of `stage` when the car leaves the stage on that lane."""

    def leave(k: int, lane: Lane) -> LaneCost:
        if stage.required not in (None, k):
            return BLOCKED
        if following is None:
            return LaneCost(0.0, 0)
        if following.route_index == stage.route_index:
            return ahead[k]
        ways = route_connections(graph, lane, following.lanes, vehicle_class)
        return min((ahead[graph.lanes[c.to_lane].index] for c in ways), default=BLOCKED)

    def dear(onward: LaneCost, lane: Lane) -> LaneCost:
        return onward._replace(cost=onward.cost + SHARED_LANE_COST) if is_shared(graph, lane) else onward

    return tuple(dear(leave(k, lane), lane) for k, lane in enumerate(stage.lanes))


@kept(8192)
def is_shared(graph: RoadGraph, lane: Lane) -> bool:
    """Whether the map draws an oncoming lane over `lane`: cars of both directions would stand before each other there."""
    oncoming = graph.oncoming(lane.edge_id)
    return any(separation(lane, other) < -SHARED_OVERLAP_M for other in oncoming[-1:])


def _stages(graph: RoadGraph, route: Route) -> Iterator[Stage]:
    """Yield the stages of the route in driving order, cut at its stops."""
    pending = list(route.stops)
    for i, edge_id in enumerate(route.edges):
        lanes = graph.edge_lanes.get(edge_id)
        if not lanes:
            raise PlanError(f"route edge '{edge_id}' is not in the network")
        start = 0.0
        index = {lane.id: lane.index for lane in lanes}
        while pending and pending[0].lane_id in index and pending[0].position >= start:
            stop = pending.pop(0)
            yield Stage(i, lanes, start, stop.position, index[stop.lane_id], stop, graph.left_hand)
            start = stop.position
        if i + 1 < len(route.edges):
            yield Stage(i, lanes, start, lanes[0].length, left_hand=graph.left_hand)
            continue
        arrival = lanes[0].length if route.arrival_position is None else route.arrival_position
        yield Stage(i, lanes, start, max(arrival, start), route.arrival_lane, left_hand=graph.left_hand)
    if pending:
        raise PlanError(f"scheduled stop on lane '{pending[0].lane_id}' at {pending[0].position:.1f} m is not on the route")


def parallel_lanes(choice: LaneChoice, segments: tuple[LaneSegment, ...]) -> Mapping[int, tuple[ParallelLane, ...]]:
    """Return, by route index, the lanes beside C by which the route can be driven with no change back on that edge.

    Where C itself changes lanes on an edge, they are those beside the lane that it comes to: that change comes first.
    """
    lanes = (segment for segment in segments if not choice.graph.lanes[segment.lane_id].is_internal)
    last = {segment.route_index: segment for segment in lanes}
    found = {index: tuple(_beside(choice, segment)) for index, segment in last.items()}
    return {index: ways for index, ways in found.items() if ways}


def _beside(choice: LaneChoice, segment: LaneSegment) -> Iterator[ParallelLane]:
    own, left_hand = choice.graph.lanes[segment.lane_id], choice.graph.left_hand
    number = choice.stage_at(segment.route_index, segment.lane_offset / own.scale)
    lanes, onward = choice.stages[number].lanes, choice.onward[number]
    for index in (own.index + 1, own.index - 1):
        if not 0 <= index < len(lanes) or math.inf in (onward[index].cost, onward[own.index].cost):
            continue  # one of them does not lead on; C may end before it has left its own
        if may_change(own, lanes[index], choice.vehicle_class, left_hand):
            side = -1 if (index > own.index) == left_hand else 1
            cost = 1.0 + onward[index].cost - onward[own.index].cost
            yield ParallelLane(
                from_lane=own.id, to_lane=lanes[index].id, side=side, cost=cost,
                merges=_merges(choice, number, own.index, index), is_inner=index > own.index,
            )  # fmt: skip


def _merges(choice: LaneChoice, number: int, own: int, beside: int) -> bool:
    """Whether lane `own` of a stage ends in a merge with the lane `beside`, to which it yields: an on-ramp's lane."""
    if number + 1 == len(choice.stages) or choice.stages[number + 1].route_index == choice.stages[number].route_index:
        return False
    a, b = choice.connections(number, own)[0], choice.connections(number, beside)[0]
    junction = choice.graph.junctions.get(a.junction_id)
    return junction is not None and a.to_lane == b.to_lane and junction.right_of_way.must_yield(a.index, b.index)


@dataclass(frozen=True, eq=False)
class LaneStep:
    """One stage driven: over `lanes` (two or more: the changes in it), from `start` (m), out by `connection`.

    `connection` is None where the stage ends at a stop on the lane or at the route's end. `opens` says how many steps
    before this one the neighbour lane of the first change already runs along and leads to the same place.
    """

    stage: Stage
    lanes: tuple[Lane, ...]
    start: float
    connection: Connection | None
    opens: int = 0


def lane_path(
    choice: LaneChoice, number: int, lane_index: int, position: float, *, stays: bool = False
) -> Iterator[LaneStep]:
    """Yield the steps from `position` (m) on a lane of stage `number`, which the first step keeps to if it `stays`, to the
    route's end; PlanError: no way."""
    steps: list[LaneStep] = []
    k = lane_index
    for n in range(number, len(choice.stages)):
        stage = choice.stages[n]
        start = position if n == number else stage.start
        leave = k if stays and n == number else _exit_lane(choice, n, k, start)
        step = 1 if leave > k else -1
        lanes = tuple(stage.lanes[j] for j in range(k, leave + step, step))
        following = choice.stages[n + 1] if n + 1 < len(choice.stages) else None
        same_edge = following is not None and following.route_index == stage.route_index
        connection = None if following is None or same_edge else choice.connections(n, leave)[0]
        opens = _parallel_steps(choice, n, steps[1:] if stays else steps, lanes) if len(lanes) > 1 else 0
        steps.append(LaneStep(stage, lanes, start, connection, opens))
        yield steps[-1]
        k = leave if connection is None else choice.graph.lanes[connection.to_lane].index


def _exit_lane(choice: LaneChoice, number: int, lane_index: int, start: float) -> int:
    """Return the lane to leave stage `number` by: least cost, then fewest changes here."""
    stage = choice.stages[number]
    ways = options(stage, lane_index, choice.onward[number], stage.end - start, choice.vehicle_class)
    ranked = min(ways, key=lambda way: (round(way[1].cost, 6), abs(way[0] - lane_index)))
    if ranked[1].cost == math.inf:
        raise PlanError(_break_of(choice, number, stage.lanes[lane_index]))
    return ranked[0]


def _parallel_steps(choice: LaneChoice, number: int, before: list[LaneStep], lanes: tuple[Lane, ...]) -> int:
    """Return how many steps back the lane `lanes[1]` already runs beside the path and leads here."""
    side = lanes[1].index - lanes[0].index
    target, count = lanes[1].index, 0
    for step in reversed(before):
        own = step.lanes[-1]
        beside = own.index + side
        if len(step.lanes) > 1 or not 0 <= beside < len(step.stage.lanes):
            break
        if not may_change(own, step.stage.lanes[beside], choice.vehicle_class, choice.graph.left_hand):
            break
        if not _leads_to(choice, number - count - 1, beside, target):
            break
        target, count = beside, count + 1
    return count


def _leads_to(choice: LaneChoice, number: int, lane_index: int, target: int) -> bool:
    """Whether a lane of stage `number` continues to lane `target` of the next stage."""
    if choice.onward[number][lane_index].cost == math.inf:
        return False
    stage, following = choice.stages[number], choice.stages[number + 1]
    if following.route_index == stage.route_index:
        return lane_index == target
    connections = choice.connections(number, lane_index)
    return any(choice.graph.lanes[c.to_lane].index == target for c in connections)


def _break_of(choice: LaneChoice, number: int, lane: Lane) -> str:
    """Describe where the route from `lane` in stage `number` cannot be driven on."""
    who = f"class '{choice.vehicle_class}'"
    for n in reversed(range(number, len(choice.stages))):
        stage = choice.stages[n]
        if all(onward.cost == math.inf for onward in choice.onward[n]):
            if stage.stop is not None:
                return f"scheduled stop on lane '{stage.stop.lane_id}' cannot be reached or left by {who}"
            if n + 1 == len(choice.stages):
                return f"arrival lane {stage.required} of edge '{stage.lanes[0].edge_id}' does not exist for {who}"
            ahead = choice.stages[n + 1].lanes[0].edge_id
            return f"no lane leads from edge '{stage.lanes[0].edge_id}' to edge '{ahead}' along the route for {who}"
    return f"lane '{lane.id}' has no lane changes that lead along the route for {who}"
