"""What activates the pilot: everything that differs from what it took for granted (F&L 1991, §2)."""

from __future__ import annotations

import math

from sumo_reactive.driver.nouns.completed_plan import CompletedPlan
from sumo_reactive.driver.nouns.decision import Instruction
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import Foe, PathObstacle, Snapshot
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.pilot.behaviours.backing_up import is_right
from sumo_reactive.driver.pilot.behaviours.changing_lanes import seeks
from sumo_reactive.driver.pilot.behaviours.turning_round import is_in_reach
from sumo_reactive.driver.pilot.memory import PilotMemory, Premises
from sumo_reactive.driver.pilot.overturned import overturned
from sumo_reactive.driver.pilot.passages import Ahead, View, reach_of
from sumo_reactive.driver.pilot.rules.highway_code import Rule, Rules
from sumo_reactive.driver.pilot.rules.region import ENTERING_M, intent_of
from sumo_reactive.driver.pilot.rules.scheduled_stop import is_next
from sumo_reactive.driver.pilot.situation import next_on_way
from sumo_reactive.driver.pilot.transitions import RULES

FAR, NEAR, ENTERING, INSIDE = range(4)
"""How far the ego has come in a passage: out of reach, within cautious reach, just before its line, past it."""


def detect(
    snapshot: Snapshot, plan: NominalPlan, ahead: Ahead, held: CompletedPlan | None, memory: PilotMemory, no_command: bool
) -> tuple[Event, ...]:
    """Return every event since the pilot last decided; none means that its plan `held` stays in force.

    `no_command`: the executor's feedback that no command was admissible.
    """
    premises = memory.premises
    if held is None or premises is None or premises.plan is not plan:
        new_route = (Event(EventKind.NEW_ROUTE, plan.missed),) if plan.missed else ()
        return (Event(EventKind.NEW_PLAN), *new_route)
    late, nominal = plan.on_schedule(snapshot.s, snapshot.time)
    found = _others(snapshot, held, memory, premises)
    found += _own(snapshot, nominal, ahead, memory, premises)
    found += _times(snapshot, late, held, memory, premises)
    if no_command:
        found.append(Event(EventKind.NO_COMMAND))
    return tuple(found)


def premises_of(
    view: View, made: CompletedPlan, memory: PilotMemory, rules: Rules, *, looks_beside_s: float, is_settled: bool
) -> Premises:
    """Return what the decision `made` now rests on; `rules`: what the highway code asked for.

    `looks_beside_s`: after so long it looks anew at the lane beside (infinite: never); `is_settled`: it rests on none of the
    others, for a light or a time decides.
    """
    snapshot, ahead, p = view.snapshot, view.ahead, view.limits.parameters
    plan, regions = made.plan, frozenset(foe.conflict.region.id for foe in snapshot.foes)
    is_seeking, asks = seeks(snapshot, plan), Rule.REGION in RULES[made.behaviour].asks
    others: tuple[PathObstacle | Foe, ...] = (*snapshot.on_path, *(snapshot.foes if asks else ()))
    due = {}
    looks_beside_s = p.trust_s if is_seeking else looks_beside_s
    if not is_settled and looks_beside_s < math.inf:
        due[EventKind.GAP_SOUGHT] = snapshot.time + looks_beside_s
    if not is_settled and (memory.overtaking or made.sight):
        due[EventKind.PASS_TRIED] = snapshot.time + (p.trust_s if memory.overtaking or _is_blocked(snapshot) else p.retry_s)
    return Premises(
        view=view,
        speeds={one.user.id: one.user.speed for one in others},
        judged={(one.foe.user.id, one.region): one for one in rules.judged},
        exits=rules.exits,
        regions=regions,
        stages=_stages(snapshot, plan, ahead, regions),
        is_standing=snapshot.ego.speed < STANDING_SPEED,
        is_off_nominal=_is_off_nominal(snapshot, plan.on_schedule(snapshot.s, snapshot.time)[1]),
        is_seeking=is_seeking,
        is_settled=is_settled,
        asks=asks,
        halts=_halts(snapshot, plan, ahead, memory),
        due=due,
    )


def _is_blocked(snapshot: Snapshot) -> bool:
    """Whether somebody stands in the ego's way: the gap in which he can be passed is not to be missed."""
    x = next_on_way(snapshot)
    return x is not None and x.user.speed < STANDING_SPEED


