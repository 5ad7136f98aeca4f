"""Comfort of the ego's passengers, and where the ego spent its time."""

from __future__ import annotations

import math

from sumo_reactive.lab.metrics.moment import Figures, Moment

STANDING_SPEED = 0.1
"""m/s; slower is standing, as SUMO counts it."""


class Comfort:
    """Extreme accelerations, root mean square of the jerk, seconds standing and off the road, emergencies."""

    def __init__(self, wheelbase: float) -> None:
        self._wheelbase = wheelbase
        self._highest = self._lowest = self._lateral = 0.0
        self._squared_jerk = self._jerk_time = 0.0
        self._standing = self._off_road = self._emergency_time = 0.0
        self._emergencies = 0
        self._before = math.nan
        self._in_emergency = False

    def see(self, moment: Moment) -> None:
        """Add one step."""
        step = moment.step
        self._lateral = max(self._lateral, step.speed * step.speed * abs(math.sin(step.steering_angle)) / self._wheelbase)
        self._emergencies += step.emergency and not self._in_emergency
        self._in_emergency = step.emergency
        if moment.duration == moment.duration:  # not NaN: not the first step
            self._spend(moment)

    def _spend(self, moment: Moment) -> None:
        step, duration, acceleration = moment.step, moment.duration, moment.acceleration
        self._highest = max(self._highest, acceleration)
        self._lowest = min(self._lowest, acceleration)
        self._standing += duration if step.speed < STANDING_SPEED else 0.0
        self._off_road += 0.0 if step.lane_id else duration
        self._emergency_time += duration if step.emergency else 0.0
        if self._before == self._before:
            self._squared_jerk += (acceleration - self._before) ** 2 / duration
            self._jerk_time += duration
        self._before = acceleration

    def figures(self) -> Figures:
        """Return the figures; lateral acceleration is v² sin φ / L, at the front axle's speed v."""
        jerk = math.sqrt(self._squared_jerk / self._jerk_time) if self._jerk_time else 0.0
        return {
            "max_acceleration_m_s2": round(self._highest, 3),
            "max_braking_m_s2": round(-self._lowest, 3),
            "max_lateral_acceleration_m_s2": round(self._lateral, 3),
            "rms_jerk_m_s3": round(jerk, 3),
            "standstill_s": round(self._standing, 3),
            "off_road_s": round(self._off_road, 3),
            "emergencies": self._emergencies,
            "emergency_s": round(self._emergency_time, 3),
        }
