"""Whom the pilot trusts at a conflict region: who waits for the ego, and who goes first for certain."""

from __future__ import annotations

from sumo_reactive.driver.nouns.snapshot import Foe
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.driver.pilot.passages import WAIT_SHIFT_M, Crossing
from sumo_reactive.driver.world.junction import Control

BEFORE_THE_LINE_M = 3.0
"""Where a region begins farther before a stop line than this, nobody is trusted to yield: SUMO's cars look at each other's
times behind the lines only."""

WAIT_INTO_M = 1.0
"""A foe before its line is trusted to wait inside the junction only where its front then reaches no farther into the region:
the ego's way is moved aside by as much. An ego that stands or creeps so little behind its place to wait still waits."""

OFF_THE_LINE_M = 1.5
"""A car that moves this near to its all-way stop line has stopped there already and now goes (SUMO halts at 1 m)."""

STOPS_WITHIN_M = 0.5
"""A foe is trusted to stop if it is seen to brake so that it stands no farther than this behind the place to wait…"""

LEAVES_AT = 1.0
"""m/s²; a foe inside the junction that gains speed by more at its place to wait leaves it…"""

LEAVES_WITHIN_M = 1.0
"""…if that is no farther ahead than this."""

BRAKES_SHARE = 1.05
"""…braking this much harder towards the end: SUMO's cars brake late, and with just the 4.5 m/s² that is theirs."""


def gives_way(foe: Foe, committed: bool, crossing: Crossing, parameters: Parameters) -> bool:
    """Whether the foe lets the ego go first and is still able to: by the rules, or because the ego is already inside."""
    conflict, user = foe.conflict, foe.user
    if user.body.is_person:
        return False
    if not conflict.must_yield and not conflict.is_yielded_to:
        return False  # no rule makes it wait, and SUMO's cars then do not look
    if not committed and min(conflict.region.own.start, conflict.region.other.start) < -BEFORE_THE_LINE_M:
        return False  # nor do they look at each other before their lines
    all_way = conflict.other.control is Control.ALL_WAY_STOP
    if conflict.must_yield and not committed and not (conflict.is_yielded_to and all_way):
        return False
    if all_way and not committed and (user.speed < STANDING_SPEED or foe.to_stop_line < OFF_THE_LINE_M):
        return False  # it stopped before the ego, see `_can_come`, or is already leaving its line
    room = room_to_wait(foe)
    if not committed and conflict.other.id in crossing.waits_in_the_way:
        return False  # each would wait for the other there
    if room is None or leaves_its_place(foe):
        return False
    if _brakes_for_its_place(user, room):
        return True
    stops = all_way and foe.to_stop_line >= 0.0
    trusted = parameters.sign_stop_deceleration if stops else parameters.foe_can_stop_deceleration
    return user.speed * user.speed <= 2.0 * trusted * max(room, 0.3)


def _brakes_for_its_place(user: RoadUser, room: float) -> bool:
    """Whether a foe is seen to brake so that it stands `room` m ahead, where it waits for the ego."""
    return user.speed * user.speed <= 2.0 * BRAKES_SHARE * max(-user.acceleration, 0.0) * (room + STOPS_WITHIN_M)


def stops_in_the_way(foe: Foe, crossing: Crossing) -> bool:
    """Whether a foe is about to stand for the ego in its corridor: it will not have gone first, nor can the ego pass it."""
    room = room_to_wait(foe) if foe.conflict.other.id in crossing.waits_in_the_way else None
    return room is not None and _brakes_for_its_place(foe.user, room)


def room_to_wait(foe: Foe) -> float | None:
    """The foe's way to the place where it would wait for the ego: inside, else its line; None when it has passed both."""
    wait, to_line, start = foe.conflict.other.wait_at, foe.to_stop_line, foe.conflict.region.other.start
    if to_line >= 0.0:
        return to_line if wait is None or wait > start + WAIT_INTO_M else to_line + wait
    if wait is None or wait > start + WAIT_SHIFT_M or wait + to_line < -1.0:
        return None
    return max(wait + to_line, 0.0)


def is_certain(foe: Foe) -> bool:
    """Whether the foe goes through first for certain: too near to stop, at its line where it lets the ego go first by the
    map. One that sees the ego start may hesitate."""
    body, conflict = foe.user.body, foe.conflict
    waits_at = foe.to_stop_line if conflict.region.own_id in conflict.lets_pass else foe.to_region
    return body.is_person or foe.user.speed**2 > 2.0 * body.emergency_deceleration * max(foe.to_region, waits_at, 0.0)


def leaves_its_place(foe: Foe) -> bool:
    """Whether a foe that has come to its place to wait inside the junction is seen to go on instead."""
    room = room_to_wait(foe)
    is_there = foe.to_stop_line < 0.0 and (room is None or room < LEAVES_WITHIN_M)
    return is_there and foe.user.acceleration > LEAVES_AT


def leaves_its_stop(foe: Foe) -> bool:
    """Whether the foe has started from its all-way stop, and has nowhere left to wait but in others' way."""
    return foe.conflict.other.control is Control.ALL_WAY_STOP and room_to_wait(foe) is None
