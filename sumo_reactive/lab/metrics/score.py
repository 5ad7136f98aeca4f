"""Parts of a driving score after nuPlan's closed-loop score: comfort, time to collision, speed limit."""

from __future__ import annotations

import math

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.lab.metrics.moment import Figures, Moment, is_oncoming

COMFORT_BOUNDS = {
    "max_yaw_rate_rad_s": 0.95, "max_yaw_acceleration_rad_s2": 1.93,
    "max_longitudinal_jerk_m_s3": 4.13, "max_jerk_m_s3": 8.37,
}  # fmt: skip
"""nuPlan's bounds of the absolute values, by figure (metrics_description.md)…"""

MOST_ACCELERATION_M_S2, MOST_BRAKING_M_S2, MOST_LATERAL_M_S2 = 2.40, 4.05, 4.89
"""…and of the smoothed accelerations, m/s²."""

SMOOTHED_STEPS = 15
"""Window of the filter that takes derivatives, an odd number: 1.5 s in steps of 0.1 s."""

LEAST_TTC_S = 0.95
"""nuPlan's bound of the time to collision."""

MOST_OVERSPEED_M_S = 2.23
"""Who drives so much too fast all the time scores 0."""


class Score:
    """The parts that follow from where the ego was, how fast, and who was near."""

    def __init__(self) -> None:
        self._motion: list[tuple[float, float, float]] = []
        self._is_near = self._knows_limits = False
        self._overspeed = self._time = 0.0

    def see(self, moment: Moment) -> None:
        """Add one step."""
        step = moment.step
        self._motion.append((step.time, step.speed, step.heading))
        if not self._is_near and min(moment.times_to_collision, default=math.inf) < LEAST_TTC_S:
            self._is_near = step.speed > 0.0 and _is_near_ahead(moment)
        if moment.duration == moment.duration and moment.world is not None:  # not NaN
            self._add_overspeed(moment.world, moment)

    def _add_overspeed(self, world: RoadGraph, moment: Moment) -> None:
        limit = speed_limit(world, moment.step.lane_id)
        self._knows_limits = True
        self._time += moment.duration
        self._overspeed += max(moment.step.speed - limit, 0.0) * moment.duration

    def figures(self) -> Figures:
        """Return the figures and scores, 0 to 1; None where nothing tells."""
        motion = np.array(self._motion).reshape(-1, 3)
        extremes, is_comfortable = _comfort(motion)
        lost = self._overspeed / (MOST_OVERSPEED_M_S * self._time) if self._time else 0.0
        return {
            **extremes,
            "comfort_score": is_comfortable,
            "ttc_score": int(not self._is_near),
            "speed_limit_score": round(max(0.0, 1.0 - lost), 4) if self._knows_limits else None,
        }


def speed_limit(world: RoadGraph, lane_id: str) -> float:
    """Return the limit (m/s) of a lane, inside a junction the higher one of the roads; infinite: nobody knows it."""
    lane = world.lanes.get(lane_id)
    if lane is not None:
        return lane.speed_limit
    inside = world.connection_of.get(lane_id)
    ends = (inside.from_lane, inside.to_lane) if inside else ()
    return max((world.lanes[name].speed_limit for name in ends if name in world.lanes), default=math.inf)


def _is_near_ahead(moment: Moment) -> bool:
    """Whether somebody not behind the ego's front, and not oncoming, is nearer than the bound."""
    x, y, heading = moment.step.x, moment.step.y, moment.step.heading
    near = np.array(moment.times_to_collision) < LEAST_TTC_S
    boxes = moment.boxes[near]
    ahead = (boxes[:, 0] - x) * math.cos(heading) + (boxes[:, 1] - y) * math.sin(heading) > 0.0
    return bool(np.any(ahead & ~is_oncoming(boxes, heading)))


def _comfort(motion: Floats) -> tuple[Figures, int | None]:
    """Return the extremes by name, and 1 if all is within nuPlan's bounds, else 0, of rows of time, speed, heading.

    None for fewer steps than the filter's window.
    """
    if len(motion) < SMOOTHED_STEPS:
        return dict.fromkeys(COMFORT_BOUNDS), None
    time, speed, heading = motion.T
    step = float(np.median(np.diff(time)))

    acceleration, yaw_rate = slopes(speed, step), slopes(np.unwrap(heading), step)
    lateral = speed * yaw_rate
    jerk, lateral_jerk = slopes(acceleration, step), slopes(lateral, step)
    extremes = dict(zip(
        COMFORT_BOUNDS,
        (float(np.abs(values).max()) for values in (yaw_rate, slopes(yaw_rate, step), jerk, np.hypot(jerk, lateral_jerk))),
        strict=True,
    ))  # fmt: skip
    within = all(extremes[name] <= bound for name, bound in COMFORT_BOUNDS.items())
    within = within and acceleration.max() <= MOST_ACCELERATION_M_S2 and acceleration.min() >= -MOST_BRAKING_M_S2
    within = within and float(np.abs(lateral).max()) <= MOST_LATERAL_M_S2
    return {name: round(value, 3) for name, value in extremes.items()}, int(within)


def slopes(values: Floats, step: float) -> Floats:
    """Return the derivative of values `step` s apart: the slopes of parabolas laid through windows of SMOOTHED_STEPS.

    At each end one parabola gives all (Savitzky & Golay 1964).
    """
    half = SMOOTHED_STEPS // 2
    places = np.arange(-half, half + 1)
    inner = sliding_window_view(values, SMOOTHED_STEPS) @ places / (places @ places)
    ends = (np.polyfit(places, part, 2) for part in (values[:SMOOTHED_STEPS], values[-SMOOTHED_STEPS:]))
    first, last = (2.0 * curve * places + slope for curve, slope, _ in ends)
    found: Floats = np.concatenate((first[:half], inner, last[half + 1 :])) / step
    return found
