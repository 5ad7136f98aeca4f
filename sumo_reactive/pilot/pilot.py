"""The pilot: one look at the snapshot, one completed plan (F&L 1991, §2)."""

from __future__ import annotations

from sumo_reactive.messages.completed_plan import CompletedPlan, Intent, Weights
from sumo_reactive.messages.decision import Behaviour, Decision, Reason, StopAt
from sumo_reactive.messages.plan import NominalPlan, TimeConstraint
from sumo_reactive.messages.snapshot import Conflict, Snapshot
from sumo_reactive.parameters import CAUTIOUS_AHEAD_M, CAUTIOUS_AHEAD_S, STANDING_SPEED
from sumo_reactive.pilot.behaviours import cautious, crossing, normal, stopping
from sumo_reactive.pilot.behaviours.crossing import Crossing
from sumo_reactive.pilot.lane_changing import seek_gap
from sumo_reactive.pilot.memory import PilotMemory
from sumo_reactive.vehicle.limits import VehicleLimits
from sumo_reactive.world.junction import Connection

_WEIGHTS: dict[Behaviour, Weights] = {
    Behaviour.NORMAL: normal.WEIGHTS,
    Behaviour.CAUTIOUS: cautious.WEIGHTS,
    Behaviour.STOPPING: stopping.WEIGHTS,
    Behaviour.CROSSING: crossing.WEIGHTS,
}

Ahead = tuple[tuple[int, Connection, tuple[Conflict, ...]], ...]
"""The passages in sight: index in the plan, connection, conflicts."""


def decide(
    snapshot: Snapshot, plan: NominalPlan, ahead: Ahead, memory: PilotMemory, limits: VehicleLimits
) -> tuple[CompletedPlan, PilotMemory]:
    """Complete the plan: whom to follow, where to stop and why, what to tell the others.

    1. remember standing; 2. leaders; 3. scheduled stop; 4. lane change; 5. each passage: line, regions, exit;
    6. the nearest stop wins.
    """
    memory = _stand(snapshot, memory)
    ahead_of_ego = tuple(normal.leaders(snapshot, limits))
    stop, memory = stopping.serve(snapshot, plan, memory)
    changing = seek_gap(snapshot, plan, limits)
    candidates = [(s, _decision(s)) for s in (stop, changing.stop) if s is not None]
    found = list(crossing.crossings(snapshot, plan, ((i, c) for i, c, _ in ahead)))
    for way, (_, _, conflicts) in zip(found, ahead, strict=True):
        waits, memory = _passage(way, conflicts, snapshot, memory, limits)
        candidates.extend(waits)
    nearest = min((s for s, _ in candidates), key=lambda s: s.s, default=None)
    behaviour = _behaviour(snapshot, nearest, found, ahead)
    completed = CompletedPlan(
        plan=plan,
        behaviour=behaviour,
        target=_target(snapshot, plan),
        stop=nearest,
        leaders=ahead_of_ego,
        slot=changing.slot,
        weights=_WEIGHTS[behaviour],
        intent=_intent(snapshot, nearest),
        decisions=tuple(d for _, d in candidates),
        change_lane=changing.side,
    )
    return completed, memory


def _stand(snapshot: Snapshot, memory: PilotMemory) -> PilotMemory:
    if snapshot.ego.speed >= STANDING_SPEED:
        return memory._replace(standing_since=None) if memory.standing_since is not None else memory
    return memory if memory.standing_since is not None else memory._replace(standing_since=snapshot.time)


def _passage(
    way: Crossing, conflicts: tuple[Conflict, ...], snapshot: Snapshot, memory: PilotMemory, limits: VehicleLimits
) -> tuple[list[tuple[StopAt, Decision]], PilotMemory]:
    """Return the stops that one passage asks for: at its line, before its regions, for want of room behind them."""
    waits: list[tuple[StopAt, Decision]] = []
    at_line, memory = cautious.stop_at_line(way.passage, way.connection, snapshot, memory, limits)
    if at_line is not None:
        waits.append((at_line, _decision(at_line)))
    region = crossing.stop_before_region(way, snapshot, memory, limits)
    if region is not None:
        waits.append((region[0], _decision(region[0], region[1].figures)))
    blocker = crossing.exit_is_blocked(way, snapshot, limits, conflicts)
    if blocker:
        stop = StopAt(way.passage.start, Reason.EXIT_BLOCKED, region=way.connection.id, cause=blocker)
        waits.append((stop, _decision(stop)))
    return [w for w in waits if w[0].s >= snapshot.front - limits.front_overhang], memory


def _decision(stop: StopAt, figures: tuple[tuple[str, float], ...] = ()) -> Decision:
    at_location = stop.reason in (Reason.SCHEDULED_STOP, Reason.NO_GAP)
    behaviour = Behaviour.STOPPING if at_location else Behaviour.CAUTIOUS
    return Decision(behaviour, stop.reason, stop.region, stop.cause, figures=figures)


def _behaviour(snapshot: Snapshot, stop: StopAt | None, ways: list[Crossing], ahead: Ahead) -> Behaviour:
    if stop is not None and stop.reason is Reason.SCHEDULED_STOP:
        return Behaviour.STOPPING
    for way, (_, _, conflicts) in zip(ways, ahead, strict=True):
        to_line = way.passage.start - snapshot.front
        if to_line < 0.0 < way.passage.end - snapshot.s and conflicts:
            return Behaviour.CROSSING
        if to_line < CAUTIOUS_AHEAD_M + CAUTIOUS_AHEAD_S * snapshot.ego.speed and (conflicts or way.connection.light):
            return Behaviour.CAUTIOUS
    return Behaviour.NORMAL


def _target(snapshot: Snapshot, plan: NominalPlan) -> TimeConstraint:
    for constraint in plan.time_constraints:
        if constraint.s > snapshot.front:
            return constraint
    return TimeConstraint(plan.curve.length, snapshot.time)


def _intent(snapshot: Snapshot, stop: StopAt | None) -> Intent:
    if stop is None or snapshot.ego.speed >= STANDING_SPEED:
        return Intent.DRIVE
    return Intent.GO_NEXT if stop.reason is Reason.WAIT_FOR_TURN else Intent.YIELD

