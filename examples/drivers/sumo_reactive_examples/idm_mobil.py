"""IDM and MOBIL: how fast by the gap to the leader, on which lane by what a change costs those behind.

Treiber, Hennecke & Helbing, "Congested traffic states in empirical observations and microscopic simulations", Phys. Rev. E
62 (2000); Kesting, Treiber & Helbing, "General lane-changing model MOBIL for car-following models", TRR 1999 (2007). Neither
knows junctions: with `checked` SUMO's own checks see to lights and right of way.
"""

from __future__ import annotations

import math

from sumo_reactive.driver.nouns.surroundings import LaneAround, NextUser
from sumo_reactive.lab.drivers.protocol import DriverView, LaneCommand, Mission, TripEnd

MUST_CHANGE_M, MUST_CHANGE_M_S2 = 300.0, 5.0
"""A lane that leads on for less has to be left for one that leads on farther, which is worth so much more."""


class IdmMobil:
    """The driver; options: `headway_s`, `gap_m` at a stand, `politeness`, the `gain_m_s2` of a change, `checked`."""

    def __init__(
        self, headway_s: float = 1.5, gap_m: float = 2.0, politeness: float = 0.3, gain_m_s2: float = 0.2,
        checked: bool = True,
    ) -> None:  # fmt: skip
        self.headway, self.gap, self.politeness, self.gain, self.checked = headway_s, gap_m, politeness, gain_m_s2, checked
        self.reason = ""

    def start(self, mission: Mission) -> None:
        """Take the car's limits."""
        self.limits = mission.limits

    def step(self, view: DriverView) -> LaneCommand:
        """Return IDM's acceleration on the lane that MOBIL chooses."""
        around, speed = view.surroundings, view.ego.speed
        if around is None:
            return LaneCommand(0.0)
        beside = [lane for lane in (around.inner, around.outer) if lane is not None]
        best = max((around.own, *beside), key=lambda lane: self.worth(lane, around.own, speed))
        leader = best.leader
        self.reason = f"follows {leader.id}, {leader.gap:.1f} m ahead" if leader else "drives freely"
        self.reason += f"; to lane {best.number}" if best is not around.own else ""
        return LaneCommand(self.follow(speed, best.limit, leader), best.number, self.checked)

    def end(self, result: TripEnd) -> None:
        """Nothing is left to do."""

    def worth(self, lane: LaneAround, own: LaneAround, speed: float) -> float:
        """Return what driving on a lane is worth, m/s²: the own acceleration, and in part that of who would follow."""
        if lane is own:
            return self.gain
        gains = self.follow(speed, lane.limit, lane.leader) - self.follow(speed, own.limit, own.leader)
        if min(lane.leads_on, own.leads_on) < MUST_CHANGE_M:
            gains += math.copysign(MUST_CHANGE_M_S2, lane.leads_on - own.leads_on) if lane.leads_on != own.leads_on else 0.0
        if lane.follower is None:
            return gains
        behind = self.follow(lane.follower.speed, lane.limit, NextUser("", lane.follower.gap, speed))
        is_safe = behind > -self.limits.comfort_deceleration and lane.follower.gap > self.gap
        return gains + self.politeness * min(behind, 0.0) if is_safe else -math.inf

    def follow(self, speed: float, limit: float, leader: NextUser | None) -> float:
        """Return IDM's acceleration, m/s²."""
        a, b = self.limits.max_acceleration, self.limits.comfort_deceleration
        free = 1.0 - (speed / min(limit, self.limits.max_speed)) ** 4
        if leader is None:
            return a * free
        wished = self.gap + max(0.0, speed * self.headway + speed * (speed - leader.speed) / (2.0 * math.sqrt(a * b)))
        return max(a * (free - (wished / max(leader.gap, 0.1)) ** 2), -self.limits.emergency_deceleration)
