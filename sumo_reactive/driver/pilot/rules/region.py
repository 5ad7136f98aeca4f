"""The conflict region: one vehicle at a time, and who goes first (F&L 1991, §2)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.assessment import Encounter
from sumo_reactive.driver.nouns.completed_plan import Intent
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.nouns.snapshot import Conflict, Foe, Snapshot
from sumo_reactive.driver.nouns.state import CREEPING_SPEED, STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import FOLLOWER_STANDSTILL_GAP_M, QUEUED_SPEED, TWO_WHEELER_WIDTH_M, RoadUser
from sumo_reactive.driver.pilot.assessment import leader_table, passing, simulate, way_of, would_meet
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.passages import REGION_MARGIN_M, WAIT_SHIFT_M, Crossing, View
from sumo_reactive.driver.pilot.rules.gaps import Judgement, Passing, follows_at, threat, turning
from sumo_reactive.driver.pilot.rules.lights import holds_back, letter_of, outranks
from sumo_reactive.driver.pilot.rules.trust import (
    WAIT_INTO_M,
    gives_way,
    is_certain,
    leaves_its_place,
    leaves_its_stop,
    stops_in_the_way,
)
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.travel_time import travel_time
from sumo_reactive.driver.world.junction import Control
from sumo_reactive.driver.world.regions import ConflictKind, ConflictRegion

HESITATING_SPEED = 3.0
"""m/s; an ego that moves no faster, and has not come on, has been waiting…"""

HESITATION_S = 1.5
"""…since this long after it last came on: the time of a start."""


ZIPPER_LEAD_M = 0.1
"""Where lanes merge in turns, who is nearer by more than this goes first."""


ENTERING_M = 6.0
"""Nearer than this to its line the ego goes after a foe only if that foe is sure to go."""

LETS_PASS_S = 5.0
"""Who comes to a region within this time is let pass by those who have to."""

PASSAGE_FORESEEN_S = 12.0
"""The ego's way through a junction is simulated so far; beyond it goes on at its speed then."""

_SOON_S = 0.01
"""Later than just enough."""


class Motions(NamedTuple):
    """The ego's simulated motion (n, 5) if it goes `on`, and if it is `stopping` behind the passage."""

    on: Floats
    stopping: Floats


class Counted(NamedTuple):
    """A `foe` who may be in a region, with the right of way that the lights' letters leave him; whether the ego
    `is_committed` there."""

    foe: Foe
    is_committed: bool


def judgements(
    crossing: Crossing, foes: tuple[Foe, ...], view: View, memory: PilotMemory
) -> Iterator[tuple[Judgement, float | None]]:
    """Yield what each of the `foes` who matter means for a passage, with the place (m of C) to wait for it (None: go on).

    Who waits for one of them in the region of another has not cleared that: it goes before him only if it need not wait.
    """
    snapshot, limits = view.snapshot, view.limits
    theirs = (counted(foe, crossing, snapshot, memory, limits) for foe in foes if foe.passage == crossing.number)
    matter = [one for one in theirs if one is not None]
    if not matter:
        return
    motions = _motions(crossing, view)

    def judged(one: Counted, *, stands: bool) -> tuple[Judgement, float | None]:
        own = _foreseen(one.foe.conflict.region, crossing, motions, snapshot, limits)
        own = own._replace(clearance=math.inf, merged=math.inf) if stands else own
        judgement = judge(one, own, crossing, snapshot, memory, limits)
        return judgement, None if judgement.passes else _place_to_wait(one.foe.conflict, crossing, snapshot, limits)

    found = [judged(one, stands=False) for one in matter]
    stands_at = min((place for _, place in found if place is not None), default=math.inf)
    for one, (judgement, place) in zip(matter, found, strict=True):
        region = one.foe.conflict.region
        stands = crossing.at(region.own.start) < stands_at < crossing.at(region.post.start) + limits.length
        yield judged(one, stands=True) if judgement.passes and stands else (judgement, place)


def _motions(crossing: Crossing, view: View) -> Motions:
    """Simulate an ego that goes on through a passage, and one that stops behind it where it means to."""
    leaders = leader_table(view.snapshot)
    on = simulate(view.snapshot, way_of(view.plan), leaders, view.limits, PASSAGE_FORESEEN_S)
    if crossing.stop == math.inf:
        return Motions(on, on)
    stopping = simulate(view.snapshot, way_of(view.plan, crossing.stop), leaders, view.limits, PASSAGE_FORESEEN_S)
    return Motions(on, stopping)


