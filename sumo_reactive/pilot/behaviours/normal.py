"""Normal driving: follow C at the speed of the road, behind whoever is ahead (F&L 1991, §2)."""

from __future__ import annotations

from collections.abc import Iterator

from sumo_reactive.messages.completed_plan import Weights
from sumo_reactive.messages.decision import Leader
from sumo_reactive.messages.snapshot import PathObstacle, Snapshot
from sumo_reactive.parameters import CROSSER_MARGIN_S, STANDING_SPEED
from sumo_reactive.vehicle.limits import VehicleLimits

WEIGHTS = Weights(valley=10.0, shadow=0.3, velocity=1.0)


def leaders(snapshot: Snapshot, limits: VehicleLimits) -> Iterator[Leader]:
    """Yield all that the ego must stay behind: who drives ahead, stands in the way, comes towards it or crosses."""
    for obstacle in snapshot.on_path:
        leader = _leader(obstacle, snapshot, limits)
        if leader is not None:
            yield leader


def _leader(obstacle: PathObstacle, snapshot: Snapshot, limits: VehicleLimits) -> Leader | None:
    user, along, across = obstacle.user, obstacle.along, abs(obstacle.across)
    brakes = user.body.emergency_deceleration
    gap, speed = obstacle.start - snapshot.front, snapshot.ego.speed
    if along < -STANDING_SPEED and across < -along:
        shared = gap * speed / (speed - along)
        return Leader(user.id, snapshot.front + shared, 0.0, brakes)
    if across > max(along, STANDING_SPEED):
        leaves = (user.body.length + limits.width) / across
        if gap > 0.0 and gap / max(speed, 0.1) > leaves + CROSSER_MARGIN_S:
            return None
        return Leader(user.id, obstacle.start, 0.0, brakes)
    return Leader(user.id, obstacle.start, max(along, 0.0), brakes)
