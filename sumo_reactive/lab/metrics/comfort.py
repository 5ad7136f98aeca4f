"""The ego's own figures: comfort, emergencies, how often the pilot ran, wall-clock times."""

from __future__ import annotations

import math
import time as clock
from collections import Counter, deque

import numpy as np

from sumo_reactive.driver.nouns.event import EventKind
from sumo_reactive.driver.nouns.record import StepRecord
from sumo_reactive.lab.metric_names import event_key
from sumo_reactive.lab.metrics.moment import Figures, Moment

STANDSTILL_SPEED = 0.1
"""m/s; slower is standing, as SUMO counts it."""

TURN_S = 1.0
"""SUMO turns its cars by a jerk at each corner of a lane's line; their yaw rate is the mean over this time."""


class Comfort:
    """Extreme accelerations, root mean square of the jerk, seconds standing and off the road, emergencies."""

    def __init__(self, wheelbase: float) -> None:
        self._wheelbase = wheelbase
        self._highest = self._lowest = self._lateral = 0.0
        self._squared_jerk = self._jerk_time = 0.0
        self._standing = self._off_road = self._emergency_time = 0.0
        self._emergencies = 0
        self._before = math.nan
        self._in_emergency = self._is_ours = self._is_placed = False
        self._headings: deque[tuple[float, float]] = deque()

    def see(self, moment: Moment) -> None:
        """Add one step."""
        step = moment.step
        self._is_ours, self._is_placed = step.emergency is not None, step.steering_angle is not None
        steering_angle = self._apparent_angle(step) if step.steering_angle is None else step.steering_angle
        self._lateral = max(self._lateral, step.speed * step.speed * abs(math.sin(steering_angle)) / self._wheelbase)
        self._emergencies += bool(step.emergency) and not self._in_emergency
        self._in_emergency = bool(step.emergency)
        if moment.duration == moment.duration:  # not NaN: not the first step
            self._spend(moment)

    def _apparent_angle(self, step: StepRecord) -> float:
        """Return φ of a car without wheels to steer, as its mean yaw rate would take it: sin φ = L θ̇ / v, rad."""
        self._headings.append((step.time, step.heading))
        while step.time - self._headings[0][0] > TURN_S:
            self._headings.popleft()
        since, before = self._headings[0]
        turn = (step.heading - before + math.pi) % (2.0 * math.pi) - math.pi
        yaw_rate = turn / (step.time - since) if step.time > since else 0.0
        sine = yaw_rate * self._wheelbase / step.speed if step.speed >= STANDSTILL_SPEED else 0.0
        return math.asin(min(1.0, max(-1.0, sine)))

    def _spend(self, moment: Moment) -> None:
        step, duration, acceleration = moment.step, moment.duration, moment.acceleration
        self._highest = max(self._highest, acceleration)
        self._lowest = min(self._lowest, acceleration)
        self._standing += duration if step.speed < STANDSTILL_SPEED else 0.0
        self._off_road += 0.0 if step.lane_id else duration
        self._emergency_time += duration if step.emergency else 0.0
        if self._before == self._before:
            self._squared_jerk += (acceleration - self._before) ** 2 / duration
            self._jerk_time += duration
        self._before = acceleration

    def figures(self) -> Figures:
        """Return the figures; lateral acceleration is v² sin φ / L, at the front axle's speed v.

        Where SUMO moves the vehicle, nobody judges time on no lane, and where no pilot tells of them, emergencies: None.
        """
        jerk = math.sqrt(self._squared_jerk / self._jerk_time) if self._jerk_time else 0.0
        return {
            "max_acceleration_m_s2": round(self._highest, 3),
            "max_braking_m_s2": round(-self._lowest, 3),
            "max_lateral_acceleration_m_s2": round(self._lateral, 3),
            "rms_jerk_m_s3": round(jerk, 3),
            "standstill_s": round(self._standing, 3),
            "off_road_s": round(self._off_road, 3) if self._is_placed else None,
            "emergencies": self._emergencies if self._is_ours else None,
            "emergency_s": round(self._emergency_time, 3) if self._is_ours else None,
        }


class PilotActivity:
    """Runs of the pilot, share of the steps that needed none, events by kind."""

    def __init__(self) -> None:
        self._steps = self._activations = self._free = 0
        self._events: Counter[EventKind] = Counter()

    def see(self, moment: Moment) -> None:
        """Add one step."""
        if moment.step.pilot is None:  # SUMO's own driver has none
            return
        self._steps += 1
        self._activations += moment.step.pilot
        self._free += not moment.step.pilot
        for event in moment.step.events:
            self._events[event.kind] += 1

    def figures(self) -> Figures:
        """Return the figures, the share from 0 to 1; None without a pilot."""
        steps = self._steps
        activity: Figures = {
            "pilot_activations": self._activations,
            "pilot_free_share": round(self._free / steps, 4) if steps else None,
        }
        activity |= {event_key(kind): self._events[kind] for kind in EventKind}
        return activity if steps else dict.fromkeys(activity)


class Timing:
    """Time of the control steps, and how much faster than real time the run was."""

    def __init__(self) -> None:
        self._control_us: list[float] = []
        self._began = self._wall = clock.perf_counter()
        self._first = self._last = math.nan

    def see(self, moment: Moment) -> None:
        """Add one step; SUMO's own driver has no control step."""
        if moment.step.control_us is None:
            return
        self._wall = clock.perf_counter()
        if not self._control_us:
            self._first, self._began = moment.step.time, self._wall
        self._last = moment.step.time
        self._control_us.append(moment.step.control_us)

    def figures(self) -> dict[str, float]:
        """Return mean, 99th percentile and maximum (µs), and simulated time per wall-clock time; empty: no step."""
        if not self._control_us:
            return {}
        times = np.array(self._control_us)
        wall = self._wall - self._began
        return {
            "control_step_mean_us": round(float(times.mean()), 1),
            "control_step_p99_us": round(float(np.percentile(times, 99.0)), 1),
            "control_step_max_us": round(float(times.max()), 1),
            "real_time_factor": round((self._last - self._first) / wall, 1) if wall > 0.0 else 0.0,
        }
