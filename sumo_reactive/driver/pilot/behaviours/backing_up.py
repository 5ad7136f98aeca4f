"""Leaving local minima: an ego that does not get on, though nobody has the right to block it (F&L 1991, §3.3)."""

from __future__ import annotations

import math
from typing import NamedTuple

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.nouns.completed_plan import Replanning
from sumo_reactive.driver.nouns.constraint import TimeConstraint, stop_at
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Instruction, Reason
from sumo_reactive.driver.nouns.event import EventKind
from sumo_reactive.driver.nouns.snapshot import PathObstacle
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.pilot.passed import lateral_for, passed
from sumo_reactive.driver.pilot.situation import BehaviourRule, Situation
from sumo_reactive.driver.vehicle.body import clear_behind

BACK_UP_CLEAR_M = 2.0
"""Room that must be left behind the ego after backing up."""

_TOO_NEAR_M = 1.5
"""An ego that stands by this much nearer than `halted_room_m` backs up…"""

_BACKED_UP_M = 0.02
"""…until it is no nearer than by this."""

_NO_RIGHT = (Reason.BLOCKED, Reason.NO_GAP, Reason.MUTUAL_WAIT)
"""Stops for these reasons are nobody's right."""

_KEPT_WITHIN_M = 10.0
"""A place to stop at, or somebody ahead, that is farther away is not what keeps a standing ego where it is."""

_SQUEEZING_SPEED = 1.0
"""m/s; walking speed: no faster than this does the ego squeeze past a body that stands in its corridor."""


class Escape(NamedTuple):
    """A way out of a local minimum: an instruction, a stop that goes with it, a new curve, a speed not to exceed (m/s), whom
    the ego lets go; and the decision behind it."""

    decision: Decision
    instruction: Instruction | None = None
    stop: TimeConstraint | None = None
    replanning: Replanning = Replanning.NOTHING
    top_speed: float = math.inf
    let_go: tuple[str, ...] = ()


def room_behind(situation: Situation) -> TimeConstraint | None:
    """Return the place to stop behind somebody who has halted, far enough to swing out past him later; None: no need."""
    x, snapshot = situation.ahead_of_ego, situation.snapshot
    if x is None or not x.user.is_halted or lateral_for(situation, passed(situation, x))[0] == 0.0:
        return None
    place = x.start - situation.limits.parameters.halted_room_m
    braking = snapshot.ego.speed**2 / (2.0 * situation.limits.comfort_deceleration)
    if place < snapshot.front and snapshot.ego.speed < STANDING_SPEED and not _is_too_near(situation, x):
        place = snapshot.front  # near enough to the room it needs: stay
    return stop_at(place, Reason.BLOCKED, cause=x.user.id) if place >= snapshot.front + braking - 0.5 else None


def escape(situation: Situation) -> Escape | None:
    """Return a way out, tried in this order; None when there is nothing to escape from.

    Somebody who has halted too near to swing out: back up at walking speed. Somebody who waits in the corridor, but does
    not drive the ego's way: squeeze past, if any command of a wider grid with a weaker hold of C touches nobody. Nobody in
    the way: a new C, then that wider grid.
    """
    x = situation.ahead_of_ego
    if x is not None and _is_too_near(situation, x):
        place = x.start - situation.limits.parameters.halted_room_m
        stop = stop_at(place, Reason.BLOCKED, cause=x.user.id)
        decision = Decision(behaviour=Behaviour.BACKING_UP, reason=Reason.BLOCKED, cause=x.user.id)
        return Escape(decision, Instruction.BACK_UP, stop)
    due = any(event.kind is EventKind.NO_PROGRESS for event in situation.events)
    if not (due or situation.memory.escapes > 0) or has_right(situation, x):
        return None
    if x is not None and x.start - situation.snapshot.front < situation.limits.parameters.halted_room_m + 1.0:
        decision = Decision(behaviour=Behaviour.STOPPING, reason=Reason.BLOCKED, cause=x.user.id)
        return Escape(decision) if x.user.is_halted else Escape(decision, Instruction.WIDEN, top_speed=_SQUEEZING_SPEED)
    decision = Decision(behaviour=Behaviour.STOPPING, reason=Reason.NO_PROGRESS)
    if situation.memory.escapes % 2 == 0:
        return Escape(decision, replanning=Replanning.CURVE if due else Replanning.NOTHING)
    return Escape(decision, Instruction.WIDEN, top_speed=_SQUEEZING_SPEED)


