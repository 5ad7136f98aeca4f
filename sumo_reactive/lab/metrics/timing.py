"""Wall-clock figures: they differ from run to run and are kept apart from all others."""

from __future__ import annotations

import math
import time as clock

import numpy as np

from sumo_reactive.lab.metrics.moment import Moment


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
