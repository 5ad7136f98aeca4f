"""Arrival and clearance times at a conflict region, and which gap is enough."""

from __future__ import annotations

import math
from typing import NamedTuple

from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Reason
from sumo_reactive.driver.nouns.plan import MOVE_SPEED, TURNAROUND_REACHED_M
from sumo_reactive.driver.nouns.snapshot import Foe
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import FOLLOWER_STANDSTILL_GAP_M
from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.driver.vehicle.travel_time import travel_time
from sumo_reactive.driver.world.regions import ConflictKind

FEARED_DECELERATION = 4.5
"""m/s²; a follower keeps clear of somebody ahead who may brake so: what SUMO's default car does in normal driving."""


def gap_for_follower(speed: float, ahead: float, headway: float, braking: float) -> float:
    """Least gap (m) in which a follower at `speed` feels safe behind somebody who comes before it at speed `ahead` (m/s).

    It fears that the one ahead brakes as hard as cars usually can. It must then be able to stop behind him with `braking`
    (m/s²), and if it brakes as hard, have a time `headway` (s) to react.
    """
    feared = 0.5 / FEARED_DECELERATION
    room = max(speed * (headway + speed * feared), 0.5 * speed * speed / braking) - ahead * ahead * feared
    return FOLLOWER_STANDSTILL_GAP_M + room if room > 0.0 else 0.0


class Passing(NamedTuple):
    """When the ego is in a region if it goes on now: `arrival` and `clearance` of the region, s from now.

    `merged`: when its rear has passed the region's start. `speed`: its speed then, m/s.
    """

    arrival: float
    clearance: float
    merged: float
    speed: float

    def later(self, delay: float) -> Passing:
        """Return the passage of an ego that comes `delay` s later."""
        return self._replace(arrival=self.arrival + delay, clearance=self.clearance + delay, merged=self.merged + delay)


class Threat(NamedTuple):
    """When a foe is in the region: earliest `arrival`, `clearance`, `merged` (rear past the start), s from now."""

    arrival: float
    clearance: float
    merged: float


class Judgement(NamedTuple):
    """What the pilot makes of one foe at one region: whether the ego `passes`, for what `reason`, with whose times (s)."""

    reason: Reason
    foe: Foe
    passes: bool
    own: Passing
    other: Threat

    @property
    def region(self) -> str:
        """The region's id."""
        return self.foe.conflict.region.id

    @property
    def decision(self) -> Decision:
        """The judgement as it is recorded."""
        behaviour = Behaviour.CROSSING if self.passes else Behaviour.CAUTIOUS
        figures = (
            ("arrival_s", self.own.arrival),
            ("clearance_s", self.own.clearance),
            ("foe_arrival_s", self.other.arrival),
            ("foe_clearance_s", self.other.clearance),
        )
        return Decision(
            behaviour=behaviour, reason=self.reason, region=self.region, cause=self.foe.user.id, passes=self.passes,
            figures=figures,
        )  # fmt: skip


def turning(to_start: float, speed: float, acceleration: float, duration: float) -> Passing:
    """Foresee an ego that turns round in several moves, `to_start` m ahead: it is in every region for all of the `duration`
    (s), from when it has come so near that it begins, and rolls out of them."""
    arrival = travel_time(to_start - TURNAROUND_REACHED_M, speed, acceleration, max(speed, 1.0))
    return Passing(arrival, arrival + duration, arrival + duration, MOVE_SPEED)


def threat(foe: Foe, parameters: Parameters, *, expects_ego: bool = False, gaining: float = 0.0) -> Threat:
    """Foresee a foe: it may speed up on the way to the region (not if it `expects_ego`), and keeps its speed behind, but for
    its turn, unless it is seen to be `gaining` speed (m/s²) as it leaves."""
    user = foe.user
    if user.body.is_person:
        pace = max(user.speed, 0.5)
        return Threat(max(foe.to_region, 0.0) / pace, foe.to_clear / pace, foe.to_clear / pace)
    top = user.speed if expects_ego else max(user.speed, min(foe.conflict.other.speed_limit, user.body.max_speed))
    to_merged = max(0.0, foe.to_region + user.body.length)
    slow, fast = max(user.speed, STANDING_SPEED), min(foe.conflict.other.speed_limit, user.body.max_speed)
    gaining = min(gaining, parameters.leaving_acceleration)
    if gaining > 0.0 and slow < fast:
        clearance, merged = (travel_time(way, slow, gaining, fast) for way in (foe.to_clear, to_merged))
    else:
        clearance, merged = _into_its_turn(foe, foe.to_clear), _into_its_turn(foe, to_merged)
    arrival = travel_time(foe.to_region, user.speed, user.body.gains(parameters.foe_acceleration), max(top, STANDING_SPEED))
    return Threat(
        arrival=arrival if expects_ego else min(arrival, _over_the_road(foe, parameters)),
        clearance=clearance,
        merged=merged,
    )


