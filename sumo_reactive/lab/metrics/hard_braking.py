"""Hard braking that the ego caused."""

from __future__ import annotations

import math
from collections.abc import Iterator

from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.lab.metrics.moment import Figures, Moment
from sumo_reactive.lab.result import HardBrake

HARD_BRAKING = -4.6
"""m/s²; harder than SUMO's cars brake in comfort (4.5)."""

LEADER_REACH_M = 60.0
"""A leader farther ahead is not the cause."""


class HardBraking:
    """Counts vehicles that begin to brake below −4.6 m/s² while the ego is their leader.

    The leader is the nearest body ahead, within 60 m, that is on the same lane or in the straight corridor of the
    vehicle's width.
    """

    def __init__(self) -> None:
        self.hard_brakes: list[HardBrake] = []
        self._braking: set[str] = set()

    def see(self, moment: Moment) -> None:
        """Note who begins to brake hard behind the ego."""
        if moment.hardest_braking >= HARD_BRAKING and not self._braking:
            return
        braking = {name for name, acceleration in moment.slowing.items() if acceleration < HARD_BRAKING}
        for user in moment.users:
            if user.id in braking and user.id not in self._braking and not user.body.is_person:
                self._judge(user, moment)
        self._braking = braking

    def figures(self) -> Figures:
        """Return the number of vehicles that the ego made brake hard."""
        return {"hard_braking_caused": len(self.hard_brakes)}

    def _judge(self, user: RoadUser, moment: Moment) -> None:
        if _follows_ego(user, moment):
            self.hard_brakes.append(HardBrake(moment.step.time, user.id, moment.step.lane_id))


def _follows_ego(user: RoadUser, moment: Moment) -> bool:
    step = moment.step
    gap = _gap(user, step.x, step.y, step.heading, moment.length, moment.width, step.lane_id)
    return 0.0 <= gap < LEADER_REACH_M and all(not 0.0 <= other < gap for other in _gaps(user, moment))


def _gaps(user: RoadUser, moment: Moment) -> Iterator[float]:
    for other in moment.users:
        if other.id != user.id and not other.body.is_person:
            yield _gap(user, other.x, other.y, other.heading, other.body.length, other.body.width, other.lane_id)


def _gap(user: RoadUser, x: float, y: float, heading: float, length: float, width: float, lane_id: str) -> float:
    """Return the way (m) from the front of `user` to the rear of a body, along its heading; infinite: not in its way."""
    c, s = math.cos(user.heading), math.sin(user.heading)
    dx, dy = x - length * math.cos(heading) - user.x, y - length * math.sin(heading) - user.y
    ahead, aside = dx * c + dy * s, abs(dy * c - dx * s)
    on_the_way = aside < 0.5 * (user.body.width + width) or (bool(lane_id) and lane_id == user.lane_id)
    if not on_the_way or (x - user.x) * c + (y - user.y) * s <= 0.0:
        return math.inf
    return max(0.0, ahead)