def _others(snapshot: Snapshot, held: CompletedPlan, memory: PilotMemory, premises: Premises) -> list[Event]:
    """Return what the others and the lights have changed."""
    found: list[Event] = []
    known = premises.view.snapshot.lights
    for light, letters in snapshot.lights.items():
        if known.get(light) != letters:
            found.append(Event(EventKind.LIGHT_CHANGE, light))
    if premises.is_settled:
        return found
    speeds, trusted = {one.user.id: one.user.speed for one in snapshot.on_path}, premises.speeds
    tolerance = snapshot.parameters.behaviour_tolerance
    for user_id, speed in speeds.items():
        foreseen = trusted.get(user_id)
        if foreseen is None:
            found.append(Event(EventKind.NEW_OBSTACLE, user_id))
        elif abs(speed - foreseen) > tolerance or (speed < STANDING_SPEED) != (foreseen < STANDING_SPEED):
            found.append(Event(EventKind.OTHER_BEHAVIOUR, user_id))
    if snapshot.asker is not premises.view.snapshot.asker and _asker(snapshot) != _asker(premises.view.snapshot):
        found.append(Event(EventKind.ASKED, _asker(snapshot)))
    stop = held.stop
    if stop is not None and stop.cause not in speeds and _was_there(stop.cause, premises):
        found.append(Event(EventKind.CAUSE_VANISHED, stop.cause))
    if snapshot.foes or premises.judged or premises.exits:
        found += [event for event in overturned(snapshot, memory, premises) if event not in found]
    return found


def _asker(snapshot: Snapshot) -> str:
    """Return who asks to be let in (empty: nobody)."""
    return "" if snapshot.asker is None else snapshot.asker.user.id


def _was_there(user_id: str, premises: Premises) -> bool:
    """Whether somebody was in the corridor."""
    return any(obstacle.user.id == user_id for obstacle in premises.view.snapshot.on_path)


def _own(
    snapshot: Snapshot, nominal: float, ahead: Ahead, memory: PilotMemory, premises: Premises
) -> list[Event]:
    """Return what the ego itself has come to, whose `nominal` speed it is (m/s)."""
    found, plan = list[Event](), premises.plan
    if _stages(snapshot, plan, ahead, premises.regions) != premises.stages:
        found.append(Event(EventKind.INTERSECTION, next((plan.passages[i].junction_id for i, _, _ in ahead), "")))
    if not premises.halts and (plan.stops or plan.turnarounds) and _halts(snapshot, plan, ahead, memory):
        found.append(Event(EventKind.STOP_AHEAD))
    if not premises.is_seeking and seeks(snapshot, plan):
        found.append(Event(EventKind.LANE_CHANGE))
    if (snapshot.ego.speed < STANDING_SPEED) != premises.is_standing:
        found.append(Event(EventKind.STANDSTILL))
    if not premises.is_off_nominal and _is_off_nominal(snapshot, nominal):
        found.append(Event(EventKind.OFF_NOMINAL))
    return found


def _halts(snapshot: Snapshot, plan: NominalPlan, ahead: Ahead, memory: PilotMemory) -> bool:
    """Whether a place to halt at, by the route or for a turn in several moves, is in reach."""
    return is_next(snapshot, plan, ahead, memory) or is_in_reach(snapshot, plan)


def _times(
    snapshot: Snapshot, late: float, held: CompletedPlan, memory: PilotMemory, premises: Premises
) -> list[Event]:
    """Return what is due with an ego that is so `late` (s): times that the plan or an instruction named, delays, want of
    progress."""
    now = snapshot.time
    found = [Event(kind) for kind, due in premises.due.items() if now >= due - 1e-6]
    if memory.serving_until is not None and now >= memory.serving_until:
        found.append(Event(EventKind.TIME_REACHED))
    if not premises.is_settled:
        due = next((one.time for one in held.schedule if one.s > snapshot.front), math.inf)
        if now > due + snapshot.parameters.time_tolerance_s:
            found.append(Event(EventKind.CONSTRAINT_MISSED))
        if late > memory.delay + snapshot.parameters.delay_step_s:
            found.append(Event(EventKind.DELAY))
        if intent_of(held.stop, snapshot, memory) is not held.intent:
            found.append(Event(EventKind.TIME_REACHED, held.stop.cause if held.stop else ""))
    if now - memory.progress_time > snapshot.parameters.no_progress_s * (memory.escapes + 1):
        found.append(Event(EventKind.NO_PROGRESS))
        if not is_right(held.stop, snapshot.front):
            found.append(Event(EventKind.LOCKED))
    if held.move is not None and held.move.is_over(snapshot.ego):
        found.append(Event(EventKind.MOVE_ENDED))
    if memory.escapes == 0 and held.instruction is Instruction.WIDEN:
        found.append(Event(EventKind.PROGRESS))
    return found


def _is_off_nominal(snapshot: Snapshot, nominal: float) -> bool:
    return abs(snapshot.ego.speed - nominal) > snapshot.parameters.off_nominal_speed


def _stages(snapshot: Snapshot, plan: NominalPlan, ahead: Ahead, regions: frozenset[str]) -> tuple[tuple[int, ...], ...]:
    """Return for each passage in sight the ego's stage, its index and how many of `regions` the front bumper has reached."""
    front = snapshot.front
    reach = reach_of(snapshot)
    found = []
    for i, connection, conflicts in ahead:
        if not conflicts and connection.light is None:
            continue
        inside = front - plan.passages[i].start
        stage = FAR if inside < -reach else NEAR if inside < -ENTERING_M else ENTERING if inside <= 0.0 else INSIDE
        if snapshot.s >= plan.passages[i].end:
            continue
        reached = sum(c.region.id in regions and inside > c.region.own.start for c in conflicts) if stage == INSIDE else 0
        found.append((stage, i, reached))
    return tuple(found)