def opens_at(judged: Iterable[Judgement], place: float, crossing: Crossing, view: View) -> float:
    """Return in how many seconds the ego can pass `place` (m of C) and meet nobody who is `judged` at a passage, if they go
    on as foreseen: after the first ones, and before those for whom the gap is enough; infinite: too late to roll there."""
    snapshot, parameters = view.snapshot, view.limits.parameters
    soonest = travel_time(place - snapshot.front, snapshot.ego.speed, view.limits.acceleration_in_plan, crossing.pace)
    time, left = soonest, list(judged)
    while time < parameters.rolling_s:
        later = time - soonest
        met = [one for one in left if would_meet(one.own.later(later), one.foe, one.other, parameters, may_follow=True)]
        if not met:
            return time
        if any(one.foe.user.speed < STANDING_SPEED for one in met):
            return math.inf  # nobody knows when he goes
        follows = (follows_at(one.own, one.foe, one.other, parameters) - (one.own.arrival - soonest) for one in met)
        time = max(time, *follows) + _SOON_S
        left = [one for one in left if one not in met]
    return math.inf


def arrivals_of(judged: Iterable[Judgement], crossing: Crossing, snapshot: Snapshot) -> Iterator[TimeConstraint]:
    """Yield when the ego may be in the regions that it passes after somebody: no earlier than he has cleared them."""
    for one in judged:
        follows = follows_at(one.own, one.foe, one.other, snapshot.parameters)
        if one.passes and follows < one.own.arrival < snapshot.parameters.rolling_s:
            place = crossing.at(one.foe.conflict.region.own.start)
            yield TimeConstraint(
                place, snapshot.time + follows, reason=one.reason, region=one.region, cause=one.foe.user.id
            )


def encounter_of(judgement: Judgement, crossing: Crossing, view: View) -> Encounter:
    """Return who, when and where the ego would meet if it went on in spite of a judgement."""
    s, snapshot = crossing.at(judgement.foe.conflict.region.own.start), view.snapshot
    x, y, _ = view.plan.curve.at(s)
    return Encounter(judgement.foe.user.id, snapshot.time + judgement.own.arrival, s, x, y)


def without_queues(foes: tuple[Foe, ...]) -> tuple[Foe, ...]:
    """Return `foes` without those in a queue before their line whose head is judged for all behind it: the foremost of a
    lane that stands."""
    heads: dict[str, float] = {}
    for foe in foes:
        user = foe.user
        if foe.to_stop_line >= 0.0 and user.speed < STANDING_SPEED and not user.is_halted and _is_wide(user):
            heads[user.lane_id] = max(user.lane_position, heads.get(user.lane_id, user.lane_position))
    return tuple(foe for foe in foes if not _is_behind(heads, foe)) if heads else foes


def _is_behind(heads: dict[str, float], foe: Foe) -> bool:
    """Whether a foe cannot come before the head of its queue does."""
    head = heads.get(foe.user.lane_id)
    return head is not None and foe.user.lane_position < head and _is_wide(foe.user)


def _is_wide(user: RoadUser) -> bool:
    """Whether a road user fills its lane: two-wheelers pass queues and are passed."""
    return not user.body.is_person and user.body.width >= TWO_WHEELER_WIDTH_M


def counted(
    foe: Foe, crossing: Crossing, snapshot: Snapshot, memory: PilotMemory, limits: VehicleLimits
) -> Counted | None:
    """Return a foe who may be in a region while the ego is not yet out of it, and does not let it go first; None: he does
    not matter there."""
    foe = _by_letters(foe, crossing, snapshot)
    region, front = foe.conflict.region, snapshot.front
    if crossing.at(region.post.start) + limits.length - front <= 0.0 or not _can_come(foe, snapshot, memory, crossing):
        return None
    to_region = crossing.at(region.own.start) - front
    if _takes_turns(foe, crossing) and _is_ahead_of(foe, crossing.passage.start - front, to_region):
        return None
    committed = _is_committed(foe.conflict, crossing, snapshot, limits)
    lets_go = gives_way(foe, committed, crossing, snapshot.parameters) or _lets_in(foe, crossing, snapshot, memory)
    return None if lets_go else Counted(foe, committed)


def _lets_in(foe: Foe, crossing: Crossing, snapshot: Snapshot, memory: PilotMemory) -> bool:
    """Whether a foe crawls in a queue that an ego which has waited for long may drive into before him: he stops with ease
    for whom he then follows."""
    user, p = foe.user, snapshot.parameters
    if foe.conflict.region.kind is not ConflictKind.MERGING or user.body.is_person or user.speed >= QUEUED_SPEED:
        return False
    stops_within = user.speed * user.speed / (2.0 * p.easy_stop_deceleration) + user.speed * p.follower_headway_s
    waited = memory.waited_at(crossing.connection.id, snapshot.time)
    return foe.to_region > stops_within + FOLLOWER_STANDSTILL_GAP_M and waited > p.queue_patience_s


