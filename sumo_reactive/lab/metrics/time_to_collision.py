"""Smallest time to collision."""

from __future__ import annotations

import math

from sumo_reactive.lab.metrics.moment import Figures, Moment

HORIZON_S = 10.0
"""Longer times are no conflict."""


class TimeToCollision:
    """min δ / ‖v − v_D‖: both bodies keep their velocities, δ is exact for their boxes (F&L 1991, §3.3.2).

    Straight extrapolation: cars that meet on a bend are on collision course for a moment without any danger.
    """

    def __init__(self) -> None:
        self._smallest = HORIZON_S
        self._when = math.nan

    def see(self, moment: Moment) -> None:
        """Note the smallest time of this step."""
        smallest = min(moment.times_to_collision, default=math.inf)
        if smallest < self._smallest:
            self._smallest, self._when = smallest, moment.step.time

    def figures(self) -> Figures:
        """Return the smallest time and when it was; None if no one was on collision course."""
        if math.isnan(self._when):
            return {"min_time_to_collision_s": None, "min_time_to_collision_at_s": None}
        return {"min_time_to_collision_s": round(self._smallest, 3), "min_time_to_collision_at_s": round(self._when, 3)}