def _into_its_turn(foe: Foe, way: float) -> float:
    """When a foe that keeps its speed, but brakes for its turn as late and hard as cars usually can, has gone `way` m, s."""
    to_line, speed, turn = foe.to_stop_line, max(foe.user.speed, STANDING_SPEED), foe.conflict.other.speed_limit
    if not 0.0 < to_line < way or speed <= turn:
        return way / speed
    brakes = FEARED_DECELERATION
    at_line = max(turn, math.sqrt(max(speed * speed - 2.0 * brakes * to_line, 0.0)))
    braking = (speed - at_line) / brakes
    return braking + (to_line - 0.5 * (speed + at_line) * braking) / speed + (way - to_line) / at_line


def _over_the_road(foe: Foe, parameters: Parameters) -> float:
    """When a foe may come that speeds up as far as the road before its line allows, and brakes for its turn there, s."""
    way, speed, turn = foe.to_stop_line, foe.user.speed, foe.conflict.other.speed_limit
    body = foe.user.body
    top, gains = min(foe.conflict.other.approach_limit, body.max_speed), body.gains(parameters.foe_acceleration)
    if way <= 0.0 or turn >= top or speed >= top:
        return math.inf
    brakes = FEARED_DECELERATION
    highest = (2.0 * gains * brakes * way + brakes * speed * speed + gains * turn * turn) / (gains + brakes)
    peak = min(math.sqrt(highest), top)
    if peak <= max(speed, turn):
        return math.inf  # nearer than it takes to brake, or to be faster than in the turn
    changing = (peak * peak - speed * speed) / (2.0 * gains) + (peak * peak - turn * turn) / (2.0 * brakes)
    at_line = (peak - speed) / gains + (peak - turn) / brakes + (way - changing) / peak
    behind = foe.to_region - way
    return at_line + behind / turn if behind >= 0.0 else travel_time(foe.to_region, speed, gains, top)


def is_enough(
    own: Passing, foe: Foe, other: Threat, parameters: Parameters, patience: float = 1.0, *, may_follow: bool
) -> bool:
    """Whether the ego may pass before the foe, or after it if it `may_follow`; `patience` (0..1] scales the margins."""
    if foe.conflict.region.kind is ConflictKind.MERGING and not foe.user.body.is_person:
        before = _merges_before(own, foe, other, parameters, patience)
        after = _merges_after(own, foe, other, parameters, patience)
    else:
        before = own.clearance + parameters.gap_before_s * patience < other.arrival
        after = other.clearance + parameters.gap_after_s * patience < own.arrival
    return before or (may_follow and after)


def _merges_before(own: Passing, foe: Foe, other: Threat, parameters: Parameters, patience: float) -> bool:
    """The foe behind must not brake harder than a follower may be asked to and keeps a gap."""
    closing = max(0.0, foe.user.speed - own.speed)
    to_adapt = closing * closing / (2.0 * parameters.follower_deceleration) / max(foe.user.speed, 1.0)
    return own.merged + (parameters.merge_gap_s + to_adapt) * patience < other.arrival


def _merges_after(own: Passing, foe: Foe, other: Threat, parameters: Parameters, patience: float) -> bool:
    """The foe ahead has left the start of the common stretch, and the ego need not brake hard behind it."""
    return _merged_behind(own, foe, other, parameters, patience) < own.arrival


def _merged_behind(own: Passing, foe: Foe, other: Threat, parameters: Parameters, patience: float) -> float:
    """When the ego may come behind a foe onto the common stretch, s from now."""
    closing = max(0.0, own.speed - foe.user.speed)
    to_adapt = closing * closing / (2.0 * parameters.follower_deceleration) / max(own.speed, 1.0)
    return other.merged + (parameters.gap_after_s + to_adapt) * patience


def follows_at(own: Passing, foe: Foe, other: Threat, parameters: Parameters) -> float:
    """Return when the ego may be in the region after a foe that goes on as foreseen, s from now."""
    if foe.conflict.region.kind is ConflictKind.MERGING and not foe.user.body.is_person:
        return _merged_behind(own, foe, other, parameters, 1.0)
    return other.clearance + parameters.gap_after_s