def _foreseen(
    region: ConflictRegion, crossing: Crossing, motions: Motions, snapshot: Snapshot, limits: VehicleLimits
) -> Passing:
    """Foresee when the ego is in a region if it goes on now: at the earliest, and until when by its simulated motions."""
    front, speed, gains = snapshot.front, snapshot.ego.speed, limits.acceleration_in_plan
    if crossing.turn is not None:
        return turning(crossing.turn.start - front, speed, gains, crossing.turn.duration)
    to_region, to_clear = crossing.at(region.own.start) - front, crossing.at(region.post.start) + limits.length - front
    earliest = travel_time(to_region, speed, gains, crossing.pace)
    motion = motions.stopping if crossing.stop - front > to_clear else motions.on
    return passing(motion, earliest, to_region, to_clear, limits.length)


def carried_on(
    known: Judgement, before: tuple[float, float], crossing: Crossing, snapshot: Snapshot, limits: VehicleLimits
) -> Passing:
    """Foresee when the ego is in a region if it goes on now from what was `known` when its front and speed were as `before`
    (m of C, m/s): by as much sooner or later as the least travel times have changed since."""
    region, gains, (front, speed) = known.foe.conflict.region, limits.acceleration_in_plan, before
    if crossing.turn is not None:
        return turning(crossing.turn.start - snapshot.front, snapshot.ego.speed, gains, crossing.turn.duration)
    start, clear = crossing.at(region.own.start), crossing.at(region.post.start) + limits.length

    def later(place: float) -> float:
        now = travel_time(place - snapshot.front, snapshot.ego.speed, gains, crossing.pace)
        return now - travel_time(place - front, speed, gains, crossing.pace)

    _, clearance, merged, pace = known.own
    clearance, merged = clearance + later(clear), merged + later(start + limits.length)
    earliest = travel_time(start - snapshot.front, snapshot.ego.speed, gains, crossing.pace)
    return Passing(earliest, max(clearance, 0.0), max(merged, 0.0), pace)


def judge(
    one: Counted, own: Passing, crossing: Crossing, snapshot: Snapshot, memory: PilotMemory, limits: VehicleLimits
) -> Judgement:
    """Return whether an ego that is in a region at its `own` times may enter it before or after a foe who counts.

    The conflict-region rule: one vehicle at a time (F&L 1991, §2).
    """
    (foe, committed), p, front = one, snapshot.parameters, snapshot.front
    expects_ego = committed and not leaves_its_place(foe)
    other = threat(foe, p, expects_ego=expects_ego, gaining=_gaining(foe, snapshot, memory))
    may_follow = committed or is_certain(foe) or _entry(foe.conflict, crossing) - front > ENTERING_M
    if not committed and stops_in_the_way(foe, crossing):
        may_follow = False
    if not may_follow and leaves_its_stop(foe):  # it goes first, but the ego may be there sooner than planned
        may_follow, to_region = True, crossing.at(foe.conflict.region.own.start) - front
        own = own._replace(arrival=travel_time(to_region, snapshot.ego.speed, limits.max_acceleration, crossing.pace))
    meets = would_meet(own, foe, other, p, p.committed_patience if committed else 1.0, may_follow=may_follow)
    return Judgement(_reason(foe), foe, not meets, own, other)


def _entry(conflict: Conflict, crossing: Crossing) -> float:
    """Arc length on C at which the ego enters: the stop line, or a region that begins before it."""
    return crossing.at(min(conflict.region.own.start, 0.0))


def _by_letters(foe: Foe, crossing: Crossing, snapshot: Snapshot) -> Foe:
    """Return the foe with the right of way that the lights' letters leave: nobody yields at a full green or with the light
    off, whatever the map says, and between paths that yield to each other the higher letter goes first."""
    known = foe.conflict
    if not known.is_yielded_to or not snapshot.lights:
        return foe
    conflict = _at_letters(known.region, known, letter_of(crossing.connection, snapshot), letter_of(known.other, snapshot))
    return foe if conflict is known else foe._replace(conflict=conflict)


