"""The stops of the route: where, and for how long (F&L 1991, §2)."""

from __future__ import annotations

from dataclasses import replace

from sumo_reactive.driver.nouns.constraint import TimeConstraint, stop_at
from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.nouns.plan import NominalPlan, PlannedStop
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.passages import Ahead, reach_of

STOP_REACHED_M = 2.0
"""A stop counts as reached when the ego stands this close before it."""


def pending_stop(plan: NominalPlan, memory: PilotMemory) -> PlannedStop | None:
    """Return the next scheduled stop that has not been served."""
    return next((planned for planned in plan.stops if planned.stop not in memory.served), None)


def is_next(snapshot: Snapshot, plan: NominalPlan, ahead: Ahead, memory: PilotMemory) -> bool:
    """Whether a stop of the route is in reach, and the ego comes to no line before it where somebody may cross its path or a
    light speaks."""
    planned = pending_stop(plan, memory)
    if planned is None or planned.s - snapshot.front > reach_of(snapshot):
        return False
    lines = (plan.passages[i].start for i, connection, conflicts in ahead if conflicts or connection.light)
    return not any(snapshot.front < line < planned.s for line in lines)


def still_to_serve(plan: NominalPlan, memory: PilotMemory, time: float) -> tuple[PlannedStop, ...]:
    """Return the stops not yet served at `time` (s), the one that is being served for as long as is left of it."""
    left = tuple(planned for planned in plan.stops if planned.stop not in memory.served)
    if memory.serving_until is None or not left:
        return left
    serving = replace(left[0].stop, duration=max(memory.serving_until - time, 0.0), until=None)
    return replace(left[0], stop=serving), *left[1:]


def serve(snapshot: Snapshot, plan: NominalPlan, memory: PilotMemory) -> tuple[TimeConstraint | None, PilotMemory]:
    """Stop where the route says, stay for the duration and not before `until`, then go on."""
    planned = pending_stop(plan, memory)
    if planned is None:
        return None, memory
    stop = planned.stop
    if memory.serving_until is None:
        if snapshot.ego.speed < STANDING_SPEED and planned.s - snapshot.front < STOP_REACHED_M:
            memory = memory._replace(serving_until=max(snapshot.time + stop.duration, stop.until or 0.0))
    elif snapshot.time >= memory.serving_until:
        return None, memory._replace(served=(*memory.served, stop), serving_until=None)
    return stop_at(planned.s, Reason.SCHEDULED_STOP, cause=stop.lane_id), memory
