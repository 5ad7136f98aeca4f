"""Overtaking: pass somebody slower, or somebody who stands, where the law and the others leave room (F&L 1991, §2)."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

from sumo_reactive.driver.nouns.decision import Behaviour, Instruction, Reason
from sumo_reactive.driver.nouns.plan import Aside
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.pilot.instructions import PASSING_HEADWAY
from sumo_reactive.driver.pilot.manoeuvre import in_the_way_back, proof, proof_under_way
from sumo_reactive.driver.pilot.memory import Overtaking
from sumo_reactive.driver.pilot.passed import (
    Passed,
    ahead_on_lane,
    find,
    follows_within,
    is_clear_of,
    is_slow,
    lane_in_use,
    lateral_for,
    legal_end,
    passed,
)
from sumo_reactive.driver.pilot.situation import BehaviourRule, Proof, Situation
from sumo_reactive.driver.vehicle.safe_speed import following_speed

HALTED_AHEAD_S = 4.0
"""Somebody who has halted counts from this far on, so that the ego need not stop behind him."""

FALL_BACK_BY = 4.0
"""m/s; so much slower than X the ego drops back beside it."""

BESIDE_S = 1.5
"""So long before it would come back C is led on beside X if the ego is not clear of it."""

UPDATE_ASIDE_M = 4.0
"""The place of return is planned anew when it moves by more."""


def follows_x(situation: Situation) -> bool:
    """M follows X: X is next on C, near, slow against the road, or it has halted."""
    x = situation.ahead_of_ego
    if x is None or situation.snapshot.ego.speed < -STANDING_SPEED:
        return False
    speed, gap, p = situation.snapshot.ego.speed, x.start - situation.snapshot.front, situation.limits.parameters
    if x.user.is_halted:
        return gap < p.following_m + HALTED_AHEAD_S * speed
    road = situation.plan.road_speed(situation.snapshot.s)
    return is_slow(x.along, road, p) and gap < follows_within(speed, p)


def has_settled(situation: Situation) -> bool:
    """|v − v_d| < k₁, with v_d the speed that following X allows."""
    x, limits, snapshot = situation.ahead_of_ego, situation.limits, situation.snapshot
    if x is None:
        return False
    gap = x.start - snapshot.front - limits.standstill_gap
    allowed = following_speed(gap, max(x.along, 0.0), limits.comfort_deceleration, limits.time_headway)
    wanted = min(allowed, situation.plan.road_speed(snapshot.s))
    return x.user.is_halted or abs(snapshot.ego.speed - wanted) < situation.limits.parameters.settled_speed


def is_late(situation: Situation) -> bool:
    """Delay > k₂: the assessment finds the plan degraded, or X will not move at all."""
    x = situation.ahead_of_ego
    is_degraded = situation.assessment.lateness > situation.limits.parameters.excessive_delay_s
    return is_degraded or (x is not None and x.user.is_halted)


def is_legal(situation: Situation) -> bool:
    """There is a lane to pass on, and X is far enough from the next intersection."""
    x = situation.ahead_of_ego
    if x is None:
        return False
    target = passed(situation, x)
    lateral, lane = lateral_for(situation, target)
    return lateral != 0.0 and legal_end(situation, target, lane) > x.end


def has_looked(situation: Situation) -> bool:
    """M has looked far enough along the road, at all who are on it."""
    return situation.outlook.sight >= situation.limits.parameters.overtaking_sight_m


def gap_is_proven(situation: Situation) -> bool:
    """The simulated manoeuvre meets nobody, out, past X and back."""
    return situation.proof is not None and situation.proof.aside is not None


def is_back(situation: Situation) -> bool:
    """d(M, C) < ε: M is on C again, or never left it; or it has come to a stand behind X."""
    overtaking = situation.memory.overtaking
    if overtaking is None or overtaking.instruction is Instruction.OVERTAKE:
        return overtaking is None
    snapshot, plan = situation.snapshot, situation.plan
    joins = max(plan.joins, plan.aside.until if plan.aside else 0.0)
    stands = overtaking.instruction is Instruction.FALL_BACK and snapshot.ego.speed < STANDING_SPEED
    return stands or (snapshot.s >= joins and abs(snapshot.d) < situation.limits.parameters.off_curve_epsilon_m)


def instruct(situation: Situation) -> Instruction:
    """Weaken the attraction of C and raise v_d until X is passed; then return."""
    overtaking = situation.memory.overtaking
    return Instruction.OVERTAKE if overtaking is None else overtaking.instruction


RULE = BehaviourRule(
    Behaviour.OVERTAKING, (follows_x, has_settled, is_late, is_legal, has_looked, gap_is_proven), instruct, (is_back,)
)


class OvertakingStep(NamedTuple):
    """What overtaking asks for now: the manoeuvre as it stands, a new way `aside` (None with `replans`: back to C), a
    speed not to exceed (m/s), and why."""

    overtaking: Overtaking
    replans: bool = False
    aside: Aside | None = None
    top_speed: float = math.inf
    reason: Reason | None = None
    cause: str = ""


def try_out(situation: Situation) -> Proof | None:
    """Return the proof that X can be passed, or why not; None when nothing asks for it."""
    x = situation.ahead_of_ego
    asks = (follows_x, has_settled, is_late, is_legal, has_looked)
    if x is None or situation.memory.overtaking is not None or not all(holds(situation) for holds in asks):
        return None
    return proof(situation, x)


def begin(situation: Situation) -> OvertakingStep | None:
    """Pull out: the way aside that the proof found."""
    x, found = situation.ahead_of_ego, situation.proof
    if x is None or found is None or found.aside is None:
        return None
    overtaking = Overtaking(found.passes, situation.snapshot.time, Instruction.OVERTAKE)
    return OvertakingStep(overtaking, replans=True, aside=found.aside, reason=Reason.SLOW_AHEAD, cause=x.user.id)


def carry_on(situation: Situation, overtaking: Overtaking) -> OvertakingStep:
    """Pass X, and come back behind who is next on the lane; if the proof no longer holds, fall back behind X."""
    step = _carried_on(situation, overtaking)
    if step.overtaking.instruction is Instruction.FALL_BACK or situation.plan.aside is None:
        return step
    return step._replace(top_speed=min(step.top_speed, _behind_next(situation, step.overtaking.user_ids)))


def _behind_next(situation: Situation, passes: tuple[str, ...]) -> float:
    """Return the speed (m/s) at which the ego can come back behind who drives before those whom it `passes`."""
    limits, front = situation.limits, situation.snapshot.front
    before = [one for one in ahead_on_lane(situation) if one.user_ids[0] not in passes]
    gaps = ((one.rear - front - limits.standstill_gap, one.speed) for one in before)
    headway = PASSING_HEADWAY * limits.time_headway
    return min((following_speed(gap, v, limits.comfort_deceleration, headway) for gap, v in gaps), default=math.inf)


def _carried_on(situation: Situation, overtaking: Overtaking) -> OvertakingStep:
    plan, snapshot = situation.plan, situation.snapshot
    way = plan.aside
    if overtaking.instruction is not Instruction.OVERTAKE or way is None:
        return OvertakingStep(overtaking)
    coming_back = overtaking._replace(instruction=Instruction.RETURN)
    x = find(situation, overtaking.user_ids)
    if x is None or is_clear_of(situation, x):
        if snapshot.s >= way.back:
            return OvertakingStep(coming_back)
        beside = in_the_way_back(situation, way)
        if not beside:
            return OvertakingStep(coming_back, replans=way.back > snapshot.s + UPDATE_ASIDE_M)
        overtaking, x = overtaking._replace(user_ids=(beside,)), find(situation, (beside,))
        if x is None:
            return OvertakingStep(coming_back)
    takes_too_long = snapshot.time - overtaking.since > situation.limits.parameters.overtaking_s
    found = Proof(None, overtaking.user_ids[0]) if takes_too_long else proof_under_way(situation, x, way.lateral)
    if found.aside is not None:
        moved = abs(found.aside.back - way.back) > UPDATE_ASIDE_M
        return OvertakingStep(overtaking._replace(user_ids=found.passes), replans=moved, aside=found.aside)
    reached = tuple(one for one in overtaking.user_ids if _is_reached(situation, one))
    if reached and reached != overtaking.user_ids:  # it comes back behind those who drive on before the others
        return _carried_on(situation, overtaking._replace(user_ids=reached))
    lane = lane_in_use(situation, way.lateral)
    if lane is not None and not lane.is_oncoming and _is_over(situation, x):
        return _beside(situation, way, OvertakingStep(overtaking))  # that lane is the ego's by now: who is there follows it
    return _beside(situation, way, _fall_back(situation, overtaking, x, found))


def _is_reached(situation: Situation, user_id: str) -> bool:
    """Whether the ego is beside somebody whom it passes, or has passed him."""
    one = find(situation, (user_id,))
    return one is not None and one.rear < situation.snapshot.front


def _beside(situation: Situation, way: Aside, step: OvertakingStep) -> OvertakingStep:
    """Have C lead on beside X where it would soon come back, though the ego is not clear of X."""
    snapshot = situation.snapshot
    soon = max(UPDATE_ASIDE_M, BESIDE_S * snapshot.ego.speed)
    if step.replans or way.back > snapshot.s + soon:
        return step
    back = snapshot.s + 2.0 * soon
    return step._replace(replans=True, aside=replace(way, back=back, until=back + way.until - way.back))


def _is_over(situation: Situation, x: Passed) -> bool:
    """Whether half the way aside is behind the ego."""
    plan, s = situation.plan, situation.snapshot.s
    return s > 0.5 * plan.joins or situation.snapshot.front > x.rear


def _fall_back(situation: Situation, overtaking: Overtaking, x: Passed, found: Proof) -> OvertakingStep:
    """Return behind X if the ego can slow down in time, else slow down first; go on if that is only short of its margin."""
    falling, snapshot = overtaking._replace(instruction=Instruction.FALL_BACK), situation.snapshot
    faster = max(snapshot.ego.speed - x.speed, 0.0)
    if snapshot.front + 0.5 * faster * faster / situation.limits.comfort_deceleration < x.rear:
        return OvertakingStep(falling, replans=True, reason=Reason.GAP_LOST, cause=found.obstacle)
    if found.only_margin:
        return OvertakingStep(overtaking)
    slower = max(x.speed - FALL_BACK_BY, 0.0)
    return OvertakingStep(overtaking, top_speed=slower, reason=Reason.GAP_LOST, cause=found.obstacle)
