"""What a control step tells of its decision, in full and line by line: a change of any word or figure is seen."""

from __future__ import annotations

import math

import numpy as np

from helpers.situations import Situation
from sumo_reactive.driver.controller import Step
from sumo_reactive.driver.nouns.completed_plan import CompletedPlan, Replanning
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Occupancy, Reason
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.pilot.memory import PilotMemory


def again(ego: Situation, *users: RoadUser, lights: dict[str, str] | None = None) -> Step:
    """Return the step in which the pilot decides a second time, with the plan that it has completed in the first."""
    drive = ego.step(*users, lights=lights).drive
    premises = drive.memory.premises
    assert premises is not None
    forgotten = premises._replace(is_standing=not premises.is_standing)  # an event: it seems to have started or stopped
    drive = ego.drive()._replace(completed=drive.completed, memory=drive.memory._replace(premises=forgotten))
    return ego.step(*users, lights=lights, drive=drive)


def told(ego: Situation, step: Step) -> list[str]:
    """Return orders, reasons, regions, what was foreseen and what the decision rests on; places in m behind the first line
    (behind the ego's front bumper where it has none), figures to two places."""
    completed, memory = step.completed, step.drive.memory
    origin = ego.line if ego.plan.passages else step.snapshot.front
    return [*_orders(completed, origin), *_reasons(completed), *_foreseen(completed, origin), *_rests_on(memory)]


def _orders(completed: CompletedPlan, origin: float) -> list[str]:
    lines = [f"{completed.behaviour.name}: {completed.instruction.name}, {completed.intent.name}"]
    stop, request, aside = completed.stop, completed.request, completed.request.aside
    if stop is not None:
        lines.append(_words("stop at", stop.s - origin, *_until(stop), stop.reason.name, stop.region, stop.cause))
    for one in completed.constraints:
        if not one.is_hard and one.reason is not Reason.ON_SCHEDULE:
            speed = () if one.speed == math.inf else ("to", one.speed)
            whom = ("behind", one.behind) if one.behind else ()
            due = _words("from", one.s - origin, *_until(one), *speed, one.reason.name, one.region, one.cause, *whom)
            lines.append(due)
    if request.what is not Replanning.NOTHING:
        lines.append(_words("asks for", request.what.name, request.change_lane, request.onto, request.route_index))
    if aside is not None:
        lines.append(_words("leads", aside.lateral, "aside", aside.back - origin, aside.until - origin))
    if completed.sight:
        lines.append(_words("looks", completed.sight))
    if completed.move is not None:
        lines.append(_words("moves", completed.move.gear, completed.move.steering_angle, completed.move.until))
    weights, profile = completed.tuning.weights, completed.tuning.profile
    return [*lines, _words("tuned", weights.valley, profile.deceleration, profile.headway)]


def _until(constraint: TimeConstraint) -> tuple[object, ...]:
    return ("until", constraint.time) if constraint.time < math.inf else ()


def _reasons(completed: CompletedPlan) -> list[str]:
    lines = []
    for one in completed.decisions:
        figures = [word for name, value in one.figures for word in (name, value)]
        why = "passes" if one.passes else "because"
        lines.append(_words(one.behaviour.name, why, one.reason.name, one.region, one.cause))
        lines += [_words("-", *figures)] if figures else []
    taken = [one for one in completed.regions if one.occupancy is not Occupancy.FREE]
    lines += [_words(one.occupancy.name, one.region, one.user_id) for one in taken]
    return [*lines, f"{len(completed.regions)} regions"]


def _foreseen(completed: CompletedPlan, origin: float) -> list[str]:
    found = completed.assessment
    lines = [_words(found.outcome.name, "late", found.lateness, "for", found.constraint - origin)]
    if found.encounter is not None:
        meets = found.encounter
        lines.append(_words("meets", meets.user_id, "at", meets.time, meets.s - origin, meets.x, meets.y))
    return lines


def _rests_on(memory: PilotMemory) -> list[str]:
    premises = memory.premises
    assert premises is not None
    flags = {name: value for name, value in premises._asdict().items() if isinstance(value, bool | np.bool_)}
    said = [name for name, value in flags.items() if value]
    counted_on = [f"{user_id} at {region}" for user_id, region in sorted(premises.judged)]
    due = [word for kind, time in premises.due.items() for word in (kind.name, "in", time - premises.time)]
    lines = [_words("rests on", *sorted(premises.speeds), *said, *due), *counted_on]
    lines.append(_words(len(premises.regions), "can be reached, stages", *(tuple(map(int, one)) for one in premises.stages)))
    lines.append(_words("may go by", *memory.released, *memory.yellows, "stopped at", memory.stopped_at))
    return [*lines, _words("delay", memory.delay, "on", memory.progress_time, memory.escapes, *_under_way(memory))]


def _under_way(memory: PilotMemory) -> list[object]:
    """Return since when or up to when what lasts lasts."""
    found = {"waits since": memory.waiting_since, "serves until": memory.serving_until, "move": memory.move}
    under_way = memory.overtaking
    passing = ["passing", *under_way.user_ids, under_way.since, under_way.instruction.name] if under_way else []
    return [*passing, *(word for name, value in found.items() if value is not None for word in (name, value))]


def _words(*what: object) -> str:
    """Return it as one line; what is empty is left out."""
    return " ".join(f"{one + 0.0:.2f}" if isinstance(one, float) else str(one) for one in what if one != "")
