"""Pure pursuit: steer for a point of the way that lies a little ahead, at a speed from which one can stop behind the leader.

Coulter, "Implementation of the pure pursuit path tracking algorithm", CMU-RI-TR-92-01 (1992). It yields to nobody who comes
from the side.
"""

from __future__ import annotations

import math

import numpy as np

from sumo_reactive.driver.nouns.state import Command
from sumo_reactive.lab.drivers.protocol import DriverView, Mission, TripEnd

LOOK_AHEAD_S, LEAST_LOOK_AHEAD_M = 0.8, 5.0
SEARCHED = 400
"""Points of the way that are looked at from the last one on."""


class PurePursuit:
    """The driver; options: `speed_m_s` at most, `lateral_m_s2` in bends, `braking_m_s2` that it counts on."""

    def __init__(self, speed_m_s: float = 13.9, lateral_m_s2: float = 2.0, braking_m_s2: float = 2.0) -> None:
        self.speed, self.lateral, self.braking = speed_m_s, lateral_m_s2, braking_m_s2
        self.reason = ""

    def start(self, mission: Mission) -> None:
        """Keep the way, a point every half metre."""
        line = mission.way
        arc = np.concatenate(([0.0], np.hypot(*np.diff(line, axis=0).T).cumsum()))
        at = np.arange(0.0, arc[-1], 0.5)
        self.way = np.column_stack([np.interp(at, arc, line[:, 0]), np.interp(at, arc, line[:, 1])])
        self.k, self.limits, self.step_length = 0, mission.limits, mission.step_length

    def step(self, view: DriverView) -> Command:
        """Return the command that turns the wheels towards the point ahead."""
        pose, v = view.state.pose, view.state.speed
        front = np.array(pose.ahead(self.limits.wheelbase))
        near = self.way[self.k : self.k + SEARCHED] - front
        self.k += int(np.argmin(np.hypot(*near.T)))
        ahead = max(LEAST_LOOK_AHEAD_M, LOOK_AHEAD_S * v)
        x, y = self.way[min(self.k + int(2.0 * ahead), len(self.way) - 1)] - (pose.x, pose.y)
        bearing = math.atan2(y, x) - pose.heading
        wheel = math.atan2(2.0 * self.limits.wheelbase * math.sin(bearing), math.hypot(x, y))
        rate = (wheel - view.state.steering_angle) / self.step_length
        return Command((self.wished(view, wheel) - v) / max(0.5, self.step_length), rate)

    def end(self, result: TripEnd) -> None:
        """Nothing is left to do."""

    def wished(self, view: DriverView, wheel: float) -> float:
        """Return the speed to drive at, m/s: for bend and limit, and to stop behind the leader or before a red light."""
        bend = math.sqrt(self.lateral * self.limits.wheelbase / max(abs(math.sin(wheel)), 1e-3))
        found, around = [(self.speed, "drives freely"), (bend, "slows for the bend")], view.surroundings
        if around is not None:
            found.append((around.own.limit, "keeps the limit"))
            if around.own.leader is not None:
                found.append((self.before(around.own.leader.gap), f"keeps behind {around.own.leader.id}"))
            if around.light is not None and around.light.letter in "rRyYu":
                found.append((self.before(around.light.distance), f"stops for {around.light.id}"))
        speed, self.reason = min(found)
        return speed

    def before(self, distance: float) -> float:
        """Return the speed from which it stops 2 m before a place, m/s."""
        return math.sqrt(2.0 * self.braking * max(0.0, distance - 2.0))
