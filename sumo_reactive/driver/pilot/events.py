"""What activates the pilot: everything that differs from what it took for granted (F&L 1991, §2)."""

from __future__ import annotations

import math
from collections.abc import Mapping

from sumo_reactive.driver.nouns.completed_plan import CompletedPlan
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Instruction, Reason
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import Snapshot
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
    found = _others(snapshot, held, memory, premises)
    found += _own(snapshot, plan, ahead, memory, premises)
    found += _times(snapshot, held, memory, premises)
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
    due = {}
    looks_beside_s = p.trust_s if is_seeking else looks_beside_s
    if not is_settled and looks_beside_s < math.inf:
        due[EventKind.GAP_SOUGHT] = snapshot.time + looks_beside_s
    if not is_settled and (memory.overtaking or made.sight):
        due[EventKind.PASS_TRIED] = snapshot.time + (p.trust_s if memory.overtaking or _is_blocked(snapshot) else p.retry_s)
    return Premises(
        view=view,
        speeds=_speeds(snapshot) | ({foe.user.id: foe.user.speed for foe in snapshot.foes} if asks else {}),
        judged={(one.foe.user.id, one.region): one for one in rules.judged},
        exits=rules.exits,
        regions=regions,
        stages=_stages(snapshot, plan, ahead, regions),
        is_standing=snapshot.ego.speed < STANDING_SPEED,
        is_off_nominal=_is_off_nominal(snapshot, plan),
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
    speeds, trusted = _speeds(snapshot), premises.speeds
    tolerance = snapshot.parameters.behaviour_tolerance
    for user_id, speed in speeds.items():
        foreseen = trusted.get(user_id)
        if foreseen is None:
            found.append(Event(EventKind.NEW_OBSTACLE, user_id))
        elif abs(speed - foreseen) > tolerance or (speed < STANDING_SPEED) != (foreseen < STANDING_SPEED):
            found.append(Event(EventKind.OTHER_BEHAVIOUR, user_id))
    if _asker(snapshot) != _asker(premises.view.snapshot):
        found.append(Event(EventKind.ASKED, _asker(snapshot)))
    stop = held.stop
    if stop is not None and _is_gone(stop, speeds, premises):
        found.append(Event(EventKind.CAUSE_VANISHED, stop.cause))
    found += [event for event in overturned(snapshot, memory, premises) if event not in found]
    return found


def _asker(snapshot: Snapshot) -> str:
    """Return who asks to be let in (empty: nobody)."""
    return "" if snapshot.asker is None else snapshot.asker.user.id


def _is_gone(stop: TimeConstraint, speeds: Mapping[str, float], premises: Premises) -> bool:
    """Whether the road user in the corridor that the ego stops for is out of it."""
    return stop.cause not in speeds and any(one.user.id == stop.cause for one in premises.view.snapshot.on_path)


def _own(
    snapshot: Snapshot, plan: NominalPlan, ahead: Ahead, memory: PilotMemory, premises: Premises
) -> list[Event]:
    """Return what the ego itself has come to."""
    found: list[Event] = []
    if _stages(snapshot, plan, ahead, premises.regions) != premises.stages:
        found.append(Event(EventKind.INTERSECTION, next((plan.passages[i].junction_id for i, _, _ in ahead), "")))
    if not premises.halts and _halts(snapshot, plan, ahead, memory):
        found.append(Event(EventKind.STOP_AHEAD))
    if not premises.is_seeking and seeks(snapshot, plan):
        found.append(Event(EventKind.LANE_CHANGE))
    if (snapshot.ego.speed < STANDING_SPEED) != premises.is_standing:
        found.append(Event(EventKind.STANDSTILL))
    if not premises.is_off_nominal and _is_off_nominal(snapshot, plan):
        found.append(Event(EventKind.OFF_NOMINAL))
    return found


def _halts(snapshot: Snapshot, plan: NominalPlan, ahead: Ahead, memory: PilotMemory) -> bool:
    """Whether a place to halt at, by the route or for a turn in several moves, is in reach."""
    if not plan.stops and not plan.turnarounds:
        return False
    return is_next(snapshot, plan, ahead, memory) or is_in_reach(snapshot, plan)


def _times(snapshot: Snapshot, held: CompletedPlan, memory: PilotMemory, premises: Premises) -> list[Event]:
    """Return what is due: times that the plan or an instruction named, delays, want of progress."""
    now = snapshot.time
    found = [Event(kind) for kind, due in premises.due.items() if now >= due - 1e-6]
    if memory.serving_until is not None and now >= memory.serving_until:
        found.append(Event(EventKind.TIME_REACHED))
    if not premises.is_settled:
        found += _late(snapshot, held, memory)
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


def _late(snapshot: Snapshot, held: CompletedPlan, memory: PilotMemory) -> list[Event]:
    """Return what a delay has changed: the next time constraint, and whether it has become excessive."""
    found: list[Event] = []
    front = snapshot.front
    for target in held.constraints:
        if target.reason is Reason.ON_SCHEDULE and target.s > front:
            if snapshot.time > target.time + snapshot.parameters.time_tolerance_s:
                found.append(Event(EventKind.CONSTRAINT_MISSED))
            break
    if held.plan.delay(snapshot.s, snapshot.time) > memory.delay + snapshot.parameters.delay_step_s:
        found.append(Event(EventKind.DELAY))
    return found


def _speeds(snapshot: Snapshot) -> dict[str, float]:
    return {obstacle.user.id: obstacle.user.speed for obstacle in snapshot.on_path}


def _is_off_nominal(snapshot: Snapshot, plan: NominalPlan) -> bool:
    return abs(snapshot.ego.speed - plan.nominal_speed(snapshot.s)) > snapshot.parameters.off_nominal_speed


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
