"""Whom the ego must stay behind: who drives ahead, stands in the way, comes towards it or crosses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from sumo_reactive.messages.snapshot import Leader, PathObstacle
from sumo_reactive.parameters import CROSSER_MARGIN_S, STANDING_SPEED
from sumo_reactive.vehicle.limits import VehicleLimits


def leaders(on_path: Iterable[PathObstacle], front: float, speed: float, limits: VehicleLimits) -> Iterator[Leader]:
    """Yield a leader for each body in the corridor that will not be gone; ego's bumper at `front` m of C, `speed` m/s."""
    for obstacle in on_path:
        leader = _leader(obstacle, front, speed, limits)
        if leader is not None:
            yield leader


def _leader(obstacle: PathObstacle, front: float, speed: float, limits: VehicleLimits) -> Leader | None:
    user, along, across = obstacle.user, obstacle.along, abs(obstacle.across)
    brakes = user.body.emergency_deceleration
    gap = obstacle.start - front
    if along < -STANDING_SPEED and across < -along:
        shared = gap * speed / (speed - along)
        return Leader(user.id, front + shared, 0.0, brakes)
    if across > max(along, STANDING_SPEED):
        leaves = (user.body.length + limits.width) / across
        if gap > 0.0 and gap / max(speed, 0.1) > leaves + CROSSER_MARGIN_S:
            return None
        return Leader(user.id, obstacle.start, 0.0, brakes)
    return Leader(user.id, obstacle.start, max(along, 0.0), brakes)
