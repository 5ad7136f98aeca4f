"""Every compiled kernel that a control step may call, loaded before the first one."""

from __future__ import annotations

import numpy as np

from sumo_reactive.driver.field.velocity import carried_out
from sumo_reactive.driver.geometry.curve import project_on_curve
from sumo_reactive.driver.geometry.polyline import Polyline
from sumo_reactive.driver.pilot.assessment import time_of
from sumo_reactive.driver.vehicle.safe_speed import following_speed, stopping_speed
from sumo_reactive.driver.view.corridor import blocking_ones, related
from sumo_reactive.driver.view.foresee import point_at, turned


def load_kernels() -> None:
    """Call those that a first step on an empty road need not call, with arguments of the kinds that steps give them.

    The first call of a process takes some milliseconds, in which its code comes from the disk.
    """
    path, boxes = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]), np.zeros((1, 6))
    x, y, _ = (np.ascontiguousarray(column) for column in path.T)
    Polyline(path[:, :2]).sampled(1.0)
    project_on_curve(0.0, 0.0, x, y, 1.0, 0.0, 1.0)
    turned(path, 0.0, 1.0, 0.0, 1.0)
    point_at(path, 0.0)
    related(boxes, 0.0, 0.0, 0.0, 0.0, 1.0, x, y, y, 1.0, 0.0, 1.0, y, y, 0.0)
    blocking_ones(boxes, x, y, y, 1.0, 0.0, 1.0, y, y, 0.0)
    stopping_speed(1.0, 1.0, 1.0)
    following_speed(1.0, 1.0, 1.0, 1.0)
    time_of(np.zeros((1, 5)), 1.0, 1.0)
    carried_out(y, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0)
