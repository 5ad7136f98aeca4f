"""Changing to the lane that the route needs: when the gap is there, else waiting for one."""

from __future__ import annotations

from typing import NamedTuple

from sumo_reactive.messages.decision import Reason, StopAt
from sumo_reactive.messages.plan import LaneChange, NominalPlan
from sumo_reactive.messages.snapshot import Neighbour, Snapshot
from sumo_reactive.parameters import (
    FOLLOWER_DECELERATION,
    LANE_CHANGE_DURATION_S,
    LANE_CHANGE_GAP_M,
    LANE_CHANGE_LOOK_AHEAD_M,
    LANE_CHANGE_LOOK_AHEAD_S,
    LANE_CHANGE_REACTION_S,
    MIN_LANE_CHANGE_LENGTH_M,
)
from sumo_reactive.vehicle.limits import VehicleLimits


class LaneChanging(NamedTuple):
    """What to do about the next lane change: begin it now to `side` (0: not now), or stop at the latest by `stop`."""

    side: int = 0
    stop: StopAt | None = None


def seek_gap(snapshot: Snapshot, plan: NominalPlan, limits: VehicleLimits) -> LaneChanging:
    """Begin the change that the route needs as soon as a gap allows; without one, stop where C would begin it."""
    change = next((c for c in plan.lane_changes if c.end > snapshot.front), None)
    if change is None or change.start <= snapshot.s or change.opens > snapshot.front:
        return LaneChanging()
    speed = snapshot.ego.speed
    left = change.start - snapshot.front
    if left > max(LANE_CHANGE_LOOK_AHEAD_M, LANE_CHANGE_LOOK_AHEAD_S * speed):
        return LaneChanging()
    blocker = _blocker(snapshot, limits)
    if not blocker:
        return LaneChanging(side=change.side if _has_room(snapshot, plan, change) else 0)
    return LaneChanging(stop=StopAt(change.start, Reason.NO_GAP, region=change.to_lane, cause=blocker))


def _has_room(snapshot: Snapshot, plan: NominalPlan, change: LaneChange) -> bool:
    """Whether the lane goes on beside the other long enough to be left smoothly."""
    here = next((g for g in plan.segments if g.start <= snapshot.front < g.end), None)
    if here is None or here.lane_id.startswith(":"):
        return False
    needed = max(MIN_LANE_CHANGE_LENGTH_M, 0.8 * LANE_CHANGE_DURATION_S * snapshot.ego.speed)
    end = change.end if here.lane_id == change.from_lane else here.end
    return end - snapshot.front > min(needed, change.end - change.start)


def _blocker(snapshot: Snapshot, limits: VehicleLimits) -> str:
    """Return who leaves no gap on the other lane; empty when the gap is free."""
    for neighbour in snapshot.neighbours:
        if not _leaves_gap(neighbour, snapshot.ego.speed, limits.length):
            return neighbour.user.id
    return ""


def _leaves_gap(neighbour: Neighbour, speed: float, length: float) -> bool:
    """Whether the one ahead need not be braked for, and the one behind need not brake hard."""
    other = neighbour.user
    if neighbour.ahead >= 0.0:
        gap, closing = neighbour.ahead - other.body.length, speed - other.speed
        pace = speed
    else:
        gap, closing = -neighbour.ahead - length, other.speed - speed
        pace = other.speed
    braking = max(0.0, closing) ** 2 / (2.0 * FOLLOWER_DECELERATION)
    return gap > LANE_CHANGE_GAP_M + LANE_CHANGE_REACTION_S * pace + braking