def is_right(stop: TimeConstraint | None, front: float) -> bool:
    """Whether the ego, whose bumper is at `front` m of C, stands for a place to stop at that is somebody's right."""
    return stop is not None and stop.s < front + _KEPT_WITHIN_M and stop.reason not in _NO_RIGHT


def has_right(situation: Situation, x: PathObstacle | None) -> bool:
    """Whether a rule, or somebody who waits himself, keeps the ego where it is."""
    return is_right(situation.stop, situation.snapshot.front) or is_queued(situation, x)


def is_queued(situation: Situation, x: PathObstacle | None) -> bool:
    """Whether the ego stands behind somebody who drives its way and waits himself, and not for the ego."""
    if x is None or x.start >= situation.snapshot.front + _KEPT_WITHIN_M or x.user.is_halted:
        return False
    if _waits_for_ego(situation, x):
        return False
    return x.along > -STANDING_SPEED and _same_way(situation, x)


def _waits_for_ego(situation: Situation, x: PathObstacle) -> bool:
    """Whether somebody who comes from another road has the ego ahead of him as it has him."""
    if any(segment.lane_id == x.user.lane_id for segment in situation.plan.segments):
        return False
    return any(one.user_id == x.user.id and one.is_waiting for one in situation.outlook.hindered)


def _same_way(situation: Situation, x: PathObstacle) -> bool:
    return math.cos(x.user.heading - situation.plan.curve.at(x.start)[2]) > 0.0


def _is_too_near(situation: Situation, x: PathObstacle) -> bool:
    """Whether the ego stands behind somebody who has halted, with a lane to pass on but no room to swing out."""
    snapshot = situation.snapshot
    if not x.user.is_halted or snapshot.ego.speed > STANDING_SPEED or situation.memory.overtaking is not None:
        return False
    gap = x.start - snapshot.front
    backing = snapshot.ego.speed < -STANDING_SPEED
    enough = situation.limits.parameters.halted_room_m - (_BACKED_UP_M if backing else _TOO_NEAR_M)
    if gap > enough or _would_back_into_junction(situation, x) or lateral_for(situation, passed(situation, x))[0] == 0.0:
        return False
    clear = clear_behind(snapshot.boxes, snapshot.ego.pose, situation.limits)
    return clear >= situation.limits.parameters.halted_room_m - gap + BACK_UP_CLEAR_M


def _would_back_into_junction(situation: Situation, x: PathObstacle) -> bool:
    """Whether the ego's rear would come to stand inside an intersection that it has passed."""
    rear, front = x.start - situation.limits.parameters.halted_room_m - situation.limits.length, situation.snapshot.front
    return any(passage.start < front and rear < passage.end for passage in situation.plan.passages)


def is_too_near(situation: Situation) -> bool:
    """The ego stands too near behind somebody who has halted to swing out past him, and there is room behind."""
    x = situation.ahead_of_ego
    return x is not None and situation.limits.parameters.has(Mechanism.ESCAPE) and _is_too_near(situation, x)


def has_room(situation: Situation) -> bool:
    """There is room to swing out, or nobody to pass."""
    return not is_too_near(situation)


def reverse(situation: Situation) -> Instruction:
    """Back up at walking speed."""
    return Instruction.BACK_UP


RULE = BehaviourRule(Behaviour.BACKING_UP, (is_too_near,), reverse, (has_room,))