@kept(64)
def _at_letters(_region: ConflictRegion, conflict: Conflict, own: str, theirs: str) -> Conflict:
    """Return a conflict in a region that the other lets the ego go first in, with what the letters leave of that."""
    if theirs and theirs in "GO":
        return conflict._replace(is_yielded_to=False)
    if conflict.must_yield and outranks(own, theirs):
        return conflict._replace(must_yield=False)
    return conflict._replace(is_yielded_to=False) if conflict.must_yield and outranks(theirs, own) else conflict


def _takes_turns(foe: Foe, crossing: Crossing) -> bool:
    """Whether two lanes merge like a zipper: who is nearer goes first."""
    return crossing.connection.control is Control.ZIPPER and foe.conflict.region.kind is ConflictKind.MERGING


def _is_ahead_of(foe: Foe, to_line: float, to_region: float) -> bool:
    """Whether an ego, `to_line` and `to_region` m before its line and the region, is nearer than the foe to both.

    SUMO's cars go by the lines, which may lie differently far from where the lanes meet.
    """
    return foe.to_region > to_region + ZIPPER_LEAD_M and foe.to_stop_line > to_line + ZIPPER_LEAD_M


def _gaining(foe: Foe, snapshot: Snapshot, memory: PilotMemory) -> float:
    """How a foe that leaves its all-way stop is seen to gain speed, m/s²."""
    premises = memory.premises
    known = None if premises is None else premises.speeds.get(foe.user.id)
    if premises is None or known is None or snapshot.time <= premises.time or not leaves_its_stop(foe):
        return 0.0
    return (foe.user.speed - known) / (snapshot.time - premises.time)


def _is_committed(conflict: Conflict, crossing: Crossing, snapshot: Snapshot, limits: VehicleLimits) -> bool:
    """Whether the ego is past the last place where it can wait for a region without standing in others' way."""
    if snapshot.front <= _entry(conflict, crossing):
        return False
    place = _waiting_place(conflict, crossing)
    return place is None or place < _nearest_stop(snapshot, limits)


def _reason(foe: Foe) -> Reason:
    if foe.user.body.is_person:
        return Reason.PEDESTRIAN
    if foe.to_region <= 0.0:
        return Reason.REGION_OCCUPIED
    if foe.conflict.must_yield and foe.conflict.is_yielded_to:
        return Reason.WAIT_FOR_TURN
    if foe.conflict.must_yield:
        return Reason.YIELD_TO
    return Reason.FOE_CANNOT_STOP if foe.conflict.is_yielded_to else Reason.NO_RULE


def _can_come(foe: Foe, snapshot: Snapshot, memory: PilotMemory, crossing: Crossing) -> bool:
    """Whether the foe may be in the region soon: its light lets it, and it does not just stand there.

    A body that stands in the ego's corridor is a leader, whatever the region says.
    """
    user, standing, p = foe.user, memory.standing_for(snapshot.time), snapshot.parameters
    if snapshot.ego.speed < HESITATING_SPEED:  # an ego that starts in vain has been waiting all the same
        standing = max(standing, snapshot.time - memory.progress_time - HESITATION_S)
    if user.body.is_person:
        return foe.to_stop_line < 0.0 or _may_step_on(foe, snapshot, standing)
    letter, shut_for = letter_of(foe.conflict.other, snapshot), memory.shut_for(foe.conflict.other, snapshot.time)
    braking = user.body.emergency_deceleration, p.yellow_deceleration
    if holds_back(letter, foe.to_stop_line, user.speed, shut_for, *braking):
        is_before_it = _is_swung_over(foe.conflict) or foe.conflict.region.other.start < -WAIT_INTO_M
        return user.speed >= STANDING_SPEED and is_before_it  # a light keeps nobody off the way to its line
    if user.speed >= STANDING_SPEED:
        return True
    if crossing.connection.control is Control.ALL_WAY_STOP and foe.to_stop_line >= 0.0:
        in_vain = standing > p.foe_patience_s and user.waiting_time > 2.0 * p.foe_patience_s
        own = snapshot.time - memory.stopped_since if memory.stopped_at == crossing.connection.id else 0.0
        return user.waiting_time > own and not in_vain
    waits = math.inf if user.is_halted else user.waiting_time  # who has halted waits for nobody
    waited = min(waits, snapshot.time - dict(memory.kept).get(user.id, -math.inf))
    patience = min(max(2.0 * p.foe_patience_s - waited, p.least_patience_s), p.foe_patience_s)
    return waited <= p.foe_patience_s or standing <= patience


