"""The lane sequence that the plan drives: the cheapest one that changes lanes as late as it can."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from sumo_reactive.driver.path.lane_choice import LaneChoice, Stage, may_change, options
from sumo_reactive.driver.world.junction import Connection
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.errors import PlanError


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


def lane_path(choice: LaneChoice, number: int, lane_index: int, position: float) -> Iterator[LaneStep]:
    """Yield the steps from `position` (m) on a lane of stage `number` to the route's end; PlanError: no way."""
    steps: list[LaneStep] = []
    k = lane_index
    for n in range(number, len(choice.stages)):
        stage = choice.stages[n]
        start = position if n == number else stage.start
        leave = _exit_lane(choice, n, k, start)
        step = 1 if leave > k else -1
        lanes = tuple(stage.lanes[j] for j in range(k, leave + step, step))
        following = choice.stages[n + 1] if n + 1 < len(choice.stages) else None
        same_edge = following is not None and following.route_index == stage.route_index
        connection = None if following is None or same_edge else choice.connections(n, leave)[0]
        opens = _parallel_steps(choice, n, steps, lanes) if len(lanes) > 1 else 0
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
        if all(outlook.cost == math.inf for outlook in choice.onward[n]):
            if stage.stop is not None:
                return f"scheduled stop on lane '{stage.stop.lane_id}' cannot be reached or left by {who}"
            if n + 1 == len(choice.stages):
                return f"arrival lane {stage.required} of edge '{stage.lanes[0].edge_id}' does not exist for {who}"
            ahead = choice.stages[n + 1].lanes[0].edge_id
            return f"no lane leads from edge '{stage.lanes[0].edge_id}' to edge '{ahead}' along the route for {who}"
    return f"lane '{lane.id}' has no lane changes that lead along the route for {who}"
