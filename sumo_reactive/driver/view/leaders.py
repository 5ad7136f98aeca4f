"""Whom the ego must stay behind: who drives ahead, stands in the way, comes towards it or crosses."""

from __future__ import annotations

import math
from collections.abc import Iterable

from sumo_reactive.driver.nouns.snapshot import Leader, PathObstacle
from sumo_reactive.driver.parameters import CROSSER_MARGIN_S, STANDING_SPEED
from sumo_reactive.driver.vehicle.limits import VehicleLimits

FASTER = 2.0
"""m/s; the ego may speed up by so much until it meets somebody."""


def leaders(on_path: Iterable[PathObstacle], front: float, speed: float, limits: VehicleLimits) -> list[Leader]:
    """Return a leader for each body in the corridor that will not be gone; ego's bumper at `front` m of C, `speed` m/s."""
    found = [_leader(obstacle, front, speed, limits) for obstacle in on_path]
    return [leader for leader in found if leader is not None]


def time_to_meet(obstacle: PathObstacle, front: float, speed: float) -> float:
    """Return when somebody who comes towards the ego or crosses must have left its corridor, s; infinite for others.

    That is the earliest time at which they meet, or a margin before the ego comes where he crosses. The ego's bumper is at
    `front` m of C, its `speed` in m/s.
    """
    gap = max(obstacle.start - front, 0.0)
    if comes_towards(obstacle):
        return gap / (speed + FASTER + obstacle.user.speed)
    if _crosses(obstacle):
        return max(gap / max(speed, 0.1) - CROSSER_MARGIN_S, 0.0)
    return math.inf


def comes_towards(obstacle: PathObstacle) -> bool:
    """Whether somebody in the corridor drives against the ego's way more than across it."""
    return obstacle.along < -STANDING_SPEED and abs(obstacle.across) < -obstacle.along


def _crosses(obstacle: PathObstacle) -> bool:
    return abs(obstacle.across) > max(obstacle.along, STANDING_SPEED)


def _leader(obstacle: PathObstacle, front: float, speed: float, limits: VehicleLimits) -> Leader | None:
    user, start, along = obstacle.user, obstacle.start, obstacle.along
    brakes, gap = user.body.emergency_deceleration, start - front
    if comes_towards(obstacle):
        return Leader(user.id, front + gap * speed / (speed - along), 0.0, brakes)
    if not _crosses(obstacle):
        return Leader(user.id, start, max(along, 0.0), brakes)
    leaves = (user.body.length + limits.width) / abs(obstacle.across)
    if gap > 0.0 and gap / max(speed, 0.1) > leaves + CROSSER_MARGIN_S:
        return None
    return Leader(user.id, start, 0.0, brakes)