def kept_waiting(snapshot: Snapshot, memory: PilotMemory) -> tuple[tuple[str, float], ...]:
    """Return the foes who stand because they let somebody pass, each with the time (s) until which they were seen to: they
    go when he is past."""
    standing = [foe for foe in snapshot.foes if foe.user.speed < STANDING_SPEED and not foe.user.is_halted]
    if not standing and not memory.kept:
        return ()
    patience = snapshot.parameters.foe_patience_s
    known = {name: until for name, until in memory.kept if snapshot.time - until <= patience}
    moving = {
        foe.conflict.other.id
        for foe in snapshot.foes
        if foe.user.speed >= STANDING_SPEED and foe.to_region <= foe.user.speed * LETS_PASS_S
    }
    for foe in standing:
        if not foe.conflict.lets_pass.isdisjoint(moving):
            known[foe.user.id] = snapshot.time
    return tuple(sorted(known.items()))


def _is_swung_over(conflict: Conflict) -> bool:
    """Whether the ego's body alone makes the conflict, with those who come to their line."""
    return not conflict.must_yield and not conflict.is_yielded_to and conflict.region.other.start < 0.0


def _may_step_on(foe: Foe, snapshot: Snapshot, standing: float) -> bool:
    """Whether a pedestrian beside a crossing may walk: at green, or without a light where he goes first, or comes walking
    where no rule makes him wait.

    One who does not move, though the ego has been `standing` for a while (s), lets it go.
    """
    stands, conflict = foe.user.speed < STANDING_SPEED, foe.conflict
    if stands and standing > snapshot.parameters.foe_patience_s:
        return False
    letter = letter_of(conflict.other, snapshot)
    return letter in "gG" if letter else conflict.must_yield or not (stands or conflict.is_yielded_to)


def _waiting_place(conflict: Conflict, crossing: Crossing) -> float | None:
    """Arc length of the place inside the junction where a turn may wait for a region; None when there is none.

    Over whom the body swings, he goes first: it would stand in his way there.
    """
    drawn, place, start = crossing.connection.wait_at, crossing.wait_at, conflict.region.own.start
    if drawn is None or place is None or start < drawn - WAIT_SHIFT_M or _is_swung_over(conflict):
        return None
    return crossing.at(min(place, start - REGION_MARGIN_M))


def _nearest_stop(snapshot: Snapshot, limits: VehicleLimits) -> float:
    """Arc length at which the ego can stop; one that stands or creeps a little too far in waits there as well."""
    speed = snapshot.ego.speed
    too_far = WAIT_INTO_M if speed < CREEPING_SPEED else 0.0
    return snapshot.front - too_far + speed * speed / (2.0 * limits.service_deceleration)


def _place_to_wait(conflict: Conflict, crossing: Crossing, snapshot: Snapshot, limits: VehicleLimits) -> float | None:
    """Arc length at which to wait for a region: the waiting place inside, the line, else just before the region."""
    inside, stops = _waiting_place(conflict, crossing), _nearest_stop(snapshot, limits)
    line = crossing.line
    if conflict.region.own.start < 0.0 and snapshot.front > line:
        return inside if inside is not None and inside >= stops else None  # on it already: off it
    over = conflict.reaches_over
    if max(crossing.connection.hold_back, crossing.swing, over) > 0.0 and snapshot.front <= crossing.passage.start:
        line = min(line, crossing.passage.start - over - REGION_MARGIN_M) if over > 0.0 else line
        line = min(max(line, stops), crossing.passage.start)  # too late for it: as soon as can be
    places = [line] if inside is None else [inside, line]
    if snapshot.front > crossing.passage.start:
        places.append(crossing.at(conflict.region.own.start) - REGION_MARGIN_M)
    return next((place for place in places if place >= stops), None)


def intent_of(stop: TimeConstraint | None, snapshot: Snapshot, memory: PilotMemory) -> Intent:
    """Return what an ego that stops there (None: nowhere) shows the others: that it goes, goes next, or lets them go."""
    if stop is None:
        return Intent.DRIVE
    if stop.reason is Reason.WAIT_FOR_TURN and not _lets_start(stop.cause, snapshot, memory):
        return Intent.GO_NEXT
    return Intent.YIELD


def _lets_start(user_id: str, snapshot: Snapshot, memory: PilotMemory) -> bool:
    """Whether the ego waits for somebody whose turn it is and who still stands: others wait for who means to go next, and he
    would wait for the ego. It means to go again shortly before it goes, should he not start."""
    user = next((foe.user for foe in snapshot.foes if foe.user.id == user_id), None)
    if user is None or user.speed >= STANDING_SPEED:
        return False
    p = snapshot.parameters
    patience = p.foe_patience_s - p.least_patience_s
    return memory.standing_for(snapshot.time) < patience or user.waiting_time < p.foe_patience_s + patience
